"""Firmware of a design: the detector `fast` as a C99 library, sketches, wiring and costs.

`fingers` plans which inputs of which controller read which finger.

>>> from fingertip.design import Design
>>> from fingertip.firmware.fingers import list_controllers
>>> list_controllers(Design())[0].key
'teensy40'
"""
