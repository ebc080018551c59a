"""A crash never looks like a failed check: it has its own exit code,
a sentence, and a file with the details.
"""

from __future__ import annotations

import errno
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from fingertip.cli import console as last_resort
from fingertip.design import design_file as export
from tests.conftest import ROOT, run_fingertip, run_python


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    return tmp_path


def fail_with(error: BaseException, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> None:
        raise error

    monkeypatch.setattr(export, "list_parameters", fail)


@pytest.mark.parametrize(
    "error", [ZeroDivisionError("float division"), EOFError(), KeyError("x"), RecursionError()]
)
def test_an_unexpected_exception_has_its_own_exit_code(
    folder: Path, monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    fail_with(error, monkeypatch)
    done = run_fingertip("params", "--json")
    assert done.returncode == last_resort.FAULT == 70
    assert "Traceback" not in done.stderr
    assert done.stderr.count("\n") == 1
    assert (
        f"stopped at a fault of its own, not at one of your input ({type(error).__name__}"
        in done.stderr
    )
    assert '"issues"' in done.stdout
    (details,) = folder.glob("fingertip-fault-*.txt")
    assert f"details are in {details}; report it, with that file" in done.stderr
    text = details.read_text()
    assert "Traceback (most recent call last)" in text
    assert re.match(r"fingertip \S+, Python 3\.\d+", text)


def test_the_sentence_for_the_limits_of_the_machine(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fail_with(MemoryError("Unable to allocate 8 GiB"), monkeypatch)
    assert (
        "the memory did not suffice (MemoryError: Unable to allocate 8 GiB)"
        in run_fingertip("params").stderr
    )
    fail_with(OSError(errno.EMFILE, "Too many open files"), monkeypatch)
    done = run_fingertip("params")
    assert "no more files may be opened" in done.stderr
    assert "ulimit -n 256" in done.stderr


@pytest.mark.parametrize(
    "words", [("calibrate", "sensor", "fsr400"), ("detect",), ("check",), ("sweep",), ("make",)]
)
def test_a_path_that_is_too_long_is_refused(words: tuple[str, ...]) -> None:
    for path in ("x" * 300, "9" * 5000):
        done = run_fingertip(*words, path)
        assert done.returncode == 2
        assert (
            done.stderr.count("(File name too long)") + done.stderr.count("neither a file nor") == 1
        )
        assert len(done.stderr) < 2000


def test_an_error_of_a_path_is_no_fault() -> None:
    for number, name, said in (
        (
            errno.EACCES,
            "folder/file",
            "folder/file: cannot be used (No); give another path, or change its mode.",
        ),
        (
            errno.ENOENT,
            b"file",
            "file: cannot be used (No); give another path, or change its mode.",
        ),
        (errno.EBADF, 7, "7: cannot be used (No); give another path, or change its mode."),
        (errno.ENOSPC, None, "disk: cannot be written (No); free some space there, and in TMPDIR."),
        (errno.ENOENT, None, "None"),
    ):
        assert str(last_resort.describe_path_error(OSError(number, "No", name))) == said


def test_details_that_cannot_be_written_are_left_out(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "missing"))
    fail_with(ValueError("x\x1b[31m\n" + "y" * 10_000), monkeypatch)
    done = run_fingertip("params")
    assert done.returncode == 70
    assert "no file of details could be written" in done.stderr
    assert "\x1b" not in done.stderr
    assert len(done.stderr) < 1000


def test_a_program_that_cannot_be_loaded_is_a_fault_too(tmp_path: Path) -> None:
    (tmp_path / "typer.py").write_text("raise OSError('broken')")
    done = run_python(
        "-m", "fingertip", "params", PYTHONPATH=f"{tmp_path}:{ROOT / 'src'}", PYTHONSAFEPATH="1"
    )
    assert done.returncode == 70
    assert done.stderr == (
        "error: fingertip cannot be loaded (OSError: broken); install it again, and see that "
        "files may be opened "
        "(ulimit -n).\n"
    )


def test_a_closed_pipe_is_no_failed_check() -> None:
    reading, writing = os.pipe()
    os.close(reading)
    try:
        done = subprocess.run(
            [sys.executable, "-m", "fingertip", "params"],
            stdout=writing,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    finally:
        os.close(writing)
    assert (done.returncode, done.stderr) == (141, "")


def test_exit_codes_are_documented() -> None:
    page = (ROOT / "docs/files.md").read_text(encoding="utf-8")
    for code in (0, 1, 2, 70, 130, 141):
        assert f"\n| {code} | " in page


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no full disk to offer")
@pytest.mark.parametrize(
    "words", [pytest.param(("params",), marks=pytest.mark.full), ("params", "--json")]
)
def test_results_that_cannot_be_written(words: tuple[str, ...]) -> None:
    script = (
        "import os, sys\nos.dup2(os.open('/dev/full', os.O_WRONLY), 1)\n"
        "from fingertip.cli import app\napp(sys.argv[1:])\n"
    )
    done = run_python("-c", script, *words)
    assert done.returncode == 2
    assert (
        done.stderr
        == "error: standard output: cannot be written (No space left on device); redirect it "
        "elsewhere.\n"
    )
