"""Signals of the project's own: generators apart from the detector, bursts, and simulated trials.

Generators (`benchmarks/held_out_signals.py`) are drawn five times, so that a number has a scatter.
Seeds of one half tune and train, those of the other judge: nobody who tunes looks at the latter.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

from benchmarks import held_out_signals
from benchmarks.slip.mix_signals import (
    LabelledSignal,
    Slide,
    abrupt_burst,
    simulate_scene,
)
from benchmarks.slip.recordings import SETTLING_S, Recording, Stretch
from fingertip.design import Design
from fingertip.foundation.jit import compiled
from fingertip.lab.campaign.campaign import HELD_OUT_FROM, CampaignPlan, generate_cases
from fingertip.lab.campaign.closed_loop import plan_manipulations
from fingertip.lab.campaign.run import select_board_outputs
from fingertip.sim.runs.manipulation import run_manipulation
from fingertip.slip.traces.trace import Trace
from fingertip.slip.traces.truth import STICK_S, Interval, intervals, merge

LoadLaw: TypeAlias = Literal["hertz", "proportional"]

JUDGING = "judging"
TUNING = "tuning"
SEEDS = {JUDGING: (2001, 2002, 2003, 2004, 2005), TUNING: (1003, 1006, 1007, 1008, 1009)}
"""Seeds of the generators by half; those of training are others."""
SHARE = 0.396
"""Share of all recordings of a row that a seed draws: it gives 89 minutes without slip."""
BURST_SEEDS = {JUDGING: 4_001_000, TUNING: 3_001_000}
BURSTS = 60
BURST_V = 0.005, 0.05
"""Bursts on each board, and the bounds of their RMS voltage [V]: 10 to 100 times the noise."""
MANIPULATION_SEED = HELD_OUT_FROM + 1_100_000
"""First seed of the manipulations that train: the closed loop of a report has others."""
TRIAL_SEEDS = {JUDGING: HELD_OUT_FROM, TUNING: HELD_OUT_FROM + 50_000}
TRIALS = 120
BOARDS = {"S": "fsr400", "A": "article"}
"""Board of the generators -> design that has it."""
TRIAL_DESIGNS = ("fsr400", "first_finger", "article")
LOAD_LAWS: tuple[LoadLaw, ...] = ("hertz", "proportional")
"""Laws by which the vibration of a trial's slip grows with the force (`SurfaceTable.load_law`)."""
LINES = {
    "hand motion": tuple(held_out_signals.MOTION_BANDS_HZ),
    "servo steps": ("servo steps",),
    "steps": ("isolated step", "isolated step with gear vibration"),
    "set-downs": ("set-down",),
    "ramps": ("force ramp",),
    "late hum": ("hum that begins late",),
    "taps": ("tap",),
    "knocks": ("knock",),
    "rings": ("ring",),
    "vibration with the grasp": ("vibration with the grasp",),
    "releases": ("release",),
    "quiet": tuple(row for row in held_out_signals.ROWS if row.startswith("quiet")),
}
"""Line of the report -> rows of the generators; all other rows are slips."""
load_design = functools.cache(Design.load)


@dataclass(frozen=True)
class Generated:
    """One row of the generators on one board."""

    row: str
    board: str
    run: int
    """Seed of the generators."""
    share: float = SHARE

    def read(self) -> Iterator[Recording]:
        count = count_recordings(self.row, self.share)
        for made in held_out_signals.generate(self.row, self.board, self.run, count):
            yield take_generated(made)


def count_recordings(row: str, share: float) -> int:
    """Count the recordings of a row in a share of all: at least two."""
    return max(2, round(share * held_out_signals.COUNTS[row]))


def take_generated(made: held_out_signals.Recording) -> Recording:
    """Take a recording of the generators, with the stretches that its row names."""
    slides = tuple(Slide(*slip) for slip in made.slips)
    events = tuple(Interval(*event) for event in made.events)
    signal = LabelledSignal(
        kind=made.row,
        rate_hz=held_out_signals.RATE_HZ,
        voltage_v=made.tactile_v,
        slides=slides,
        events=events,
        alarms_from_s=made.quiet_from_s,
        filtered_v=made.filtered_v,
    )
    # What a row without slips and events holds is the same from its start to its end.
    whole_s = Interval(made.quiet_from_s, len(made.tactile_v) / held_out_signals.RATE_HZ)
    spans = events if slides or events else (whole_s,)
    stretches = tuple(Stretch(made.row, span.onset_s, span.end_s) for span in spans)
    return Recording(signal, stretches, design=load_design(BOARDS[made.board]))


@dataclass(frozen=True)
class Bursts:
    """Abrupt bursts on the board of a design."""

    design: str
    run: int
    """First seed."""
    count: int = BURSTS

    def read(self) -> Iterator[Recording]:
        design = load_design(self.design)
        for number in range(self.count):
            signal = abrupt_burst(design, self.run + number, *BURST_V)
            yield Recording(signal, (), design=design)


@dataclass(frozen=True)
class Trials:
    """Simulated trials of the article's plan with a design."""

    design: str
    law: LoadLaw
    run: int
    """First seed."""
    count: int = TRIALS

    def read(self) -> Iterator[Recording]:
        design = load_design(self.design)
        kind = name_trials(self.design, self.law)
        with compiled():
            for case in generate_cases(CampaignPlan(self.count, 0.5), self.run):
                if case.cause == "slip":
                    surface = case.scene.surface.model_copy(update={"load_law": self.law})
                    scene = case.scene.model_copy(update={"surface": surface})
                    signal = simulate_scene(design, scene, case.seed, kind, SETTLING_S)
                    yield Recording(signal, (), design=design)


@dataclass(frozen=True)
class Manipulations:
    """Hands that grasp and hold an object until a pin hits it: each finger is a recording."""

    design: str
    run: int
    """First seed."""
    repeats: int = 1
    """Manipulations of each of four objects."""

    def read(self) -> Iterator[Recording]:
        design = load_design(self.design)
        outputs = ["voltage_v", "slip", *select_board_outputs(design, ["fast"])]
        for scene, seed in plan_manipulations(self.repeats, self.run):
            with compiled():
                held = scene.model_copy(update={"outputs": outputs})
                result = run_manipulation(design, held, None, seed)

            for finger in result.fingers:
                yield Recording(take_finger(result.trace(finger)), (), design=design)


def take_finger(trace: Trace) -> LabelledSignal:
    """Take the signals of a finger of a hand, with its slips and what is none."""
    assert trace.slip is not None
    slips = merge(intervals(trace.time_s, trace.slip), STICK_S)
    rate_hz = 1 / float(trace.time_s[1] - trace.time_s[0])
    slides = tuple(Slide(slip.onset_s, slip.onset_s, slip.end_s) for slip in slips)
    return LabelledSignal(
        kind="manipulation",
        rate_hz=rate_hz,
        voltage_v=trace.voltage_v,
        slides=slides,
        events=(),
        alarms_from_s=SETTLING_S,
        filtered_v=trace.filtered_v,
    )


def name_trials(design: str, law: LoadLaw) -> str:
    return f"trials {design}, {law}"


def list_generated(seeds: Sequence[int], share: float = SHARE) -> list[Generated]:
    """List the generators' signals of some seeds, those of the largest rows first."""
    return [
        Generated(row, board, seed, share)
        for seed in seeds
        for row in held_out_signals.ROWS
        for board in BOARDS
    ]


def list_own(
    half: str, share: float = SHARE, trials_each: int = TRIALS
) -> list[Generated | Bursts | Trials]:
    """List all signals of the project's own for a half."""
    bursts = [Bursts(design, BURST_SEEDS[half]) for design in BOARDS.values()]
    trials = [
        Trials(design, law, TRIAL_SEEDS[half], trials_each)
        for design in TRIAL_DESIGNS
        for law in LOAD_LAWS
        if trials_each
    ]
    return [*trials, *bursts, *list_generated(SEEDS[half], share)]
