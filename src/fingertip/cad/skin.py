"""The silicone skin: the outer form around the bone, the sensor lying flush in its pocket."""

from __future__ import annotations

from fingertip.cad.bone import core
from fingertip.cad.solids import Form, Solid, difference
from fingertip.design import Design


def skin(design: Design) -> Solid:
    """The skin as cast: the closed cavity less the core."""
    return difference(Form(design.dimensions.outer), core(design))
