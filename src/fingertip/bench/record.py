"""Guided recording of trials: the schedule follows the times of the samples, so that nobody presses a key.

A trial is written when it is complete. At an interruption the trial in progress is not kept, and no file is half
written; the next run goes on with it. A sample that did not arrive is replaced by the one before, as in the firmware,
and counted; after a longer gap the trial is repeated.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from fingertip.bench.stream import Sample, SampleReader
from fingertip.bench.trials import KINDS, PAUSE_S, SAID, STROKE_M, Labels, kind_of, list_trials, trial_path, write_trial
from fingertip.design import Design
from fingertip.foundation.errors import Issue, TraceError, raise_issues
from fingertip.foundation.output_set import hash_parameters
from fingertip.sim.runs.grip import ForceCurve
from fingertip.slip.detectors import registry
from fingertip.slip.traces.trace import Trace

SHOWN_S, MAX_GAP_S = 0.1, 0.02
"""Time from one shown line to the next, and longest gap that is filled, as in the firmware [s]."""


@dataclass(frozen=True)
class Plan:
    """What is recorded. Raises TraceError."""

    trials: int = 40
    forces_n: tuple[float, ...] = ()
    """Forces by weights, each for an equal part of the trials [N]; empty: unknown."""
    surface: str = ""
    stroke_m: float = STROKE_M
    temperature_c: float | None = None
    onset_error_s: float | None = None
    """Error of the contact that opens with the motion [s]; None: unknown."""
    pace: float = 1.0
    """Factor of all durations."""

    def __post_init__(self) -> None:
        issues = []
        if not 1 <= self.trials <= 9999:
            issues.append(Issue("--trials", f"{self.trials} is refused; choose 1 to 9999."))
        if not all(0.01 <= force <= 100.0 for force in self.forces_n):
            issues.append(Issue("--force-n", "holds what is no force; give 0.01 to 100 N each, such as 0.5,1,2."))
        if not 0.001 <= self.stroke_m <= 1.0:
            issues.append(Issue("--stroke-mm", f"{1000 * self.stroke_m:g} mm is refused; choose 1 to 1000 mm."))
        if not 0.02 <= self.pace <= 10.0:
            issues.append(Issue("--pace", f"{self.pace:g} is refused; choose 0.02 to 10."))
        if self.temperature_c is not None and not -40.0 <= self.temperature_c <= 100.0:
            issues.append(Issue("--temperature-c", f"{self.temperature_c:g} is refused; choose -40 to 100."))
        raise_issues(TraceError, issues)

    def force_n(self, number: int) -> float | None:
        """Force of a trial, numbered from 1 [N]."""
        at = (number - 1) % self.trials * len(self.forces_n) // self.trials
        return self.forces_n[at] if self.forces_n else None


@dataclass(frozen=True)
class Moment:
    """What is shown while a trial runs."""

    trial: int
    trials: int
    kind: str
    phase: str
    left_s: float
    """Time until the next phase [s]."""
    voltage_v: float
    force_n: float
    slip: bool

    def __str__(self) -> str:
        slip = "SLIP" if self.slip else "    "
        return (
            f"trial {self.trial} of {self.trials}, {self.kind}: {SAID[self.phase]} {max(0.0, self.left_s):4.1f} s | "
            f"{self.voltage_v:.3f} V {self.force_n:6.2f} N {slip}"
        )


@dataclass(frozen=True)
class Recorded:
    trials: tuple[int, ...]
    """Numbers of the trials that were written."""
    lost: int
    repeated: int
    """Trials that were repeated because of a gap."""
    samples: int


@dataclass
class Recorder:
    design: Design
    folder: Path
    plan: Plan
    show: Callable[[Moment], None] = lambda moment: None
    note: Callable[[str], None] = lambda message: None
    _lost: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        settings = self.design.detector
        self._rate_hz, self._detector = settings.sample_rate_hz, registry.make_detector("fast", self.design)
        self._curve = ForceCurve.from_design(self.design)
        self._base = Labels(
            0, "", {}, self.design.name, hash_parameters(self.design.identity()), self.plan.surface,
            stroke_m=self.plan.stroke_m, onset_error_s=self.plan.onset_error_s, temperature_c=self.plan.temperature_c,
        )  # fmt: skip

    def run(self, reader: SampleReader) -> Recorded:
        """Record all trials that the folder lacks. Raises TraceError if the samples end before."""
        samples, written, lost, repeated, count = iter(reader), list[int](), 0, 0, 0
        done = {path.name for path in list_trials(self.folder)}
        for number in range(1, self.plan.trials + 1):
            path = trial_path(self.folder, number)
            if path.name in done:
                continue
            force_n = self.plan.force_n(number)
            if not written or force_n != self.plan.force_n(number - 1):
                pause_s, weights = self.plan.pace * PAUSE_S, f"weights for {force_n:g} N" if force_n else "get ready"
                self.note(f"trial {number} begins in {pause_s:g} s: {weights}")
                for _ in zip(range(round(pause_s * self._rate_hz)), samples, strict=False):
                    pass
            while (trace := self._take(samples, number)) is None:
                repeated += 1
                self.note(f"trial {number}: a gap of more than {1000 * MAX_GAP_S:g} ms; it is repeated")
            phases = dict(self._schedule(number))
            labels = replace(
                self._base, trial=number, kind=kind_of(number), phases=phases, force_n=force_n, lost=self._lost,
                firmware=reader.firmware,
            )  # fmt: skip
            write_trial(path, labels, trace)
            written.append(number)
            lost, count = lost + self._lost, count + len(trace.time_s)
        return Recorded(tuple(written), lost, repeated, count)

    def _schedule(self, number: int) -> Iterator[tuple[str, tuple[float, float]]]:
        start = 0.0
        for phase, duration_s in KINDS[kind_of(number)].items():
            end = start + self.plan.pace * duration_s
            yield phase, (round(start, 6), round(end, 6))
            start = end

    def _take(self, samples: Iterator[Sample], number: int) -> Trace | None:
        """Take the samples of one trial; None after a long gap."""
        phases = [*self._schedule(number)]
        total, taken, self._lost = round(self._rate_hz * phases[-1][1][1]), list[Sample](), 0
        shown = 0
        while len(taken) < total:
            sample = next(samples, None)
            if sample is None:
                message = f"ended in trial {number}, which is not kept; run the command again to go on with it."
                raise TraceError(Issue("samples", message))
            if taken:
                steps = round((sample.time_s - taken[-1].time_s) * self._rate_hz)
                if not 0 < steps <= MAX_GAP_S * self._rate_hz + 1:  # the controller was reset, or much was lost
                    return None
                for _ in range(1, steps):
                    taken.append(replace(taken[-1], time_s=taken[-1].time_s + 1 / self._rate_hz))
                    self._lost += 1
            taken.append(sample)
            if len(taken) - shown >= SHOWN_S * self._rate_hz:
                self._report(taken[shown:], number, phases, len(taken) / self._rate_hz)
                shown = len(taken)
        return self._make_trace(taken[:total], kind_of(number) == "slide")

    def _report(
        self, part: list[Sample], number: int, phases: list[tuple[str, tuple[float, float]]], at_s: float
    ) -> None:
        volts, filtered = [one.voltage_v for one in part], [one.filtered_v for one in part]
        inputs = [volts] if None in filtered or not self.design.board.has_filter else [volts, filtered]
        on = self._detector.process(*(np.array(values, dtype=float) for values in inputs)).on
        phase, (_, end) = next((each for each in phases if at_s <= each[1][1]), phases[-1])
        mean_v = float(np.mean(volts))
        self.show(Moment(number, self.plan.trials, kind_of(number), phase, end - at_s, mean_v,
                         self._curve.force_n(mean_v), bool(on.any())))  # fmt: skip

    def _make_trace(self, taken: list[Sample], is_slide: bool) -> Trace:
        time_s = np.arange(len(taken)) / self._rate_hz
        filtered = None if taken[0].filtered_v is None else np.array([one.filtered_v or 0.0 for one in taken])
        moving = None if taken[0].moving is None and is_slide else np.array([bool(one.moving) for one in taken])
        return Trace(time_s, np.array([one.voltage_v for one in taken]), None, moving, None, filtered)
