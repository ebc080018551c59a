"""A simulation as a picture: one panel for each output. The only module of `sim`, beside the bench's, that draws."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from fingertip.plot_style import TEXT_COLOUR, style_axes, to_png, new_figure
from fingertip.sim.hand.manipulated import Manipulated
from fingertip.sim.stages.result import Simulated
from fingertip.slip.intervals import intervals

Array = NDArray[Any]

_COLORS = ("#1f4e79", "#b03a2e", "#7d8f3a", "#c98a2b", "#6c5b9c")
_TRUTH = "#7fb3a6"
_LABELS = {
    "voltage_v": ("sampled\nvoltage [V]", 1),
    "force_n": ("normal\nforce [N]", 1),
    "slip": ("true slip", 1),
    "velocity_m_s": ("velocity\n[mm/s]", 1000),
    "shear_m": ("shear of\nthe pad [mm]", 1000),
    "tactile_v": ("tactile\nvoltage [V]", 1),
    "filtered_v": ("filtered\n[V]", 1),
    "envelope_v": ("enveloped\n[V]", 1),
    "closing_m": ("closing of\nfingers [mm]", 1000),
    "command_m": ("commanded\nclosing [mm]", 1000),
    "object_m": ("way of the\nobject [mm]", 1000),
    "pin_n": ("force of\nthe pin [N]", 1),
    "slip_pin_v": ("ON/OFF\npin [V]", 1),
}


def draw(found: Simulated | Manipulated, title: str) -> bytes:
    """Draw the outputs over one time axis; where a finger slips is shaded.

    Returns
    -------
    bytes
        A PNG, 1500 pixels wide, the same for the same data (no date, no version in it).
    """
    names = found.scene.outputs
    several = isinstance(found, Manipulated)
    fingers = found.fingers if isinstance(found, Manipulated) else ("",)
    ratios = [0.25 + 0.15 * len(fingers) if name == "slip" else 1.0 for name in names]
    figure = new_figure(10, 1.4 + 1.9 * sum(ratios))
    panels = figure.subplots(len(names), 1, sharex=True, squeeze=False, height_ratios=ratios)[:, 0]
    figure.suptitle(title, x=0.01, ha="left", fontweight="bold", fontsize=12)
    for axes, name in zip(panels, names, strict=True):
        signal = found.signals[name] if isinstance(found, Manipulated) else found.columns[name]
        rows = signal if signal.ndim == 2 else signal[None, :]
        style_axes(axes, "both")
        label, factor = _LABELS[name]
        if name == "slip":
            _bars(axes, found.time_s, rows, fingers)
        else:
            _shade(axes, found)
            for i, row in enumerate(rows):
                axes.plot(found.time_s, factor * row, color=_COLORS[i % 5], linewidth=0.8, zorder=3 - 0.1 * i)
            axes.set_ylabel(label)
    if several:
        _legend(panels, names, fingers)
    _moments(panels, found)
    panels[-1].set_xlabel("time [s]")
    panels[-1].set_xlim(float(found.time_s[0]), float(found.time_s[-1]))
    figure.align_ylabels()
    return to_png(figure)


def _bars(axes: Axes, time_s: Array, rows: Array, fingers: tuple[str, ...]) -> None:
    for i, row in enumerate(rows):
        parts = intervals(time_s, row.astype(np.bool_))
        axes.broken_barh([(p.onset_s, p.end_s - p.onset_s) for p in parts], (i - 0.35, 0.7), color=_TRUTH, linewidth=0)
    axes.set_yticks(range(len(rows)), [name or "true slip" for name in fingers])
    axes.set_ylim(-0.6, len(rows) - 0.4)
    axes.invert_yaxis()
    axes.tick_params(axis="y", length=0)
    if len(rows) > 1:
        axes.set_ylabel("true slip")


def _shade(axes: Axes, found: Simulated | Manipulated) -> None:
    slip = found.columns.get("slip")
    if slip is not None:
        for part in intervals(found.time_s, slip.astype(np.bool_)):
            axes.axvspan(part.onset_s, part.end_s, color=_TRUTH, alpha=0.25, linewidth=0)


def _legend(panels: Array, names: list[str], fingers: tuple[str, ...]) -> None:
    """Beside the first panel that has a line for each finger."""
    for axes, name in zip(panels, names, strict=True):
        if name not in ("slip", "object_m", "pin_n"):
            axes.legend(
                axes.get_lines(),
                fingers,
                loc="upper left",
                framealpha=1.0,
                edgecolor="none",
                ncols=len(fingers),
                fontsize=9,
            )
            low, high = axes.get_ylim()
            axes.set_ylim(low, high + 0.2 * (high - low))
            return


def _moments(panels: Array, found: Simulated | Manipulated) -> None:
    if not isinstance(found, Manipulated):
        return
    moments = [("let go", found.plan.let_go_s - found.scene.grasp.let_go_s)]
    if found.plan.pin:
        moments.append(("knock", found.plan.knock_s))
    if found.lost_s is not None:
        moments.append(("lost", found.lost_s))
    for words, at in moments:
        for axes in panels:
            axes.axvline(at, color=TEXT_COLOUR, linewidth=0.9, linestyle=":")
        panels[0].annotate(
            words, (at, 1.0), xycoords=("data", "axes fraction"), xytext=(0, 3), textcoords="offset points",
            ha="center", va="bottom", fontsize=9, color=TEXT_COLOUR,
        )  # fmt: skip
