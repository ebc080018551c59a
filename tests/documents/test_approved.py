"""Documents of twelve designs, compared whole with approved ones.

After a change that is meant, `FINGERTIP_APPROVE=1 pytest tests/documents` writes them; then read the difference.
"""

from __future__ import annotations

import functools
import json
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from fingertip.cad.printing.print_files import parts_on_plates
from fingertip.cad.printing.settings import PLATE_KINDS
from fingertip.cad.printing.slicer import PrintEstimate
from fingertip.casting.quantities import SiliconeVolumes
from fingertip.catalogues.silicones import MaterialProperty, Silicone, load_silicones
from fingertip.design import Design
from fingertip.design.finger_set import load_set
from fingertip.documents.acceptance import acceptance_data, render_acceptance
from fingertip.documents.casting.sheet import casting_sheet_data, render_sheet, steps
from fingertip.documents.firmware import render_readme
from fingertip.documents.robot import describe_model, render_robot_readme, render_set_readme
from fingertip.documents.start import render_basis_table, render_start
from fingertip.firmware.fingers import plan_fingers
from fingertip.robot.model import build_finger
from tests.approved import check_text
from tests.conftest import ROOT, design_file

SILICONES = load_silicones()

APPROVED = Path(__file__).parent / "approved"
TEMPLATES = ROOT / "src/fingertip/documents"
DOCUMENTS = ("casting", "acceptance", "firmware", "robot", "start", "basis")
ROBOTS = {"adult_finger": "urdf", "fsr400": "mjcf"}
"""Design whose model is built -> format."""

MOLD_WITHOUT_CHAPLET = "mold.chaplet_diameter_mm=0 mold.fit_clearance_mm=0.01 printer.surface_error_mm=0"
STRAIGHT = (
    "skin.crown_radius_mm=0 bone.platform_mm=0 skin.semi_axis_palmar_mm=6 skin.pulp_fullness=0.8845 "
    "bone.palmar_fullness=0.9422 skin.thickness_side_mm=2 skin.thickness_tip_mm=2.5 mold.chaplet_from_tip_mm=10"
)
"""The same finger with a straight pad, whose tape and vents differ."""
CALIBRATED_CURVE = (
    "force_curve.curve=calibrated force_curve.min_force_n=0.5 force_curve.max_force_n=3 force_curve.interval_factor=1.2"
)
ONE, THICK = MaterialProperty(1.0, 1.0, "design"), MaterialProperty(1.2, 1.2, "design")
WEIGHED = replace(SILICONES["mold_star_30"], density_a_g_cm3=THICK, density_b_g_cm3=ONE)
HASTY = replace(SILICONES["sylgard_184"], pot_life_min=MaterialProperty(8.0, 8.0, "design"))
LARGE, SMALL = SiliconeVolumes(12.625, 0.5, 0.125), SiliconeVolumes(2.0, 0.01, 0.003)
ESTIMATES = {"plate_fdm": PrintEstimate(90.4, 20.04), "plate_fdm_2": PrintEstimate(31.6, 2.98)}

DESIGNS: dict[str, tuple[str, str, Silicone, dict[str, Any]]] = {
    # name of the files: bundled design, changes, silicone, and what else the sheets depend on
    "fsr400": ("fsr400", "", SILICONES["addition_40a"], {"weak": True}),
    "fsr402": ("fsr402", "board.channels=3", SILICONES["smooth_sil_940"], {"pictures": True}),
    "fsr400_compact": ("fsr400_compact", "", SILICONES["dragon_skin_30"], {"prints": ESTIMATES}),
    "article": ("article", "", HASTY, {"delays_s": ()}),
    "adult_finger": ("adult_finger", "", SILICONES["addition_40a"], {}),
    "child_thumb": (
        "child_thumb", f"{CALIBRATED_CURVE} {MOLD_WITHOUT_CHAPLET}",
        SILICONES["mold_star_30"], {"volumes": SMALL},
    ),
    "david_finger": ("hands/david_finger", "", SILICONES["ecoflex_00_30"], {}),
    "socket": (
        "fsr400", "name=A_very-long_name_with-forty_characters_1 bone.interface=socket bone.base_length_mm=32 "
        "sensor.insert=mushroom sensor.insert_height_mm=0.5 mold.key_diameter_mm=8.2 mold.land_mm=4",
        WEIGHED, {"volumes": SMALL, "delays_s": (0.025, 0.01)},
    ),
    "flange": (
        "fsr400", "bone.interface=flange bone.base_length_mm=27 mold.fit_clearance_mm=0.1 mold.seat_tape_mm=0 "
        f"printer.scale_percent=100.4 printer.offset_mm=0.06 bone.groove_depth_mm=0.9 bone.wall_mm=0.8 {STRAIGHT} "
        "strength.print_material=petg board.variant=comparator",
        SILICONES["condensation_40a"], {"delays_s": (0.025, None)},
    ),
}  # fmt: skip


FILES = ("README.md", "bringup.md", "wiring.svg")


def describe_build(
    design: Design, data: dict[str, Any], is_whole: bool
) -> tuple[dict[str, Any], list[float], set[str]]:
    """Report, size and files of a build; those that are not whole have neither board nor resin plate."""
    warning = "the bone is expected to break at 39 N, below strength.shock_force_n = 60 N, at the collar."
    checks = [
        {"name": "bone.safety_factor.shock", "passed": True, "warning": warning},
        {"name": "pad.turn_on_force", "passed": True, "warning": "the sensor turns on at 3 N; an insert helps."},
        {"name": "mold.wall", "passed": True},
    ]
    parts = {name: {"volume_mm3": 1234.5} for name in ("bone", "skin", "mold_palmar", "mold_dorsal")}
    plates = {f"print/plate_{kind.name}.3mf": {"parts": list(parts_on_plates(design, kind))} for kind in PLATE_KINDS}
    files = {f"board/{name}" for name in FILES} | {"acceptance.md", *plates} if is_whole else {"print/plate_fdm.3mf"}
    files = files if design.name != "fsr400" or is_whole else set()
    return {"checks": checks, "parts": parts, "print": plates, "casting": data}, [18.0, 16.4, 61.8], files


@functools.cache
def render_documents(name: str) -> dict[str, str]:
    """Render the documents of a design."""
    file, changes, silicone, given = DESIGNS[name]
    design = Design.load(design_file(file), changes=changes.split())
    warnings = ["bone.safety_factor.grip: the bone breaks"] if given.get("weak") else []
    data = casting_sheet_data(design, given.get("volumes", LARGE), silicone, given.get("prints"), warnings)
    pictures = [f"steps/{step.picture}.png" for step in steps(data)] if given.get("pictures") else []
    assert json.loads(json.dumps(data)) == data
    score = SimpleNamespace(delays_s=given.get("delays_s", (0.01,)))
    detection: Any = SimpleNamespace(detector="fast", memory_s=0.1, score=score)
    robot = {}
    if name in ROBOTS:
        robot["robot"] = render_robot_readme(describe_model(build_finger(design), ROBOTS[name]), [design.name])
    return robot | {
        "start": render_start(design, *describe_build(design, data, bool(pictures)), len(steps(data)), "✓ All passed"),
        "basis": render_basis_table(design),
        "casting": render_sheet(data, pictures),
        "acceptance": render_acceptance(acceptance_data(design, detection)),
        "firmware": render_readme(design, plan_fingers(design, "5" if name == "adult_finger" else None)),
    }


def test_readme_of_the_model_of_a_set_is_the_approved_one() -> None:
    places_m = {"thumb": -0.03, "index": 0.0, "middle": 0.03, "ring": 0.06, "little": 0.09}
    check_text(APPROVED / "set_hand_robot.md", render_set_readme(load_set("adult_hand"), "finger.xml", places_m))
    urdf = render_set_readme(load_set("adult_hand"), "finger.urdf", places_m)
    assert "change `origin` of their joints" in urdf


@pytest.mark.every_case
@pytest.mark.parametrize("name", DESIGNS)
def test_documents_are_the_approved_ones(name: str) -> None:
    for document, text in render_documents(name).items():
        check_text(APPROVED / f"{name}_{document}.md", text)


UNUSED = {"thinner than the hole of"}
"""Texts that no design gives: every screw of the catalogue leaves room for a needle."""


def list_texts(template: str) -> set[str]:
    """Texts of a template between its expressions and statements, of three words or more."""
    plain = re.sub(r"^#+ [^\n]*$|\{#.*?#\}|\{%.*?%\}|\{\{.*?\}\}", "\0", template, flags=re.DOTALL | re.MULTILINE)
    texts = (" ".join(text.split()) for line in plain.split("\0") for text in re.split(r"\n\n|\n- |\|", line))
    return {text for text in texts if text.count(" ") >= 2}


def test_every_sentence_stands_in_an_approved_document() -> None:
    """Documents of boards, validations and a first finger have tests of their own."""
    approved = " ".join(" ".join(path.read_text(encoding="utf-8").split()) for path in sorted(APPROVED.glob("*.md")))
    templates = [path for path in TEMPLATES.rglob("*.md") if path.parent.name not in ("board", "first", "validation")]
    texts = {text for path in templates for text in list_texts(path.read_text(encoding="utf-8"))}
    assert len(texts) > 200
    assert {text for text in texts if text not in approved} == UNUSED
