"""Plot of the filter's response: target, nominal board and the band of boards within their tolerances."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from fingertip.board.analysis.figures import format_figure
from fingertip.board.analysis.response_band import Ends, ResponseBand
from fingertip.plot_style import BLUE, ORANGE, RED, TEXT_COLOUR, new_figure, style_axes, to_png, to_svg

if TYPE_CHECKING:
    from fingertip.arrays import Array

FORMATS = {".png": to_png, ".svg": to_svg}
"""Renderers by the suffix of the file."""
_FLOOR_DB = -25.0
"""Lowest level of the axis relative to the maximum [dB]: three times below it, nothing tells boards apart."""
_HEADROOM_DB = 8.0


def draw_response(band: ResponseBand, title: str, suffix: str) -> bytes:
    """Plot a band as PNG or SVG.

    The file holds no date and no version, so the same band gives the same bytes.

    Parameters
    ----------
    band
        Band of a board.
    title
        Title of the plot.
    suffix
        Suffix of the file, one of `FORMATS`.
    """
    figure = new_figure(9, 5.4)
    axes = figure.add_subplot()
    figure.suptitle(title, x=0.01, ha="left", fontweight="bold", fontsize=12)
    nominal_db = _decibel(band.nominal)
    maximum_db = float(nominal_db.max())
    axes.fill_between(
        band.f_hz, _decibel(band.low), _decibel(band.high), color=BLUE, alpha=0.22, linewidth=0,
        label=f"95 % of boards ({describe_tolerances(band.percent)})",
    )  # fmt: skip
    axes.plot(band.f_hz, _decibel(band.target), color=ORANGE, linewidth=1.4, linestyle=(0, (5, 2)),
              label=f"target: Butterworth, third order, {format_figure(band.target_cutoff_hz)} Hz")  # fmt: skip
    axes.plot(band.f_hz, nominal_db, color=BLUE, linewidth=1.6, label="board with nominal values")
    level_db = maximum_db - 10.0 * np.log10(2.0)
    axes.axhline(level_db, color=TEXT_COLOUR, linewidth=0.7, linestyle=(0, (1, 2)))
    # Outside the passband and above the level, nothing else is drawn.
    for hz, ends_hz, side in ((band.lower_hz, band.lower_ends_hz, -1), (band.upper_hz, band.upper_ends_hz, 1)):
        axes.plot([hz], [level_db], marker="o", color=RED, markersize=5)
        axes.hlines(level_db, *ends_hz, color=RED, linewidth=2.5)
        axes.annotate(
            f"−3 dB at {format_figure(hz)} Hz\n95 %: {describe_ends(ends_hz)} Hz", (hz, level_db),
            (14 * side, 4), textcoords="offset points", ha="left" if side > 0 else "right", va="bottom",
            color=RED, fontsize=9,
        )  # fmt: skip
    axes.set_xscale("log")
    axes.set_xlim(band.f_hz[0], band.f_hz[-1])
    axes.set_ylim(maximum_db + _FLOOR_DB, maximum_db + _HEADROOM_DB)
    axes.set_xlabel("frequency [Hz]")
    axes.set_ylabel("gain, tactile voltage to rectifier [dB]")
    style_axes(axes, "both")
    axes.legend(loc="upper left", frameon=False, fontsize=9)
    return FORMATS[suffix](figure)


def describe_tolerances(percent: Mapping[str, float]) -> str:
    """Describe the tolerances of the components: "R1, R2 1 %; C1, C2 10 %"."""
    groups: dict[float, list[str]] = {}
    for name, value in percent.items():
        groups.setdefault(value, []).append(name)
    parts = (f"{', '.join(names)} {value:g} %" for value, names in sorted(groups.items()))
    return "; ".join(parts)


def describe_ends(ends_hz: Ends) -> str:
    """Describe the ends of a band of frequencies."""
    return " to ".join(format_figure(hz, 3) for hz in ends_hz)


def _decibel(magnitude: Array) -> Array:
    result: Array = 20.0 * np.log10(magnitude)
    return result
