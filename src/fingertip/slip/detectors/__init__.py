"""Slip detectors behind one interface: samples come in, in any chunks, and ON or OFF goes out for
each.

`registry` names them, with those that other packages bring.

>>> from fingertip.design import Design
>>> from fingertip.slip.detectors.registry import make_detector
>>> make_detector("fft", Design()).process([1.0, 1.0, 1.0]).on.tolist()
[False, False, False]
"""
