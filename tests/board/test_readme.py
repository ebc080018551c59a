"""Documents of a board, compared whole with approved ones: README, bring-up sheet and tables of the analysis.

The approved documents of the default board and of the article's are those in `pcb/`, which the manifest compares.
After a change that is meant, `FINGERTIP_APPROVE=1 FINGERTIP_FULL=1 pytest tests/board/test_readme.py` writes the rest.
"""

from __future__ import annotations

import functools
import os
from dataclasses import replace
from pathlib import Path

import pytest

from fingertip.board import board_circuit, board_values
from fingertip.board.analysis.noise import NETS, Contribution, NoiseAlternative
from fingertip.board.analysis.report import Analysis, analyse
from fingertip.board.bringup.wiring import wiring_diagram
from fingertip.board.fabrication.bom import assembly_bom_file, placement_file
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.design import Design
from fingertip.documents.board.analysis import analysis_text
from fingertip.tasks.board import board_files, bring_up_files, write_board
from tests.conftest import ROOT
from tests.designs import load_article

APPROVED = Path(__file__).parent / "approved"
SLOW_SHEETS = ("precision_split", "comparator_split", "comparator_single_3v3")


def check_approved(name: str, data: bytes) -> None:
    """Compare a document with the approved one, or approve it."""
    if os.environ.get("FINGERTIP_APPROVE"):
        (APPROVED / name).write_bytes(data)
    assert data.decode() == (APPROVED / name).read_text(encoding="utf-8")


@pytest.mark.every_case
@pytest.mark.parametrize("name", BOARD_CONFIGURATIONS)
def test_readme_and_wiring_are_the_approved_ones(name: str) -> None:
    design = load_article(BOARD_CONFIGURATIONS[name].changes)
    files, circuit = board_files(design), board_circuit(board_values(design))
    check_approved(f"{name}.md", files["README.md"])
    if name == "comparator_single_3v3":  # has the most parts; the folder `pcb` holds these files of two other boards
        for file in ("values.json", "slip_filter.cir", "bom.csv"):
            check_approved(f"{name}_{file}", files[file])
        check_approved(f"{name}_bom_assembly.csv", assembly_bom_file(circuit))
        placement = BOARD_CONFIGURATIONS[name].placement
        check_approved(f"{name}_placement.csv", placement_file(circuit, placement, for_house=True))
    check_approved(f"{name}_wiring.svg", wiring_diagram(circuit, design.board.supply_v, design.name))


SHEETS = ["article_single", *(pytest.param(name, marks=pytest.mark.full) for name in SLOW_SHEETS)]


@pytest.mark.parametrize("name", SHEETS)
def test_bring_up_sheet_and_readings_are_the_approved_ones(name: str) -> None:
    design = load_article(BOARD_CONFIGURATIONS[name].changes)
    files = bring_up_files(design)
    check_approved(f"{name}_bringup.md", files["bringup.md"])
    check_approved(f"{name}_readings.toml", files["bringup_readings.toml"])
    check_approved(f"{name}_wiring.svg", files["wiring.svg"])


@pytest.mark.parametrize(
    ("name", "folder", "has_bring_up"),
    [("fsr400", "pcb", False), pytest.param("fsr400", "pcb", True, marks=pytest.mark.full),
     ("article", "pcb/article", True)],
)  # fmt: skip
def test_bundled_board_is_up_to_date(name: str, folder: str, has_bring_up: bool, tmp_path: Path) -> None:
    """The folder pcb/ holds the default board with its bring-up sheet, pcb/article/ that of the article."""
    write_board(Design.load(name), tmp_path, bring_up=has_bring_up)
    for path in (path.relative_to(tmp_path) for path in tmp_path.rglob("*") if path.is_file()):
        if has_bring_up or path.name != "manifest.json":
            hint = f"run: fingertip board {name} --out {folder} --bringup ({path})"
            assert (tmp_path / path).read_bytes() == (ROOT / folder / path).read_bytes(), hint


@functools.cache
def analysis_of(variant: str) -> Analysis:
    return analyse(load_article([f"board.variant={variant}", "board.supply=split"]), boards=20)


@pytest.mark.parametrize("variant", ["article", "precision", "comparator"])
def test_analysis_is_the_approved_one(variant: str) -> None:
    check_approved(f"analysis_{variant}.txt", analysis_text(analysis_of(variant)).encode())


@pytest.mark.parametrize(("name", "part"), [("below", 1 - 4e-7), ("above", 1 + 4e-7)])
def test_figures_of_the_analysis_are_rounded_at_their_edges(name: str, part: float) -> None:
    """Every made-up figure lies between two printed ones: a millionth less or more gives the other neighbour."""
    found = analysis_of("precision")
    volts = (12.35e-6 * part, 0.0, 6.065e-3 * part, 0.99995e-3 * part)
    offsets = (12.35e-3 * part, -0.0, -2.005e-3 * part, 0.5e-6 * part)
    spread = replace(
        next(iter(found.spread.values())), nominal=66.775 * part, mean=67.105 * part, deviation=2.2505 * part,
        low_95=62.925 * part, high_95=71.215 * part, worst_low=60.0, worst_high=75.0,
    )  # fmt: skip
    row = {"R1": -0.2275 * part, "R2": 0.1235 * part, "C1": -0.0005 * part, "C2": 1.0}
    made_up = replace(
        found,
        amplifier="TL082",
        noise=tuple(Contribution(f"part{i}", volts) for i in range(9)),
        noise_total_v=volts,
        noise_alternatives=(
            NoiseAlternative("with", 12.345e-3 * part, 2.345e-3 * part), NoiseAlternative("less", 1e-3, None),
        ),
        threshold_v=12.345e-3 * part,
        aliasing=replace(found.aliasing, one_lsb_tone_v=12.5e-3 * part, lsb_v=0.1235e-3 * part, alias_hz=1799.0),
        voltage_limits=replace(found.voltage_limits, vibration_peak_v=12.35e-3 * part),
        offset=(Contribution("U9", offsets),),
        component_percent=found.component_percent | {"C1": 10.0, "C2": 5.0, "C3": 10.0},
        spread=dict.fromkeys(found.spread, spread),
        sensitivity={"cutoff_hz": row, "passband_gain": dict.fromkeys(row, -0.0)},
    )  # fmt: skip
    assert len(volts) == len(NETS)
    check_approved(f"analysis_{name}_edges.txt", analysis_text(made_up).encode())


def test_cost_of_the_capacitors_is_stated_unless_they_are_the_articles() -> None:
    analysis = analysis_of("precision")
    for percent, stated in ((10.0, True), (5.0, False), (2.0, True)):
        own = analysis.component_percent | dict.fromkeys(("C1", "C2", "C3"), percent)
        text = analysis_text(replace(analysis, component_percent=own))
        assert ("95 % of the boards" in text) == stated
        assert (f"with C1 to C3 of {percent:g} %; with the article's 5 %" in text) == stated
