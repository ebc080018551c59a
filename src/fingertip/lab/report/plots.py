"""Plots of a campaign as in the article, delays (figure 14), surfaces and velocities (figure 15),
and a comparison of detectors.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

from fingertip.foundation import display as style
from fingertip.lab.campaign.run import CampaignResult, DetectorResult, speed_m_s, surface
from fingertip.slip.detectors.registry import DETECTORS
from fingertip.slip.traces.truth import ENCODER_HZ, encoder_delay_band_s

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = {name: kind.colour for name, kind in DETECTORS.items()}
MARKERS = {name: kind.marker for name, kind in DETECTORS.items()}
OTHER_COLOUR = style.PURPLE
NOTE = "simulated, held-out seeds"
_NO_ALARMS = 0.02
"""Position of thresholds without alarms on the logarithmic axis [1/min]."""


def add_legend(axes: Axes, columns: int = 1) -> None:
    """Add a legend above the axes, where it covers no data."""
    anchor = (1.0, 1.0)
    axes.legend(
        frameon=False,
        ncols=columns,
        fontsize=9,
        loc="lower right",
        bbox_to_anchor=anchor,
        borderaxespad=0.2,
    )


def plot_delays(result: CampaignResult) -> bytes:
    """Plot a histogram of the delays in bins of 5 ms, a row for each detector; returns a PNG."""
    figure = style.new_figure(10, 2.4 * len(result.detectors) + 0.8)
    rows = figure.subplots(len(result.detectors), 1, sharex=True, squeeze=False)[:, 0]

    for axes, name in zip(rows, result.detectors, strict=True):
        nominal = result.at_nominal_threshold(name)
        delays_ms = [1000 * delay_s for delay_s in nominal.delays_s]
        # Bins are centred on multiples of 5 ms; the last one holds all longer delays.
        bins_ms = [min(5 * math.floor(delay / 5 + 0.5), 155) for delay in delays_ms]
        counts = Counter(bins_ms)
        colour = COLOURS.get(name, OTHER_COLOUR)
        axes.bar(list(counts), list(counts.values()), width=4.4, color=colour)

        median_s = nominal.motion_delay_s(0.5)
        if math.isfinite(median_s):
            low_s, high_s = encoder_delay_band_s(median_s)
            label = f"median since the robot moved, by encoders at {ENCODER_HZ:g} Hz"
            axes.axvspan(
                1000 * low_s,
                1000 * high_s,
                color=style.ORANGE,
                alpha=0.35,
                linewidth=1.0,
                zorder=0,
                label=label,
            )
            add_legend(axes)

        within = sum(delay < 30 for delay in delays_ms)
        title = (
            f"{name}: {len(delays_ms)} of {nominal.slips} slips found, {within} within 30 ms, "
            f"median {1000 * nominal.delay_s(0.5):.1f} ms"
        )
        axes.set_title(title, loc="left", fontsize=10)
        axes.axvline(30, color=style.TEXT_COLOUR, linestyle="--", linewidth=1)
        axes.set_ylabel("trials")
        style.style_axes(axes)

    rows[-1].set_xlim(-2.5, 160)
    rows[-1].set_xlabel(
        f"delay from gross slip [ms]; the last bin contains all longer delays ({NOTE})"
    )
    return style.to_png(figure)


def plot_surfaces(result: CampaignResult, detector: str) -> bytes:
    """Plot the mean delay by surface and velocity, and by surface with its standard deviation.

    Returns a PNG.
    """
    nominal = result.at_nominal_threshold(detector)
    figure = style.new_figure(10, 7)
    top, bottom = figure.subplots(2, 1, sharex=True)
    _draw_speeds(top, nominal)
    _draw_deviations(bottom, nominal, COLOURS.get(detector, OTHER_COLOUR))
    top.set_title(
        f"{detector}: delay from gross slip by surface and velocity ({NOTE})",
        loc="left",
        fontsize=10,
    )

    for axes, label in ((top, "mean delay [ms]"), (bottom, "mean and standard deviation [ms]")):
        axes.set_ylabel(label)
        add_legend(axes, 3)
        style.style_axes(axes)

    return style.to_png(figure)


def _draw_speeds(axes: Axes, nominal: DetectorResult) -> None:
    """Draw the mean delay on each surface, a bar for each velocity."""
    names = list(nominal.group_delays(surface))
    speeds = sorted({speed_m_s(trial) for trial in nominal.trials if trial.slips})
    groups = nominal.group_delays(lambda trial: (surface(trial), speed_m_s(trial)))

    for i, speed in enumerate(speeds):
        heights = []
        for name in names:
            mean_s, _, _ = groups.get((name, speed), (math.inf, 0.0, 0))
            heights.append(1000 * mean_s if math.isfinite(mean_s) else 0)

        x = [n + 0.25 * (i - (len(speeds) - 1) / 2) for n in range(len(names))]
        colour = style.SHADES[i % len(style.SHADES)]
        axes.bar(x, heights, 0.22, label=f"{100 * speed:g} cm/s", color=colour)


def _draw_deviations(axes: Axes, nominal: DetectorResult, colour: str) -> None:
    """Draw mean and standard deviation of the delay on each surface."""
    groups = nominal.group_delays(surface)
    places = [n for n, (_, _, count) in enumerate(groups.values()) if count]
    means = [1000 * mean_s for mean_s, _, count in groups.values() if count]
    deviations = [1000 * deviation_s for _, deviation_s, count in groups.values() if count]
    axes.errorbar(places, means, deviations, fmt="o", capsize=5, color=colour)

    for n, (_, _, count) in enumerate(groups.values()):
        if not count:
            axes.annotate("none found", (n, 2), ha="center", fontsize=9, color=style.TEXT_COLOUR)

    axes.axhline(
        60,
        color=style.TEXT_COLOUR,
        linestyle="--",
        linewidth=1,
        label="60 ms (article)",
    )
    ends = [mean + deviation for mean, deviation in zip(means, deviations, strict=True)]
    axes.set_ylim(0, max(70.0, 1.1 * max(ends, default=0.0)))
    axes.set_xticks(range(len(groups)), [str(name) for name in groups], rotation=20, ha="right")


def plot_comparison(result: CampaignResult) -> bytes:
    """Plot the median (solid) and 90th percentile (dashed) of the delay over false alarms per
    minute; returns a PNG.
    """
    figure = style.new_figure(10, 6)
    axes = figure.subplots()
    for name, results in result.detectors.items():
        _draw_trade_off(axes, name, results)
        nominal = result.at_nominal_threshold(name)
        median_s = nominal.delay_s(0.5)
        if math.isfinite(median_s):
            axes.plot(
                max(nominal.alarms_per_minute, _NO_ALARMS),
                1000 * median_s,
                "o",
                markersize=11,
                markerfacecolor="none",
                color=COLOURS.get(name, OTHER_COLOUR),
            )

    axes.axvline(
        0.1,
        color=style.TEXT_COLOUR,
        linewidth=1,
        linestyle=":",
        label="0.1 false alarms per minute",
    )
    axes.set_xscale("log")
    axes.set_ylim(0, 160)
    causes = "contact, release, load change and drift"
    axes.set_xlabel(f"false alarms per minute from {causes}; {_NO_ALARMS:g} means none ({NOTE})")
    axes.set_ylabel("delay over all slips [ms]")
    title = (
        "Each line: one detector from low to high threshold; circle: the detector's own threshold"
    )
    axes.set_title(title, loc="left", fontsize=10)
    figure.legend(
        frameon=False,
        ncols=3,
        fontsize=9,
        loc="outside lower left",
    )
    style.style_axes(axes)

    return style.to_png(figure)


def _draw_trade_off(axes: Axes, name: str, results: Sequence[DetectorResult]) -> None:
    """Draw median and 90th percentile of the delay of one detector over its false alarms."""
    # Above the lowest threshold without alarms, a higher one only increases the delay: draw that
    # one only.
    with_alarms = [result for result in results if result.alarms_per_minute]
    silent = [result for result in results if not result.alarms_per_minute]
    shown = with_alarms + silent[:1]

    for fraction, line, quantile in ((0.5, "-", "median"), (0.9, "--", "90th percentile")):
        reached = [result for result in shown if math.isfinite(result.delay_s(fraction))]
        axes.plot(
            [max(result.alarms_per_minute, _NO_ALARMS) for result in reached],
            [1000 * result.delay_s(fraction) for result in reached],
            line,
            marker=MARKERS.get(name, "."),
            markersize=5,
            color=COLOURS.get(name, OTHER_COLOUR),
            label=f"{name}, {quantile}",
        )
