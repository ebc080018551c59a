"""Plots of a campaign like the article's: delays (figure 14), surfaces
and velocities (figure 15), and a comparison.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fingertip.foundation import display as style
from fingertip.lab.campaign.run import CampaignResult, speed_m_s, surface
from fingertip.slip.detectors.registry import DETECTORS
from fingertip.slip.traces.truth import ENCODER_HZ, encoder_delay_band_s

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = {name: kind.colour for name, kind in DETECTORS.items()}
MARKERS = {name: kind.marker for name, kind in DETECTORS.items()}
OTHER_COLOUR = style.PURPLE
NOTE = "simulated, held-out seeds"


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
    """Plot a histogram of the delays in bins of 5 ms centred on multiples of 5, one row per
    detector; returns a PNG.
    """
    figure = style.new_figure(10, 2.4 * len(result.detectors) + 0.8)
    rows = figure.subplots(len(result.detectors), 1, sharex=True, squeeze=False)[:, 0]

    for axes, name in zip(rows, result.detectors, strict=True):
        nominal = result.at_nominal_threshold(name)
        ms = [1000 * d for d in nominal.delays_s]
        counts: dict[int, int] = {}

        for d in ms:
            at = min(5 * math.floor(d / 5 + 0.5), 155)
            counts[at] = counts.get(at, 0) + 1

        axes.bar(
            list(counts), list(counts.values()), width=4.4, color=COLOURS.get(name, OTHER_COLOUR)
        )
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

        below = sum(d < 30 for d in ms)
        title = (
            f"{name}: {len(ms)} of {nominal.slips} slips found, {below} within 30 ms, median "
            f"{1000 * nominal.delay_s(0.5):.1f} ms"
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
    """Plot the mean delay by surface and velocity, and by surface
    with its standard deviation; returns a PNG.
    """
    nominal = result.at_nominal_threshold(detector)
    figure = style.new_figure(10, 7)
    top, bottom = figure.subplots(2, 1, sharex=True)
    groups = nominal.group_delays(surface)
    names = list(groups)
    speeds = sorted({speed_m_s(trial) for trial in nominal.trials if trial.slips})
    both = nominal.group_delays(lambda trial: (surface(trial), speed_m_s(trial)))

    for i, speed in enumerate(speeds):
        values = [
            1000 * both[(name, speed)][0] if (name, speed) in both else math.nan for name in names
        ]
        x = [n + 0.25 * (i - (len(speeds) - 1) / 2) for n in range(len(names))]
        heights = [v if math.isfinite(v) else 0 for v in values]
        colour = style.SHADES[i % len(style.SHADES)]
        top.bar(x, heights, 0.22, label=f"{100 * speed:g} cm/s", color=colour)

    found = [
        (n, 1000 * groups[name][0], 1000 * groups[name][1])
        for n, name in enumerate(names)
        if groups[name][2]
    ]
    means = [mean for _, mean, _ in found]
    deviations = [deviation for _, _, deviation in found]
    colour = COLOURS.get(detector, OTHER_COLOUR)
    bottom.errorbar([n for n, _, _ in found], means, deviations, fmt="o", capsize=5, color=colour)

    for n, name in enumerate(names):
        if not groups[name][2]:
            bottom.annotate("none found", (n, 2), ha="center", fontsize=9, color=style.TEXT_COLOUR)

    bottom.axhline(
        60,
        color=style.TEXT_COLOUR,
        linestyle="--",
        linewidth=1,
        label="60 ms (article)",
    )
    highest = max((m + s for m, s in zip(means, deviations, strict=True)), default=0.0)
    bottom.set_ylim(0, max(70.0, 1.1 * highest))
    bottom.set_xticks(range(len(names)), names, rotation=20, ha="right")
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


def plot_comparison(result: CampaignResult) -> bytes:
    """Plot the median (solid) and 90th percentile (dashed) of the delay
    over false alarms per minute; returns a PNG.
    """
    figure = style.new_figure(10, 6)
    axes = figure.subplots()
    no_alarms = 0.02  # position of thresholds without alarms on the logarithmic axis

    for name, results in result.detectors.items():
        colour = COLOURS.get(name, OTHER_COLOUR)
        # Above the lowest threshold without alarms, a higher one only increases the delay: draw
        # that one only.
        silent = [r for r in results if not r.alarms_per_minute][:1]
        shown = [r for r in results if r.alarms_per_minute] + silent
        rates = [max(r.alarms_per_minute, no_alarms) for r in shown]

        for fraction, line in ((0.5, "-"), (0.9, "--")):
            values = [1000 * r.delay_s(fraction) for r in shown]
            kept = [(r, v) for r, v in zip(rates, values, strict=True) if math.isfinite(v)]
            label = f"{name}, {'median' if fraction == 0.5 else '90th percentile'}"
            marker = MARKERS.get(name, ".")
            x = [rate for rate, _ in kept]
            y = [value for _, value in kept]
            axes.plot(
                x,
                y,
                line,
                marker=marker,
                markersize=5,
                color=colour,
                label=label,
            )

        nominal = result.at_nominal_threshold(name)
        if math.isfinite(nominal.delay_s(0.5)):
            at = (max(nominal.alarms_per_minute, no_alarms), 1000 * nominal.delay_s(0.5))
            axes.plot(*at, "o", markersize=11, markerfacecolor="none", color=colour)

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
    axes.set_xlabel(f"false alarms per minute from {causes}; {no_alarms:g} means none ({NOTE})")
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
