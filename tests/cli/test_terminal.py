"""What the command line says besides results: help, words that it does
not take, and the summary of what was made.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from fingertip.cli.console import CLEAR_LINE
from fingertip.foundation import workers
from fingertip.tasks import build as build_task
from fingertip.tasks import views
from tests.conftest import DESIGNS, ROOT, run_fingertip
from tests.tools import leave_out

BUNDLED = sorted(
    path.stem for folder in ("params", "params/sets") for path in (ROOT / folder).glob("*.toml")
)
IN_FIRST_SET = ("article",)
"""The design with the most warnings."""


@pytest.mark.parametrize("words", [(), ("calibrate",)])
def test_a_program_without_words_prints_its_help(words: tuple[str, ...]) -> None:
    done = run_fingertip(*words)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == run_fingertip(*words, "--help").stdout


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ("make",),
            "fingertip make: missing argument 'DESIGN'; `fingertip make --help` lists what it "
            "takes.",
        ),
        (
            ("nosuch",),
            "fingertip: no such command 'nosuch'; `fingertip --help` lists what it takes.",
        ),
        (
            ("board", "--bode"),
            "fingertip board: option '--bode' requires an argument; `fingertip board --help` "
            "lists what it takes.",
        ),
        (
            ("calibrate", "printer", "fsr400"),
            "fingertip calibrate printer: missing option '--half-thickness-mm'; ",
        ),
        (("params", "--foo"), "fingertip params: no such option: --foo"),
        (
            ("sweep", "board", "--jobs", "x"),
            r"fingertip sweep: invalid value for '--jobs': (Input should be|'x' is not) a valid "
            r"integer",
        ),
    ],
)
@pytest.mark.every_case
def test_words_that_are_not_taken_are_errors_like_any_other(
    words: tuple[str, ...], said: str
) -> None:
    done = run_fingertip(*words)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert re.match(f"error: {said}", done.stderr)  # versions of typer say it in two ways
    remedy = re.search(r"`fingertip (.*)--help`", done.stderr)
    assert remedy
    assert run_fingertip(*remedy[1].split(), "--help").returncode == 0


@pytest.mark.second
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[] if name in IN_FIRST_SET else pytest.mark.full)
        for name in BUNDLED
    ],
)
@pytest.mark.every_case
def test_a_summary_has_twelve_lines_of_a_hundred_characters(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert {*IN_FIRST_SET, *DESIGNS} <= {*BUNDLED}
    # The others do not know what is replaced here.
    monkeypatch.setattr(workers, "count_processors", lambda: 1)
    monkeypatch.setattr(build_task, "_draw_steps", lambda *_: {})
    monkeypatch.setattr(
        views, "write_page", lambda design, folder, force, prepared: (folder / "index.html", 0, ())
    )
    done = run_fingertip("make", name, "--formats", "stl,3mf", PWD=str(tmp_path))
    lines = done.stdout.splitlines()
    assert done.returncode == 0, done.stderr
    assert len(lines) <= 12
    assert [line for line in lines if len(line) > 100] == []
    assert f"out/{name}" in done.stdout
    assert [line.partition(":")[0] for line in lines[-2:]] == ["look at", "next"]
    assert "%" not in done.stderr
    assert [line for line in done.stderr.splitlines() if not line.startswith("warning: ")] == []


@pytest.mark.full
def test_many_remarks_are_cut_and_counted(tmp_path: Path) -> None:
    """A design of which many checks fail still gives a summary,
    which names the file with all of them.
    """
    weak = (
        "printer.bed_x_mm=20",
        "printer.bed_y_mm=20",
        "printer.bed_z_mm=20",
        "strength.grip_force_n=40",
    )
    words = [word for change in weak for word in ("--set", change)]
    done = run_fingertip("build", "article", "--formats", "stl,3mf", *words, PWD=str(tmp_path))
    lines = done.stdout.splitlines()
    assert done.returncode == 1
    assert len(lines) == 12
    assert max(map(len, lines)) <= 100
    assert re.fullmatch(r"and \d+ more, in report.json", lines[-2])


@pytest.mark.full
def test_a_terminal_shows_one_line_that_is_drawn_again() -> None:
    try:
        reader, writer = os.openpty()
    except (
        AttributeError,
        OSError,
    ) as error:  # as on Windows, and where no file system of terminals is mounted
        leave_out(f"NO PSEUDO-TERMINAL, THIS IS NOT TESTED: {error}")
    command = [
        sys.executable,
        "-m",
        "fingertip",
        "check",
        "fsr400",
        "fsr402",
        "--tolerance-mm",
        "0.05",
    ]
    done = subprocess.run(
        command,
        stdout=subprocess.PIPE,
        stderr=writer,
        env=os.environ | {"TERM": "xterm"},
        text=True,
        check=False,
    )
    os.close(writer)
    shown = os.read(reader, 10_000).decode()
    os.close(reader)
    assert done.returncode == 0
    assert "\n" not in shown
    first, second, end = shown.split(CLEAR_LINE)[1:]
    assert first.endswith("checking: fsr400: 0 % done")
    assert re.search(r"checking: fsr402: 50 % done, \d+ s left$", second)
    assert end == ""
