"""Detectors that are compared, with the factors of their thresholds, which trade delay for alarms.

A detector of your own is a Python file with a function and a number::

    THRESHOLD = 4.0

    def find_statistic(voltage_v, filtered_v, rate_hz, quiet_v):
        ...

It returns one number for each sample, from this and earlier samples alone; slip is ON where it
exceeds a multiple of `THRESHOLD`. `filtered_v` and `quiet_v` are None where a recording has no
filtered signal or no quiet stretch.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.slip.baselines import (
    SHORT_S,
    Flags,
    adapt,
    make_fast_run,
    make_fft_run,
    run_chain,
    run_cusum,
    run_ratio,
)
from benchmarks.slip.recordings import Recording
from benchmarks.slip.recurrent import FACTORS as RECURRENT_FACTORS
from benchmarks.slip.recurrent import run_recurrent
from fingertip.design import Design
from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.numerics import Array
from fingertip.slip.detectors.registry import make_detector

FACTORS = (0.5, 0.6, 0.7, 0.8, 0.86, 0.93, 1.0, 1.1, 1.2, 1.35, 1.5, 1.8, 2.2, 3.0)
"""Factors of the threshold of `fast`, whose scores end soon above it."""
WIDE_FACTORS = (0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0, 11.0, 16.0, 22.0, 32.0, 64.0, 128.0)
"""Factors of the other thresholds."""
OWN_MEMORY_S = 0.06
"""Time after a slip in which ON of a detector of your own is no alarm [s]."""
COUNTED = "instructions"
"""Work of a detector whose instructions were counted by an emulator."""


@dataclass(frozen=True)
class Competitor:
    label: str
    words: str
    factors: tuple[float, ...]
    run: Callable[[Design, Recording, Sequence[float]], Iterator[Flags]]
    """Returns ON at each sample, for each factor."""
    memory_s: Callable[[Design], float]
    """Time that ON outlasts a slip by construction [s]."""
    operations: str
    """Work of a sample: instructions where they were counted,
    otherwise multiplications and additions.
    """


COMPETITORS = {
    "fast": Competitor(
        label="fast, on",
        words="this project's detector at its sure point",
        factors=FACTORS,
        run=make_fast_run("fast"),
        memory_s=lambda design: make_detector("fast", design).memory_s,
        operations=COUNTED,
    ),
    "incipient": Competitor(
        label="fast, incipient",
        words="the same at its early point",
        factors=FACTORS,
        run=make_fast_run("incipient"),
        memory_s=lambda design: make_detector("fast", design).memory_s,
        operations=COUNTED,
    ),
    "digital": Competitor(
        label="the article's chain",
        words="Romeo et al. 2021, in software",
        factors=WIDE_FACTORS,
        run=run_chain,
        memory_s=lambda design: make_detector("digital", design).memory_s,
        operations="16",
    ),
    "fft": Competitor(
        label="FFT, stronger",
        words="64 ms every 2 ms, Hann window, one band",
        factors=WIDE_FACTORS,
        run=make_fft_run(is_plain=False),
        memory_s=lambda design: make_detector("fft", design).memory_s,
        operations="1 200",
    ),
    "plain_fft": Competitor(
        label="FFT, as published",
        words="Romeo et al. 2021: 64 ms side by side, strongest bin",
        factors=WIDE_FACTORS,
        run=make_fft_run(is_plain=True),
        memory_s=lambda design: make_detector("fft", design).memory_s,
        operations="40",
    ),
    "cusum": Competitor(
        label="CUSUM",
        words="Page 1954, of the variance",
        factors=WIDE_FACTORS,
        run=run_cusum,
        memory_s=lambda _: 0.1,
        operations="20",
    ),
    "recurrent": Competitor(
        label="recurrent network",
        words="16 gated units, trained on this project's training signals",
        factors=RECURRENT_FACTORS,
        run=run_recurrent,
        memory_s=lambda _: 0.06,
        operations="540",
    ),
    "ratio": Competitor(
        label="energy ratio",
        words="short over long mean, Allen 1978",
        factors=WIDE_FACTORS,
        run=run_ratio,
        memory_s=lambda _: 5 * SHORT_S,
        operations="19",
    ),
}
"""Name -> detector."""


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
        found = find_statistic(signal.voltage_v, signal.filtered_v, signal.rate_hz, recording.quiet)
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

    return Competitor(
        label=path.stem,
        words=str(path),
        factors=WIDE_FACTORS,
        run=run,
        memory_s=lambda _: OWN_MEMORY_S,
        operations="unknown",
    )


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
            find_statistic(signal.voltage_v[:end], filtered, signal.rate_hz, recording.quiet)
        )

        if not np.allclose(
            found, whole[:end], rtol=1e-6, atol=1e-9 * float(np.abs(whole).max()), equal_nan=True
        ):
            message = (
                "find_statistic gives other numbers where the recording ends sooner: it looks ahead"
            )
            raise TraceError(Issue("--own", f"{message}; use this sample and earlier ones alone."))
