"""What a builder of `first_finger` must read, do and buy: counted, and every thing that a step names is in the list."""

from __future__ import annotations

import io
import re
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from PIL import Image

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.parts import PARTS
from fingertip.casting.quantities import measure_volumes
from fingertip.design import Design
from fingertip.design.finger_set import load_set
from fingertip.documents.acceptance import acceptance_data, render_acceptance
from fingertip.documents.casting.sheet import casting_sheet_data, render_sheet, steps
from fingertip.documents.first.sheet import list_first_steps
from fingertip.documents.start import render_start
from fingertip.foundation.errors import DesignError
from fingertip.pictures.steps.objects import Bench
from fingertip.pictures.steps.pictures import draw_steps, list_scenes
from fingertip.tasks.board import board_files
from fingertip.tasks.firmware import firmware_files
from fingertip.tasks.make_set import make_set
from tests.conftest import design_file

DESIGN = Design.load(design_file("first_finger"))
TOOLS = (
    "adhesive|baking|breadboard|brush|cloth|drill|epoxy|felt|glue|goggles|jumper|key|lacquer|multimeter|needle|oven|pen|"
    "pliers|pot|primer|reamer|ruler|sandpaper|scissors|screw|screwdriver|sealant|shim|soap|syringe|tape|thread|towel|"
    "tweezers|vacuum|vise|voltmeter|washer|water|wax|wedges?|weights?"
)
"""Words of tools and materials that are not in the list, many of them from the sheet of another method."""
PRIVATE = "chaplet|facet|runner|sprue|gate|trough|dent|ridge|rib|bump|ring groove|bed|step|foot|notches in the seam"
"""Words of this project's own: where a step says one, its picture names it."""


@cache
def sheet() -> dict[str, Any]:
    return casting_sheet_data(DESIGN, measure_volumes(DESIGN, MeshEvaluator(0.05)), DESIGN.silicone.material)


@cache
def to_read() -> dict[str, str]:
    """Everything that a builder must read; of the sketch its head."""
    detection: Any = SimpleNamespace(detector="fast", memory_s=0.1, score=SimpleNamespace(delays_s=(0.02,)))
    checks = [
        {"name": f"bone.safety_factor.{load}", "value": 3.0, "limit": 2.0, "passed": True} for load in ("grip", "shock")
    ]
    report = {"parts": {}, "checks": checks, "casting": sheet()}
    files = [file for group in firmware_files(DESIGN).values() for file in group.items()]
    (sketch,) = (data.decode() for name, data in files if name.endswith("slip_lamp.ino"))
    return {
        "sheet": render_sheet(sheet(), [f"steps/{step.picture}.png" for step in steps(sheet())]),
        "start": render_start(DESIGN, report, [19.0, 16.0, 49.0], {"acceptance.md"}, 12, "All checks passed"),
        "acceptance": render_acceptance(acceptance_data(DESIGN, detection)),
        "wiring": board_files(DESIGN)["wiring.svg"].decode(),
        "sketch": sketch.partition("#include")[0],
    }


def count_words(text: str) -> int:
    plain = re.sub(r"!\[[^\]]*\]\([^)]*\)|<[^>]*>", " ", text)
    return sum(any(character.isalnum() for character in word) for word in plain.split())


def test_builder_reads_little_buys_little_and_waits_little() -> None:
    data = sheet()
    assert len(steps(data)) <= 12
    assert len(data["items"]) <= 20
    assert 0 < sum(bool(item["reason"]) for item in data["items"]) <= 8
    assert data["days"] <= 2
    assert sum(map(count_words, to_read().values())) <= 1500, {name: count_words(t) for name, t in to_read().items()}


def test_steps_are_short_and_every_thing_they_name_is_in_the_list() -> None:
    found = steps(sheet())
    for step in found:
        assert len(re.findall(r"[.!?](?=\s|$)", step.text)) <= 3, step.text
    keys = {item["key"] for item in sheet()["items"]}
    assert {key for step in found for key in step.uses} == keys  # none is bought for nothing
    said = " ".join([*(step.text for step in found), to_read()["acceptance"]])
    assert not re.findall(rf"\b(?:{TOOLS})\b", said)
    items = [item for item in sheet()["items"] if item["key"] != "scale"]
    with pytest.raises(KeyError, match="scale"):
        list_first_steps({**sheet(), "items": items})


def test_every_step_has_a_picture_that_names_what_the_step_names_by_a_word_of_its_own() -> None:
    found, bench = steps(sheet()), Bench(DESIGN)
    for step in found:
        scene = list_scenes(DESIGN)[step.picture](bench, sheet())
        labels = " ".join(label.text for label in scene.labels).replace("\n", " ")
        for word in re.findall(rf"\b(?:{PRIVATE})", step.text):
            assert word in labels, (step.picture, word)
    drawn = draw_steps(DESIGN, sheet(), [step.picture for step in found[:1]])
    assert list(drawn) == ["01-print.png"]
    assert len(Image.open(io.BytesIO(drawn["01-print.png"])).convert("RGB").getcolors(1 << 20) or ()) > 20


def test_sheet_states_what_the_parts_and_the_silicone_give() -> None:
    """Heights are measured on meshes; the mixture is that of the container's ratio, and fills the cup."""
    data, evaluator = sheet(), MeshEvaluator(0.05)
    boxes = {name: evaluator.manifold(PARTS[name].solid(DESIGN)).bounding_box() for name in ("core", "mold_palmar")}
    low, high = data["height_mm"]
    assert low + 0.05 < boxes["mold_palmar"][5] - boxes["core"][2] < high - 0.05 < low + 1.0
    batch, silicone = data["batch"], DESIGN.silicone.material
    assert batch["a_g"] / batch["b_g"] == pytest.approx(silicone.parts_a.low / silicone.parts_b.low, rel=0.03)
    cast_cm3 = evaluator.manifold(PARTS["skin"].solid(DESIGN)).volume() / 1000.0
    assert batch["total_g"] > 1.25 * 1.1 * cast_cm3 * silicone.density_g_cm3.high
    assert f"{batch['a_g']:g} g of part A" in to_read()["sheet"]
    assert "34-00004" in to_read()["sheet"]


def test_set_of_such_fingers_is_refused_in_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "hand.toml").write_text('name = "hand"\n[fingers.index]\ndesign = "first_finger"\n')
    with pytest.raises(DesignError, match="make one finger: fingertip make first_finger"):
        make_set(load_set(tmp_path / "hand.toml"), tmp_path / "out")
    assert not (tmp_path / "out").exists()
