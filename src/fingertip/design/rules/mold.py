"""Rules of the mold: its walls beside the cavity hold what is cut into them."""

from __future__ import annotations

from fingertip.design.geometry import DesignTables
from fingertip.design.geometry.mold_layout import BELT_MM
from fingertip.design.rules.ruleset import Limit, Ruleset

RULES = Ruleset()


@RULES.at_least("mold.wall_mm")
def wall_holds_cuts(design: DesignTables) -> Limit:
    depth, wall = max(BELT_MM[1], design.mold.engraving_depth_mm), design.printer.min_wall_mm
    return Limit(depth + wall, f"leaves less than printer.min_wall_mm={wall:g} behind belts and letters")
