"""The layout: KiCad's design rules check, parity with the schematic, pads, print on both sides, and
3D models.

The check measures size and clearances of texts with the true shapes of KiCad's letters. STEP files
are those that a B-rep kernel reads, alone and in the board as KiCad exports it.
"""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import pytest

from fingertip.board.analysis.board_values import board_values
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.board.kicad.back_print import find_text_box, list_back_texts, list_values
from fingertip.board.kicad.netlist import REVISION
from fingertip.board.kicad.placement import PlacedPart, Placement
from fingertip.board.kicad.project import (
    MODEL_FOLDER_OF_KICAD,
    MODEL_VARIABLE,
    load_project,
    model_files,
)
from fingertip.board.kicad.sexpr import turn
from fingertip.board.parts.circuit import Circuit
from fingertip.catalogues.output_files import LAYOUT
from fingertip.foundation.errors import BoardError
from fingertip.tasks.board_files import board_files, write_board
from tests.board.conftest import BoardFolder
from tests.board.kicad import HOW_TO_INSTALL_KICAD, kicad_cli
from tests.designs import ARTICLE, load_article
from tests.oracles.sexpressions import children, parse
from tests.tools import require_module, require_tool


def load_circuit(name: str) -> Circuit:
    return board_circuit(board_values(load_article(VARIANT_CHANGES[name])))


PARTS: dict[str, PlacedPart] = {
    part.footprint: part
    for project in (*map(load_project, VARIANT_CHANGES), load_project("precision", 5))
    for part in project.placement.parts.values()
}
"""A part with each footprint."""


def run_drc(folder: Path) -> dict[str, list[str]]:
    """Violations, unconnected items and differences from the
    schematic that KiCad's design rules check finds.
    """
    run = kicad_cli(
        folder,
        "pcb",
        "drc",
        LAYOUT,
        "--schematic-parity",
        "--severity-all",
        "--exit-code-violations",
        "--all-track-errors",
        "--format",
        "json",
        "-o",
        "drc.json",
    )
    report = json.loads((folder / "drc.json").read_text("utf-8"))
    found = {
        key: [v["type"] for v in report[key]]
        for key in ("violations", "unconnected_items", "schematic_parity")
    }
    assert (run.returncode == 0) == (not any(found.values()))
    return found


NO_VIOLATIONS: dict[str, list[str]] = {
    "violations": [],
    "unconnected_items": [],
    "schematic_parity": [],
}


CORRUPTIONS = {
    "value": ('"Value" "4.7k"', '"Value" "47k"', "schematic_parity"),
    "width": ("(width 0.2)", "(width 0.6)", "violations"),
    "text height": ("(size 1 1)", "(size 0.9 0.9)", "violations"),
    "text line": ("(thickness 0.15)", "(thickness 0.14)", "violations"),
}


@pytest.mark.full
@pytest.mark.parametrize(("original", "corrupted", "key"), CORRUPTIONS.values(), ids=CORRUPTIONS)
def test_design_rules_check_detects_a_corrupted_board(
    tmp_path: Path, original: str, corrupted: str, key: str
) -> None:
    write_board(ARTICLE, tmp_path / "pcb")
    path = tmp_path / "pcb" / LAYOUT
    text = path.read_text("utf-8")
    assert original in text
    path.write_text(text.replace(original, corrupted), encoding="utf-8")
    assert run_drc(tmp_path / "pcb")[key]


DECOUPLING_MM = 7.0
"""Greatest way from a decoupling capacitor to the supply pin of its
amplifier, or to where the supply enters.
"""


@pytest.mark.every_case
@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_decoupling_capacitors_are_at_the_supply_pins_and_at_the_entry(name: str) -> None:
    circuit = load_circuit(name)
    parts = load_project(name).placement.parts
    found = [
        (c, match[1])
        for c in circuit.components
        if (match := re.search(r"at (U\d+|its entry)$", c.role))
    ]
    assert len(found) >= 3
    for component, place in found:
        own = [pad for pad in parts[component.reference].pads if pad.net != "GND"]
        owners = ("J2", "Q1") if place == "its entry" else (place,)
        pins = [
            pad
            for name in owners
            if name in parts
            for pad in parts[name].pads
            if pad.net == own[0].net
        ]
        assert min(math.dist(a.centre, b.centre) for a in own for b in pins) < DECOUPLING_MM, (
            component.reference
        )


@pytest.mark.parametrize("footprint", sorted(PARTS))
def test_pads_equal_those_of_kicads_library(footprint: str) -> None:
    folder = require_tool("/usr/share/kicad/footprints", HOW_TO_INSTALL_KICAD)
    library, name = footprint.split(":")
    module = parse((folder / f"{library}.pretty" / f"{name}.kicad_mod").read_text("utf-8"))
    kicad_pads = set()
    for pad in children(module, "pad"):
        x, y = (float(word) for word in next(children(pad, "at"))[1:3])
        w, h = (float(word) for word in next(children(pad, "size"))[1:3])
        drill = next((float(d[1]) for d in children(pad, "drill")), 0.0)
        ratio = next((float(r[1]) for r in children(pad, "roundrect_rratio")), 0.0)
        kicad_pads.add(
            (pad[1], pad[3], round(x, 4) + 0.0, round(y, 4) + 0.0, w, h, drill, round(ratio, 4))
        )
    part = PARTS[footprint]
    own_pads = set()
    for own in part.pads:
        x, y = turn(own.centre[0] - part.x, own.centre[1] - part.y, -part.angle)
        size = (own.width, own.height, own.drill, round(own.rounding, 4))
        own_pads.add((own.name, own.shape, round(x, 4) + 0.0, round(y, 4) + 0.0, *size))
    assert own_pads == kicad_pads


def list_prints(name: str) -> list[tuple[str, str, tuple[float, ...]]]:
    """Printed texts of a board, with the letter of their side and their place on the board."""
    left, top = load_project(name).placement.corner
    items = children(
        parse(board_files(load_article(VARIANT_CHANGES[name]))[LAYOUT].decode()), "gr_text"
    )
    found = [
        (item[1], *(next(children(item, head))[1:] for head in ("layer", "at"))) for item in items
    ]
    return [
        (text, layer[0][0], (float(x) - left, float(y) - top)) for text, layer, (x, y, *_) in found
    ]


@pytest.mark.every_case
@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_signs_at_the_supply_are_at_the_right_pins(name: str) -> None:
    """The pad of the connector nearest to each sign is on the net that
    it names; a board of the old order differs.
    """
    is_article = name == "article"
    prints = list_prints(name)
    pads = load_project(name).placement.parts["J2" if is_article else "J3"].pads
    order = {"GND": "GND", "3V3": "POWER_IN", "T": "ADC_TACTILE", "S": "ADC_FILTERED"}
    signs = {"+": "VCC", "-": "VEE", "0": "GND"} if is_article else order
    for sign, net in signs.items():
        places = [place for text, side, place in prints if (text, side) == (sign, "F")]
        nearest = min(
            (math.dist(place, pad.centre), pad.net.removeprefix("/"))
            for place in places
            for pad in pads
        )
        assert nearest[1] == net
    assert {side for text, side, _ in prints if "3.3 V only" in text} == (
        set() if is_article else {"F", "B"}
    )


@pytest.mark.every_case
@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_back_names_board_and_revision_and_lists_the_values(name: str) -> None:
    title, revision, *others = (text for text, side, _ in list_prints(name) if side == "B")
    assert (title, revision) == (f"fingertip {name}", f"rev {REVISION}")
    warning = [] if name == "article" else ["3.3 V only"]
    listed = [
        f"{c.reference} {c.value}" for c in load_circuit(name).components if c.reference[0] in "RC"
    ]
    assert sorted(others) == sorted([*warning, *listed])


def long_values(name: str) -> tuple[Circuit, Placement]:
    """A board whose values are as long as the list prints them."""
    circuit = board_circuit(board_values(load_article(VARIANT_CHANGES[name])))
    for component in circuit.components:
        if component.reference[0] in "RC" and component.reference != "RV1":
            circuit = circuit.replace(component.reference, "14.321987k")
    return circuit, load_project(name).placement


@pytest.mark.every_case
@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_back_has_room_for_values_of_any_length(name: str) -> None:
    circuit, placement = long_values(name)
    texts = list_back_texts(circuit, placement)
    values = [text.text for text in texts]
    assert values == list_values(circuit)
    assert all(value.endswith(" 14.3k") for value in values if value[:2] != "RV")
    left, top, right, bottom = zip(*map(find_text_box, texts), strict=True)
    assert min(*left, *top) > 0.3
    assert max(right) < placement.width - 0.3
    assert max(bottom) < placement.height - 0.3


def test_list_that_does_not_fit_is_refused() -> None:
    circuit, placement = long_values("comparator")
    with pytest.raises(BoardError, match="no room for the list of values"):
        list_back_texts(circuit, replace(placement, width=24.0))


def test_layout_that_prints_no_value_of_a_part_is_refused() -> None:
    circuit, _ = long_values("article")
    layout = load_project("article").layout.replace('(gr_text "R4 ', '(gr_text "R44 ')
    with pytest.raises(
        BoardError, match=r"prints no value of R4 on its back; add a text there in KiCad"
    ):
        replace(load_project("article"), layout=layout).enter(circuit)


EXPORTED = ("article", "comparator")
"""Boards that together have every package."""
Centre = tuple[float, float, float]


def model_path(footprint: str) -> str:
    library, name = footprint.split(":")
    return f"{library}.3dshapes/{name}.step"


def read_solids(path: Path) -> list[tuple[float, Centre]]:
    """Volume and centre of each valid solid of a STEP file."""
    cadquery = require_module("cadquery")
    solids = cadquery.importers.importStep(str(path)).solids().vals()
    assert all(solid.isValid() for solid in solids)
    return [(solid.Volume(), solid.Center().toTuple()) for solid in solids]


@pytest.fixture(scope="session")
def solids(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[tuple[float, Centre]]]:
    """Solids of each model, by its path."""
    path = tmp_path_factory.mktemp("models") / "model.step"
    found = {}
    for name, data in model_files().items():
        path.write_bytes(data)
        found[name] = read_solids(path)
    return found


@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_every_part_to_buy_has_a_model_in_the_pose_of_kicads_and_nothing_else(name: str) -> None:
    circuit = board_circuit(board_values(load_article(VARIANT_CHANGES[name])))
    pose_here = [["0"] * 3, ["1"] * 3, ["0"] * 3]
    for footprint in children(parse(load_project(name).layout), "footprint"):
        models = list(children(footprint, "model"))
        reference = next(
            field[2] for field in children(footprint, "property") if field[1] == "Reference"
        )
        is_bought = reference[:3] != "FID" and bool(circuit.component(reference).rating)
        assert [model[1] for model in models] == [
            f"${{{MODEL_VARIABLE}}}/{model_path(footprint[1])}"
        ] * is_bought
        for model in models:
            assert model_path(footprint[1]) in model_files()
            keys = ("offset", "scale", "rotate")
            assert [
                next(children(next(children(model, key)), "xyz"))[1:] for key in keys
            ] == pose_here


@pytest.mark.full
@pytest.mark.parametrize(
    ("package", "top_mm"),
    [
        ("SOIC-8", 1.75),
        ("MSOP-8", 1.1),
        ("SOT-23-5", 1.45),
        ("SOT-23", 1.12),  # JEDEC MS-012, MO-187, MO-178, TO-236
        ("PinHeader", 8.54),  # 2.54 mm of plastic, and 6 mm of pins
        ("JST_SH", 2.95),
        ("R_0603", 0.45),
        ("C_0805", 1.25),  # of the makers
    ],
)
def test_packages_are_as_high_as_their_outlines(
    tmp_path: Path, package: str, top_mm: float
) -> None:
    cadquery = require_module("cadquery")
    path = tmp_path / "model.step"
    path.write_bytes(
        model_files()[min((name for name in model_files() if package in name), key=len)]
    )
    assert cadquery.importers.importStep(str(path)).val().BoundingBox().zmax == pytest.approx(
        top_mm, abs=0.03
    )


def test_kicads_library_has_models_of_these_paths_in_the_same_pose() -> None:
    folder = require_tool("/usr/share/kicad/footprints", HOW_TO_INSTALL_KICAD)
    for path in model_files():
        library, name = path.removesuffix(".step").split(".3dshapes/")
        module = parse((folder / f"{library}.pretty" / f"{name}.kicad_mod").read_text("utf-8"))
        (model,) = children(module, "model")
        assert model[1] == f"{MODEL_FOLDER_OF_KICAD}/{path}"
        pose = [
            next(children(next(children(model, key)), "xyz"))[1:]
            for key in ("offset", "scale", "rotate")
        ]
        assert [[float(word) for word in words] for words in pose] == [
            [0.0] * 3,
            [1.0] * 3,
            [0.0] * 3,
        ]


def expected_solids(
    placement: Placement, solids: dict[str, list[tuple[float, Centre]]]
) -> list[tuple[float, Centre]]:
    """Volume and centre of each solid on a board, relative to its
    lower left corner and its upper face.
    """
    found = []
    for part in placement.parts.values():
        for volume, (x, y, z) in solids.get(model_path(part.footprint), ()):
            dx, dy = turn(x, -y, part.angle)
            found.append((volume, (part.x + dx, placement.height - part.y - dy, z)))
    return found


def export_step(folder: Path, target: Path, *options: str) -> list[tuple[float, Centre]]:
    run = kicad_cli(
        folder, "pcb", "export", "step", LAYOUT, "--drill-origin", "-f", *options, "-o", str(target)
    )
    assert run.returncode == 0, run.stderr
    return read_solids(target)


@pytest.mark.full
@pytest.mark.parametrize("name", EXPORTED)
def test_kicad_exports_every_part_in_its_place(
    board_folder: BoardFolder,
    solids: dict[str, list[tuple[float, Centre]]],
    tmp_path: Path,
    name: str,
) -> None:
    placement = load_project(name).placement
    board, *parts = sorted(
        export_step(board_folder(*VARIANT_CHANGES[name]), tmp_path / "b.step"), reverse=True
    )
    expected = sorted(expected_solids(placement, solids), reverse=True)
    assert len(parts) == len(expected) > 2 * len(placement.parts)
    assert board[0] > 0.8 * placement.width * placement.height
    board_top = max(centre[2] for _, centre in parts) - max(centre[2] for _, centre in expected)
    for found_volume, (x, y, z) in parts:
        assert any(
            math.dist((x, y, z - board_top), centre) < 0.01 and abs(found_volume - size) < 1e-4
            for size, centre in expected
        ), (x, y, z)
