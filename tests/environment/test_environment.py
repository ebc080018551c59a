"""Machines that lack something: the working folder, a cache of compiled loops, streams, UTF-8."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from fingertip.foundation.jit import CompiledLoop, Floats, MutableFloats, compiled
from tests.conftest import run_fingertip, run_python


def read_files(folder: Path) -> dict[str, bytes]:
    """Read all files of a folder."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


@pytest.mark.full
@pytest.mark.parametrize("words", [("board", "fsr400"), ("new", "tip")])
def test_a_working_folder_that_was_removed_is_a_sentence(
    words: tuple[str, ...], tmp_path: Path
) -> None:
    """It once was a fault of the program, with exit code 70."""
    gone = tmp_path / "gone"
    gone.mkdir()
    words = (sys.executable, "-m", "fingertip", *words)
    script = ("sh", "-c", 'cd "$0" && rmdir "$0" && exec "$@"', str(gone), *words)
    done = subprocess.run(script, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 2
    assert (
        "working folder: has been removed" in done.stderr
        or "tip.toml: cannot be written" in done.stderr
    )
    assert list(tmp_path.iterdir()) == []


# Cache of compiled loops


def _double(values: Floats, out: MutableFloats) -> None:
    for i in range(len(values)):
        out[i] = 2.0 * values[i]


def run_loop() -> list[float]:
    """Run a compiled loop of this module, loaded anew."""
    import numpy as np

    out = np.zeros(3)
    with compiled():
        CompiledLoop(_double, samples="values", plain_us=1e3)(np.arange(3.0), out)
    return out.tolist()


LOOP = "import sys; from tests.environment.test_environment import run_loop; print(run_loop())"


@pytest.mark.full
@pytest.mark.parametrize("place", ["/dev/null/cache", "emptied", "overwritten"])
def test_a_cache_of_compiled_loops_that_cannot_be_used(place: str, tmp_path: Path) -> None:
    """A place that cannot be written and a damaged file once ended the command with
    exit code 70.
    """
    pytest.importorskip("numba")
    cache = place
    if place in ("emptied", "overwritten"):
        cache = str(tmp_path)
        assert run_python("-c", LOOP, NUMBA_CACHE_DIR=cache).returncode == 0
        files = [path for path in tmp_path.rglob("*.nb*")]
        assert len(files) == 2
        for path in files:
            if place == "emptied" or path.suffix == ".nbc":
                path.write_bytes(b"" if place == "emptied" else b"other")
    for _ in range(2):
        done = run_python("-c", LOOP, NUMBA_CACHE_DIR=cache)
        assert (done.stdout, done.returncode) == ("[0.0, 2.0, 4.0]\n", 0), done.stderr


# Output


@pytest.mark.full
@pytest.mark.parametrize("closed", ["<&- >&- 2>&-", "2>&-"])
def test_closed_streams_change_neither_files_nor_exit_codes(closed: str, tmp_path: Path) -> None:
    """A closed stderr once gave exit code 1, that of a failed check, and a closed stdout 70."""
    for words, code in (("board fsr400 --out b", 0), ("params missing", 2)):
        command = f'exec "$0" -m fingertip {words} {closed}'
        done = subprocess.run(
            ["sh", "-c", command, sys.executable], cwd=tmp_path, check=False, timeout=300
        )
        assert done.returncode == code, words
    names = {path.name for path in (tmp_path / "b").iterdir()}
    assert {"bom.csv", "manifest.json"} <= names
    # Messages must not end up in a file that takes the number of the closed stream.
    assert b"wrote" not in (tmp_path / "b" / "bom.csv").read_bytes()


@pytest.mark.full
def test_the_c_locale_writes_the_same_bytes(tmp_path: Path) -> None:
    ascii_only = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    for name, environment in (("utf8", {"LC_ALL": "C.UTF-8"}), ("c", ascii_only)):
        (tmp_path / name).mkdir()
        words = ("board", "fsr400", "--out", "b")
        done = run_fingertip(*words, PWD=str(tmp_path / name), **environment)
        assert done.returncode == 0, done.stderr
    done = run_fingertip("params", "fsr400", **ascii_only)
    assert done.returncode == 0, done.stderr
    assert read_files(tmp_path / "utf8") == read_files(tmp_path / "c")
