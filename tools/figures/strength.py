"""Command `python -m tools.figures.strength`: what the bones of the bundled designs
hold, as JSON.
"""

from __future__ import annotations

import json

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.verification.strength import assess_strength
from fingertip.design import Design

DESIGNS = ("first_finger", "fsr402", "fsr400", "article")
FINGERS = (
    "adult_finger",
    "adult_thumb",
    "youth_finger",
    "youth_thumb",
    "child_finger",
    "child_thumb",
)
RESINS = ("durable", "clear", "surgical_guide")
TOLERANCE_MM = 0.01
MIN_FACTOR = 2.0


def assess(design: Design) -> dict[str, float]:
    """Assess a bone: grip at a safety factor of 2.0, grip that
    breaks it [N], and knock that breaks it [m/s].
    """
    strength = assess_strength(design, MeshEvaluator(TOLERANCE_MM))
    return {
        "grip_n": strength.breaks_n / MIN_FACTOR,
        "breaks_n": strength.breaks_n,
        "knock_m_s": strength.knock_m_s,
    }


def main() -> None:
    """Print all figures."""
    petg = {
        name: assess(Design.load(name, changes=["strength.print_material=petg"]))
        for name in DESIGNS + FINGERS
    }
    resins = {
        resin: [
            assess(Design.load(name, changes=[f"strength.print_material={resin}"]))
            for name in FINGERS
        ]
        for resin in RESINS
    }
    print(
        json.dumps(
            {"petg": petg, "fingers": [petg[name] for name in FINGERS], "resins": resins}, indent=1
        )
    )


if __name__ == "__main__":
    main()
