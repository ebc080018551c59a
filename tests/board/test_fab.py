"""`fingertip board --check` and `--fab`: what differs is said; what is sent away is whole and the same each time."""

from __future__ import annotations

import csv
import io
import json
import zipfile
from pathlib import Path

import pytest

from fingertip.board import board_circuit, board_files, board_values, differences, write_board
from fingertip.board.fabrication.bom import bill_of_materials
from fingertip.board.fabrication.fab import PARTS_COLUMNS, PLACEMENT_COLUMNS, gerbers, parts_file, placement_file
from fingertip.board.fabrication.made_from import differing, origin
from fingertip.board.layout.placements import load_placement
from fingertip.board.output import LAYOUT, MADE_FROM, README
from fingertip.design import Design
from tests.board.kicad import HOW, kicad_cli
from tests.conftest import run_fingertip
from tests.tools import require_tool

CIRCUIT = board_circuit(board_values(Design()))
ARTICLE_PLACEMENT = load_placement("article_split")


def test_check_of_a_current_folder(tmp_path: Path) -> None:
    write_board(Design(), tmp_path)
    run = run_fingertip("board", "--check", "--out", tmp_path)
    assert (run.returncode, run.stderr) == (0, "")
    assert "is what this design gives" in run.stdout


def test_check_says_what_differs_and_writes_nothing(tmp_path: Path) -> None:
    write_board(Design(), tmp_path)
    (tmp_path / "slip_filter.net").write_bytes((tmp_path / "slip_filter.net").read_bytes().replace(b'"4.7k"', b'"47k"'))
    (tmp_path / "bom.csv").unlink()
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    run = run_fingertip("board", "--check", "--json", "--out", tmp_path)
    assert run.returncode == 1
    data = json.loads(run.stdout)
    assert data["current"] is False
    text = "\n".join(data["differences"])
    assert "slip_filter.net: differs" in text
    assert '(value "47k")' in text
    assert '(value "4.7k")' in text
    assert "bom.csv: cannot be read" in text
    assert "kicad_pcb" not in text
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_check_notices_another_design(tmp_path: Path) -> None:
    write_board(Design(), tmp_path)
    assert differences(Design.load(changes=["board.cutoff_hz=80"]), tmp_path)


def test_a_readme_of_somebody_else_stays(tmp_path: Path) -> None:
    (tmp_path / README).write_text("# Mine\n")
    write_board(Design(), tmp_path)
    assert (tmp_path / README).read_text() == "# Mine\n"
    assert differences(Design(), tmp_path) == []


def rows(data: bytes) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(data.decode())))


def test_parts_and_placement_have_the_columns_houses_take() -> None:
    parts, places = rows(parts_file(CIRCUIT)), rows(placement_file(CIRCUIT, ARTICLE_PLACEMENT))
    assert tuple(parts[0]) == PARTS_COLUMNS == ("Comment", "Designator", "Footprint", "Part Number")
    assert tuple(places[0]) == PLACEMENT_COLUMNS == ("Designator", "Mid X", "Mid Y", "Layer", "Rotation")
    named = [reference for row in parts for reference in row["Designator"].split(",")]
    assert len(named) == len(set(named))
    assert set(named) == {p.reference for p in CIRCUIT.parts if p.reference[0] in "RCDUJ"}
    comments = {r: row["Comment"] for row in parts for r in row["Designator"].split(",")}
    assert [r for r, comment in comments.items() if ", 0.1 %, " in comment] == ["R10", "R11", "R12", "R13", "R14"]
    assert comments["R1"] == "2.4k, 1 % or better, 0.1 W"
    assert comments["C1"] == "1u, X7R 16 V, 5 % or better"
    assert comments["U1"] == "TL082BC"
    # The same lines as the bill of materials: what differs in its rating is not bought as one.
    assert [row["Designator"].replace(",", " ") for row in parts] == [
        row["References"] for row in rows(bill_of_materials(CIRCUIT))
    ]
    decoupled = board_circuit(
        board_values(Design.load(changes=["board.variant=comparator", "detector.window_samples=6"]))
    )
    assert decoupled.part("C17").value == decoupled.part("C18").value == "100n"
    for row in rows(parts_file(decoupled)):
        assert len({decoupled.part(r).rating for r in row["Designator"].split(",")}) == 1
    assert {row["Designator"] for row in places} == {r for r in named if r[0] != "J"}


def test_placement_is_where_kicad_has_it(tmp_path: Path) -> None:
    write_board(Design(), tmp_path / "pcb")
    run = kicad_cli(
        tmp_path / "pcb", "pcb", "export", "pos", LAYOUT, "--use-drill-file-origin", "--format", "csv", "--units", "mm",
        "-o", "pos.csv",
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    theirs = {r["Ref"]: r for r in rows((tmp_path / "pcb" / "pos.csv").read_bytes())}
    ours = rows(placement_file(CIRCUIT, ARTICLE_PLACEMENT))
    assert {r["Designator"] for r in ours} == {ref for ref in theirs if ref[0] != "J"}
    for row in ours:
        their = theirs[row["Designator"]]
        assert float(row["Mid X"].removesuffix("mm")) == pytest.approx(float(their["PosX"]), abs=1e-4)
        assert float(row["Mid Y"].removesuffix("mm")) == pytest.approx(float(their["PosY"]), abs=1e-4)
        assert float(row["Rotation"]) % 360 == float(their["Rot"]) % 360
        assert their["Side"] == row["Layer"].lower()


def test_fabrication_files_are_whole_and_the_same_each_time(tmp_path: Path) -> None:
    require_tool("kicad-cli", HOW)
    run = run_fingertip("board", "--fab", "--quiet", "--out", tmp_path)
    assert (run.returncode, run.stderr) == (0, "")
    one = tmp_path / "fab"
    archive = zipfile.ZipFile(one / "slip_filter_gerbers.zip")
    assert gerbers(board_files(Design()), "slip_filter") == (one / "slip_filter_gerbers.zip").read_bytes()
    names = {name.removeprefix("slip_filter").split(".")[0] for name in archive.namelist()}
    assert {"-F_Cu", "-B_Cu", "-F_Mask", "-B_Mask", "-F_Silkscreen", "-F_Paste", "-Edge_Cuts", ""} <= names
    for layer in ("F_Cu.gtl", "B_Cu.gbl"):
        assert archive.read(f"slip_filter-{layer}").count(b"D01*") > 20  # copper is drawn, the pour with it
    assert b"T1C0.300" in archive.read("slip_filter.drl")
    assert (one / "slip_filter_front.png").read_bytes().startswith(b"\x89PNG")
    assert (one / "slip_filter_schematic.pdf").read_bytes().startswith(b"%PDF")
    recorded = [line.split("  ")[1] for line in (one / MADE_FROM).read_text().splitlines()]
    assert {path.name for path in one.iterdir()} == {name for name in recorded if "/" not in name} | {MADE_FROM}
    assert run_fingertip("board", "--check", "--fab", "--out", tmp_path).returncode == 0


BOARD = {"slip_filter.kicad_pcb": b"pcb", "slip_filter.kicad_sch": b"sch", "bom.csv": b"bom", "values.json": b"{}"}


def test_the_record_says_what_is_not_of_this_board(tmp_path: Path) -> None:
    made = {"slip_filter_gerbers.zip": b"zip", "slip_filter_parts.csv": b"parts"}
    for name, data in (made | {"record": origin(BOARD, made)}).items():
        (tmp_path / name).write_bytes(data)
    assert differing(tmp_path, "record", BOARD) == []
    assert differing(tmp_path, "record", BOARD | {"values.json": b"other"}) == []
    for name in ("slip_filter.kicad_pcb", "slip_filter.kicad_sch", "bom.csv"):
        (sentence,) = differing(tmp_path, "record", BOARD | {name: b"other"})
        assert f"was made from another {name} than this design gives; make it anew with --fab" in sentence
    (tmp_path / "slip_filter_gerbers.zip").write_bytes(b"older")
    (tmp_path / "slip_filter_parts.csv").unlink()
    changed, missing = differing(tmp_path, "record", BOARD)
    assert "slip_filter_gerbers.zip: was changed after it was made" in changed
    assert "slip_filter_parts.csv: cannot be read" in missing
    for record in (b"hello", b"\xff\xfe"):
        (tmp_path / "record").write_bytes(record)
        assert "holds no record that says" in differing(tmp_path, "record", BOARD)[0]


def test_gerbers_of_an_earlier_board_are_named(tmp_path: Path) -> None:
    assert run_fingertip("board", "--out", tmp_path).stderr.count("warning") == 0
    assert run_fingertip("board", "--out", tmp_path, "--check", "--fab").returncode == 1, "there are none"
    (tmp_path / "fab").mkdir()
    (tmp_path / "fab" / "slip_filter_gerbers.zip").write_bytes(b"zip")
    (tmp_path / "fab" / MADE_FROM).write_bytes(origin(board_files(Design()), {"slip_filter_gerbers.zip": b"zip"}))
    assert run_fingertip("board", "--out", tmp_path, "--check", "--fab").returncode == 0
    assert "warning" not in run_fingertip("board", "--out", tmp_path).stderr

    run = run_fingertip("board", "--out", tmp_path, "--set", "board.cutoff_hz=80", "--json")
    assert run.returncode == 0
    assert f"warning: {tmp_path / 'fab'}: was made from another slip_filter.kicad_pcb than this design" in run.stderr
    assert any("bom.csv" in sentence for sentence in json.loads(run.stdout)["outdated"])
    for words in (("--check",), ("--check", "--fab")):
        run = run_fingertip("board", "--out", tmp_path, "--set", "board.cutoff_hz=80", *words)
        assert run.returncode == 1
        assert "make it anew with --fab" in run.stdout
    (tmp_path / "fab" / MADE_FROM).unlink()
    assert "holds no made_from.sha256" in run_fingertip("board", "--out", tmp_path).stderr


def test_without_kicad_it_says_how_to_install_it(tmp_path: Path) -> None:
    run = run_fingertip("board", "--fab", "--quiet", "--out", tmp_path / "pcb", PATH=str(tmp_path))
    assert run.returncode == 2
    assert len(run.stderr.splitlines()) == 1
    assert "apt-get install -t bookworm-backports kicad" in run.stderr
    assert not (tmp_path / "pcb" / "fab").exists()
