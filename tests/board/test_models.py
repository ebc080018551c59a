"""3D models of the packages: STEP files as a B-rep kernel reads them, and the board as KiCad exports it."""

from __future__ import annotations

import math
import shutil
from pathlib import Path

import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.kicad.placement import Placement
from fingertip.board.kicad.project import (
    BOARD_CONFIGURATIONS,
    MODEL_FOLDER,
    MODEL_FOLDER_OF_KICAD,
    MODEL_VARIABLE,
    model_files,
)
from fingertip.board.kicad.sexpr import turn
from fingertip.catalogues.output_files import LAYOUT
from fingertip.foundation.errors import OutputError
from fingertip.tasks.board import write_board
from tests.board.conftest import BoardFolder
from tests.board.kicad import HOW_TO_INSTALL_KICAD, kicad_cli
from tests.designs import ARTICLE, load_article
from tests.oracles.sexpressions import children, parse
from tests.tools import require_module, require_tool

EXPORTED = ("article_split", "precision_single_3v3", "comparator_single")
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


@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_every_part_to_buy_has_a_model_in_the_pose_of_kicads_and_nothing_else(name: str) -> None:
    circuit = board_circuit(board_values(load_article(BOARD_CONFIGURATIONS[name].changes)))
    pose_here = [["0"] * 3, ["1"] * 3, ["0"] * 3]
    for footprint in children(parse(BOARD_CONFIGURATIONS[name].project.layout), "footprint"):
        models = list(children(footprint, "model"))
        reference = next(field[2] for field in children(footprint, "property") if field[1] == "Reference")
        is_bought = reference[:3] != "FID" and bool(circuit.component(reference).rating)
        assert [model[1] for model in models] == [f"${{{MODEL_VARIABLE}}}/{model_path(footprint[1])}"] * is_bought
        for model in models:
            assert model_path(footprint[1]) in model_files()
            keys = ("offset", "scale", "rotate")
            assert [next(children(next(children(model, key)), "xyz"))[1:] for key in keys] == pose_here


@pytest.mark.full
@pytest.mark.parametrize(
    ("package", "top_mm"),
    [
        ("SOIC-8", 1.75), ("MSOP-8", 1.1), ("SOT-23-5", 1.45), ("SOT-23", 1.12),  # JEDEC MS-012, MO-187, MO-178, TO-236
        ("PinHeader", 8.54),  # 2.54 mm of plastic, and 6 mm of pins
        ("JST_SH", 2.95), ("JST_PH", 4.8), ("R_0603", 0.45), ("C_0805", 1.25),  # of the makers
    ],
)  # fmt: skip
def test_packages_are_as_high_as_their_outlines(tmp_path: Path, package: str, top_mm: float) -> None:
    cadquery = require_module("cadquery")
    path = tmp_path / "model.step"
    path.write_bytes(model_files()[min((name for name in model_files() if package in name), key=len)])
    assert cadquery.importers.importStep(str(path)).val().BoundingBox().zmax == pytest.approx(top_mm, abs=0.03)


def test_kicads_library_has_models_of_these_paths_in_the_same_pose() -> None:
    folder = require_tool("/usr/share/kicad/footprints", HOW_TO_INSTALL_KICAD)
    for path in model_files():
        library, name = path.removesuffix(".step").split(".3dshapes/")
        module = parse((folder / f"{library}.pretty" / f"{name}.kicad_mod").read_text("utf-8"))
        (model,) = children(module, "model")
        assert model[1] == f"{MODEL_FOLDER_OF_KICAD}/{path}"
        pose = [next(children(next(children(model, key)), "xyz"))[1:] for key in ("offset", "scale", "rotate")]
        assert [[float(word) for word in words] for words in pose] == [[0.0] * 3, [1.0] * 3, [0.0] * 3]


def expected_solids(placement: Placement, solids: dict[str, list[tuple[float, Centre]]]) -> list[tuple[float, Centre]]:
    """Volume and centre of each solid on a board, relative to its lower left corner and its upper face."""
    found = []
    for part in placement.parts.values():
        for volume, (x, y, z) in solids.get(model_path(part.footprint), ()):
            dx, dy = turn(x, -y, part.angle)
            found.append((volume, (part.x + dx, placement.height - part.y - dy, z)))
    return found


def export_step(folder: Path, target: Path, *options: str) -> list[tuple[float, Centre]]:
    run = kicad_cli(folder, "pcb", "export", "step", LAYOUT, "--drill-origin", "-f", *options, "-o", str(target))
    assert run.returncode == 0, run.stderr
    return read_solids(target)


@pytest.mark.full
@pytest.mark.parametrize("name", EXPORTED)
def test_kicad_exports_every_part_in_its_place(
    board_folder: BoardFolder, solids: dict[str, list[tuple[float, Centre]]], tmp_path: Path, name: str
) -> None:
    placement = BOARD_CONFIGURATIONS[name].placement
    board, *parts = sorted(
        export_step(board_folder(*BOARD_CONFIGURATIONS[name].changes), tmp_path / "b.step"), reverse=True
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
    model = tmp_path / MODEL_FOLDER / next(iter(model_files()))
    model.write_bytes(b"mine")
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    with pytest.raises(OutputError, match="was changed since"):
        write_board(load_article(["board.cutoff_hz=80"]), tmp_path)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before
