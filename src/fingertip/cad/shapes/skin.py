"""Silicone skin and the mold cavity in which it is cast."""

from __future__ import annotations

from fingertip.cad.shapes.chaplet import boss, hole_in_skin
from fingertip.cad.shapes.insert import skin_interior
from fingertip.cad.solids import Solid, SuperconicSolid, difference, scaled
from fingertip.design import Design


def skin(design: Design) -> Solid:
    """Build the cured skin at its design size, unstretched, with the hole that the chaplet leaves."""
    return difference(SuperconicSolid(design.dimensions.outer), skin_interior(design), *hole_in_skin(design))


def cavity(design: Design) -> Solid:
    """Build the cavity of the closed mold: its outline without the boss of the chaplet."""
    outline, bosses = cavity_outline(design), boss(design)
    return difference(outline, *bosses) if bosses else outline


def cavity_outline(design: Design) -> Solid:
    """Build the outline of the cavity: the outer surface, enlarged to allow for silicone shrinkage.

    A sleeve shrinks freely, and its core is enlarged by the same factor. An overmolded skin is held by the bone: its
    volume shrinkage, three times the linear one, reduces its thickness only. The distance is the same as for free
    shrinkage where the skin is a third of the finger's half width thick.
    """
    return scaled(SuperconicSolid(design.dimensions.outer), design.dimensions.shrinkage)
