"""Checks of the pad: what the sensor feels. They warn; a finger with a deaf sensor can be printed and cast."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress

from fingertip.cad.verification.check import Check
from fingertip.design import Design
from fingertip.foundation.comparison import Relation
from fingertip.foundation.errors import DesignError
from fingertip.pad.survey import FIRM_N, FORCE_N, GRASP_DEG, MAX_TURN_ON_N, TILTS_DEG, WIDE_DEG, survey_pad

WANTED_SHARE, WANTED_EVENNESS = 0.4, 0.6
"""Least share of a force that should reach the sensor in a grasp, and over the largest one there. Assumptions."""
_MAX_STRAIN = 1.0
"""Indentation by the whole thickness, which no finger survives."""
WANTED_TURN_ON_N, WANTED_STRAIN = 1.0, 0.3
"""Force on the pad at which the sensor should be on, and largest strain for which small strain is a fair model."""
_STEPS = {"bone.collar_inset_mm": 0.05, "sensor.distance_from_tip_mm": 0.5}
"""Lengths that let skin, not collar, meet a plate that is tilted tip up -> step of which eight are tried [mm]."""


def check_pad(design: Design) -> Iterator[Check]:
    survey = survey_pad(design)
    share, turn_on = survey.least_share(*GRASP_DEG), survey.worst_turn_on_n
    grasp = f"{GRASP_DEG[0]:g} to {GRASP_DEG[1]:g} degrees"
    remedy = "an insert or harder silicone helps"
    if design.skin.crown_radius_mm == 0.0:
        remedy = "begin with fsr400, whose pad has a crown"
    yield _warn(
        "pad.share", share, 0.0, "", share < WANTED_SHARE,
        f"{share:.0%} of {FORCE_N:g} N reaches the sensor at some tilt of {grasp}, below {WANTED_SHARE:.0%}; {remedy}.",
    )  # fmt: skip
    yield _warn(
        "pad.evenness", survey.evenness, 0.0, "", survey.evenness < WANTED_EVENNESS,
        f"a turn of the finger by {grasp} changes the signal {1 / max(survey.evenness, 0.001):.3g} times, as a grip "
        f"does; {remedy}.",
    )  # fmt: skip
    never, tilts = turn_on == math.inf, zip(TILTS_DEG, survey.turn_on_n, strict=True)
    deaf = [f"{tilt:g}" for tilt, force in tilts if force > WANTED_TURN_ON_N and WIDE_DEG[0] <= tilt <= WIDE_DEG[1]]
    feels = f"turns on at {turn_on:.2g} N, not below {WANTED_TURN_ON_N:g} N"
    if never:
        feels = f"feels no force up to {MAX_TURN_ON_N:g} N"
    mend = _find_mend(design) if turn_on > WANTED_TURN_ON_N and design.skin.crown_radius_mm else remedy
    yield _warn(
        "pad.turn_on_force", MAX_TURN_ON_N if never else turn_on, MAX_TURN_ON_N, "N", turn_on > WANTED_TURN_ON_N,
        f"on a plate tilted by {', '.join(deaf)} degrees (below 0: tip up) the sensor {feels}; {mend}.", never,
    )  # fmt: skip
    yield _warn(
        "pad.strain", survey.strain, _MAX_STRAIN, "", survey.strain > WANTED_STRAIN,
        f"{FIRM_N:g} N presses the pad by {survey.strain:.0%} of its thickness, above {WANTED_STRAIN:.0%}, where these "
        "figures err; use a harder or thicker silicone.",
    )  # fmt: skip


def _find_mend(design: Design) -> str:
    """Try values with which the sensor turns on in time."""
    for name, value in (
        (name, round(design.value(name) + i * _STEPS[name], 2)) for name in _STEPS for i in range(1, 9)
    ):
        with suppress(DesignError):
            tried = Design.without_remedies(**design.with_values({name: value}).model_dump())
            if survey_pad(tried).worst_turn_on_n <= WANTED_TURN_ON_N:
                return f"it turns on with {name}={value:g}"
    return f"no larger {' or '.join(_STEPS)} that was tried helps"


def _warn(
    name: str, value: float, limit: float, unit: str, is_wanting: bool, warning: str, is_beyond: bool = False
) -> Check:
    relation: Relation = "at most" if limit else "at least"
    return Check(name, value, limit, unit, relation, warning if is_wanting else "", is_beyond=is_beyond)
