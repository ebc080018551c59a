"""Silicone skin and the mold cavity in which it is cast."""

from __future__ import annotations

from fingertip.cad.shapes.insert import skin_interior
from fingertip.cad.solids import Solid, SuperconicSolid, difference, scaled
from fingertip.design import Design


def skin(design: Design) -> Solid:
    """Build the cured skin at its design size, unstretched."""
    return difference(SuperconicSolid(design.dimensions.outer), skin_interior(design))


def cavity(design: Design) -> Solid:
    """Build the cavity of the closed mold: the outer surface, enlarged to allow for silicone shrinkage.

    A sleeve shrinks freely, and its core is enlarged by the same factor. An overmolded skin is held by the bone: its
    volume shrinkage, three times the linear one, reduces its thickness only. The distance is the same as for free
    shrinkage where the skin is a third of the finger's half width thick.
    """
    return scaled(SuperconicSolid(design.dimensions.outer), design.dimensions.shrinkage)
