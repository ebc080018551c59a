"""Detectors that are compared, with the factors of their thresholds, which trade delay for alarms.

A detector of your own is a Python file with a function and a number::

    THRESHOLD = 4.0

    def find_statistic(voltage_v, filtered_v, rate_hz, quiet_v):
        ...

It returns one number for each sample, from this and earlier samples alone; slip is ON where it
exceeds a multiple of `THRESHOLD`. `filtered_v` and `quiet_v` are None where a recording has no
filtered signal or no stated rest.
"""

from __future__ import annotations

import functools
import importlib.util
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.slip.baselines import (
    Run,
    adapt,
    make_fast_run,
    make_fft_run,
    run_chain,
    run_cusum,
    run_incipient,
    run_ratio,
)
from benchmarks.slip.recordings import MIN_QUIET_S, Recording
from benchmarks.slip.scores import Flags
from fingertip.design import Design
from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.numerics import Array

FACTORS = (0.7, 0.85, 1.0, 1.2, 1.6, 2.2)
"""Factors of the threshold of `fast`."""
WIDE_FACTORS = (0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0, 16.0, 32.0, 64.0, 128.0)
"""Factors of the other thresholds."""
SHORT_REST_S = MIN_QUIET_S
LONG_REST_S = 4.0
"""Rest from which a baseline takes its noise [s], in either of its rows."""


@dataclass(frozen=True)
class Competitor:
    label: str
    words: str
    run: Run
    factors: tuple[float, ...] = WIDE_FACTORS
    needs_rest: bool = True
    """False if it learns the noise by itself."""


COMPETITORS = {
    "fast": Competitor(
        "fast, on", "this project's detector", make_fast_run(), FACTORS, needs_rest=False
    ),
    "incipient": Competitor(
        "fast, incipient", "its first stage", run_incipient, FACTORS, needs_rest=False
    ),
    "digital": Competitor("the article's chain", "Romeo et al. 2021, in software", run_chain),
    "fft": Competitor(
        "FFT, stronger", "64 ms every 2 ms, Hann window, one band", make_fft_run(is_plain=False)
    ),
    "plain_fft": Competitor(
        "FFT, as published",
        "Romeo et al. 2021: 64 ms side by side, strongest bin",
        make_fft_run(is_plain=True),
    ),
    "cusum": Competitor("CUSUM", "Page 1954, of the variance", run_cusum),
    "ratio": Competitor("energy ratio", "short over long mean, Allen 1978", run_ratio),
}
"""Name -> detector."""


@functools.cache
def find_competitor(name: str) -> Competitor:
    """Find a detector by name; another name is a table of `fast` or a file of the user's detector.

    Raises TraceError.
    """
    if name in COMPETITORS:
        return COMPETITORS[name]

    path = Path(name)
    if path.suffix == ".json":
        return replace(COMPETITORS["fast"], label=f"fast, {path.stem}", run=make_fast_run(path))

    return load_own(path)


@dataclass(frozen=True)
class Row:
    """A detector, and the rest from which it takes the noise."""

    name: str
    rest_s: float = 0.0

    @property
    def label(self) -> str:
        label = find_competitor(self.name).label
        return f"{label}, rest {self.rest_s:g} s" if self.rest_s else label

    def hears(self, recording: Recording) -> bool:
        """Tell whether it is run: both rows of a baseline are one where no rest is stated."""
        return recording.rest is not None or self.rest_s != LONG_REST_S

    def run(
        self, design: Design, recording: Recording, factors: Sequence[float]
    ) -> Iterator[Flags]:
        """Run the detector; it takes the noise from the end of the stated rest."""
        if recording.rest is not None and self.rest_s:
            count = math.ceil(self.rest_s * recording.signal.rate_hz)
            recording = replace(recording, rest=recording.rest[-count:])

        return find_competitor(self.name).run(recording.design or design, recording, factors)


def list_rows(names: Sequence[str], has_rest: bool = True) -> list[Row]:
    """List the rows of detectors: two for each that takes its noise from a stated rest."""
    rows = list[Row]()
    for name in names:
        is_split = has_rest and find_competitor(name).needs_rest
        rows += [
            Row(name, rest_s) for rest_s in ((SHORT_REST_S, LONG_REST_S) if is_split else (0.0,))
        ]

    return rows


def load_own(path: Path) -> Competitor:
    """Load a detector from a Python file that the user names. Raises TraceError."""
    spec = importlib.util.spec_from_file_location("own_detector", path)
    if not path.is_file() or spec is None or spec.loader is None:
        raise TraceError(
            Issue(
                "--own", f"{path} is not a Python file; give one with find_statistic and THRESHOLD."
            )
        )

    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
        find_statistic = module.find_statistic
        threshold = float(module.THRESHOLD)
    except Exception as error:
        message = (
            f"{path} cannot be used ({type(error).__name__}: {error}); it needs "
            "find_statistic and THRESHOLD."
        )
        raise TraceError(Issue("--own", message)) from None

    checked = list[bool]()

    def run(design: Design, recording: Recording, factors: Sequence[float]) -> Iterator[Flags]:
        _, recording = adapt(design, recording)
        signal = recording.signal
        found = find_statistic(signal.voltage_v, signal.filtered_v, signal.rate_hz, recording.rest)
        statistic = np.asarray(found, dtype=np.float64)

        if statistic.shape != signal.voltage_v.shape:
            shapes = f"returned {statistic.shape} for {len(signal.voltage_v)} samples"
            raise TraceError(
                Issue("--own", f"find_statistic {shapes}; return one number for each sample.")
            )

        if not checked:
            _refuse_foresight(find_statistic, recording, statistic)
            checked.append(True)

        for factor in factors:
            yield statistic > factor * threshold

    return Competitor(path.stem, str(path), run)


def _refuse_foresight(
    find_statistic: Callable[..., Any], recording: Recording, whole: Array
) -> None:
    """Refuse a detector whose statistic changes when the recording ends sooner.

    Raises TraceError.
    """
    signal = recording.signal
    for share in (0.3, 0.6, 0.9):
        end = round(share * len(whole))
        filtered = None if signal.filtered_v is None else signal.filtered_v[:end]
        found = np.asarray(
            find_statistic(signal.voltage_v[:end], filtered, signal.rate_hz, recording.rest)
        )

        if not np.allclose(
            found, whole[:end], rtol=1e-6, atol=1e-9 * float(np.abs(whole).max()), equal_nan=True
        ):
            message = (
                "find_statistic gives other numbers where the recording ends sooner: it looks ahead"
            )
            raise TraceError(Issue("--own", f"{message}; use this sample and earlier ones alone."))
