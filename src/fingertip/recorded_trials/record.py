"""Guided recording of trials from a controller's stream.

The schedule follows the times of the samples, so that nobody presses a key. A trial is written when
it is complete: an interruption leaves no file half written, and the next run goes on. A sample that
did not arrive, or whose line is damaged, is replaced by the one before, as in the firmware, and
counted; after a longer gap the trial is repeated.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fingertip.design import Design
from fingertip.drivers import SampleReader
from fingertip.foundation.errors import Issue, TraceError, raise_issues
from fingertip.foundation.output_set import hash_parameters
from fingertip.recorded_trials.trials import (
    KINDS,
    PAUSE_S,
    SAID,
    STROKE_M,
    Labels,
    kind_of,
    list_trials,
    trial_path,
    write_trial,
)
from fingertip.sim.signal.finger_curve import FingerCurve
from fingertip.slip.detectors import registry
from fingertip.slip.detectors.fast_settings import GAP_S
from fingertip.slip.traces.trace import Trace


@dataclass(frozen=True)
class Plan:
    """Plan of a recording. Raises TraceError.

    `forces_n` are set by weights, each for an equal part of the trials, or empty if unknown.
    `onset_error_s` is the error of the contact that opens with the motion, or None. `pace` is a
    factor of all durations.
    """

    trials: int = 40
    forces_n: tuple[float, ...] = ()
    surface: str = ""
    stroke_m: float = STROKE_M
    temperature_c: float | None = None
    onset_error_s: float | None = None
    pace: float = 1.0

    def __post_init__(self) -> None:
        limits = (
            ("--trials", [self.trials], 1, 9999, ""),
            ("--force-n", self.forces_n, 0.01, 100, " N each"),
            ("--stroke-mm", [1000 * self.stroke_m], 1, 1000, " mm"),
            ("--pace", [self.pace], 0.02, 10, ""),
            ("--temperature-c", [self.temperature_c or 0.0], -40, 100, ""),
            ("--onset-error-ms", [1000 * (self.onset_error_s or 0.0)], 0, 1000, " ms"),
        )
        issues = []
        for name, values, low, high, unit in limits:
            message = f"is refused; choose {low:g} to {high:g}{unit}."
            refused = [value for value in values if not low <= value <= high]
            issues += [Issue(name, f"{value:g} {message}") for value in refused]

        raise_issues(TraceError, issues)

    def force_n(self, number: int) -> float | None:
        """Return the force of a trial, numbered from 1 [N]; None if it is unknown."""
        place = (number - 1) % self.trials * len(self.forces_n) // self.trials
        return self.forces_n[place] if self.forces_n else None

    def schedule(self, number: int) -> dict[str, tuple[float, float]]:
        """Return the phases of a trial with their starts and ends [s]."""
        durations = KINDS[kind_of(number)]
        ends = [round(self.pace * end, 6) for end in np.cumsum([*durations.values()]).tolist()]
        return dict(zip(durations, zip([0.0, *ends], ends, strict=False), strict=True))


class Recorded(NamedTuple):
    """Result of a recording: trials written, samples lost, trials repeated, and samples in all."""

    trials: tuple[int, ...]
    lost: int
    repeated: int
    samples: int


@dataclass
class Recorder:
    """Recorder of the trials of a plan, which tells a person what to do."""

    design: Design
    folder: Path
    plan: Plan
    show: Callable[[int, str, str], None] = lambda number, phase, line: None
    note: Callable[[str], None] = lambda message: None
    _lost: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        self._rate_hz = self.design.detector.sample_rate_hz
        self._hash = hash_parameters(self.design.identity())
        self._detector = registry.make_detector("fast", self.design)
        self._curve = FingerCurve.from_design(self.design)

    def run(self, reader: SampleReader) -> Recorded:
        """Record all trials that the folder lacks. Raises TraceError if the samples end before."""
        stream = iter(reader)
        numbers = list[int]()
        lost = 0
        repeated = 0
        samples = 0
        present = {path.name for path in list_trials(self.folder)}

        for number in range(1, self.plan.trials + 1):
            path = trial_path(self.folder, number)
            if path.name in present:
                continue

            if not numbers or self.plan.force_n(number) != self.plan.force_n(number - 1):
                self._pause(stream, number)

            trace = self._take(stream, number)
            while trace is None:
                repeated += 1
                self.note(f"trial {number}: a gap of more than {1000 * GAP_S:g} ms; it is repeated")
                trace = self._take(stream, number)

            self._note_motion(trace, number)
            write_trial(path, self._label(number, reader.firmware), trace)
            numbers.append(number)
            lost += self._lost
            samples += len(trace.time_s)

        return Recorded(tuple(numbers), lost, repeated, samples)

    def _pause(self, stream: Iterator[tuple[float, ...]], number: int) -> None:
        """Let samples pass while a person changes the weights."""
        force_n = self.plan.force_n(number)
        pause_s = self.plan.pace * PAUSE_S
        weights = f"weights for {force_n:g} N" if force_n else "get ready"
        self.note(f"trial {number} begins in {pause_s:g} s: {weights}")
        for _ in zip(range(round(pause_s * self._rate_hz)), stream, strict=False):
            pass

    def _note_motion(self, trace: Trace, number: int) -> None:
        """Tell how long a slide moved."""
        if trace.slip is None or kind_of(number) != "slide":
            return

        text = "the contact of MOTION_PIN never opened"
        if trace.slip.any():
            text = f"moved for {1000 * trace.slip.sum() / self._rate_hz:.0f} ms"

        self.note(f"trial {number}: {text}")

    def _label(self, number: int, firmware: str) -> Labels:
        plan = self.plan
        return Labels(
            trial=number,
            kind=kind_of(number),
            phases=plan.schedule(number),
            design=self.design.name,
            design_hash=self._hash,
            surface=plan.surface,
            force_n=plan.force_n(number),
            stroke_m=plan.stroke_m,
            lost=self._lost,
            onset_error_s=plan.onset_error_s,
            firmware=firmware,
            temperature_c=plan.temperature_c,
        )

    def _take(self, stream: Iterator[tuple[float, ...]], number: int) -> Trace | None:
        """Take the samples of one trial; None after a long gap."""
        end_s = max(end for _, end in self.plan.schedule(number).values())
        total = round(self._rate_hz * end_s)
        samples = list[tuple[float, ...]]()
        reported = 0
        self._lost = 0

        while len(samples) < total:
            sample = next(stream, None)
            if sample is None:
                message = (
                    f"ended in trial {number}, which is not kept; run the command again to "
                    "go on with it."
                )
                raise TraceError(Issue("samples", message))

            if samples:
                steps = round((sample[0] - samples[-1][0]) * self._rate_hz)
                # Otherwise the controller was reset, or much was lost.
                if not 0 < steps <= GAP_S * self._rate_hz + 1:
                    return None

                samples += [samples[-1]] * (steps - 1)
                self._lost += steps - 1

            samples.append(sample)
            if len(samples) - reported >= 0.1 * self._rate_hz:  # a line each 0.1 s
                self._report(np.array(samples[reported:]), number, len(samples) / self._rate_hz)
                reported = len(samples)

        _, volts, filtered, moving = np.array(samples[:total]).T
        slip = None if np.isnan(moving[0]) and kind_of(number) == "slide" else moving > 0.0
        return Trace(
            time_s=np.arange(total) / self._rate_hz,
            voltage_v=volts,
            force_n=None,
            slip=slip,
            envelope_v=None,
            filtered_v=None if np.isnan(filtered[0]) else filtered,
        )

    def _report(self, part: np.ndarray, number: int, at_s: float) -> None:
        count = 2 if self.design.board.has_filter and np.isfinite(part[:, 2]).all() else 1
        is_on = self._detector.process(*part[:, 1 : 1 + count].T).on.any()
        phases = self.plan.schedule(number)
        mean_v = float(part[:, 1].mean())
        phase = next((name for name, (_, end) in phases.items() if at_s <= end), [*phases][-1])
        self.show(
            number,
            phase,
            (
                f"trial {number} of {self.plan.trials}, {kind_of(number)}: {SAID[phase]} "
                f"{max(0.0, phases[phase][1] - at_s):4.1f} s | "
                f"{mean_v:.3f} V {self._curve.force_n(mean_v):6.2f} N {'SLIP' if is_on else '    '}"
            ),
        )
