"""Calibration: measurements come in, and parameters of a design go out.

Caliper readings of printed parts give those of the printer, weighings those of the sensor.

>>> from fingertip.calibration.printer import calibrate_printer
>>> from fingertip.design import Design
>>> calibrate_printer(Design(), 11.5).changes
{'printer.offset_mm': 0.09}
"""
