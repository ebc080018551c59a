"""What workers do in tests of lost workers: most points compute quickly, some do not come back."""

from __future__ import annotations

import collections
import itertools
import os
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fingertip.sweep.chunk import Done, Outcome, Part
from fingertip.sweep.worker_loop import each_limited

LIMIT_S = 0.4
BAD = (3, 17)
FLAG = "FINGERTIP_TEST_FLAG"


def row(point: int) -> Outcome:
    return point, "ok", "", "", (float(point), 2.0 * point, 3.0)


def _work(part: Part, bad: Callable[[], None]) -> Done:
    def outcome(point: int, changes: dict[str, Any]) -> Outcome:
        if point in BAD:
            bad()
        time.sleep(0.002)
        return row(point)

    start = time.perf_counter()
    return Done(each_limited(part, LIMIT_S, 1, outcome), time.perf_counter() - start)


def healthy(part: Part) -> Done:
    return _work(part, lambda: None)


def dying(part: Part) -> Done:
    return _work(part, lambda: os.kill(os.getpid(), signal.SIGKILL))


def dying_once(part: Part) -> Done:
    """The worker dies when it first comes to each bad point, not when that is tried again."""

    def once() -> None:
        flag = Path(os.environ[FLAG])
        if len(flag.read_text()) < len(BAD):
            with flag.open("a") as file:
                file.write("x")
            os.kill(os.getpid(), signal.SIGKILL)

    return _work(part, once)


def sleeping(part: Part) -> Done:
    return _work(part, lambda: time.sleep(60))


def never_back(part: Part) -> Done:
    """A loop in C that holds Python's lock and looks at no signal, as a geometry kernel might."""
    return _work(part, lambda: collections.deque(itertools.repeat(0), maxlen=0))


def stillborn(part: Part) -> Done:
    """The worker dies before it is at any point."""
    os._exit(1)
