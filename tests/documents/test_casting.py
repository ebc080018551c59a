"""What a builder must read, do and buy: counted for every preset, and
every thing that a step names is in the list.
"""

from __future__ import annotations

import io
import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from PIL import Image

from fingertip.board.analysis.board_values import board_values
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.casting.sheet import CastingSheet, casting_sheet
from fingertip.casting.shopping import add_prices
from fingertip.catalogues.file_kinds import PRESETS
from fingertip.design import Design
from fingertip.documents.acceptance import acceptance_sheet, render_acceptance
from fingertip.documents.finger_sheets import FirstScreen, list_steps, render_sheet, render_start
from fingertip.documents.wiring import wiring_diagram
from fingertip.models.parts import PARTS
from fingertip.pictures.casting_scenes import SCENES, draw_steps
from fingertip.pictures.labelled_scene import Scene
from fingertip.pictures.workbench import Workbench
from fingertip.tasks.board_files import board_files
from fingertip.tasks.firmware_files import firmware_files
from tests.conftest import ROOT, design_file

NAMES = ("first_finger", "article", "fsr400", "fsr402", *PRESETS)
FLANGE = "first_finger bone.interface=flange bone.foot_radius_mm=0.45"
MOUNTED = {
    "first_finger": "the stand",
    "first_finger bone.interface=socket bone.base_length_mm=32": "onto the post of your hand, of "
    "4.8 mm",
    f"{FLANGE} bone.base_length_mm=27": "Screw the flange to your hand with 2 bolts",
}
"""Designs with another way to hold the finger -> words of the step that says it."""
TOOLS = (
    "adhesive|baking|breadboard|brush|cloth|drill|epoxy|felt|glue|goggles|jumper|key|lacquer|needle|oven|pen|pliers|pot|"
    "primer|reamer|ruler|sandpaper|scissors|screw|screwdriver|sealant|shim|soap|syringe|tape|thread|cable tie|towel|"  # noqa: E501
    "tweezers|vacuum|vise|voltmeter|washer|water|wax|wedges?|weights?"
)
"""Words of tools and materials that most lists do not hold."""
PRIVATE = (
    "trough|dent|ridge|rib|bump|ring groove|bed|step|foot|notches in the seam|tongue|eyes|horn"
)
"""Words of this project's own: where a step says one, its picture names it."""


@cache
def load(words: str) -> tuple[Design, CastingSheet]:
    name, *changes = words.split()
    design = Design.load(design_file(name), changes=changes)
    return design, casting_sheet(design, MeshEvaluator(0.05))


@cache
def scenes(words: str) -> dict[str, Scene]:
    design, sheet = load(words)
    workbench = Workbench(design)
    return {step.picture: SCENES[step.picture](workbench, sheet) for step in list_steps(sheet)}


def to_read(words: str) -> dict[str, str]:
    """Everything that a builder must read besides the README of a board; of the sketch its head."""
    design, sheet = load(words)
    steps = list_steps(sheet)
    pages = {
        "sheet": render_sheet(sheet, [f"steps/{step.picture}.png" for step in steps]),
        "start": render_start(
            FirstScreen(
                design,
                sheet,
                None,
                [19.0, 16.0, 49.0],
                {"acceptance.md"},
                len(steps),
                "All checks passed",
            )
        ),
        "acceptance": render_acceptance(acceptance_sheet(design)),
    }
    if design.board.has_filter:
        circuit = board_circuit(board_values(design), design.board.channels)
        pages["wiring"] = wiring_diagram(circuit, design.board.supply_v, design.name).decode()
    else:
        pages["wiring"] = board_files(design)["wiring.svg"].decode()
        files = [file for group in firmware_files(design).values() for file in group.items()]
        (sketch,) = (data.decode() for name, data in files if name.endswith("slip_lamp.ino"))
        pages["sketch"] = sketch.partition("#include")[0]
    return pages


def count_words(text: str) -> int:
    plain = re.sub(r"!\[[^\]]*\]\([^)]*\)|<[^>]*>", " ", text)
    return sum(any(character.isalnum() for character in word) for word in plain.split())


@pytest.mark.parametrize("name", NAMES)
def test_builder_reads_little_buys_little_and_waits_little(name: str) -> None:
    design, sheet = load(name)
    most_steps, most_things, most_words = (
        (12, 20, 1500) if name == "first_finger" else (18, 30, 2500)
    )
    assert len(list_steps(sheet)) <= most_steps - 6 * (
        design.dimensions.joint is None and name != "first_finger"
    )
    assert len(sheet.things) <= most_things
    assert 0 < sum(bool(thing.reason) for thing in sheet.things) <= 8
    assert sheet.days <= 2
    assert sum(map(count_words, to_read(name).values())) <= most_words, name


def test_the_readme_states_what_a_first_finger_takes() -> None:
    sheet = load("first_finger")[1]
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    least, most, in_all = add_prices(sheet.things)
    for words in (
        f"{sheet.printed_g:g} g of PETG, {round(sheet.print_h)} hours",
        f"{sheet.batch.total_g:g} g of two-part",
        "{} days with {:g} h and {:g} h of work, after up to {}".format(
            sheet.days, *sheet.work_h, sheet.mail_days
        ),
        f"{least} to {most} US dollars to order, up to {in_all} with all tools",
    ):
        assert words in readme


@pytest.mark.parametrize("name", [*NAMES, *list(MOUNTED)[1:]])
def test_steps_are_short_and_every_thing_they_name_is_in_the_list(name: str) -> None:
    sheet = load(name)[1]
    found = list_steps(sheet)
    for step in found:
        assert len(step.text.split()) <= 85, step.text
    assert {key for step in found for key in step.uses} == {thing.key for thing in sheet.things}
    said = " ".join([*(step.text for step in found), to_read(name)["acceptance"]])
    listed = " ".join(thing.label for thing in sheet.things)
    assert {word for word in re.findall(rf"\b(?:{TOOLS})\b", said) if word not in listed} == set()
    with pytest.raises(KeyError, match="scale"):
        list_steps(
            replace(sheet, things=tuple(thing for thing in sheet.things if thing.key != "scale"))
        )


@pytest.mark.parametrize("name", ["first_finger", "article", "adult_finger", "child_thumb"])
def test_every_step_has_a_picture_that_names_what_the_step_names_by_a_word_of_its_own(
    name: str,
) -> None:
    design, sheet = load(name)
    page = render_sheet(sheet)
    for step in list_steps(sheet):
        scene = scenes(name)[step.picture]
        labels = " ".join(label.text for label in scene.labels).replace("\n", " ")
        for word in re.findall(rf"\b(?:{PRIVATE})", step.text):
            assert word in labels, (step.picture, word)
        for number in re.findall(r"\d+(?:\.\d+)? (?:mm|g|N|s|h|degrees)\b", labels):
            assert number in page, (step.picture, number)
        boxes = [
            (item.mesh.vertices.min(axis=0) - 0.15, item.mesh.vertices.max(axis=0) + 0.15)
            for item in scene.meshes
        ]
        for label in scene.labels:
            assert any(
                np.all((low <= label.point_mm) & (label.point_mm <= high)) for low, high in boxes
            ), label
    drawn = draw_steps(design, sheet, ["print"])
    assert (
        len(Image.open(io.BytesIO(drawn["01-print.png"])).convert("RGB").getcolors(1 << 20) or ())
        > 20
    )


def test_every_scene_is_used() -> None:
    used = {
        step.picture
        for name in ("first_finger", "adult_finger", "article")
        for step in list_steps(load(name)[1])
    }
    assert used == set(SCENES)


@pytest.mark.parametrize("words", MOUNTED)
def test_step_says_how_the_finger_is_held(words: str) -> None:
    (step,) = (step for step in list_steps(load(words)[1]) if step.picture == "connect")
    assert MOUNTED[words] in step.text
    assert {"bolt", "controller"} <= set(step.uses)


def test_front_end_decides_what_is_wired_and_read() -> None:
    divider, board = (
        load(words)[1] for words in ("first_finger", "first_finger board.variant=precision")
    )
    only = {thing.key for thing in board.things} ^ {thing.key for thing in divider.things}
    assert only == {"controller", "resistor", "board", "multimeter"}
    assert "board/README.md" in to_read("first_finger board.variant=precision")["sheet"]
    read = {
        board: to_read(f"first_finger board.variant={board}")["acceptance"]
        for board in ("divider", "precision")
    }
    assert "the LED lights" in read["divider"]
    assert "multimeter" in read["precision"]
    falling = to_read("article")["acceptance"]
    assert "| untouched | at least" in falling


def test_only_a_print_of_resin_is_said_to_stop_silicone() -> None:
    resin = to_read("first_finger strength.print_material=clear")["sheet"]
    assert "stops silicone" in resin
    assert "`print/plate_sla.3mf` in Formlabs Clear resin V4" in resin
    assert "stops silicone" not in to_read("first_finger")["sheet"]


def test_sheet_states_what_the_parts_and_the_silicone_give() -> None:
    """Heights are measured on meshes; the mixture is that of the
    container's ratio, and fills the cup.
    """
    design, sheet = load("first_finger")
    evaluator = MeshEvaluator(0.05)
    boxes = {
        name: evaluator.manifold(PARTS[name].solid(design)).bounding_box()
        for name in ("core", "mold_palmar")
    }
    low, high = sheet.height_mm
    assert low + 0.05 < boxes["mold_palmar"][5] - boxes["core"][2] < high - 0.05 < low + 1.0
    batch = sheet.batch
    silicone = design.silicone.material
    assert batch.a_g / batch.b_g == pytest.approx(
        silicone.parts_a.low / silicone.parts_b.low, rel=0.03
    )
    cast_cm3 = evaluator.manifold(PARTS["skin"].solid(design)).volume() / 1000.0
    assert batch.total_g > 1.25 * 1.1 * cast_cm3 * silicone.density_g_cm3.high
    page = render_sheet(sheet)
    assert f"{batch.a_g:g} g of part A" in page
    assert "34-00004" in page
