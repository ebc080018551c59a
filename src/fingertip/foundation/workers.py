"""Work in other processes: one worker that answers calls, and several of them side by side.

A worker is a new process, or a copy of this one. It answers pickled calls one after the other
through two pipes. It may report its steps in between, so that a crash or a hang is attributed to a
step. No worker outlives the process that started it, and none reads anything from the current
folder, which may be a stranger's.

Whole calls are divided, such as the trials of a campaign, and not their loops. Each runs the same
code on the same numbers wherever it runs, so no bit depends on the number of workers, and calls of
different lengths cost no padding.
"""

from __future__ import annotations

import contextlib
import ctypes
import itertools
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
import time
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor, wait
from pathlib import Path
from typing import IO, Any, TypeVar

from fingertip.foundation.errors import FingertipError, Issue
from fingertip.foundation.jit import compiled

T = TypeVar("T")
MAX_JOBS = 1024
_AHEAD = 256
"""Number of calls that are computed ahead of the result that is taken: results may be large."""
_POLL_S = 0.5
_SLOWEST = 4.0
"""Time on the clock that a busy machine may take for each second of computing."""
_MESSAGES = "messages.txt"
"""File in the folder of a worker with the output of libraries; its last line names a crash."""
_answers: IO[bytes] | None = None
"""Pipe to which this process reports its steps, if it is a worker."""
_pool: Pool | None = None
"""Workers of `call_each`, within a block of `side_by_side`."""


class WorkerDiedError(Exception):
    """A worker ended by itself, or was killed, before it answered."""

    def __init__(
        self, step: Any = None, elapsed_s: float = 0.0, last_words: str = "no message"
    ) -> None:
        super().__init__(last_words)
        self.step = step
        self.elapsed_s = elapsed_s


class Worker(contextlib.AbstractContextManager["Worker"]):
    """Process that answers calls one after the other, and ends with the block."""

    def __init__(self, folder: Path | None = None, *, is_fork: bool = False) -> None:
        """Start a process in a folder, or in the current one.

        Libraries may look for settings in the current folder. A fork of this process, where
        `can_fork` allows it, saves the time to import all modules once more; the threads of numpy's
        BLAS stop for it.
        """
        self.steps: list[Any] = []
        """Steps of the present call that the worker reported."""
        self._since_s = 0.0
        """Time of the last step as the worker states it, as it may arrive late; or of the call."""
        self._folder = folder
        self._process: subprocess.Popen[bytes] | None = None

        if is_fork:
            self.pid, self._calls, self._answers = _fork(folder)
            return

        # Where this package is found by a path of the script alone, the worker finds it too.
        root = str(Path(__file__).parents[2])
        program = (
            f"import sys; sys.path.append({root!r}); from {__name__} import serve_parent; "
            f"serve_parent({os.getpid()})"
        )
        command = [sys.executable, "-P", "-c", program]
        places = filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep))
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(map(os.path.abspath, places))}
        pipe = subprocess.PIPE

        with (folder / _MESSAGES if folder else Path(os.devnull)).open("wb") as messages:
            self._process = subprocess.Popen(
                command,
                stdin=pipe,
                stdout=pipe,
                stderr=messages,
                cwd=folder,
                env=environment,
                # Ctrl-C reaches this process alone, which ends the other one
                start_new_session=True,
            )

        assert self._process.stdin
        assert self._process.stdout
        self.pid = self._process.pid
        self._calls = self._process.stdin
        self._answers = self._process.stdout

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the process, and close its pipes."""
        self.kill()
        with contextlib.suppress(BrokenPipeError):  # of a call that it has not read
            self._calls.close()

        self._answers.close()

    def kill(self) -> None:
        """End the process; a call that another thread waits for raises WorkerDiedError there.

        That thread ends the process too.
        """
        if self._process:
            self._process.kill()
            self._process.wait()
            return

        pid = self.pid
        self.pid = 0
        if pid:
            with contextlib.suppress(ChildProcessError, ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
                os.waitpid(pid, 0)

    def send(self, function: Callable[..., Any], *arguments: Any) -> None:
        """Send a call. If the worker has ended, `receive` raises WorkerDiedError."""
        self.steps = []
        self._since_s = time.monotonic()

        with contextlib.suppress(BrokenPipeError):
            self._calls.write(pickle.dumps((function, arguments)))
            self._calls.flush()

    def receive(self, until: Any = None, watch: Callable[[Any], None] = lambda _: None) -> Any:
        """Wait for the result or for a step, and call a function with each step.

        Raises what the function of the call raises, and WorkerDiedError.
        """
        while True:
            try:
                kind, value = pickle.load(self._answers)
            except (OSError, EOFError, pickle.UnpicklingError):
                raise self._describe_death() from None

            if kind == "error":
                raise value
            if kind == "result":
                return value

            step, self._since_s = value
            self.steps.append(step)
            watch(step)
            if step == until:
                return None

    def receive_within(self, limit_s: float, watch: Callable[[], None] = lambda: None) -> Any:
        """Wait for the result, and call `watch` all the while.

        After the limit, kills the worker and raises TimeoutError.
        """
        with ThreadPoolExecutor(1) as thread:
            answer = thread.submit(self.receive)
            end_s = time.monotonic() + limit_s
            try:
                left_s = limit_s
                while not answer.done() and left_s > 0:
                    wait([answer], min(_POLL_S, left_s))
                    watch()
                    left_s = end_s - time.monotonic()

                if not answer.done():
                    raise TimeoutError

                return answer.result()
            finally:
                if not answer.done():
                    self.kill()

    def _describe_death(self) -> WorkerDiedError:
        step = self.steps[-1] if self.steps else None
        elapsed_s = time.monotonic() - self._since_s
        self.kill()
        text = (
            (self._folder / _MESSAGES).read_text(encoding="utf-8", errors="replace")
            if self._folder
            else ""
        )

        return WorkerDiedError(step, elapsed_s, *text.strip().splitlines()[-1:])


class Pool:
    """Workers that answer calls side by side.

    One that dies is replaced, and only its call is lost.
    """

    def __init__(self, workers: int) -> None:
        self._threads = ThreadPoolExecutor(workers)
        self._lock = threading.Lock()
        self._is_closed = False
        self._workers = [Worker() for _ in range(workers)]
        self._idle: queue.SimpleQueue[int] = queue.SimpleQueue()
        for place in range(workers):
            self._idle.put(place)

    def submit(self, function: Callable[..., T], *arguments: Any) -> Future[T]:
        """Let the next idle worker answer a call."""
        return self._threads.submit(self._ask, function, *arguments)

    def close(self) -> None:
        """Kill the workers; calls without a result are discarded."""
        with self._lock:
            self._is_closed = True
            for worker in self._workers:
                worker.kill()

        self._threads.shutdown(cancel_futures=True)
        for worker in self._workers:
            worker.close()

    def _ask(self, function: Callable[..., T], *arguments: Any) -> T:
        place = self._idle.get()
        worker = self._workers[place]
        try:
            worker.send(function, *arguments)
            return worker.receive()  # type: ignore[no-any-return]
        except WorkerDiedError:
            with self._lock:
                if not self._is_closed:
                    worker.close()
                    self._workers[place] = Worker()

            raise
        finally:
            self._idle.put(place)


@contextlib.contextmanager
def side_by_side(workers: int) -> Iterator[None]:
    """Let `call_each` use so many worker processes; with one, calls run in this process.

    Every loop runs compiled.
    """
    global _pool
    before = _pool
    _pool = Pool(workers) if workers > 1 else None

    try:
        with compiled():
            yield
    finally:
        if _pool:
            _pool.close()

        _pool = before


def call_each(calls: Iterable[Callable[[], T]]) -> Iterator[T]:
    """Make calls with compiled loops, and yield the results in their order.

    Calls are pickled: they are partials of functions. Raises what a call raises, and FingertipError
    if a worker ends by itself.
    """
    if _pool is None:
        yield from map(_call_compiled, calls)
        return

    pool = _pool
    submitted = (pool.submit(_call_compiled, call) for call in calls)
    futures = deque(itertools.islice(submitted, _AHEAD))

    try:
        while futures:
            answer = futures.popleft().result()
            futures.extend(itertools.islice(submitted, 1))
            yield answer
    except WorkerDiedError:
        message = (
            "a worker process ended by itself, as it does where memory is full; choose --jobs 1."
        )
        raise FingertipError(Issue("--jobs", message)) from None
    finally:
        for future in futures:
            future.cancel()


def _call_compiled(call: Callable[[], T]) -> T:
    with compiled():
        return call()


@contextlib.contextmanager
def in_background(function: Callable[..., T], *arguments: Any) -> Iterator[Callable[[], T]]:
    """Call a function in another process, which ends with this block.

    The block gets a function that waits for the result. With one processor, or if the process fails
    for any reason, that function computes the result here.
    """
    if count_processors() == 1:
        yield lambda: function(*arguments)
        return

    def receive() -> T:
        with contextlib.suppress(Exception):
            return worker.receive()  # type: ignore[no-any-return]

        return function(*arguments)

    with Worker(is_fork=can_fork()) as worker:
        worker.send(function, *arguments)
        yield receive


def can_fork() -> bool:
    """Tell whether a copy of this process is safe, which saves the time to import all modules."""
    return sys.platform == "linux" and threading.active_count() == 1


def call_within_limits(
    limit_s: float, memory_bytes: int, function: Callable[..., T], *arguments: Any
) -> T:
    """Call a function in a process of its own, such as a library that reads a stranger's file.

    Raises what the function raises, MemoryError at the limit of memory, and ValueError if the
    process ends by itself or at the limit of time. Windows has no limit of memory, and counts time
    on the clock.
    """
    with Worker() as worker, contextlib.suppress(WorkerDiedError, TimeoutError):
        worker.send(_call_limited, limit_s, memory_bytes, function, arguments)
        return worker.receive_within(_SLOWEST * limit_s)  # type: ignore[no-any-return]

    raise ValueError(f"it cannot be read in {limit_s:g} s of computing")


def _call_limited(
    limit_s: float, memory_bytes: int, function: Callable[..., T], arguments: tuple[Any, ...]
) -> T:
    if sys.platform != "win32":
        import resource  # noqa: PLC0415

        for kind, limit in (
            (resource.RLIMIT_CPU, round(limit_s)),
            (resource.RLIMIT_DATA, memory_bytes),
        ):
            resource.setrlimit(kind, (limit, resource.getrlimit(kind)[1]))

    return function(*arguments)


def report_step(step: Any) -> None:
    """Report the present step of this worker to the process that waits for it.

    In a process that is no worker, nothing happens.
    """
    if _answers:
        # The clock is that of the whole machine.
        _answers.write(pickle.dumps(("step", (step, time.monotonic()))))
        _answers.flush()


def count_processors() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def find_workers(jobs: int | None) -> int:
    """Return the number of processes that is asked for, one for each processor by default.

    Raises FingertipError.
    """
    if jobs is not None and not 1 <= jobs <= MAX_JOBS:
        raise FingertipError(
            Issue("--jobs", f"{jobs} is out of range; choose 1 to {MAX_JOBS}, or leave it out.")
        )

    return count_processors() if jobs is None else jobs


def end_with(parent: int) -> None:
    """Let Linux kill this process when the one that started it ends.

    On other systems it ends when its job is done.
    """
    if sys.platform == "linux":
        with contextlib.suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG

        if os.getppid() != parent:  # it has ended before
            os._exit(0)


def serve_parent(parent: int) -> None:
    """Answer the calls of the process with this number on stdin, as the program of a new worker."""
    calls = os.dup(0)
    answers = os.dup(1)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)  # libraries print there
    _serve(parent, calls, answers)
    os._exit(0)  # unloading the libraries of the B-rep kernel would take a third of a second


def _fork(folder: Path | None) -> tuple[int, IO[bytes], IO[bytes]]:
    """Copy this process; return the number of the copy, the pipe of calls, and that of answers.

    The copy works in the folder, if one is given, and writes its messages there.
    """
    calls, calling = os.pipe()
    answering, answers = os.pipe()
    parent = os.getpid()

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # which counts the threads of BLAS too
        pid = os.fork()

    if pid:
        os.close(calls)
        os.close(answers)
        return pid, os.fdopen(calling, "wb"), os.fdopen(answering, "rb")

    try:
        os.setsid()
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        messages = os.open(os.devnull, os.O_WRONLY)
        if folder:
            os.chdir(folder)
            messages = os.open(_MESSAGES, os.O_WRONLY | os.O_CREAT)

        for stream in (1, 2):
            os.dup2(messages, stream)

        # All other open files belong to the other process, which closes pipes to end this one.
        bounds = (2, *sorted((calls, answers)), os.sysconf("SC_OPEN_MAX"))
        for low, high in itertools.pairwise(bounds):
            os.closerange(low + 1, high)

        _serve(parent, calls, answers)
    finally:
        os._exit(0)


def _serve(parent: int, calls: int, answers: int) -> None:
    """Answer calls until the other process closes its pipe."""
    global _answers, _pool
    end_with(parent)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _pool = None
    _answers = os.fdopen(answers, "wb")

    with os.fdopen(calls, "rb") as pipe, contextlib.suppress(EOFError):
        while True:
            function, arguments = pickle.load(pipe)  # imports what the function needs
            try:
                answer = "result", function(*arguments)
            except Exception as error:
                answer = "error", error.with_traceback(None)

            _answers.write(pickle.dumps(answer))
            _answers.flush()
