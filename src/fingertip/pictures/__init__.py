"""Pictures and drawings of the parts, rendered in software: no display or graphics card is needed.

In: a design, or meshes and a camera. Out: PNG, and SVG and PDF of drawings.

>>> from fingertip.pictures.section import spread
>>> spread([4.0, 4.0], [5.0, 6.0], 20.0)  # widths of two names, and where each is wanted
[3.5, 7.5]
"""
