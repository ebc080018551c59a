"""Power spectra of slip, bare sensor and embedded (the article's figure 2): portions of 512 ms."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.campaign.plan import HELD_OUT_FROM
from fingertip.design import Design
from fingertip.sim import run_scene
from fingertip.sim.campaign import trials
from fingertip.sim.jit import compiled

PORTION_S = 0.512
RESONANCES_HZ = {"embedded": 90.0, "bare": 230.0}
"""As in ``params/scenes``: about where the article's two spectra end."""
_AVERAGED = 5


@dataclass(frozen=True, eq=False)
class Spectrum:
    """One sensor."""

    label: str
    frequency_hz: Array
    power_v2_hz: Array
    """One-sided power spectral density of the voltage [V^2/Hz], mean of a few trials."""

    def beyond(self, frequency_hz: float) -> float:
        """Share of the power from 20 Hz on that lies beyond a frequency [Hz]."""
        kept = self.frequency_hz >= 20.0
        above = self.frequency_hz >= frequency_hz
        whole = float(self.power_v2_hz[kept].sum())
        return float(self.power_v2_hz[above].sum()) / whole if whole else 0.0


def spectra(design: Design, first_seed: int = HELD_OUT_FROM) -> list[Spectrum]:
    """Slip on the medium surface at 4 cm/s, from the middle of the slide."""
    rate = design.detector.sample_rate_hz
    count = round(PORTION_S * rate)
    window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(count) / count)
    slide = next(s for s, _ in trials() if s.contact.surface == "medium" and s.slide.speed_m_s == 0.04)
    out = []
    with compiled():
        for label, resonance_hz in RESONANCES_HZ.items():
            contact = slide.contact.model_copy(update={"resonance_hz": resonance_hz})
            scene = slide.model_copy(update={"contact": contact, "outputs": ["voltage_v", "slip"]})
            total = np.zeros(count // 2 + 1)
            for seed in range(first_seed, first_seed + _AVERAGED):
                trace = run_scene(design, scene, seed).trace
                assert trace.slip is not None
                moving = np.flatnonzero(trace.slip)
                start = max(0, int(moving[0] + moving[-1] - count) // 2)
                part = trace.voltage_v[start : start + count]
                total += np.abs(np.fft.rfft((part - part.mean()) * window)) ** 2
            density = 2 * total / _AVERAGED / rate / float(window @ window)
            out.append(Spectrum(label, np.arange(count // 2 + 1) * rate / count, density))
    return out
