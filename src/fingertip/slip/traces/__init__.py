"""Traces: a file of a recording comes in, and validated columns of samples go out.

A column has the name of its quantity, which another one of the file may stand for.

>>> from fingertip.slip.traces.cells import split_cells
>>> split_cells("0.0005; 1.25", ";")
['0.0005', ' 1.25']
"""
