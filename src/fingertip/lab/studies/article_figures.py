"""Simulated counterparts of two of the article's figures: spectra of slip (figure 2), and window length (figure 5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.design import Design
from fingertip.foundation.jit import compiled
from fingertip.foundation.numerics import Array
from fingertip.lab.campaign.plan import HELD_OUT_FROM, CampaignPlan, generate_cases
from fingertip.lab.campaign.run import DetectorResult, TrialResult, evaluate, simulate_trace
from fingertip.sim import run_scene
from fingertip.sim.article import article_trials
from fingertip.slip.detectors.digital import noise_level

SEGMENT_S = 0.512
"""Length of the segments whose spectra are computed [s]."""
RESONANCES_HZ = {"embedded": 90.0, "bare": 230.0}
"""Resonance of the pad with an embedded and with a bare sensor [Hz], as in ``params/scenes``: about where the article's
two spectra end."""
_AVERAGED = 5

WINDOWS_S = (0.005, 0.01, 0.02, 0.03, 0.05, 0.1)
"""Window lengths [s]. The article shows 10 ms and more, uses 30 ms, and calls 20 to 100 ms acceptable."""
WINDOW_DETECTOR = "digital"
"""Detector of the window study. The article's figure shows its board's output; the simulated board of variant article,
with a bare diode, passes no contact."""
CONTACTS = ("contact", "release", "load change")


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Power spectrum of slip with one sensor."""

    label: str
    frequency_hz: Array
    power_v2_hz: Array
    """One-sided power spectral density of the voltage [V^2/Hz], mean of a few trials."""

    def share_above(self, frequency_hz: float) -> float:
        """Fraction of the power from 20 Hz on that lies above a frequency [Hz]."""
        kept = self.frequency_hz >= 20.0
        above = self.frequency_hz >= frequency_hz
        total = float(self.power_v2_hz[kept].sum())
        return float(self.power_v2_hz[above].sum()) / total if total else 0.0


def compute_spectra(design: Design, first_seed: int = HELD_OUT_FROM) -> list[Spectrum]:
    """Compute the spectra of slip on the medium surface at 4 cm/s, from the middle of the slide."""
    rate = design.detector.sample_rate_hz
    count = round(SEGMENT_S * rate)
    window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(count) / count)
    slide = next(s for s, _ in article_trials() if s.contact.surface == "medium" and s.slide.speed_m_s == 0.04)
    spectra = []
    with compiled():
        for label, resonance_hz in RESONANCES_HZ.items():
            contact = slide.contact.model_copy(update={"resonance_hz": resonance_hz})
            scene = slide.model_copy(update={"contact": contact, "outputs": ["voltage_v", "slip"]})
            total = np.zeros(count // 2 + 1)
            for seed in range(first_seed, first_seed + _AVERAGED):
                trace = run_scene(design, scene, seed).trace
                assert trace.slip is not None
                slipping = np.flatnonzero(trace.slip)
                start = max(0, int(slipping[0] + slipping[-1] - count) // 2)
                segment = trace.voltage_v[start : start + count]
                total += np.abs(np.fft.rfft((segment - segment.mean()) * window)) ** 2
            density = 2 * total / _AVERAGED / rate / float(window @ window)
            spectra.append(Spectrum(label, np.arange(count // 2 + 1) * rate / count, density))
    return spectra


@dataclass(frozen=True)
class WindowResult:
    """Result of the article's chain with one window length."""

    window_s: float
    threshold_v: float
    """Threshold by the design's rule, noise level plus six standard deviations, which fall with a longer window [V]."""
    found_share: float
    median_s: float
    """Median delay over all slips [s]; infinite if fewer than half were found."""
    p90_s: float
    contact_alarms_per_minute: float
    """False alarms per minute in contacts, releases and load changes, those of the trials included."""


def study_windows(
    design: Design,
    trials: int = 24,
    negative_minutes: float = 4.0,
    first_seed: int = HELD_OUT_FROM,
    windows_s: Sequence[float] = WINDOWS_S,
) -> list[WindowResult]:
    """Measure delay and false alarms of the detector `digital` by window length, on the same traces.

    A short window takes contacts for slip; a long one is late.
    """
    designs = [with_window(design, window_s) for window_s in windows_s]
    collected: list[list[TrialResult]] = [[] for _ in designs]
    with compiled():
        for case in generate_cases(CampaignPlan(trials, negative_minutes), first_seed):
            if case.cause not in ("slip", *CONTACTS):
                continue
            trace, force_n = simulate_trace(design, case, [WINDOW_DETECTOR])
            for results, other in zip(collected, designs, strict=True):
                results += evaluate(case, trace, force_n, WINDOW_DETECTOR, other, [1.0])
    pooled = [DetectorResult(1.0, tuple(results)) for results in collected]
    return [
        WindowResult(
            window_s, d.detector.threshold_v, r.found_share, r.delay_s(0.5), r.delay_s(0.9), r.alarms_per_minute
        )
        for window_s, d, r in zip(windows_s, designs, pooled, strict=True)
    ]


def with_window(design: Design, window_s: float) -> Design:
    """Copy of the design with another window [s] and the threshold that the noise allows."""
    tables = design.model_dump()
    tables["detector"]["window_samples"] = max(1, round(window_s * design.detector.sample_rate_hz))
    threshold_v = noise_level(Design(**tables)).threshold_v
    if threshold_v > 0.0:
        tables["detector"]["threshold_v"] = threshold_v
    return Design(**tables)
