"""Spectra of slip and of contact, of the bare sensor and of the finger (the article's figure 2).

A bare sensor has no silicone: all of a force is its own, and what yields under it is its film. How
stiff that film is the article does not say. It is assumed ten times as stiff as the pad; that four
or thirty times change no statement is part of the figure.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fingertip.design import Design
from fingertip.foundation import display as style
from fingertip.foundation.jit import compiled
from fingertip.foundation.numerics import Array
from fingertip.lab.campaign.campaign import HELD_OUT_FROM
from fingertip.lab.report.plots import NOTE, add_legend
from fingertip.pad.response import Pad
from fingertip.sim.contact.surface_files import ARTICLE_SURFACES
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.runs.scene_and_manipulation_files import SceneFile
from fingertip.sim.simulation import SPEEDS_M_S, Trial
from tools.article.pictures.figure import Figure, Statement

SEGMENT_S = 0.512
"""Length of a segment [s] (article, III.A)."""
FROM_HZ = 20.0
"""Least frequency of what counts as vibration in slip [Hz]; slower is the force itself."""
CONTACT_HZ = 30.0
EMBEDDED_HZ = 100.0
BARE_HZ = 200.0
"""Frequencies of the article: contacts lie below the first, the finger's slip rarely above the
second, the bare sensor's mostly below the third [Hz].
"""
RARE = 0.1
"""Share of the power that counts as rare, and as minor. Assumption: the article gives no number."""
FILM = 10.0
OTHER_FILMS = (4.0, 30.0)
"""Stiffness of a bare sensor's film over that of the pad at 1 N. Assumptions."""
_BEFORE_TOUCH_S = 0.05


class BareScene(SceneFile):
    """Scene whose sensor is bare."""

    film: float = FILM

    def draw_pad(self, design: Design, seed: int) -> Pad:
        pad = super().draw_pad(design, seed)
        return replace(
            pad,
            stiffness_1n_n_per_m=self.film * pad.stiffness_1n_n_per_m,
            share=(1.0, 0.0),
            shear_share=(0.0, 0.0),
            reference_share=1.0,
            rest_n=0.0,
        )


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Mean one-sided power spectral density of some segments of the tactile voltage."""

    frequency_hz: Array
    power_v2_hz: Array

    @classmethod
    def of_segments(cls, segments: Sequence[Array], rate_hz: float) -> Spectrum:
        """Average the spectra of segments of equal length, each under a Hann window."""
        count = len(segments[0])
        window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(count) / count)
        powers = [np.abs(np.fft.rfft((part - part.mean()) * window)) ** 2 for part in segments]
        scale = 2 / rate_hz / float(window @ window)

        return cls(np.arange(count // 2 + 1) * rate_hz / count, scale * np.mean(powers, axis=0))

    def share_above(self, frequency_hz: float, from_hz: float = 0.0) -> float:
        """Share of the power from one frequency on that lies above another [Hz]."""
        kept = self.power_v2_hz[self.frequency_hz >= from_hz].sum()
        above = self.power_v2_hz[self.frequency_hz >= max(frequency_hz, from_hz)].sum()

        return float(above / kept)


def list_scenes(film: float | None = None) -> Iterator[SceneFile]:
    """Yield a slide on each surface at each speed, with the finger, or with a bare sensor."""
    for surface in ARTICLE_SURFACES:
        for speed in SPEEDS_M_S:
            scene = Trial(surface, speed).scene
            outputs = {"outputs": ["voltage_v", "force_n", "slip"]}
            tables = scene.model_dump() | outputs
            yield SceneFile(**tables) if film is None else BareScene(**tables, film=film)


def compute_spectra(design: Design, scenes: Iterator[SceneFile]) -> tuple[Spectrum, Spectrum]:
    """Compute the spectra of slip, from the middle of each slide, and of the touch before it."""
    rate_hz = design.detector.sample_rate_hz
    count = round(SEGMENT_S * rate_hz)
    slips = []
    contacts = []

    with compiled():
        for i, scene in enumerate(scenes):
            trace = run_scene(design, scene, HELD_OUT_FROM + i).trace
            assert trace.slip is not None
            assert trace.force_n is not None
            slipping = np.flatnonzero(trace.slip)
            start = max(0, int(slipping[0] + slipping[-1] - count) // 2)
            touch = int(np.flatnonzero(trace.force_n > 0.0)[0])
            before = max(0, touch - round(_BEFORE_TOUCH_S * rate_hz))
            slips.append(trace.voltage_v[start : start + count])
            contacts.append(trace.voltage_v[before : before + count])

    return Spectrum.of_segments(slips, rate_hz), Spectrum.of_segments(contacts, rate_hz)


def draw_spectra(design: Design) -> Figure:
    """Draw figure 2 with what the article says of it."""
    bare = compute_spectra(design, list_scenes(FILM))
    embedded = compute_spectra(design, list_scenes())
    others = [compute_spectra(design, list_scenes(film))[0] for film in OTHER_FILMS]
    bare_share = bare[0].share_above(BARE_HZ, FROM_HZ)
    embedded_share = embedded[0].share_above(EMBEDDED_HZ, FROM_HZ)
    contact_shares = [pair[1].share_above(CONTACT_HZ) for pair in (bare, embedded)]
    minor = [one.share_above(BARE_HZ, FROM_HZ) for one in (bare[0], *others)]
    softer, stiffer = (f"{100 * share:.1f} %" for share in minor[1:])
    lost = embedded[0].share_above(BARE_HZ, FROM_HZ)

    statements = (
        Statement(
            "embedded, content above 100 Hz very rarely",
            f"{100 * embedded_share:.1f} % of the power from {FROM_HZ:g} Hz on, "
            f"{100 * embedded[0].share_above(EMBEDDED_HZ, 1 / SEGMENT_S):.1f} % of all of it",
            embedded_share < RARE,
        ),
        Statement(
            "bare, up to 200 Hz predominant, minor but not negligible above",
            f"{100 * bare_share:.1f} % above 200 Hz ({softer} and {stiffer} with a film of "
            f"{OTHER_FILMS[0]:g} and {OTHER_FILMS[1]:g} times the pad's stiffness)",
            all(lost < share < RARE for share in minor) and bare_share > 10 * lost,
        ),
        Statement(
            "the silicone takes the higher frequencies away",
            f"above 200 Hz {100 * lost:.2f} % embedded, {100 * bare_share:.1f} % bare",
            lost < bare_share,
        ),
        Statement(
            "contact events lie below 30 Hz",
            f"all but {100 * max(contact_shares):.1g} % of their power",
            max(contact_shares) < RARE,
        ),
    )
    return Figure(
        "article_spectra.png",
        "Fig. 2: spectra of slip and contact",
        f"Power density of the tactile voltage in segments of {1e3 * SEGMENT_S:g} ms, mean of six "
        f"surfaces at three speeds. The bare sensor's film is assumed {FILM:g} times as stiff as "
        "the pad.",
        _plot({"bare sensor": bare, "embedded in the finger": embedded}),
        statements,
    )


def _plot(pairs: dict[str, tuple[Spectrum, Spectrum]]) -> bytes:
    figure = style.new_figure(7, 4.4)
    rows = figure.subplots(len(pairs), 1, sharex=True, sharey=True)

    for axes, (name, (slip, contact)) in zip(rows, pairs.items(), strict=True):
        for label, one, colour in (("slip", slip, style.BLUE), ("contact", contact, style.RED)):
            axes.semilogy(one.frequency_hz, one.power_v2_hz, color=colour, linewidth=1, label=label)

        axes.axvline(67, color=style.TEXT_COLOUR, linestyle=":", linewidth=1, label="cutoff, 67 Hz")
        axes.set_title(name, loc="left", fontsize=10)
        axes.set_ylabel("power density [V\u00b2/Hz]")
        style.style_axes(axes)

    add_legend(rows[0], 3)
    rows[-1].set_xlim(0, 400)
    rows[-1].set_xlabel(f"frequency [Hz] ({NOTE})")
    return style.to_png(figure)
