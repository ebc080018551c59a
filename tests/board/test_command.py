"""`fingertip board`: output, errors, files, reports of differences, and fabrication files."""

from __future__ import annotations

import csv
import io
import json
import zipfile
from pathlib import Path

import pytest

from fingertip.board.analysis.board_values import board_values
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.board.fabrication.bom import placement_file
from fingertip.board.fabrication.fabrication_files import (
    export_gerbers,
    find_outdated_files,
    kicad_session,
    provenance_record,
)
from fingertip.board.kicad.project import MODEL_FOLDER, load_project
from fingertip.catalogues.output_files import LAYOUT, PROVENANCE
from fingertip.foundation.output_set import MANIFEST
from fingertip.tasks.board_files import board_files, write_board
from tests.board.kicad import HOW_TO_INSTALL_KICAD, kicad_cli
from tests.conftest import run_fingertip
from tests.designs import ARTICLE, ARTICLE_OPTIONS
from tests.tools import require_tool

FILES = [
    "3d",
    "README.md",
    "assembly.svg",
    "bom.csv",
    "manifest.json",
    "slip_filter.cir",
    "slip_filter.kicad_pcb",
    "slip_filter.kicad_pro",
    "slip_filter.kicad_sch",
    "slip_filter.net",
    "values.json",
]


def test_json_output_equals_the_values_file_and_quiet_prints_no_messages(tmp_path: Path) -> None:
    design = tmp_path / "mine.toml"
    design.write_text('[board]\nseries = "E12"\n')
    run = run_fingertip(
        "board",
        design,
        "--out",
        tmp_path,
        "--json",
        "--quiet",
        *ARTICLE_OPTIONS,
        "--set",
        "board.series=E96",
    )
    assert (run.returncode, run.stderr) == (0, "")
    data = json.loads(run.stdout)
    assert {"ideal", "preferred", "achieved_response", "errata", "files"} <= set(data)
    assert data["preferred"]["r1_ohm"] == 2370.0
    assert round(data["achieved_response"]["cutoff_hz"], 2) == 67.07
    assert all({"subject", "statement", "correction"} == set(erratum) for erratum in data["errata"])
    assert sorted([*(Path(name).name for name in data["files"]), MANIFEST, MODEL_FOLDER]) == FILES
    assert all(Path(name).is_file() for name in data["files"])
    values = json.loads((tmp_path / "values.json").read_text())
    assert values["parameters"]["series"] == "E96"
    assert all(
        values[key] == data[key] for key in ("ideal", "preferred", "achieved_response", "errata")
    )


@pytest.mark.full
def test_panel_is_written_by_kikit_or_by_the_command_that_is_named(tmp_path: Path) -> None:
    refused = run_fingertip("board", "--panel", "2by3", "--out", tmp_path / "b")
    assert refused.returncode == 2
    assert "write rows and columns" in refused.stderr
    assert not (tmp_path / "b").exists()
    said = run_fingertip("board", "--panel", "2x3", "--out", tmp_path / "b", PATH="/nowhere").stdout
    assert "kikit panelize --layout 'grid; rows: 2; cols: 3; space: 0mm'" in said
    kikit = tmp_path / "kikit"
    kikit.write_text('#!/bin/sh\nfor last; do :; done\necho panel > "$last"\n')
    kikit.chmod(0o755)
    said = run_fingertip(
        "board", "--panel", "2x3", "--out", tmp_path / "b", PATH=f"{tmp_path}:/bin"
    ).stdout
    assert "panel of 2 x 3 in" in said
    assert (tmp_path / "b/panel/slip_filter.kicad_pcb").read_text() == "panel\n"


def test_default_output_folder_is_that_of_the_design(tmp_path: Path) -> None:
    missing = run_fingertip("board", "fsr400", "--check", PWD=str(tmp_path))
    assert missing.returncode == 1
    assert missing.stdout == "out/fsr400/board does not exist; name the folder with --out.\n"
    run = run_fingertip("board", "fsr400", "--quiet", PWD=str(tmp_path))
    assert run.returncode == 0
    assert (tmp_path / "out" / "fsr400" / "board" / "slip_filter.net").is_file()
    assert run_fingertip("board", "fsr400", "--check", PWD=str(tmp_path)).returncode == 0


def test_board_that_saturates_its_converter_is_refused_with_a_range_that_passes(
    tmp_path: Path,
) -> None:
    words = ("fsr400", "--out", tmp_path / "board", "-q", "--set")
    refused = run_fingertip("board", *words, "detector.adc_range_v=1.1")
    assert refused.returncode == 2
    assert not (tmp_path / "board").exists()
    assert refused.stderr.startswith(
        "error: detector.adc_range_v: highest tactile voltage (TACTILE): 2.14 V, must be"
    )
    remedy = refused.stderr.partition("set ")[2].partition(",")[0]
    assert run_fingertip("board", *words, remedy).returncode == 0


NOISY = (*VARIANT_CHANGES["precision"], "board.passband_gain=300", "board.band_limit_hz=3000")
SHORT_WINDOW = (
    *VARIANT_CHANGES["comparator"],
    "board.capacitor_uf=0.39",
    "detector.sample_rate_hz=10000",
    "detector.window_samples=60",
)


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        (
            (*NOISY, "detector.threshold_v=3e-4"),
            ["mean envelope to 0.3 mV, and detector.threshold_v is 0.3 mV"],
        ),
        (NOISY, []),
        (SHORT_WINDOW, ["detector.window_samples of 60 at 10000 Hz is 6 ms"]),
        (SHORT_WINDOW[:3], []),
    ],
)
def test_noisy_boards_and_short_windows_are_warned_of(
    tmp_path: Path, changes: tuple[str, ...], expected: list[str]
) -> None:
    words = [word for change in changes for word in ("--set", change)]
    run = run_fingertip("board", *ARTICLE_OPTIONS, "--out", tmp_path, "--json", *words)
    assert run.returncode == 0
    data = json.loads(run.stdout)
    assert len(data["warnings"]) == len(expected)
    assert all(part in text for part, text in zip(expected, data["warnings"], strict=True))
    assert "warning:" not in run.stderr, "a warning stands once, beside the verdict"
    first, *rest = data["verdict"].splitlines()
    assert first.endswith(
        "conditions of a working board are met, with a warning:" if expected else "are met"
    )
    assert rest == [f"  warning: {text}" for text in data["warnings"]]


@pytest.mark.full
def test_default_folder_keeps_a_board_of_another_circuit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Other values replace those of the same circuit; another
    variant is written beside, or with --force.
    """
    monkeypatch.chdir(tmp_path)
    assert run_fingertip("board", "article", "-q").returncode == 0
    assert run_fingertip("board", "article", "--set", "board.cutoff_hz=80", "-q").returncode == 0
    layout = Path("out/article/board/slip_filter.kicad_pcb")
    before = layout.read_bytes()
    other = ("article", "--set", "board.variant=comparator", "--set", "board.supply_v=3.3")
    other = (*other, "--set", "detector.threshold_v=0.011", "-q")
    refused = run_fingertip("board", *other)
    assert refused.returncode == 2
    assert "holds a board of 'article' with another circuit" in refused.stderr
    assert "it adds C14" in refused.stderr
    assert layout.read_bytes() == before
    remedy = refused.stderr.partition("--out ")[2].partition(",")[0]
    assert run_fingertip("board", *other, "--out", remedy).returncode == 0
    assert run_fingertip("board", *other, "--force").returncode == 0
    assert layout.read_bytes() == (Path(remedy) / layout.name).read_bytes() != before


CIRCUIT = board_circuit(board_values(ARTICLE))
ARTICLE_PLACEMENT = load_project("article").placement


def test_check_reports_differences_and_writes_nothing(tmp_path: Path) -> None:
    write_board(ARTICLE, tmp_path, bring_up=True)
    changed = {
        tmp_path / "slip_filter.net",
        tmp_path / "bringup.ino",
        min((tmp_path / "3d").rglob("*.step")),
    }
    for path in changed:
        path.write_bytes(path.read_bytes() + b"edited")
    (tmp_path / "bom.csv").unlink()
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    run = run_fingertip("board", *ARTICLE_OPTIONS, "--check", "--json", "--out", tmp_path)
    assert run.returncode == 1
    data = json.loads(run.stdout)
    assert data["current"] is False
    found = {f"{path}: differs from what this design gives." for path in changed}
    (missing,) = set(data["differences"]) - found
    assert found < set(data["differences"])
    assert "bom.csv: cannot be read" in missing
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


def parse_csv(data: bytes) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(data.decode())))


@pytest.mark.full
def test_placement_file_equals_kicads(tmp_path: Path) -> None:
    write_board(ARTICLE, tmp_path / "pcb")
    run = kicad_cli(
        tmp_path / "pcb",
        "pcb",
        "export",
        "pos",
        LAYOUT,
        "--use-drill-file-origin",
        "--format",
        "csv",
        "--units",
        "mm",
        "-o",
        "pos.csv",
    )
    assert run.returncode == 0, run.stderr
    kicad_rows = {r["Ref"]: r for r in parse_csv((tmp_path / "pcb" / "pos.csv").read_bytes())}
    own_rows = parse_csv(placement_file(CIRCUIT, ARTICLE_PLACEMENT, for_house=False))
    assert {r["Designator"] for r in own_rows} == {ref for ref in kicad_rows if ref[0] != "J"}
    for row in own_rows:
        kicad_row = kicad_rows[row["Designator"]]
        assert float(row["Mid X"].removesuffix("mm")) == pytest.approx(
            float(kicad_row["PosX"]), abs=1e-4
        )
        assert float(row["Mid Y"].removesuffix("mm")) == pytest.approx(
            float(kicad_row["PosY"]), abs=1e-4
        )
        assert float(row["Rotation"]) % 360 == float(kicad_row["Rot"]) % 360
        assert kicad_row["Side"] == row["Layer"].lower()


@pytest.mark.full
def test_fabrication_files_are_complete_and_reproducible(tmp_path: Path) -> None:
    require_tool("kicad-cli", HOW_TO_INSTALL_KICAD)
    run = run_fingertip("board", *ARTICLE_OPTIONS, "--fab", "--quiet", "--out", tmp_path)
    assert (run.returncode, run.stderr) == (0, "")
    fab = tmp_path / "fab"
    archive = zipfile.ZipFile(fab / "slip_filter_gerbers.zip")
    with kicad_session(board_files(ARTICLE), lambda message: None) as (folder, run_kicad):
        assert (
            export_gerbers(folder, run_kicad, "slip_filter")
            == (fab / "slip_filter_gerbers.zip").read_bytes()
        )
    names = {name.removeprefix("slip_filter").split(".")[0] for name in archive.namelist()}
    assert {
        "-F_Cu",
        "-B_Cu",
        "-F_Mask",
        "-B_Mask",
        "-F_Silkscreen",
        "-F_Paste",
        "-Edge_Cuts",
        "-PTH",
        "-NPTH",
    } <= names
    assert (fab / "slip_filter_front.png").read_bytes().startswith(b"\x89PNG")
    assert (fab / "slip_filter_schematic.pdf").read_bytes().startswith(b"%PDF")
    assert (fab / "assembly.pdf").read_bytes().startswith(b"%PDF")
    recorded = [line.split("  ")[1] for line in (fab / PROVENANCE).read_text().splitlines()]
    own = {PROVENANCE, MANIFEST}
    assert {path.name for path in fab.iterdir()} == {
        name for name in recorded if "/" not in name
    } | own
    assert (
        run_fingertip("board", *ARTICLE_OPTIONS, "--check", "--fab", "--out", tmp_path).returncode
        == 0
    )


BOARD_FILES = {
    "slip_filter.kicad_pcb": b"pcb",
    "slip_filter.kicad_sch": b"sch",
    "bom.csv": b"bom",
    "values.json": b"{}",
}


def test_provenance_record_reveals_outdated_and_changed_files(tmp_path: Path) -> None:
    made = {"slip_filter_gerbers.zip": b"zip", "bom_assembly.csv": b"parts"}
    for name, data in (made | {"record": provenance_record(BOARD_FILES, made)}).items():
        (tmp_path / name).write_bytes(data)
    assert find_outdated_files(tmp_path, "record", BOARD_FILES) == []
    assert find_outdated_files(tmp_path, "record", BOARD_FILES | {"values.json": b"other"}) == []
    for name in ("slip_filter.kicad_pcb", "slip_filter.kicad_sch", "bom.csv"):
        (difference,) = find_outdated_files(tmp_path, "record", BOARD_FILES | {name: b"other"})
        assert (
            f"was made from another {name} than this design gives; write it again with --fab"
            in difference
        )
    (tmp_path / "slip_filter_gerbers.zip").write_bytes(b"older")
    (tmp_path / "bom_assembly.csv").unlink()
    changed, missing = find_outdated_files(tmp_path, "record", BOARD_FILES)
    assert "slip_filter_gerbers.zip: was changed after it was made" in changed
    assert "bom_assembly.csv: cannot be read" in missing
    for record in (b"hello", b"\xff\xfe"):
        (tmp_path / "record").write_bytes(record)
        assert (
            "has no valid record that names the board"
            in find_outdated_files(tmp_path, "record", BOARD_FILES)[0]
        )


@pytest.mark.full
def test_gerbers_of_an_earlier_board_are_reported(tmp_path: Path) -> None:
    assert run_fingertip("board", *ARTICLE_OPTIONS, "--out", tmp_path).stderr.count("warning") == 0
    assert (
        run_fingertip("board", *ARTICLE_OPTIONS, "--out", tmp_path, "--check", "--fab").returncode
        == 1
    ), "there are no fabrication files"
    (tmp_path / "fab").mkdir()
    (tmp_path / "fab" / "slip_filter_gerbers.zip").write_bytes(b"zip")
    (tmp_path / "fab" / PROVENANCE).write_bytes(
        provenance_record(board_files(ARTICLE), {"slip_filter_gerbers.zip": b"zip"})
    )
    assert (
        run_fingertip("board", *ARTICLE_OPTIONS, "--out", tmp_path, "--check", "--fab").returncode
        == 0
    )
    assert "warning" not in run_fingertip("board", *ARTICLE_OPTIONS, "--out", tmp_path).stderr

    run = run_fingertip(
        "board", *ARTICLE_OPTIONS, "--out", tmp_path, "--set", "board.cutoff_hz=80", "--json"
    )
    assert run.returncode == 0
    assert (
        f"warning: {tmp_path / 'fab'}: was made from another slip_filter.kicad_pcb than this design"
        in run.stderr
    )
    assert any("bom.csv" in text for text in json.loads(run.stdout)["fabrication_differences"])
    for options in (("--check",), ("--check", "--fab")):
        run = run_fingertip("board", "--out", tmp_path, "--set", "board.cutoff_hz=80", *options)
        assert run.returncode == 1
        assert "write it again with --fab" in run.stdout
