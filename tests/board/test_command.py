"""`fingertip board`: output, errors, files and imports."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fingertip.board.kicad.project import MODEL_FOLDER
from fingertip.foundation.output_set import MANIFEST
from tests.board.test_netlist import FILES
from tests.conftest import run_fingertip
from tests.designs import ARTICLE_OPTIONS

DETAILS = ((), ("--verbose",), ("--article",))


def test_command_prints_tables_and_writes_files(tmp_path: Path) -> None:
    run = run_fingertip("board", *ARTICLE_OPTIONS, "--out", tmp_path / "deep" / "pcb")
    assert run.returncode == 0
    for text in ("2375.4", "1187.7", "4750.9", "2.4k", "1.2k", "4.7k", "67.25", "0.9895"):
        assert text in run.stdout
    assert run.stdout.splitlines()[0].endswith("conditions of a working board are met"), "the verdict comes first"
    assert run.stderr.count("wrote ") == len(FILES) - 2  # manifest and models are not announced
    assert sorted(p.name for p in (tmp_path / "deep" / "pcb").iterdir()) == FILES


def test_details_are_printed_where_they_are_asked_for(tmp_path: Path) -> None:
    brief, verbose, article = (run_fingertip("board", "--out", tmp_path, *more).stdout for more in DETAILS)
    assert [text in brief for text in ("phase margin", "Errata", "67.67 (36.61 dB)")] == [False, False, False]
    assert verbose.startswith(brief.rstrip("\n"))
    assert "phase margin" in verbose
    assert article.startswith(brief.rstrip("\n"))
    assert "67.67 (36.61 dB)" in article


def test_json_output_equals_the_values_file_and_quiet_prints_no_messages(tmp_path: Path) -> None:
    design = tmp_path / "mine.toml"
    design.write_text('[board]\nseries = "E12"\n')
    run = run_fingertip(
        "board", design, "--out", tmp_path, "--json", "--quiet", *ARTICLE_OPTIONS, "--set", "board.series=E96"
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
    assert all(values[key] == data[key] for key in ("ideal", "preferred", "achieved_response", "errata"))


def test_default_output_folder_is_that_of_the_design(tmp_path: Path) -> None:
    missing = run_fingertip("board", "fsr400", "--check", PWD=str(tmp_path))
    assert missing.returncode == 1
    assert missing.stdout == "out/fsr400/board does not exist; name the folder with --out.\n"
    run = run_fingertip("board", "fsr400", "--quiet", PWD=str(tmp_path))
    assert run.returncode == 0
    assert (tmp_path / "out" / "fsr400" / "board" / "slip_filter.net").is_file()
    assert run_fingertip("board", "fsr400", "--check", PWD=str(tmp_path)).returncode == 0


NOISY = ("board.variant=precision", "board.passband_gain=300", "board.amplifier=OPA2197")
SHORT_WINDOW = ("board.variant=comparator", "detector.sample_rate_hz=10000", "detector.window_samples=60")


@pytest.mark.full
@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ((*NOISY, "detector.threshold_v=0.004"), ["mean envelope to 10.9 mV, and detector.threshold_v is 4 mV"]),
        (NOISY, []),
        (SHORT_WINDOW, ["detector.window_samples of 60 at 10000 Hz is 6 ms"]),
        (SHORT_WINDOW[:1], []),
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
    assert first.endswith("conditions of a working board are met, with a warning:" if expected else "are met")
    assert rest == [f"  warning: {text}" for text in data["warnings"]]


@pytest.mark.full
def test_default_folder_keeps_a_board_of_another_circuit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Other values replace those of the same circuit; another variant is written beside, or with --force."""
    monkeypatch.chdir(tmp_path)
    assert run_fingertip("board", "article", "-q").returncode == 0
    assert run_fingertip("board", "article", "--set", "board.cutoff_hz=80", "-q").returncode == 0
    layout = Path("out/article/board/slip_filter.kicad_pcb")
    before = layout.read_bytes()
    other = ("article", "--set", "board.variant=comparator", "-q")
    refused = run_fingertip("board", *other)
    assert refused.returncode == 2
    assert "holds a board of 'article' with another circuit" in refused.stderr
    assert "it adds C14" in refused.stderr
    assert layout.read_bytes() == before
    remedy = refused.stderr.partition("--out ")[2].partition(",")[0]
    assert run_fingertip("board", *other, "--out", remedy).returncode == 0
    assert run_fingertip("board", *other, "--force").returncode == 0
    assert layout.read_bytes() == (Path(remedy) / layout.name).read_bytes() != before
