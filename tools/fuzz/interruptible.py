"""Runs of the command line that can be interrupted: fresh processes, or forks of this one that need not be loaded."""

from __future__ import annotations

import contextlib
import importlib
import os
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

MARK = "FINGERTIP_INTERRUPTED_RUN"
"""Environment variable by which the processes of a run are found."""
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)


@dataclass(frozen=True)
class Run:
    """A run that has ended."""

    code: int | None
    """Exit code, negative for a signal that ended the process; None if it did not end."""
    stdout: str
    stderr: str
    seconds: float


@dataclass(frozen=True)
class Interruption:
    """A signal to send."""

    number: signal.Signals
    after_s: float


class Place:
    """Folders of a run: where it works, its temporary files, and a mark of its processes."""

    def __init__(self, top: Path) -> None:
        self.top, self.work, self.temporary = top, top / "work", top / "tmp"
        self.work.mkdir(parents=True)
        self.temporary.mkdir()
        self.mark = str(top)

    def _environment(self) -> dict[str, str]:
        return {MARK: self.mark, "TMPDIR": str(self.temporary), "OPENBLAS_NUM_THREADS": "1"}

    def run(
        self,
        words: tuple[str, ...],
        interruption: Interruption | None,
        *,
        fresh: bool,
        limit_s: float,
        modules: Path | None = None,
    ) -> Run:
        """Run a command, interrupt it after a while, and wait for its end."""
        start_s = time.monotonic()
        with (self.top / "stdout").open("wb+") as out, (self.top / "stderr").open("wb+") as err:
            if fresh:
                pid = self._start_process(words, out.fileno(), err.fileno())
            else:
                pid = self._fork(words, out.fileno(), err.fileno(), modules)
            code = _wait(pid, interruption.after_s if interruption else limit_s)
            if code is None and interruption:
                with contextlib.suppress(ProcessLookupError):
                    # A terminal sends SIGINT to the whole group; whoever sends another signal means one process.
                    (os.killpg if interruption.number == signal.SIGINT else os.kill)(pid, interruption.number)
                code = _wait(pid, limit_s)
            if code is None:
                os.kill(pid, signal.SIGKILL)
                os.waitpid(pid, 0)
        texts = [(self.top / name).read_bytes().decode("utf-8", "replace") for name in ("stdout", "stderr")]
        return Run(code, texts[0], texts[1], time.monotonic() - start_s)

    def _start_process(self, words: tuple[str, ...], out: int, err: int) -> int:
        process = subprocess.Popen(
            [sys.executable, "-m", "fingertip", *words], stdin=subprocess.DEVNULL, stdout=out, stderr=err,
            cwd=self.work, env=os.environ | self._environment(), start_new_session=True, preexec_fn=_default_signals,
        )  # fmt: skip
        process.returncode = 0  # it is waited for by its number
        return process.pid

    def _fork(self, words: tuple[str, ...], out: int, err: int, modules: Path | None) -> int:
        sys.stdout.flush()
        sys.stderr.flush()
        # The signals wait until the child handles them: those of a process that starts are tried with fresh ones.
        signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
        pid = os.fork()
        if pid:
            signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)
            return pid
        code = 99
        try:
            os.setsid()
            _default_signals()
            null = os.open(os.devnull, os.O_RDONLY)
            for handle, target in ((null, 0), (out, 1), (err, 2)):
                os.dup2(handle, target)
            os.chdir(self.work)
            os.environ.update(self._environment())
            tempfile.tempdir = None
            code = _run_main(words)
            if modules:
                modules.write_text("\n".join(sorted(sys.modules)))
        finally:
            os._exit(code)

    def find_processes(self) -> list[int]:
        """Find the processes of the run that still live."""
        found = []
        wanted = f"{MARK}={self.mark}".encode()
        for path in Path("/proc").glob("[0-9]*/environ"):
            with contextlib.suppress(OSError):
                if wanted in path.read_bytes().split(b"\0"):
                    found.append(int(path.parent.name))
        return found

    def wait_for_processes(self, limit_s: float) -> list[int]:
        """Wait until no process of the run lives, and return those that do all the same."""
        until = time.monotonic() + limit_s
        while (found := self.find_processes()) and time.monotonic() < until:
            time.sleep(0.05)
        return found


def load_modules(listed: Path) -> None:
    """Import the modules that a run has used, so that later forks have them."""
    for name in listed.read_text().splitlines():
        if name.startswith("fingertip.") or name in ("matplotlib.figure", "manifold3d", "scipy.stats", "numba"):
            with contextlib.suppress(ImportError):
                importlib.import_module(name)


def _default_signals() -> None:
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)


def _run_main(words: tuple[str, ...]) -> int:
    from fingertip.__main__ import main

    sys.argv = ["fingertip", *words]
    try:
        main()
        code = 0
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 0 if end.code is None else 1
    except BaseException:
        import traceback

        traceback.print_exc()
        code = 98
    sys.stdout.flush()
    sys.stderr.flush()
    return code


def _wait(pid: int, limit_s: float) -> int | None:
    """Wait for a process, and return its exit code; None if it still runs."""
    until = time.monotonic() + limit_s
    while True:
        done, status = os.waitpid(pid, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status)
        if time.monotonic() >= until:
            return None
        time.sleep(min(0.005, max(0.0, until - time.monotonic())))
