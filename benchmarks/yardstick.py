"""Yardstick for targets of run time: a fixed piece of work, measured in the same run.

A target in seconds is missed on a slow or busy machine. A target in yardsticks is not: both times
are processor time of the same machine in the same minute.
"""

from __future__ import annotations

import time

import numpy as np

_REPEATS = 3


def measure_yardstick_s() -> float:
    """Measure the processor time of one yardstick [s], the least of three.

    It is about equal parts of interpreted Python and of numpy: a million additions, and a sort and
    a Fourier transform of half a million numbers.
    """
    return min(_measure_once_s() for _ in range(_REPEATS))


def _measure_once_s() -> float:
    numbers = np.random.default_rng(0).random(2**19)
    start = time.process_time()

    total = 0.0
    for number in range(1_000_000):
        total += number * 0.5

    np.sort(numbers)
    np.fft.rfft(numbers)
    return time.process_time() - start
