"""3D models of the packages: boxes, STEP files as a B-rep kernel reads them, and the board as KiCad exports it."""

from __future__ import annotations

import math
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.kicad.footprints import FOOTPRINTS
from fingertip.board.kicad.models import (
    MODEL_FOLDER,
    MODEL_FOLDER_OF_KICAD,
    MODEL_VARIABLE,
    Block,
    has_model,
    model_blocks,
    model_files,
    model_path,
)
from fingertip.board.kicad.placement import Placement, rotate_offset
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.board.parts.circuit import Circuit
from fingertip.catalogues.output_files import LAYOUT
from fingertip.foundation.errors import OutputError
from fingertip.tasks.board import write_board
from tests.board.conftest import BoardFolder
from tests.board.kicad import HOW_TO_INSTALL_KICAD, kicad_cli
from tests.designs import ARTICLE, load_article
from tests.oracles.sexpressions import children, parse
from tests.tools import require_module, require_tool

MODELLED = sorted(footprint for footprint in FOOTPRINTS if has_model(footprint))
EXPORTED = ("article_split", "precision_single_3v3", "comparator_single")
"""Boards that together have every package."""
Centre = tuple[float, float, float]


def load_board(name: str) -> tuple[Circuit, Placement]:
    configuration = BOARD_CONFIGURATIONS[name]
    return board_circuit(board_values(load_article(configuration.changes))), configuration.placement


def volume(block: Block) -> float:
    return math.prod(high - low for low, high in zip(block.low, block.high, strict=True))


def read_solids(path: Path) -> list[tuple[float, Centre]]:
    """Volume and centre of each valid solid of a STEP file."""
    cadquery = require_module("cadquery")
    solids = cadquery.importers.importStep(str(path)).solids().vals()
    assert all(solid.isValid() for solid in solids)
    return [(solid.Volume(), solid.Center().toTuple()) for solid in solids]


@pytest.mark.full
@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_every_part_to_buy_has_a_model_and_nothing_else(name: str) -> None:
    circuit, _ = load_board(name)
    for component in circuit.components:
        assert has_model(component.footprint) == bool(component.rating), component.reference


def test_boxes_lie_within_the_courtyard_and_leads_on_their_pads() -> None:
    assert [(footprint, fault) for footprint in MODELLED for fault in find_faults(footprint)] == []


def find_faults(footprint: str) -> Iterator[str]:
    """Yield what is wrong with the boxes of a footprint."""
    blocks, pads = list(model_blocks(footprint)), FOOTPRINTS[footprint].pads
    left, top, right, bottom = FOOTPRINTS[footprint].courtyard
    if not all(low < high for block in blocks for low, high in zip(block.low, block.high, strict=True)):
        yield "a box without extent"
    if any(b.low[0] < left or b.high[0] > right or b.low[1] < -bottom or b.high[1] > -top for b in blocks):
        yield "a box outside the courtyard"
    body = FOOTPRINTS[footprint].body
    on_pads = [
        block
        for block in blocks
        if block.low[0] >= body[2] or block.high[0] <= body[0] or -block.low[1] <= body[1] or -block.high[1] >= body[3]
    ]
    for lead in on_pads:
        x, y = ((a + b) / 2 for a, b in zip(lead.low[:2], lead.high[:2], strict=True))
        if not any(abs(x - pad.x) <= pad.width / 2 and abs(-y - pad.y) <= pad.height / 2 for pad in pads):
            yield f"no pad under the lead at {x}, {y}"
    has_leads = any(kind in footprint for kind in ("SOIC", "MSOP", "SOT", "JST_SH"))
    if has_leads and len(on_pads) != len([pad for pad in pads if pad.number != "MP"]):
        yield f"{len(on_pads)} leads"
    if "PinHeader" in footprint and len([b for b in blocks if b.low[2] < -1.6]) != len(pads):
        yield "not all pins pass through the board"


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("package", "top_mm"),
    [
        ("SOIC-8", 1.75), ("MSOP-8", 1.1), ("SOT-23-5", 1.45), ("SOT-23", 1.12),  # JEDEC MS-012, MO-187, MO-178, TO-236
        ("PinHeader", 8.54),  # 2.54 mm of plastic, and 6 mm of pins
        ("JST_SH", 2.95), ("JST_PH", 4.8), ("R_0603", 0.45), ("C_0805", 1.25),  # of the makers
    ],
)  # fmt: skip
def test_packages_are_as_high_as_their_outlines(package: str, top_mm: float) -> None:
    name = next(footprint for footprint in MODELLED if package in footprint)
    assert max(block.high[2] for block in model_blocks(name)) == pytest.approx(top_mm, abs=0.03)


@pytest.mark.full
def test_a_kernel_reads_every_model_as_solids_of_these_volumes(tmp_path: Path) -> None:
    for footprint in MODELLED:
        path = tmp_path / "model.step"
        path.write_bytes(model_files()[model_path(footprint)])
        expected = sorted(map(volume, model_blocks(footprint)))
        assert sorted(found for found, _ in read_solids(path)) == pytest.approx(expected, rel=1e-6), footprint


def test_kicads_library_has_models_of_these_paths_in_the_same_pose() -> None:
    folder = require_tool("/usr/share/kicad/footprints", HOW_TO_INSTALL_KICAD)
    found = {}
    for footprint in MODELLED:
        library, name = footprint.split(":")
        module = parse((folder / f"{library}.pretty" / f"{name}.kicad_mod").read_text("utf-8"))
        (model,) = children(module, "model")
        pose = [next(children(next(children(model, key)), "xyz"))[1:] for key in ("offset", "scale", "rotate")]
        found[footprint] = (model[1], [[float(word) for word in words] for words in pose])
    pose_here = [[0.0] * 3, [1.0] * 3, [0.0] * 3]
    assert found == {
        footprint: (f"{MODEL_FOLDER_OF_KICAD}/{model_path(footprint)}", pose_here) for footprint in MODELLED
    }


def expected_solids(circuit: Circuit, placement: Placement) -> list[tuple[float, Centre]]:
    """Volume and centre of each box on a board, relative to its lower left corner and its upper face."""
    found = []
    for component in circuit.components:
        position = placement.positions[component.reference]
        for block in model_blocks(component.footprint) if has_model(component.footprint) else ():
            x, y, z = ((a + b) / 2 for a, b in zip(block.low, block.high, strict=True))
            dx, dy = rotate_offset(position.angle, x, -y)
            found.append((volume(block), (position.x + dx, placement.height - position.y - dy, z)))
    return found


def export_step(folder: Path, target: Path, *options: str) -> list[tuple[float, Centre]]:
    run = kicad_cli(folder, "pcb", "export", "step", LAYOUT, "--drill-origin", "-f", *options, "-o", str(target))
    assert run.returncode == 0, run.stderr
    return read_solids(target)


@pytest.mark.full
@pytest.mark.parametrize("name", EXPORTED)
def test_kicad_exports_every_part_in_its_place(board_folder: BoardFolder, tmp_path: Path, name: str) -> None:
    circuit, placement = load_board(name)
    require_module("cadquery")
    board, *parts = sorted(
        export_step(board_folder(*BOARD_CONFIGURATIONS[name].changes), tmp_path / "b.step"), reverse=True
    )
    expected = sorted(expected_solids(circuit, placement), reverse=True)
    assert len(parts) == len(expected) > 2 * len(placement.positions)
    assert board[0] > 0.8 * placement.width * placement.height
    board_top = max(centre[2] for _, centre in parts) - max(centre[2] for _, centre in expected)
    for found_volume, (x, y, z) in parts:
        assert any(
            math.dist((x, y, z - board_top), centre) < 0.01 and abs(found_volume - size) < 1e-4
            for size, centre in expected
        ), (x, y, z)


@pytest.mark.full
def test_variable_selects_another_folder_of_models(board_folder: BoardFolder, tmp_path: Path) -> None:
    require_module("cadquery")
    folder = board_folder(*BOARD_CONFIGURATIONS["article_split"].changes)
    own = export_step(folder, tmp_path / "own.step")
    assert len(export_step(folder, tmp_path / "none.step", "-D", f"{MODEL_VARIABLE}={tmp_path}")) == 1
    shutil.copytree(folder / MODEL_FOLDER, tmp_path / "other")
    other = export_step(folder, tmp_path / "other.step", "-D", f"{MODEL_VARIABLE}={tmp_path / 'other'}")
    assert sorted(other) == sorted(own)


def test_changed_model_is_kept_and_reported(tmp_path: Path) -> None:
    write_board(ARTICLE, tmp_path)
    model = tmp_path / MODEL_FOLDER / model_path(MODELLED[0])
    model.write_bytes(b"mine")
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    with pytest.raises(OutputError, match="was changed since"):
        write_board(load_article(["board.cutoff_hz=80"]), tmp_path)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before
