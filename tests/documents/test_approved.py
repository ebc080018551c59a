"""Documents of a few designs, compared whole with approved ones.

After a change that is meant, `FINGERTIP_APPROVE=1 pytest tests/documents` writes them; then read
the difference.
"""

from __future__ import annotations

import functools
import re
from pathlib import Path

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.casting.sheet import casting_sheet
from fingertip.design import Design
from fingertip.design.finger_set import load_set
from fingertip.documents.acceptance import acceptance_sheet, render_acceptance
from fingertip.documents.finger_sheets import (
    FirstScreen,
    Loads,
    list_steps,
    render_basis_table,
    render_sheet,
    render_start,
)
from fingertip.documents.firmware import render_readme
from fingertip.documents.robot import describe_model, render_robot_readme, render_set_readme
from fingertip.firmware.fingers import plan_fingers
from fingertip.recorded_trials.trials import prepare_folder
from fingertip.robot.finger_model import build_finger
from tests.approved import check_text, read_text
from tests.conftest import ROOT, design_file

APPROVED = Path(__file__).parent / "approved"
TEMPLATES = ROOT / "src/fingertip/documents"
ROBOTS = {"adult_finger_robot": "urdf", "adult_finger_mjcf": "mjcf", "fsr400_robot": "urdf"}
"""File of a model's README, which begins with the design's name -> format."""
CALIBRATED = (
    "force_curve.curve=calibrated force_curve.min_force_n=0.5 force_curve.max_force_n=3 "
    "printer.scale_percent=100.4"
)
DESIGNS = {
    # name of the files -> changes and documents
    "adult_finger": (CALIBRATED, ("start", "casting", "acceptance", "firmware", "basis")),
    "article": ("", ("casting", "firmware")),
    "fsr402": ("board.channels=3", ("firmware", "basis")),
}
FILES = {"acceptance.md", "board/README.md", "print/plate_fdm.3mf"}
LOADS = Loads(breaks_n=24.0, pin_first=True, grip_n=10.0)


@functools.cache
def render_documents(name: str) -> dict[str, str]:
    """Render the documents of a design that was built."""
    changes, wanted = DESIGNS[name]
    design = Design.load(design_file(name), changes=changes.split())
    sheet = casting_sheet(design, MeshEvaluator(0.05))
    steps = list_steps(sheet)
    pages = {
        "start": render_start(
            FirstScreen(design, sheet, LOADS, [18.0, 16.4, 61.8], FILES, len(steps), "✓ All passed")
        ),
        "basis": render_basis_table(design),
        "casting": render_sheet(sheet, [f"steps/{step.picture}.png" for step in steps]),
        "acceptance": render_acceptance(acceptance_sheet(design)),
        "firmware": render_readme(
            design, plan_fingers(design, "5" if name == "adult_finger" else None)
        ),
    }
    return {document: pages[document] for document in wanted}


@pytest.mark.every_case
@pytest.mark.parametrize("name", DESIGNS)
def test_documents_are_the_approved_ones(name: str) -> None:
    for document, text in render_documents(name).items():
        check_text(APPROVED / f"{name}_{document}.md", text)


@pytest.mark.parametrize("name", ROBOTS)
def test_readme_of_a_model_is_the_approved_one(name: str) -> None:
    design = Design.load(design_file(name.rpartition("_")[0]))
    model = describe_model(build_finger(design), ROBOTS[name])
    check_text(APPROVED / f"{name}.md", render_robot_readme(model, [design.name]))


def test_readme_of_the_model_of_a_set_is_the_approved_one() -> None:
    places_m = {"thumb": -0.03, "index": 0.0, "middle": 0.03, "ring": 0.06, "little": 0.09}
    check_text(
        APPROVED / "set_hand_robot.md",
        render_set_readme(load_set("adult_hand"), "finger.xml", places_m),
    )
    urdf = render_set_readme(load_set("adult_hand"), "finger.urdf", places_m)
    assert "change `origin` of their joints" in urdf


def test_data_sheet_and_consent_of_recordings_are_the_approved_ones(tmp_path: Path) -> None:
    prepare_folder(tmp_path, Design.load("first_finger"))
    for name in ("README.md", "CONSENT.md"):
        check_text(APPROVED / f"recordings_{name}", (tmp_path / name).read_bytes())


OWN_TESTS = {
    "comparison.md",
    "start.md",
    "casting.md",
    "casting_steps.md",
    "acceptance.md",
    "firmware.md",
    "divider_firmware.md",
}
"""Templates with branches that no approved document takes; tests of
their own count their words or assert them.
"""


def list_texts(template: str) -> set[str]:
    """Texts of a template between its expressions and statements, of three words or more."""
    plain = re.sub(
        r"^#+ [^\n]*$|\{#.*?#\}|\{%.*?%\}|\{\{.*?\}\}",
        "\0",
        template,
        flags=re.DOTALL | re.MULTILINE,
    )
    texts = (
        " ".join(text.split())
        for line in plain.split("\0")
        for text in re.split(r"\n\n|\n- |\|", line)
    )
    return {text for text in texts if text.count(" ") >= 2}


def test_every_sentence_stands_in_an_approved_document() -> None:
    """Documents of boards and validations have tests of their own."""
    approved = " ".join(" ".join(read_text(path).split()) for path in sorted(APPROVED.glob("*.md")))
    templates = [
        path for path in TEMPLATES.rglob("*.md") if path.parent.name not in ("board", "validation")
    ]
    templates = [path for path in templates if path.name not in OWN_TESTS]
    texts = {text for path in templates for text in list_texts(path.read_text(encoding="utf-8"))}
    assert len(texts) > 50
    assert texts <= {text for text in texts if text in approved}
