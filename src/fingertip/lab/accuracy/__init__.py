"""Accuracy of simulated traces: errors of the time step against run time, what each stage adds, and
extreme cases.

A design comes in; tables, data and a picture go out (`fingertip accuracy`). A case depends on its
number alone:

>>> from fingertip.lab.accuracy.extremes import try_cases
>>> [case.is_held for case in try_cases("contact, resonance", [0])]
[True]
"""
