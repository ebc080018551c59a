"""Recordings of other laboratories with rest and slip: one that has both, and slides of a set
joined behind its rest.

A BioTac's slides begin in the slide, and a detector that learns its floor must see the signal rest
first. So each is added to the rest of the stage's recording, from a moment on that is known to a
sample, at several strengths.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.slip.public_sets import MOVING_MM_S, Run, read_biotac_run, read_stage_run
from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.numerics import Array
from fingertip.slip.traces.truth import intervals

STRENGTHS = {"full": 5.8, "half": 2.9, "quarter": 1.45}
"""RMS value of a joined slide over that of the rest, in 90 to 170 Hz. 5.8 is that of the stage's
own slide; a BioTac's slides have 5.7 over the white noise of their sensor.
"""
PLACED_S = 3.55
"""Moment from which the finger lies still on the stage [s]."""
STARTS_S = tuple(PLACED_S + 0.05 * k for k in range(12))
"""Moments at which the recording of the stage begins [s]: the last leaves 0.4 s of rest."""
PEAK_S = 0.1
"""Time around the start of the motion in which the friction has its peak [s]."""
UNDER_S = 0.4
TURNS = 5
"""End of the rest that goes on, to and fro, below a slide [s]:
vibration of the touch has decayed by then.
"""
SLIDE_S = 3.0
MIN_REST_S = 1.0
"""Duration of a joined slide, and least of a stretch without slip [s]."""
SLIDING_S = 0.3
"""Time after the robot's start from which a slide is joined [s]:
until then it speeds up and shears the skin.
"""
SEED = 89
JUDGING = 60
TUNING = 120
"""Draw of the slides: constants of the detector were chosen on those for tuning alone."""


@dataclass(frozen=True, eq=False)
class Judged:
    """One signal, in any unit, that grows with the force."""

    kind: str
    name: str
    rate_hz: float
    values: Array
    motion_s: float | None = None
    """Moment from which it may slip [s]; None: there is no slip."""
    onset_s: float = 0.0
    """Gross slip [s]: where the friction has its peak, or where the slide was joined."""
    end_s: float = 0.0


def read_joined(folder: Path, judging: bool, sliding_s: float = SLIDING_S) -> Iterator[Judged]:
    """Read the stage's recording and the slides that judge, or those for tuning, from anywhere
    below a folder.

    A slide is joined `sliding_s` [s] after the robot's start. Raises TraceError.
    """
    stages = sorted(folder.rglob("data_temp.mat"))
    slides = sorted(folder.rglob("raw_data/mat*/mat*_bio.csv"))

    if not stages or len(slides) < JUDGING + TUNING:
        message = (
            "holds no data_temp.mat, or not the 1 000 runs of raw_data/; download both sets "
            "below one folder"
        )
        raise TraceError(Issue(str(folder), f"{message} (docs/slip_benchmark.md names them)."))

    stage = read_stage_run(stages[0])
    yield from _start_anywhere(stage)
    drawn = [slides[i] for i in np.random.default_rng(SEED).permutation(len(slides))]
    runs = [
        read_biotac_run(path)
        for path in (drawn[:JUDGING] if judging else drawn[JUDGING : JUDGING + TUNING])
    ]
    rest = _take_rest(stage, runs[0].rate_hz)
    yield Judged("rest", "stage, in touch", runs[0].rate_hz, rest)

    for run in runs:
        yield from _take_still(run)
        for kind, strength in STRENGTHS.items():
            yield from _join(
                rest,
                run=run,
                kind=kind,
                strength=strength,
                sliding_s=sliding_s,
            )


def _start_anywhere(stage: Run) -> Iterator[Judged]:
    time_s = np.arange(len(stage.values)) / stage.rate_hz
    rate_hz = stage.rate_hz
    moves = intervals(
        time_s, (np.abs(stage.speed_mm_s) > MOVING_MM_S) & stage.touches & (time_s > PLACED_S)
    )

    if not moves:
        raise TraceError(
            Issue(stage.name, f"shows no motion in touch after {PLACED_S:g} s; download it anew.")
        )

    first = round((moves[0].onset_s - PEAK_S / 2) * rate_hz)
    peak_s = (
        first + int(np.argmax(stage.values[first : first + round(PEAK_S * rate_hz)]))
    ) / rate_hz
    for start_s in STARTS_S:
        part = stage.values[round(start_s * rate_hz) : round(moves[0].end_s * rate_hz)]
        motion_s = moves[0].onset_s - PEAK_S / 2 - start_s
        end_s = moves[0].end_s - start_s
        yield Judged(
            kind="stage",
            name=f"from {start_s:.2f} s",
            rate_hz=rate_hz,
            values=part,
            motion_s=motion_s,
            onset_s=peak_s - start_s,
            end_s=end_s,
        )


def _take_rest(stage: Run, rate_hz: float) -> Array:
    """Rest of the finger on the stage, then its last `UNDER_S` to
    and fro `TURNS` times, which leaves no step.
    """
    from scipy.signal import resample_poly

    still = np.abs(stage.speed_mm_s) < MOVING_MM_S
    begin = round(PLACED_S * stage.rate_hz)
    end = begin + int(np.argmin(still[begin:])) - round(PEAK_S * stage.rate_hz)
    part = stage.values[begin:end] - stage.values[begin]
    up = round(rate_hz / 100)
    down = round(stage.rate_hz / 100)
    rest = resample_poly(part, up, down)
    under = rest[-round(UNDER_S * rate_hz) :]

    return np.concatenate([rest, *[under[::-1], under] * TURNS])


def _take_still(run: Run) -> Iterator[Judged]:
    """Stretches in which nothing slips: the robot rests in touch, or moves in air."""
    moves = np.abs(run.speed_mm_s) > MOVING_MM_S
    for kind, at in (("rest", ~moves & run.touches), ("air", ~run.touches)):
        for one in intervals(np.arange(len(at)) / run.rate_hz, at):
            # The transients of touch and motion are left out.
            if one.end_s - one.onset_s >= MIN_REST_S + 0.1:
                part = run.values[
                    round((one.onset_s + 0.05) * run.rate_hz) : round(
                        (one.end_s - 0.05) * run.rate_hz
                    )
                ]
                yield Judged(kind, f"{run.name}, {one.onset_s:.2f} s", run.rate_hz, part)


def _join(
    rest: Array,
    run: Run,
    kind: str,
    strength: float,
    sliding_s: float,
) -> Iterator[Judged]:
    moves = intervals(
        np.arange(len(run.values)) / run.rate_hz,
        (np.abs(run.speed_mm_s) > MOVING_MM_S) & run.touches,
    )
    long = [one for one in moves if one.end_s - one.onset_s >= sliding_s + SLIDE_S]
    if long:
        begin = round((long[0].onset_s + sliding_s) * run.rate_hz)
        count = round(SLIDE_S * run.rate_hz)
        slide = run.values[begin : begin + count] - run.values[begin]
        at = len(rest) - 2 * TURNS * round(UNDER_S * run.rate_hz)
        values = rest[: at + count].copy()
        values[at:] += (
            slide * strength * band_rms(rest[:at], run.rate_hz) / band_rms(slide, run.rate_hz)
        )
        onset_s = at / run.rate_hz
        yield Judged(
            kind=kind,
            name=run.name,
            rate_hz=run.rate_hz,
            values=values,
            motion_s=onset_s,
            onset_s=onset_s,
            end_s=onset_s + SLIDE_S,
        )


def band_rms(values: Array, rate_hz: float) -> float:
    """RMS value in 90 to 170 Hz, the upper band of `fast`."""
    from scipy.signal import butter, sosfiltfilt

    return float(
        np.std(sosfiltfilt(butter(2, [90.0, 170.0], "bandpass", fs=rate_hz, output="sos"), values))
    )
