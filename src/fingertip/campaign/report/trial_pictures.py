"""Typical trials as pictures like the article's: one with all its signals (figure 9), one for each surface (figure 12)
and for each grasped object (figure 13), and what the window's length makes of one (figure 5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from fingertip.campaign.plan import HELD_OUT_FROM, Case
from fingertip.campaign.record import record, samples
from fingertip.campaign.report.pictures import COLORS, NOTE
from fingertip.campaign.studies.windows import DETECTOR, WINDOWS_S, with_window
from fingertip.campaign.study import surface_of
from fingertip.design import Design
from fingertip.drawing import plain, png, sheet
from fingertip.sim import SceneFile
from fingertip.sim.campaign import trials
from fingertip.sim.jit import compiled
from fingertip.slip import ChainSettings, SlipChain, Trace, make
from fingertip.slip.intervals import intervals

_VOLTAGE, _ENVELOPE, _TRUTH, _GREY = "#1f4e79", "#d98c2b", "#7fb3a6", "#4a5157"
SHORT_S = 0.01
"""The window that takes a contact for slip in the article's figure 5."""
ROWS = ("analog", "digital", "fast")


@dataclass(frozen=True, eq=False)
class Typical:
    """One trial of each surface and object."""

    label: str
    speed_m_s: float
    trace: Trace
    force_n: float


def typical(design: Design, first_seed: int = HELD_OUT_FROM) -> list[Typical]:
    """Sliding finger on each surface, then the grasped objects, each at one of the velocities in turn."""
    scenes: dict[tuple[str, float], SceneFile] = {}
    for scene, _ in trials():
        scenes.setdefault((surface_of(scene), scene.slide.speed_m_s), scene)
    labels = list(dict.fromkeys(label for label, _ in scenes))
    speeds = sorted({speed for _, speed in scenes})
    out = []
    with compiled():
        for i, label in enumerate(labels):
            speed = speeds[i % len(speeds)]
            trace, force_n = record(design, Case("slip", scenes[(label, speed)], first_seed + i))
            out.append(Typical(label, speed, trace, force_n))
    return out


def files(design: Design, first_seed: int = HELD_OUT_FROM) -> dict[str, bytes]:
    """File name -> picture."""
    found = typical(design, first_seed)
    objects = [one for one in found if one.label.startswith("object")]
    surfaces = [one for one in found if one not in objects]
    slow = next(one for one in found if one.label == "wood")  # the one whose slip shows without a magnifying glass
    return {
        "trial.png": all_signals(design, slow),
        "trials_surfaces.png": panels(design, surfaces),
        "trials_objects.png": panels(design, objects),
        "window_trial.png": window_rows(design, _telling(design, found)),
    }


def _telling(design: Design, found: Sequence[Typical]) -> Typical:
    """The first trial in which the article's short window takes the contact for slip; the first of all if none does."""
    short = with_window(design, SHORT_S)
    for one in found:
        assert one.trace.slip is not None
        before = slice(0, int(np.flatnonzero(one.trace.slip)[0]))
        if make(DETECTOR, short).process(one.trace.voltage_v[before]).on.any():
            return one
    return found[0]


def all_signals(design: Design, one: Typical) -> bytes:
    """Force, voltage, the board's output and every detector's ON of one trial, as the article's figure 9: a PNG."""
    figure = sheet(10, 9)
    force, voltage, envelope, on = figure.subplots(4, 1, sharex=True, height_ratios=(2, 2, 2, 1.3))
    t = one.trace.time_s
    force.plot(t, one.trace.force_n, color=_GREY, linewidth=0.8)
    force.set_ylabel("normal force [N]")
    voltage.plot(t, one.trace.voltage_v, color=_VOLTAGE, linewidth=0.7)
    voltage.set_ylabel("tactile voltage [V]")
    made = make("digital", design).process(one.trace.voltage_v)
    bar = 1000 * design.detector.threshold_v
    sampled = samples(one.trace, "analog")
    envelope.plot(t, 1000 * sampled, color=_ENVELOPE, linewidth=0.7, label=f"board's output ({design.board.variant})")
    envelope.plot(t, 1000 * made.level_v, color=COLORS["digital"], linewidth=1.2, label="digital, mean over the window")
    envelope.axhline(bar, color="black", linestyle="--", linewidth=1, label=f"threshold {bar:g} mV")
    envelope.set_ylim(0, 1.35 * max(float(np.max(1000 * made.level_v)), bar, float(np.quantile(1000 * sampled, 0.999))))
    envelope.set_ylabel("enveloped [mV]")
    envelope.legend(frameon=False, ncols=3, fontsize=9, loc="upper left")
    rows = [(name, make(name, design).process(samples(one.trace, name)).on) for name in ROWS]
    _rows(on, one.trace, rows)
    for axes in (force, voltage, envelope):
        _slip(axes, one.trace)
        plain(axes)
    touched = np.flatnonzero(np.asarray(one.trace.force_n) > 0.0)
    for axes in (force, voltage, envelope, on):
        for at in (touched[0], touched[-1]) if touched.size else ():
            axes.axvline(float(t[at]), color="#9aa1a8", linestyle="--", linewidth=1)
    said = f"{_said(one)}: grey dashes contact and release, green slip"
    force.set_title(f"{said} ({NOTE})", loc="left", fontsize=10)
    on.set_xlabel("time [s]")
    on.set_xlim(float(t[0]), float(t[-1]))
    figure.align_ylabels()
    return png(figure)


def panels(design: Design, chosen: Sequence[Typical]) -> bytes:
    """Voltage, envelope and ON of the digital chain, a panel for each trial, as figures 12 and 13: a PNG."""
    columns = 2
    count = -(-len(chosen) // columns)
    figure = sheet(11.5, 2.8 * count + 0.4)
    grid = figure.subplots(count, columns, squeeze=False)
    for one, axes in zip(chosen, grid.flat, strict=False):
        t, trace = one.trace.time_s, one.trace
        axes.plot(t, trace.voltage_v, color=_VOLTAGE, linewidth=0.6)
        low, high = float(np.min(trace.voltage_v)), float(np.max(trace.voltage_v))
        tall = high - low
        axes.set_ylim(low - 1.1 * tall, high + 0.45 * tall)  # the voltage above, the envelope below
        axes.set_ylabel("tactile voltage [V]", color=_VOLTAGE)
        chain = SlipChain(ChainSettings.of(design)).process(trace.voltage_v)
        twin = axes.twinx()
        twin.plot(t, 1000 * chain.envelope_v, color=_ENVELOPE, linewidth=0.6)
        twin.axhline(1000 * design.detector.threshold_v, color="black", linestyle="--", linewidth=0.7)
        slipping = chain.envelope_v[np.asarray(trace.slip)]
        twin.set_ylim(0, 2600 * max(0.04, float(np.max(slipping, initial=0.0))))
        twin.set_ylabel("envelope [mV]", color=_ENVELOPE)
        twin.spines["top"].set_visible(False)
        _slip(axes, trace)
        bars = [(i.onset_s, i.end_s - i.onset_s) for i in intervals(t, chain.on)]
        axes.broken_barh(bars, (high + 0.1 * tall, 0.1 * tall), color=COLORS["digital"], linewidth=0)
        axes.text(0.005, 0.985, "ON", color=COLORS["digital"], fontsize=9, va="top", transform=axes.transAxes)
        axes.set_title(_said(one), loc="left", fontsize=10)
        axes.set_xlim(float(t[0]), float(t[-1]))
        plain(axes)
    for axes in list(grid.flat)[len(chosen) :]:
        axes.set_visible(False)
    for axes in grid[-1]:
        axes.set_xlabel(f"time [s]; green: slip; digital chain ({NOTE})", fontsize=9)
    return png(figure)


def window_rows(design: Design, one: Typical) -> bytes:
    """ON and OFF of the digital chain on one trial for each window, as figure 5: a PNG."""
    figure = sheet(10, 5.5)
    voltage, on = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1.6))
    t = one.trace.time_s
    voltage.plot(t, one.trace.voltage_v, color=_VOLTAGE, linewidth=0.7)
    voltage.set_ylabel("tactile voltage [V]")
    _slip(voltage, one.trace)
    rows = []
    for window_s in WINDOWS_S:
        flags = make(DETECTOR, with_window(design, window_s)).process(one.trace.voltage_v).on
        rows.append((f"{1000 * window_s:g} ms", flags))
    _rows(on, one.trace, rows)
    on.set_ylabel("window")
    voltage.set_title(f"{DETECTOR} by its window: {_said(one)} ({NOTE})", loc="left", fontsize=10)
    on.set_xlabel("time [s]")
    on.set_xlim(float(t[0]), float(t[-1]))
    plain(voltage)
    return png(figure)


def _said(one: Typical) -> str:
    return f"{one.label}, {100 * one.speed_m_s:g} cm/s, {one.force_n:.2f} N"


def _rows(axes: Axes, trace: Trace, rows: Sequence[tuple[str, np.ndarray[tuple[int], np.dtype[np.bool_]]]]) -> None:
    """A bar for each stretch that is ON, a row for each name, the truth last."""
    assert trace.slip is not None
    named = [*rows, ("true slip", trace.slip)]
    for row, (name, flags) in enumerate(named):
        bars = [(i.onset_s, max(i.end_s - i.onset_s, 0.004)) for i in intervals(trace.time_s, flags)]
        color = _TRUTH if name == "true slip" else COLORS.get(name, "#1f4e79")
        axes.broken_barh(bars, (row - 0.35, 0.7), color=color, linewidth=0)
    axes.set_yticks(range(len(named)), [name for name, _ in named])
    axes.set_ylim(len(named) - 0.4, -0.6)
    plain(axes, "x")


def _slip(axes: Axes, trace: Trace) -> None:
    assert trace.slip is not None
    for part in intervals(trace.time_s, trace.slip):
        axes.axvspan(part.onset_s, part.end_s, color=_TRUTH, alpha=0.25, linewidth=0)
