"""Fitting: what follows from wishes and measurements moves until a design can be made.

A design with changes comes in, or a name and a sensor, or the file of an earlier version. A design
that passes all rules and holds its loads goes out, with what moved and why.

>>> from fingertip.design import Design
>>> from fingertip.fitting.fitting import fit_design
>>> fit_design(Design(), {"skin.width_mm": 17.0}).skin.width_mm
17.0
"""
