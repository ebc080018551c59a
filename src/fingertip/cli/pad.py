"""Command `fingertip pad`: what part of a force reaches the sensor, in the poses in which a finger presses."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from fingertip.cli.console import Console
from fingertip.cli.options import DesignArgument, SetOption, command, load_design

if TYPE_CHECKING:
    from fingertip.pad.survey import PadSurvey


@command
def pad(console: Console, design: DesignArgument, changes: SetOption = None) -> None:
    """State what the sensor feels of a force on the pad: its share over tilt and roll, turn-on, stiffness and strain.

    A layer model of the silicone on the bone computes the contact with a flat, rigid plate. At a tilt of 0 the straight
    part of the pad at its base is parallel to the plate; a positive tilt turns the tip down.
    `fingertip picture DESIGN --pad` draws the same over the place and the force.
    """
    from fingertip.pad.form import PadForm
    from fingertip.pad.survey import survey_pad

    loaded = load_design(design, changes, console)
    survey, form = survey_pad(loaded), PadForm.of_design(loaded)
    data: dict[str, Any] = {"design": loaded.name, "young_mpa": round(form.young_mpa, 4), **survey.to_dict()}
    console.result(data, "\n".join(_list_lines(loaded.name, form.young_mpa, survey)))


def _list_lines(name: str, young_mpa: float, survey: PadSurvey) -> list[str]:
    from fingertip.pad.survey import FIRM_N, FORCE_N, ROLL_DEG, ROLLED_TILT_DEG, TILTS_DEG

    def row(title: str, texts: list[str]) -> str:
        return f"{title:<30}" + "".join(f"{text:>7}" for text in texts)

    turn_on = [f"{force:.2f}" if force < math.inf else "never" for force in survey.turn_on_n]
    return [
        f"{name}: what the sensor feels on a flat plate (layer model, {young_mpa:.2g} MPa)",
        row("tilt, tip down [deg]", [f"{tilt:g}" for tilt in TILTS_DEG]),
        row(f"share of {FORCE_N:g} N", [f"{share:.2f}" for share in survey.shares]),
        row("force at turn-on [N]", turn_on),
        f"share at a roll of {ROLL_DEG:g} deg and a tilt of {ROLLED_TILT_DEG:g}: {survey.rolled_share:.2f}",
        f"evenness, least over largest share at 0 to 10 deg: {survey.evenness:.2f}",
        f"stiffness at {FORCE_N:g} N: {survey.stiffness_n_per_mm:.1f} N/mm; indentation at {FIRM_N:g} N: "
        f"{survey.strain:.0%} of the thickness",
    ]
