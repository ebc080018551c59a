"""Formulas in closed form that rules, checks and the board share: filter, amplifiers, supply,
stress and knocks.

In: numbers in the units that their names end in. Out: numbers.

>>> from fingertip.design.formulas.stress_and_knock import hole_in_tension
>>> round(hole_in_tension(0.0, 10.0), 2)  # a small hole triples the stress of a wide bar
3.0
"""
