"""Command `python -m tools.figures.pad`: figures of docs/pad.md by the layer model, as JSON."""

from __future__ import annotations

import json
import math
from dataclasses import replace

from fingertip.cad.verification.skin import pull_off_n
from fingertip.design import Design
from fingertip.pad.layer import find_contacts, find_rest_n
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.survey import TILTS_DEG, find_turn_on_n, survey_pad
from fingertip.pad.touch import Pose

FORCES_N = (0.3, 1.0, 5.0)
TILT_DEG = 2.0
STEEP_DEG = 12.0
ROLLED_DEG = 8.0
STRAIGHT = ["skin.crown_radius_mm=0", "bone.platform_mm=0", "bone.base_length_mm=20"]
"""Changes of the default design that give a straight pad."""
SOFT = ["silicone.product=own", "silicone.modulus_mpa=1.18"]
CHANGES = {
    "modulus": (SOFT, ["silicone.product=own", "silicone.modulus_mpa=2.36"]),
    "radius": ([], ["skin.crown_radius_mm=14"]),
    "offset": ([], ["skin.crown_offset_mm=0.7"]),
    "width": ([], ["skin.width_mm=18"]),
}
"""Changes of the default design that are compared: before, after."""


def find_share(
    form: PadForm, tilt_deg: float = TILT_DEG, roll_deg: float = 0.0, force_n: float = 1.0
) -> float:
    """Find the share of a force that reaches the sensor."""
    (contact,) = find_contacts(form, Pose(tilt_deg, roll_deg), (force_n,), math.inf)
    return contact.share


def compare(design: Design, changed: Design) -> dict[str, float]:
    """Compare a changed design with a design: relative changes at 1 N."""
    before = PadForm.of_design(design)
    after = PadForm.of_design(changed)
    stiffer = survey_pad(changed).stiffness_n_per_mm / survey_pad(design).stiffness_n_per_mm

    return {
        "stiffness": stiffer - 1.0,
        "share": find_share(after) / find_share(before) - 1.0,
        "share_steep": find_share(after, STEEP_DEG) / find_share(before, STEEP_DEG) - 1.0,
        "share_rolled": find_share(after, roll_deg=ROLLED_DEG)
        / find_share(before, roll_deg=ROLLED_DEG)
        - 1.0,
    }


def list_fits(design: Design) -> dict[str, PadForm]:
    """List forms of the inside of a skin: bonded, without its bump at several gaps, and with it."""
    tight = PadForm.of_design(design)
    flat = replace(tight, bump_height_mm=0.0, bump_radius_mm=0.0)
    return {
        "bonded": replace(flat, bonded=True),
        "lies_on": flat,
        "off_0.05": replace(flat, gap_mm=0.05),
        "off_0.2": replace(flat, gap_mm=0.2),
        "bump_loosest": PadForm.of_design(design, is_loose=True),
        "bump_tightest": tight,
    }


def main() -> None:
    """Print all figures."""
    default = Design.load("fsr400")
    first = Design.load("first_finger")
    fits = list_fits(first)
    data = {
        "tilts_deg": TILTS_DEG,
        "straight": survey_pad(Design.load("fsr400", changes=STRAIGHT)).shares,
        "crown": survey_pad(default).shares,
        "changes": {
            name: compare(
                Design.load("fsr400", changes=before), Design.load("fsr400", changes=after)
            )
            for name, (before, after) in CHANGES.items()
        },
        "fits": {
            name: {
                "shares": [find_share(form, force_n=force_n) for force_n in FORCES_N],
                "rest_n": find_rest_n(form),
            }
            for name, form in fits.items()
        },
        "turn_on_n": {
            name: find_turn_on_n(fits[name], TILT_DEG) for name in ("bonded", "bump_tightest")
        },
        "pull_off_n": {"plain": pull_off_n(first), "glued": pull_off_n(first, is_glued=True)},
    }
    print(json.dumps(data, indent=1, allow_nan=False))


if __name__ == "__main__":
    main()
