"""Selection of a board's components: preferred values for a design, and its front ends.

Ideal values come in; values of the series that are sold go out, by reference designator
(`select_components`).

>>> from fingertip.board.components.selection import nearest_value
>>> nearest_value(2375.4, "E24")
2400.0
"""
