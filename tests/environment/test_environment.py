"""Machines that lack something: space, rights, a home, a terminal, memory, processors, a cache, the right time."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from fingertip.foundation import folder_swap
from fingertip.foundation.errors import OutputError
from fingertip.foundation.jit import CompiledLoop, compiled
from fingertip.foundation.output_set import SetWriter
from tests.conftest import run_python

resource = pytest.importorskip("resource", reason="the system bounds no process, NOT TESTED HERE")

NOBODY = 65534
FULL_BYTES = 40 * 1024
GIGABYTE = 2**30


def run(
    *words: object,
    folder: Path,
    prepare: Callable[[], object] | None = None,
    launcher: tuple[str, ...] = (),
    **environment: str,
) -> subprocess.CompletedProcess[str]:
    """Run the command line as a process, in a folder."""
    command = [*launcher, sys.executable, "-m", "fingertip", *map(str, words)]
    return subprocess.run(
        command, cwd=folder, env=os.environ | environment, preexec_fn=prepare, stdin=subprocess.DEVNULL,
        capture_output=True, text=True, check=False, timeout=300,
    )  # fmt: skip


def read_files(folder: Path) -> dict[str, bytes]:
    """Read all files of a folder."""
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def assert_refused(done: subprocess.CompletedProcess[str], message: str) -> None:
    """The command has given one sentence, and the exit code of input that is refused."""
    assert done.returncode == 2, done.stderr
    assert message in done.stderr
    assert "Traceback" not in done.stderr
    assert len(done.stderr.splitlines()) == 1


# Space


@pytest.fixture
def full_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk with little space."""
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = shutil.which("mount")
    words = [str(mount), "-t", "tmpfs", "-o", f"size={FULL_BYTES}", "tmpfs", str(disk)]
    if mount is None or subprocess.run(words, capture_output=True, check=False).returncode:
        pytest.skip("NO DISK CAN BE MOUNTED HERE, a full disk IS NOT TESTED: run the tests as root, with CAP_SYS_ADMIN")
    yield disk
    subprocess.run(["umount", str(disk)], check=True)


@pytest.mark.full
def test_a_full_disk_keeps_the_old_set_and_gets_no_litter(full_disk: Path, tmp_path: Path) -> None:
    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (8192, 8192))

    old = run("new", "tip", folder=full_disk)
    assert old.returncode == 0, old.stderr
    before = read_files(full_disk)
    done = run("board", "fsr400", "--out", "board", folder=full_disk)
    assert_refused(done, "board: cannot be written (No space left on device); choose another folder with --out.")
    assert read_files(full_disk) == before
    (full_disk / "fill").write_bytes(bytes(FULL_BYTES - 8192 - sum(map(len, before.values()))))
    names = {path.name for path in full_disk.iterdir()}
    done = run("simulate", "fsr400", folder=tmp_path, TMPDIR=str(full_disk))
    assert_refused(done, "No space left on device")
    done = run("board", "fsr400", "--out", "board", folder=tmp_path, prepare=limit)
    assert_refused(done, "board: cannot be written (File too large)")
    assert {path.name for path in full_disk.iterdir()} == names
    assert [path.name for path in tmp_path.iterdir()] == ["disk"]


# Folders


def test_a_folder_that_vanishes_while_it_is_written_is_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "area" / "board"
    write = folder_swap.write_content

    def vanish(content: bytes, path: Path) -> None:
        shutil.rmtree(tmp_path / "area")
        write(content, path)

    monkeypatch.setattr(folder_swap, "write_content", vanish)
    with pytest.raises(OutputError, match=r"board: cannot be written \(No such file or directory\); choose another"):
        SetWriter(folder, "board", "finger", "new").write({"a": b"1", "b": b"2"})
    assert list(tmp_path.iterdir()) == []


@pytest.mark.full
@pytest.mark.parametrize("words", [("board", "fsr400"), ("new", "tip")])
def test_a_working_folder_that_was_removed_is_a_sentence(words: tuple[str, ...], tmp_path: Path) -> None:
    """It once was a fault of the program, with exit code 70."""
    gone = tmp_path / "gone"
    gone.mkdir()
    words = (sys.executable, "-m", "fingertip", *words)
    script = ("sh", "-c", 'cd "$0" && rmdir "$0" && exec "$@"', str(gone), *words)
    done = subprocess.run(script, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 2
    assert "working folder: has been removed" in done.stderr or "tip.toml: cannot be written" in done.stderr
    assert list(tmp_path.iterdir()) == []


# Rights, and a home


@pytest.fixture
def unprivileged(tmp_path: Path) -> tuple[str, ...]:
    """Launcher of a command as a user without rights, but to read what is installed."""
    setpriv = shutil.which("setpriv")
    if os.geteuid() != 0 or setpriv is None:
        pytest.skip("NO OTHER USER CAN BE TAKEN HERE, an unprivileged one IS NOT TESTED: run as root, with util-linux")
    words = [setpriv, f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups"]
    words += ["--inh-caps=+dac_read_search", "--ambient-caps=+dac_read_search"]
    if subprocess.run([*words, "true"], capture_output=True, check=False).returncode:
        pytest.skip("RIGHTS CANNOT BE DROPPED HERE, an unprivileged user IS NOT TESTED: give the container CAP_SETPCAP")
    for folder in (tmp_path, *tmp_path.parents):  # pytest makes them for one user alone
        if folder.stat().st_mode & 0o005 != 0o005:
            folder.chmod(folder.stat().st_mode | 0o055)
    return tuple(words)


@pytest.mark.full
def test_a_user_without_rights_and_home(unprivileged: tuple[str, ...], tmp_path: Path) -> None:
    """A home that is missing or read-only, no cache of compiled loops that may be written, and a plot."""
    own = tmp_path / "own"
    own.mkdir()
    os.chown(own, NOBODY, NOBODY)
    readonly = tmp_path / "home"
    readonly.mkdir(0o755)
    for home in (str(readonly), "/nonexistent"):
        words = ("simulate", "fsr400", "--out", "trace.csv", "--plot", "trace.png", "-q")
        done = run(*words, folder=own, launcher=unprivileged, HOME=home, TMPDIR=str(own), XDG_CACHE_HOME="")
        assert done.returncode == 0, done.stderr
        assert done.stderr == ""
        assert sorted(path.name for path in own.iterdir()) == ["trace.csv", "trace.png"]
    assert list(readonly.iterdir()) == []


@pytest.mark.full
def test_a_folder_of_somebody_else_is_refused(unprivileged: tuple[str, ...], tmp_path: Path) -> None:
    theirs = tmp_path / "theirs"
    theirs.mkdir(0o755)
    done = run("firmware", "fsr400", "--out", "f", folder=theirs, launcher=unprivileged, HOME="/nonexistent")
    assert_refused(done, "may not be written; change its mode, or choose another folder with --out.")
    done = run("new", "tip", folder=theirs, launcher=unprivileged, HOME="/nonexistent")
    assert_refused(done, "may not be written; change its mode, or choose another file with --out.")
    assert list(theirs.iterdir()) == []


# Cache of compiled loops


def _double(values, out):  # type: ignore[no-untyped-def]
    for i in range(len(values)):
        out[i] = 2.0 * values[i]


def run_loop() -> list[float]:
    """Run a compiled loop of this module, loaded anew."""
    import numpy as np

    out = np.zeros(3)
    with compiled():
        CompiledLoop(_double, outputs=1, samples="values", plain_us=1e3)(np.arange(3.0), out)
    return out.tolist()


LOOP = "import sys; from tests.environment.test_environment import run_loop; print(run_loop())"


@pytest.mark.full
@pytest.mark.parametrize("place", ["/dev/null/cache", "full", "emptied", "overwritten"])
def test_a_cache_of_compiled_loops_that_cannot_be_used(
    place: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    """A full disk and a damaged file once ended the command with exit code 70."""
    pytest.importorskip("numba")
    cache = place
    if place == "full":
        disk = request.getfixturevalue("full_disk")
        (disk / "fill").write_bytes(bytes(FULL_BYTES - 4096))
        cache = str(disk)
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
        done = subprocess.run(["sh", "-c", command, sys.executable], cwd=tmp_path, check=False, timeout=300)
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
        done = run("board", "fsr400", "--out", "b", folder=tmp_path / name, **environment)
        assert done.returncode == 0, done.stderr
    done = run("params", "fsr400", folder=tmp_path, **ascii_only)
    assert done.returncode == 0, done.stderr
    assert read_files(tmp_path / "utf8") == read_files(tmp_path / "c")


# Processors, memory, time


@pytest.mark.full
@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="processors cannot be taken away, NOT TESTED HERE")
def test_one_processor(tmp_path: Path) -> None:
    (tmp_path / "s.toml").write_text('outputs = ["q"]\n[axes]\nboard.cutoff_hz = [60.0, 70.0]\n')
    one = min(os.sched_getaffinity(0))
    done = run("sweep", "s.toml", "--out", "o", folder=tmp_path, prepare=lambda: os.sched_setaffinity(0, {one}))
    assert done.returncode == 0, done.stderr
    assert " by 1 processes, " in done.stdout


@pytest.mark.full
@pytest.mark.parametrize("words", [("board", "fsr400", "--out", "b"), ("simulate", "fsr400", "--out", "t.csv")])
def test_one_gigabyte_of_addresses_is_enough(words: tuple[str, ...], tmp_path: Path) -> None:
    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (GIGABYTE, GIGABYTE))

    done = run(*words, folder=tmp_path, prepare=limit, OPENBLAS_NUM_THREADS="1")
    assert done.returncode == 0, done.stderr


@pytest.mark.full
def test_a_clock_that_is_set_back_changes_no_byte_and_stops_nothing(tmp_path: Path) -> None:
    """The clock says 1975, before the first date that an archive can hold, and before the dates of all files."""
    program = (
        "import os, sys, time\n"
        "moment, base = time.localtime(1.6e8), time.time()\n"
        "now, local, utc = time.time, time.localtime, time.gmtime\n"
        "time.time = lambda: now() - base + 1.6e8\n"
        "time.localtime = lambda s=None: local(1.6e8 if s is None else s)\n"
        "time.gmtime = lambda s=None: utc(1.6e8 if s is None else s)\n"
        "sys.argv = ['fingertip', *sys.argv[1:]]\n"
        "from fingertip.__main__ import main; main()\n"
    )
    for name, start in (("now", ("-m", "fingertip")), ("then", ("-c", program))):
        folder = tmp_path / name
        folder.mkdir()
        done = run_python(*start, "simulate", "fsr400", "--out", "t.npz", PWD=str(folder))
        assert done.returncode == 0, done.stderr
    assert read_files(tmp_path / "now") == read_files(tmp_path / "then")
