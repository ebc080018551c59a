"""Solid of each part, and the registry of the parts that a design has: a design comes in, and an
expression goes out.

>>> from fingertip import Design
>>> from fingertip.cad.shapes.parts import PARTS
>>> solid = PARTS["skin"].solid(Design())
>>> type(solid).__name__
'Difference'
"""
