"""Interruptions: what ends a command leaves no litter, no
half-written file and an exit code of its own.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from unittest.mock import Mock

import pytest

from fingertip.cli.options import command
from fingertip.foundation import files as temporary
from fingertip.foundation import folder_swap, interruption
from fingertip.foundation.errors import OutputError
from fingertip.foundation.files import temporary_folder
from fingertip.foundation.interruption import Interruption
from tests.conftest import run_python

pytestmark = pytest.mark.skipif(
    not hasattr(os, "fork"), reason="processes are ended with signals, NOT TESTED HERE"
)

WAIT_S = 120.0


@pytest.fixture
def handlers() -> Iterator[None]:
    """The handlers of the command line, for the time of a test."""
    before = {number: signal.getsignal(number) for number in interruption.SIGNALS}
    for number in interruption.SIGNALS:
        signal.signal(number, signal.SIG_DFL)
    interruption.raise_interruptions()
    yield
    interruption.forget_signal()
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("number", interruption.SIGNALS)
def test_a_signal_within_a_command_has_its_exit_code_and_a_sentence(
    number: signal.Signals, handlers: None, capsys: pytest.CaptureFixture[str]
) -> None:
    import typer

    @command
    def work() -> None:
        signal.raise_signal(number)

    with pytest.raises(typer.Exit) as caught:
        work()
    assert caught.value.exit_code == 128 + number
    by = "" if number == signal.SIGINT else f" by {number.name}"
    assert capsys.readouterr().err == f"interrupted{by}; no file is half-written\n"


def test_an_import_that_turns_an_interruption_into_another_error_is_interrupted_too(
    handlers: None,
) -> None:
    """numpy says that its multiarray module cannot be imported."""
    import typer

    @command
    def work() -> None:
        try:
            signal.raise_signal(signal.SIGTERM)
        except Interruption:
            raise ImportError("numpy._core.multiarray failed to import") from None

    with pytest.raises(typer.Exit) as caught:
        work()
    assert caught.value.exit_code == 143


def test_signals_are_held_while_manifold_is_imported() -> None:
    """manifold3d aborts the process if a handler raises within its import."""
    program = (
        "import os, signal, sys\n"
        "from fingertip.cad.kernel import mesh; from fingertip.foundation import interruption\n"
        "class Sender:\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        "        if name == 'manifold3d': os.kill(os.getpid(), signal.SIGTERM)\n"
        "sys.meta_path.insert(0, Sender()); interruption.raise_interruptions()\n"
        "try: mesh.load_manifold()\n"
        "except interruption.Interruption: print('manifold3d' in sys.modules)\n"
    )
    done = run_python("-c", program)
    assert (done.stdout, done.returncode) == ("True\n", 0), done.stderr


def test_a_signal_that_the_starting_process_ignores_stays_ignored() -> None:
    program = (
        "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)\n"
        "from fingertip.foundation import interruption; interruption.raise_interruptions()\n"
        "signal.raise_signal(signal.SIGINT); print('still here')\n"
    )
    assert run_python("-c", program).stdout == "still here\n"


# Temporary folders


def start_build(folder: Path, temporary_place: Path) -> subprocess.Popen[str]:
    """Start a build with STEP files, and wait until its temporary folder is there."""
    temporary_place.mkdir()
    process = subprocess.Popen(
        [
            sys.executable,
            "-m",
            "fingertip",
            "build",
            "fsr400",
            "--formats",
            "step",
            "--out",
            str(folder / "out"),
        ],
        env=os.environ | {"TMPDIR": str(temporary_place)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    until = time.monotonic() + WAIT_S
    while not list(temporary_place.glob("*/messages.txt")):
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < until, "no STEP process was started"
        time.sleep(0.02)
    return process


def wait_for_step_processes(folder: Path) -> None:
    """Wait until no process works in a folder."""
    until = time.monotonic() + WAIT_S
    while True:
        found = []
        for path in Path("/proc").glob("[0-9]*/cwd"):
            with contextlib.suppress(OSError):
                found += [path] if path.readlink().is_relative_to(folder) else []
        if not found:
            return
        assert time.monotonic() < until, "the STEP process outlives its parent"
        time.sleep(0.05)


@pytest.mark.full
@pytest.mark.parametrize(
    "number", [signal.SIGTERM, pytest.param(signal.SIGINT, marks=pytest.mark.full)]
)
def test_an_interrupted_build_leaves_no_temporary_folder(
    number: signal.Signals, tmp_path: Path
) -> None:
    """SIGTERM once left the folder of the STEP process, and the process at work."""
    place = tmp_path / "tmp"
    process = start_build(tmp_path, place)
    process.send_signal(number)
    errors = process.communicate(timeout=WAIT_S)[1]
    assert process.returncode == 128 + number
    assert errors.splitlines()[-1].startswith("interrupted")
    assert list(place.iterdir()) == []
    assert not (tmp_path / "out").exists()
    wait_for_step_processes(place)


@pytest.mark.full
@pytest.mark.skipif(
    sys.platform != "linux", reason="elsewhere a child process ends with its work, NOT TESTED HERE"
)
def test_a_killed_build_leaves_no_process_and_the_next_one_removes_its_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = tmp_path / "tmp"
    process = start_build(tmp_path, place)
    process.kill()
    process.communicate(timeout=WAIT_S)
    wait_for_step_processes(place)
    assert len(list(place.iterdir())) == 1
    monkeypatch.setattr("tempfile.tempdir", str(place))
    with temporary_folder() as folder:
        assert list(place.iterdir()) == [folder]
    assert list(place.iterdir()) == []


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder for temporary files."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    return tmp_path


def test_folders_in_use_and_those_of_others_are_left_alone(place: Path) -> None:
    (place / "theirs").mkdir()
    (place / "fingertip-tmp-link").symlink_to(place / "theirs")
    (place / "fingertip-tmp-file").write_text("mine")

    def interrupt() -> None:
        with temporary_folder() as first, temporary_folder() as second:
            (second / "a").write_text("b")
            temporary.remove_leftovers(place)
            assert first.is_dir()
            assert second.is_dir()
            raise Interruption(signal.SIGTERM)

    with pytest.raises(Interruption):
        interrupt()
    temporary.remove_leftovers(place)
    assert {path.name for path in place.iterdir()} == {
        "theirs",
        "fingertip-tmp-link",
        "fingertip-tmp-file",
    }


@pytest.mark.parametrize("loss", ["removed", "locked"])
def test_a_new_folder_that_another_process_takes_for_a_leftover_is_made_again(
    place: Path, monkeypatch: pytest.MonkeyPatch, loss: str
) -> None:
    lock = temporary.lock_folder
    handles = list[object]()
    lose: dict[str, Callable[[Path], object]] = {"removed": shutil.rmtree, "locked": lock}

    def lose_the_first(path: Path) -> int | None:
        if not handles:
            handles.append(lose[loss](path))
        return lock(path)

    monkeypatch.setattr(temporary, "lock_folder", lose_the_first)
    with temporary_folder() as folder:
        assert folder.is_dir()
        assert len(list(place.iterdir())) == (1 if loss == "removed" else 2)


@pytest.mark.skipif(sys.platform != "linux", reason="open files are listed on Linux alone")
def test_every_lock_is_closed(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A lock that stays open would hold a folder until its process
    ends, and processes may open few files.
    """
    before = os.listdir("/proc/self/fd")
    with temporary_folder() as folder:
        temporary.remove_leftovers(place)
        with pytest.raises(BlockingIOError):
            temporary.lock_folder(folder)
        assert folder.is_dir()
    (place / "fingertip-tmp-left").mkdir()
    temporary.remove_leftovers(place)
    assert list(place.iterdir()) == []
    with folder_swap.lock(place, shared=True), folder_swap.lock(place, shared=True):
        monkeypatch.setattr(folder_swap, "LOCK_S", 0.0)
        with (
            pytest.raises(OutputError, match="another command has been writing here"),
            folder_swap.lock(place),
        ):
            pass
    monkeypatch.setattr("fcntl.flock", Mock(side_effect=OSError))
    assert temporary.lock_folder(place) is None
    assert len(os.listdir("/proc/self/fd")) == len(before)


def test_no_place_for_temporary_files_is_a_sentence(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "missing"))
    with pytest.raises(
        OutputError,
        match=r"missing: cannot be written \(No such file.*set TMPDIR to another folder",
    ):
        temporary_folder().__enter__()

    def refuse() -> str:
        raise FileNotFoundError(2, "No usable temporary directory found in ['/tmp']")

    monkeypatch.setattr("tempfile.gettempdir", refuse)
    with pytest.raises(
        OutputError, match="TMPDIR: no folder for temporary files can be written; set it to one"
    ):
        temporary_folder().__enter__()
