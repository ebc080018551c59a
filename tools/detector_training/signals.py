"""Signals to train on: halves of real sets, the project's own generators, and mixtures of both.

Nothing here judges: real files are those of the half for tuning, seeds are below those of a report.
A mixture keeps the table from knowing the sensor: what is no slip on the project's boards is added
to real grasps, and real slides are added to the noise of the project's boards.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.slip.bench import Source
from benchmarks.slip.mix import MixSize, generate_mix
from benchmarks.slip.mix_signals import LabelledSignal, Slide, record, simulate_scene
from benchmarks.slip.own_sets import (
    BOARDS,
    BURST_SEEDS,
    BURSTS,
    MANIPULATION_SEED,
    TRIAL_DESIGNS,
    TRIAL_SEEDS,
    TUNING,
    Bursts,
    Generated,
    Manipulations,
    Trials,
    list_generated,
    load_design,
)
from benchmarks.slip.real_sets import (
    RATE_HZ,
    RealSet,
    band_rms,
    label,
    list_real,
    load_grasps,
    load_slides,
    measure_noise,
    read_hits,
)
from benchmarks.slip.recordings import SETTLING_S, Recording
from fingertip.design import Design
from fingertip.foundation.jit import compiled
from fingertip.foundation.numerics import Array
from fingertip.lab.campaign.campaign import HELD_OUT_FROM, NEGATIVE_SCENES

SEEDS = ((1001, 1002, 1004, 1005), (1011, 1012, 1014, 1015), (1021, 1022, 1024, 1025))
"""Seeds of the generators in each draw of a training."""
SHARE = 0.4
"""Share of all recordings of a row that each seed draws."""
TRIALS = 60
MIX_SIZE = MixSize(events=48, noisy=12)
MIX_SEED = HELD_OUT_FROM + 1_200_000
"""Size and first seed of the mix that trains; `benchmarks.slip_robustness` has other seeds."""
SIMULATED = "simulated "
"""Begin of the kinds of that mix."""
HIT_PASSES = 4
HIT_SEED = 6
PARTS = 8
MIXED_ROWS = (
    "hand motion 0.5-4 Hz",
    "hand motion 4-8 Hz",
    "hand motion 8-15 Hz",
    "servo steps",
    "isolated step",
    "isolated step with gear vibration",
    "set-down",
    "release",
    "force ramp",
    "tap",
    "knock",
    "ring",
)
"""Rows of the generators whose recordings are added to real grasps."""
MIXED_SHARE = 0.4, 1.0
"""Their strength over that on the project's own board, relative to the noise of either."""
OWN_NOISE_V = 3.6e-4
"""RMS noise of the article's board above 67 Hz [V]."""
SLIDE_V = 0.001, 0.01
SLIDE_BAND_HZ = 20.0, 300.0
MIDDLE = 0.2, 0.35
REST_S = 1.5
"""RMS value of a real slide on the project's boards [V], in a band [Hz], voltage of the held force
as a share of the converter's range, and rest before the slide [s].
"""


@dataclass(frozen=True)
class HitsForTraining:
    """Stick hits of the half for tuning, several times with other strengths and places."""

    folder: Path
    seed: int
    run: int = 0

    def read(self) -> Iterator[Recording]:
        return read_hits(self.folder, TUNING, HIT_PASSES, self.seed)


@dataclass(frozen=True)
class DisturbedGrasps:
    """Recordings of one row of the generators, each added to a real grasp."""

    folder: Path
    row: str
    run: int

    def read(self) -> Iterator[Recording]:
        rng = np.random.default_rng([self.run, len(self.row)])
        grasps = load_grasps(self.folder, TUNING)
        for made in Generated(self.row, "A", self.run, SHARE).read():
            grasp = grasps[int(rng.integers(len(grasps)))].values
            yield disturb(grasp, made, rng)


def disturb(grasp: Array, made: Recording, rng: np.random.Generator) -> Recording:
    """Add a recording of the article's board, relative to its noise, to a grasp."""
    from scipy.signal import resample_poly

    signal = made.signal
    volts = resample_poly(signal.voltage_v[0] - signal.voltage_v, 11, 10)
    count = min(len(volts), len(grasp))
    strength = rng.uniform(*MIXED_SHARE) * measure_noise(grasp) / OWN_NOISE_V
    events = [one for one in signal.events if one.end_s + 0.2 < count / RATE_HZ]
    return label(
        f"{signal.kind} on grasp",
        grasp[:count] + strength * volts[:count],
        RATE_HZ,
        grasp[: round(REST_S * RATE_HZ)],
        events=events,
        alarms_from_s=signal.alarms_from_s,
    )


@dataclass(frozen=True)
class SlidesOnBoards:
    """Real slides added to a force that is held on the project's boards, in turn."""

    folder: Path
    run: int

    def read(self) -> Iterator[Recording]:
        rng = np.random.default_rng([self.run, 1])
        for number, piece in enumerate(load_slides(self.folder, TUNING)):
            design = load_design(("fsr400", "article")[number % 2])
            yield slide_on_board(design, piece.values, rng)


def slide_on_board(design: Design, values: Array, rng: np.random.Generator) -> Recording:
    """Sample a held force, then a real slide on it, as a board and its converter do."""
    from scipy.signal import resample_poly

    rate_hz = design.detector.sample_rate_hz
    slide = resample_poly(values, 10, 11)
    slide *= np.exp(rng.uniform(*np.log(SLIDE_V))) / band_rms(slide, rate_hz, SLIDE_BAND_HZ)
    change_v = np.concatenate((np.zeros(round(REST_S * rate_hz)), slide))
    direction = 1.0 if design.board.tactile_rises else -1.0
    middle_v = design.detector.adc_range_v * rng.uniform(*MIDDLE)
    slides = (Slide(REST_S, REST_S, REST_S + len(slide) / rate_hz),)
    signal = LabelledSignal(
        kind="slide on board",
        rate_hz=rate_hz,
        voltage_v=middle_v + direction * change_v,
        slides=slides,
        alarms_from_s=SETTLING_S,
    )
    return Recording(record(design, rng, signal), (), design=design)


@dataclass(frozen=True)
class SimulatedHands:
    """Taps, changes of grip, servos, walks and vibration on the simulated finger of a design."""

    design: str
    run: int
    """First seed."""
    size: MixSize = MIX_SIZE

    def read(self) -> Iterator[Recording]:
        design = load_design(self.design)
        with compiled():
            for signal in generate_mix(design, self.size, self.run):
                yield self._take(signal)

            for number in range(self.size.events // 3):
                seed = self.run + 50_000 + number
                scene = NEGATIVE_SCENES["hard tap"][0]
                yield self._take(simulate_scene(design, scene, seed, "hard tap"))

    def _take(self, signal: LabelledSignal) -> Recording:
        named = replace(signal, kind=f"{SIMULATED}{signal.kind}")
        return Recording(named, (), design=load_design(self.design))


def list_own_training(
    seeds: Sequence[int],
    share: float = SHARE,
    trials: int = TRIALS,
    bursts: int = BURSTS,
    mix: MixSize = MIX_SIZE,
) -> list[Source]:
    """List the project's own signals for training."""
    designs = [*BOARDS.values()]
    return [
        *(Trials(design, "hertz", TRIAL_SEEDS[TUNING], trials) for design in TRIAL_DESIGNS),
        *(Bursts(design, BURST_SEEDS[TUNING], bursts) for design in designs),
        *(Manipulations(design, MANIPULATION_SEED) for design in TRIAL_DESIGNS),
        *(SimulatedHands(design, MIX_SEED, mix) for design in TRIAL_DESIGNS),
        *list_generated(seeds, share),
    ]


def list_training(folder: Path | None, draw: int) -> list[Source]:
    """List the signals of a draw; without a folder those of the project's own."""
    seeds = SEEDS[draw]
    own = list_own_training(seeds)
    if folder is None:
        return own

    real = [
        part for one in list_real(folder, TUNING) if one.name != "hits" for part in _divide(one)
    ]
    mixed = [DisturbedGrasps(folder, row, seed) for seed in seeds[:2] for row in MIXED_ROWS]
    hits = HitsForTraining(folder, HIT_SEED + draw)
    return [*own, *real, hits, *mixed, SlidesOnBoards(folder, seeds[0])]


def _divide(one: RealSet) -> list[RealSet]:
    return one.divide(PARTS)
