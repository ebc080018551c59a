"""Plan of the work by days: what waits for a cure, from the data of the silicone and the steps of the design."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from fingertip.casting.uses import uses_adhesive

Data = Mapping[str, Any]

_HOURS_PER_DAY = 24.0
_ADHESIVE_DAYS = 1
"""Days for which the plan lets adhesive cure, whose time only its maker knows. An assumption."""


def plan_data(data: Data) -> list[dict[str, Any]]:
    """List the stages of the work: the day on which each begins at the earliest, its work, and what it waits for."""
    cure_h = data["silicone"]["properties"]["cure_h"]["high"]
    silicone_days = max(1, math.ceil(cure_h / _HOURS_PER_DAY))
    cured = f"cure of the silicone: {cure_h:g} h"
    adhesive = "cure of the adhesive: as its maker says"
    is_glued, is_patched = uses_adhesive(data), data["chaplet"] is not None
    stages: list[tuple[str, str, int]] = []
    if is_glued:
        stages.append(("spread a sample of the adhesive for the test of the cure", adhesive, _ADHESIVE_DAYS))
    tried = "all parts, the mold and the syringe" if data["filling"]["syringe"] else "all parts and the mold"
    stages.append((f"test the cure; meanwhile try {tried}", cured, silicone_days))
    mounting = "mount and wire the sensor"
    if data["insert"] == "core":
        stages.append(("release the mold, close it around the core, mix and fill", cured, silicone_days))
        opening = f"open the mold and roll the skin off; {mounting}"
        stages += _glue(opening, adhesive, is_glued)
        finishing = f"{'' if is_glued else opening + '; '}cover the sensor and pull the skin on"
    else:
        stages += _glue(f"release the mold, {mounting}", adhesive, is_glued)
        before = "" if is_glued else f"release the mold, {mounting}, "
        primer = "cover the sensor and tape the seat; prime the bone, which dries as the primer's maker says"
        filling = "close, mix and fill within the open time of the primer"
        stages.append((f"{before}{primer}; {filling}", cured, silicone_days))
        finishing = "open the mold and trim the skin"
    patching = "; patch the hole of the screw" if is_patched else ""
    stages.append((f"{finishing}{patching}", cured if is_patched else "", 0))
    plan, day = [], 1
    for work, wait, days in stages:
        plan.append({"day": day, "work": work, "wait": wait})
        day += days
    return plan


def _glue(work: str, adhesive: str, is_glued: bool) -> list[tuple[str, str, int]]:
    """Return the stage that glues; none without adhesive, whose work the next stage then begins with."""
    return [(f"{work}, and seal with adhesive", adhesive, _ADHESIVE_DAYS)] if is_glued else []
