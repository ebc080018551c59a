"""The silicone skin as it is worn: the outer form around the bone, the sensor lying flush in its pocket."""

from __future__ import annotations

from fingertip.cad.shapes.core import inside_skin
from fingertip.cad.solids import Form, Solid, difference, scaled
from fingertip.design import Design


def skin(design: Design) -> Solid:
    """The skin after curing, with its designed size."""
    return difference(Form(design.dimensions.outer), inside_skin(design))


def cavity(design: Design) -> Solid:
    """The closed mold's cavity: the outer form, larger by the silicone's shrinkage.

    A sleeve shrinks freely, and its core is larger by as much. Overmolded silicone is held by the bone and shrinks
    towards it by three times the linear figure of its thickness; at a thickness of a third of the finger's half width
    that is the same distance.
    """
    return scaled(Form(design.dimensions.outer), design.dimensions.shrinkage)
