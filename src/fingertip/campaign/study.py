"""A campaign's verdicts together: how many found, how late, how many alarms of which cause, at which threshold."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.campaign.judge import Verdict, judge
from fingertip.campaign.plan import APART, HELD_OUT_FROM, Amount, cases
from fingertip.campaign.record import reads_board, record
from fingertip.campaign.studies.limit import quantile_s
from fingertip.design import Design
from fingertip.sim import SceneFile
from fingertip.sim.jit import compiled
from fingertip.slip import DETECTORS

SCALES = (0.7, 0.8, 0.9, 1.0, 1.15, 1.35, 1.5, 1.6, 1.8, 2.0, 2.3, 2.6, 3.0, 4.0, 6.0, 10.0)
"""Factors of each detector's threshold, from noisy to deaf."""
BELOW = (0.02, 0.05, 0.1, 0.2, 0.4)
"""More of them where the board's output is read: a diode without bias passes so little noise that much lower thresholds
than the design's may stand clear of it."""


@dataclass(frozen=True)
class Total:
    """One detector at one threshold."""

    scale: float
    verdicts: tuple[Verdict, ...]

    @property
    def slips(self) -> int:
        """True slips."""
        return sum(v.slips for v in self.verdicts)

    @property
    def delays_s(self) -> list[float]:
        """Of all slips that were found [s]."""
        return [d for v in self.verdicts for d in v.delays_s]

    @property
    def found_share(self) -> float:
        """Slips found, of all."""
        return len(self.delays_s) / self.slips if self.slips else 0.0

    def delay_s(self, share: float) -> float:
        """Delay by which that share of all slips was found [s]; infinite if fewer were."""
        return quantile_s(self.delays_s, self.slips, share)

    @property
    def on_share(self) -> float:
        """Mean share of the slip that is ON once it is found."""
        shares = [v.on_share for v in self.verdicts if v.delays_s]
        return float(np.mean(shares)) if shares else 0.0

    def alarms(self) -> dict[str, int]:
        """Cause -> false alarms."""
        causes = [cause for v in self.verdicts for cause in v.alarms]
        return {cause: causes.count(cause) for cause in dict.fromkeys([v.case.cause for v in self.verdicts] + causes)}

    def minutes(self) -> dict[str, float]:
        """Cause -> minutes in its scenes; the trials themselves under ``slip``."""
        spent: dict[str, float] = {}
        for v in self.verdicts:
            spent[v.case.cause] = spent.get(v.case.cause, 0.0) + v.duration_s / 60
        return spent

    @property
    def alarms_per_minute(self) -> float:
        """In all scenes but those that are counted apart."""
        minutes = sum(m for cause, m in self.minutes().items() if cause not in APART)
        return sum(n for cause, n in self.alarms().items() if cause not in APART) / minutes if minutes else 0.0

    def by(self, key: Callable[[Verdict], object]) -> dict[object, tuple[float, float, int]]:
        """Group -> mean and standard deviation of the delay [s], and how many."""
        groups: dict[object, list[float]] = {}
        for v in self.verdicts:
            if v.slips:
                groups.setdefault(key(v), []).extend(v.delays_s)
        return {k: (float(np.mean(d)), float(np.std(d)), len(d)) if d else (np.inf, 0.0, 0) for k, d in groups.items()}


def surface_of(scene: SceneFile) -> str:
    """The group of a scene: its surface, or the object that is pulled through the grasp."""
    name = scene.contact.surface
    return name if scene.scene == "sliding_finger" else f"object, {name}"


def surface(verdict: Verdict) -> str:
    """The group of a trial."""
    return surface_of(verdict.case.scene)


def speed_m_s(verdict: Verdict) -> float:
    """The trial's velocity [m/s]."""
    return verdict.case.scene.slide.speed_m_s


@dataclass(frozen=True)
class Study:
    """A campaign: detector -> totals by factor of the threshold."""

    amount: Amount
    first_seed: int
    totals: dict[str, tuple[Total, ...]]

    def at_design(self, detector: str) -> Total:
        """A detector at its own threshold."""
        return next(total for total in self.totals[detector] if total.scale == 1.0)

    def matched(self, detector: str, alarms_per_minute: float) -> Total | None:
        """A detector at the lowest threshold that keeps the alarms; None if none does."""
        kept = (t for t in self.totals[detector] if t.alarms_per_minute <= alarms_per_minute)
        return next(kept, None)


def run(
    design: Design,
    amount: Amount,
    detectors: Sequence[str] = tuple(DETECTORS),
    scales: Sequence[float] = SCALES,
    progress: Callable[[str], None] = lambda _: None,
    first_seed: int = HELD_OUT_FROM,
) -> Study:
    """Simulate every case once and judge every detector on it.

    Parameters
    ----------
    design
        Its board, sensor, converter and detector.
    amount
        How many trials and minutes.
    detectors, scales
        What is judged; 1 is always among the scales.
    progress
        Takes words of progress.
    first_seed
        Of the first case.
    """
    scales = sorted({1.0, *scales})
    factors = {name: sorted({*(BELOW if reads_board(name) else ()), *scales}) for name in detectors}
    verdicts: dict[str, list[list[Verdict]]] = {name: [[] for _ in factors[name]] for name in detectors}
    with compiled(progress):
        last = ""
        for case in cases(amount, first_seed):
            if case.cause != last:
                progress(f"{case.cause}: simulating and judging")
                last = case.cause
            trace, force_n = record(design, case, reads_board(*detectors))
            for name in detectors:
                judged = judge(case, trace, force_n, name, design, factors[name])
                for kept, verdict in zip(verdicts[name], judged, strict=True):
                    kept.append(verdict)
    totals = {
        name: tuple(Total(scale, tuple(kept)) for scale, kept in zip(factors[name], verdicts[name], strict=True))
        for name in detectors
    }
    return Study(amount, first_seed, totals)
