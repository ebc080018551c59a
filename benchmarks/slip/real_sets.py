"""Real grasps, slides, blows and one stage, of four public sets that you download below one folder.

Grasps: `joshsia/haptics-classification`, `data/*_HOLD.mat`: two BioTacs each hold something still.
Slides: `raw_data/` of the BioTac set that `public_sets` names. Each is added to a grasp from
`JOINED_S` on, at three strengths: a BioTac's slides begin in the slide, without rest.
Stage: `data_temp.mat` of R. V. Grigorii and J. E. Colgate: one slide, heard from twelve starts.
Blows: sticks on drum pads, `corrados/edrumulus`, `algorithm/signals/*.wav`, each added to a grasp.

The files of each set are divided once: one half tunes and trains, the other judges. A slide of a
half is joined to a grasp of that half. The stage has one slide, which judges alone.
"""

from __future__ import annotations

import functools
import hashlib
import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.slip.mix_signals import LabelledSignal, Slide
from benchmarks.slip.own_sets import JUDGING, TUNING, load_design
from benchmarks.slip.public_sets import MOVING_MM_S, Run, read_biotac_run, read_stage_run
from benchmarks.slip.recordings import SETTLING_S, Recording
from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.numerics import Array
from fingertip.slip.traces.truth import Interval, intervals

RATE_HZ = 2200.0
"""Sampling rate of a BioTac's pressure [Hz]; blows are resampled to it."""
DIVISION_SEED = 114
FORMER_DRAW = 89, 180
"""Seed and count of the slides on which earlier detectors were tuned: no half has them."""
SLIDE_COUNT = 120
STRENGTHS = {"full": 5.8, "half": 2.9, "quarter": 1.45}
"""RMS value of a joined slide over that of its rest, in 90 to 170 Hz. 5.8 is that of the stage's
own slide.
"""
SLIDES = tuple(f"slide {kind}" for kind in STRENGTHS)
"""Kinds of joined slides."""
JOINED_S = 5.0
SLIDING_S = 0.3
SLIDE_S = 3.0
"""Moment at which a slide is joined, time after the robot's start from which it is taken, until
which it speeds up and shears the skin, and duration [s].
"""
REST_S = 4.0
PLACED_S = 3.55
"""Moment from which the finger lies still on the stage [s]."""
STARTS_S = tuple(PLACED_S + 0.05 * number for number in range(12))
"""Moments at which the recording of the stage begins [s]: the last leaves 0.4 s of rest."""
STAGE_FROM_S = 0.3
PEAK_S = 0.1
"""Time around the start of the stage's motion in which the friction has its peak [s]."""
HITS_EACH = 8
HIT_RATIO = 12.0, 250.0
"""Blows in a grasp, and bounds of their peak over the noise of the grasp above 67 Hz."""
HIT_SEED = 5
SOURCES: Mapping[str, str] = {
    "grasps": "*_HOLD.mat",
    "slides": "raw_data/mat*/mat*_bio.csv",
    "stage": "data_temp.mat",
    "hits": "algorithm/signals/*.wav",
}
"""Name of a set -> its files, anywhere below the folder."""


@dataclass(frozen=True, eq=False)
class Piece:
    """Part of a file, in any unit, that grows with the force."""

    paths: tuple[Path, ...]
    values: Array


@dataclass(frozen=True)
class RealSet:
    """One half of a real set below a folder."""

    folder: Path
    name: str
    half: str
    run: int = 0
    part: int = 0
    parts: int = 1
    """Number of a part of its recordings, and how many there are: parts are run side by side."""

    def read(self) -> Iterator[Recording]:
        whole = _READERS[self.name](self.folder, self.half)
        return itertools.islice(whole, self.part, None, self.parts)

    def divide(self, parts: int) -> list[RealSet]:
        return [replace(self, part=part, parts=parts) for part in range(parts)]

    def hash(self) -> tuple[int, str]:
        """Count the files that it uses, and hash their contents in the order of their names."""
        paths = sorted(
            {path for one in _PIECES[self.name](self.folder, self.half) for path in one.paths}
        )
        digest = hashlib.sha256()
        for path in paths:
            digest.update(path.read_bytes())

        return len(paths), digest.hexdigest()


def list_real(folder: Path, half: str) -> list[RealSet]:
    """List the sets of a half. Raises TraceError, about each set that is missing."""
    issues = [
        Issue(str(folder), f"holds no {files}: download the set of {name} below it.")
        for name, files in SOURCES.items()
        if not any(folder.rglob(files))
    ]
    if issues:
        raise TraceError(issues)

    names = (
        ("slides", "grasps", "hits", "stage") if half == JUDGING else ("slides", "grasps", "hits")
    )
    return [RealSet(folder, name, half) for name in names]


def divide(paths: Sequence[Path], half: str) -> list[Path]:
    """Select the files of a half, in the order of the draw."""
    order = np.random.default_rng(DIVISION_SEED).permutation(len(paths))
    return [paths[i] for i in order[(0 if half == TUNING else 1) :: 2]]


def find_files(folder: Path, name: str, half: str) -> list[Path]:
    paths = sorted(folder.rglob(SOURCES[name]))
    if name == "slides":
        seed, count = FORMER_DRAW
        paths = [
            paths[i] for i in sorted(np.random.default_rng(seed).permutation(len(paths))[count:])
        ]

    return divide(paths, half)


@functools.cache
def load_grasps(folder: Path, half: str) -> list[Piece]:
    """Load the pressure of both fingers in each grasp, around its median."""
    from scipy.io import loadmat

    pieces = []
    for path in find_files(folder, "grasps", half):
        table = loadmat(path, variable_names=["F0pac", "F1pac"])
        for finger in ("F0pac", "F1pac"):
            values = table[finger].astype(float).T.ravel()
            pieces.append(Piece((path,), values - np.median(values)))

    return pieces


@functools.cache
def load_slides(folder: Path, half: str) -> list[Piece]:
    """Load the first slides of a half that are long enough."""
    pieces = list[Piece]()
    for path in find_files(folder, "slides", half):
        slide = cut_slide(read_biotac_run(path))
        if slide is not None:
            pieces.append(Piece((path, path.with_name(path.name.replace("_bio", "_cp"))), slide))
        if len(pieces) == SLIDE_COUNT:
            break

    return pieces


def cut_slide(run: Run) -> Array | None:
    """Cut `SLIDE_S` of a run's first long motion in touch; None if there is none, or no signal."""
    time_s = np.arange(len(run.values)) / run.rate_hz
    moves = intervals(time_s, (np.abs(run.speed_mm_s) > MOVING_MM_S) & run.touches)
    long = [one for one in moves if one.end_s - one.onset_s >= SLIDING_S + SLIDE_S]
    if not long:
        return None

    first = round((long[0].onset_s + SLIDING_S) * run.rate_hz)
    count = round(SLIDE_S * run.rate_hz)
    slide = run.values[first : first + count]
    if len(slide) < count or band_rms(slide, run.rate_hz) == 0.0:
        return None

    return np.asarray(slide - slide[0])


@functools.cache
def load_hits(folder: Path, half: str) -> list[Piece]:
    """Load the isolated hits of each file, 0.42 s long, their peak 1."""
    from scipy.io import wavfile

    pieces = list[Piece]()
    for path in find_files(folder, "hits", half):
        try:
            rate_hz, samples = wavfile.read(path)
        except ValueError:  # a format that scipy does not read
            continue

        first = samples[:, 0] if samples.ndim > 1 else samples
        values = first.astype(float) - np.median(first.astype(float))
        pieces += [
            Piece((path,), _cut_hit(values, at, rate_hz)) for at in _find_hits(values, rate_hz)
        ]

    return pieces


def _find_hits(values: Array, rate_hz: int) -> list[int]:
    """Find at most 20 hits with rest before them and no second one behind [samples]."""
    width = round(0.002 * rate_hz)
    level = np.abs(values)
    peaks = np.array([level[i : i + width].max() for i in range(0, len(level) - width, width)])
    noise = np.median(peaks) + 1.0
    loud = peaks > max(20 * noise, 0.02 * level.max())
    found = list[int]()

    for start in np.flatnonzero(loud & ~np.r_[False, loud[:-1]]):
        before = peaks[max(0, start - 125) : start]
        after = peaks[start + 15 : start + 150]
        top = peaks[start : start + 8].max()
        if start <= 30 or len(after) <= 100 or before.max() >= 0.05 * top:
            continue
        if top > 40 * noise and (after < 0.3 * top).all():
            found.append(int(start) * width)

    return found[:20]


def _cut_hit(values: Array, at: int, rate_hz: int) -> Array:
    """Cut a hit, resample it, and fade its ends."""
    from scipy import signal

    cut = values[at - round(0.02 * rate_hz) : at + round(0.4 * rate_hz)]
    if rate_hz == 8000:
        cut = signal.resample_poly(cut, 11, 40)
    else:
        cut = signal.resample(cut, round(len(cut) * RATE_HZ / rate_hz))

    place = np.arange(len(cut))
    cut = cut * np.minimum(1.0, np.minimum(place / 20, place[::-1] / 100))
    return np.asarray(cut / np.abs(cut).max())


def _load_stage(folder: Path, half: str) -> list[Piece]:
    (path,) = sorted(folder.rglob(SOURCES["stage"]))[:1]
    return [Piece((path,), np.zeros(0))]


_PIECES: Mapping[str, Callable[[Path, str], list[Piece]]] = {
    "grasps": load_grasps,
    "slides": load_slides,
    "stage": _load_stage,
    "hits": load_hits,
}


def read_grasps(folder: Path, half: str) -> Iterator[Recording]:
    for piece in load_grasps(folder, half):
        yield label("grasp", piece.values, RATE_HZ, piece.values[: round(REST_S * RATE_HZ)])


def read_slides(folder: Path, half: str) -> Iterator[Recording]:
    """Join each slide to another grasp, at each strength."""
    grasps = load_grasps(folder, half)
    at = round(JOINED_S * RATE_HZ)
    slides = (Slide(JOINED_S, JOINED_S, JOINED_S + SLIDE_S),)

    for number, piece in enumerate(load_slides(folder, half)):
        grasp = grasps[number % len(grasps)].values
        rest = grasp[at - round(REST_S * RATE_HZ) : at]
        unit = band_rms(rest, RATE_HZ) / band_rms(piece.values, RATE_HZ)
        for kind, strength in STRENGTHS.items():
            values = grasp[: at + len(piece.values)].copy()
            values[at:] += strength * unit * piece.values
            yield label(f"slide {kind}", values, RATE_HZ, rest, slides=slides)


def read_stage(folder: Path, half: str) -> Iterator[Recording]:
    """Read the stage's slide from each start; gross slip is where the friction has its peak."""
    (path,) = sorted(folder.rglob(SOURCES["stage"]))[:1]
    stage = read_stage_run(path)
    rate_hz = stage.rate_hz
    time_s = np.arange(len(stage.values)) / rate_hz
    moves = intervals(
        time_s, (np.abs(stage.speed_mm_s) > MOVING_MM_S) & stage.touches & (time_s > PLACED_S)
    )
    if not moves:
        raise TraceError(Issue(str(path), "shows no motion in touch; download it anew."))

    motion_s = moves[0].onset_s - PEAK_S / 2
    end_s = moves[0].end_s
    first = round(motion_s * rate_hz)
    peak = first + int(np.argmax(stage.values[first : first + round(PEAK_S * rate_hz)]))

    for start_s in STARTS_S:
        values = stage.values[round(start_s * rate_hz) : round(end_s * rate_hz)]
        slide = Slide(motion_s - start_s, peak / rate_hz - start_s, end_s - start_s)
        rest = values[: round(slide.motion_s * rate_hz)]
        yield label("stage", values, rate_hz, rest, slides=(slide,), alarms_from_s=STAGE_FROM_S)


def read_hits(
    folder: Path, half: str, passes: int = 1, seed: int = HIT_SEED
) -> Iterator[Recording]:
    """Add each hit to a grasp, some in each; in further passes with other strengths and places."""
    rng = np.random.default_rng([DIVISION_SEED, seed, half == JUDGING])
    grasps = load_grasps(folder, half)
    hits = load_hits(folder, half) * passes
    order = rng.permutation(len(hits))

    for first in range(0, len(order), HITS_EACH):
        grasp = grasps[first // HITS_EACH % len(grasps)].values
        values = grasp.copy()
        noise = measure_noise(grasp)
        events = []
        for place, number in enumerate(order[first : first + HITS_EACH]):
            start_s = 1.5 + place + rng.uniform(0, 0.3)
            at = round(start_s * RATE_HZ)
            hit = hits[number].values[: len(values) - at]
            height = np.exp(rng.uniform(*np.log(HIT_RATIO)))
            values[at : at + len(hit)] += hit * noise * height * rng.choice([-1, 1])
            events.append(Interval(start_s, start_s + 0.2))

        yield label("stick hit", values, RATE_HZ, grasp[: round(REST_S * RATE_HZ)], events=events)


_READERS: Mapping[str, Callable[[Path, str], Iterator[Recording]]] = {
    "grasps": read_grasps,
    "slides": read_slides,
    "stage": read_stage,
    "hits": read_hits,
}


def label(
    kind: str,
    values: Array,
    rate_hz: float,
    rest: Array | None,
    *,
    slides: tuple[Slide, ...] = (),
    events: Sequence[Interval] = (),
    alarms_from_s: float = SETTLING_S,
) -> Recording:
    """Make a recording of a signal that rises with the force; the article's design hears it."""
    signal = LabelledSignal(
        kind=kind,
        rate_hz=rate_hz,
        voltage_v=values,
        slides=slides,
        events=tuple(events),
        alarms_from_s=alarms_from_s,
    )
    return Recording(signal, (), rest, rises_with_force=True, design=load_design("article"))


def band_rms(values: Array, rate_hz: float, band_hz: tuple[float, float] = (90.0, 170.0)) -> float:
    """RMS value in a band, by default one of slip."""
    from scipy.signal import butter, sosfiltfilt

    sections = butter(2, band_hz, "bandpass", fs=rate_hz, output="sos")
    return float(np.std(sosfiltfilt(sections, values)))


def measure_noise(grasp: Array) -> float:
    """RMS value above 67 Hz after the first second of a grasp."""
    from scipy.signal import butter, sosfiltfilt

    sections = butter(3, 67.0, "highpass", fs=RATE_HZ, output="sos")
    return float(np.std(sosfiltfilt(sections, grasp[round(RATE_HZ) :])))
