"""Report of the benchmark of slip detectors: table, JSON and the curve of delay against alarms."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks.slip.competitors import COUNTED, Competitor
from benchmarks.slip.scores import RATES, Point, at_own_threshold, at_rate, best_points
from fingertip.foundation.display import (
    BLUE,
    ORANGE,
    PURPLE,
    RED,
    REFERENCE,
    SKY,
    TEAL,
    TEXT_COLOUR,
    new_figure,
    style_axes,
    to_png,
)
from fingertip.foundation.errors import join_words

FILES = ("slip_curve.png", "slip_bench.json", "slip_bench.txt")
_STYLES = {
    "fast": (RED, "o"),
    "incipient": (RED, "D"),
    "digital": (TEAL, "^"),
    "fft": (ORANGE, "s"),
    "plain_fft": (SKY, "v"),
    "cusum": (BLUE, "<"),
    "recurrent": (PURPLE, "P"),
    "ratio": (REFERENCE, ">"),
}
_WITHOUT_CURVE = ("incipient",)
"""Detectors without a curve: `incipient` judges each score, and its threshold has one value."""
_SHOWN_MS = 2.0, 300.0
"""Delays that the picture shows [ms]."""


@dataclass(frozen=True, eq=False)
class Report:
    title: str
    found: Mapping[str, Sequence[Point]]
    competitors: Mapping[str, Competitor]
    instructions: int | None
    """Instructions a sample of `fast` in slip on a Cortex-M4F; None
    at another sampling rate than was measured.
    """

    def as_data(self) -> dict[str, Any]:
        """Convert it to plain mappings and lists for JSON. Keys contain their units."""
        return {
            "title": self.title,
            "minutes": _round(self._first.counted_minutes),
            "slips": self._first.slips,
            "minutes_by_kind": {
                kind: _round(minutes) for kind, minutes in self._first.minutes.items()
            },
            "stretches_by_kind": self._first.stretches,
            "detectors": {
                name: {
                    "label": self.competitors[name].label,
                    "points": [_point_data(point) for point in points],
                    "at_rates": {
                        f"{rate:g}_per_minute": None
                        if (p := at_rate(points, rate)) is None
                        else _point_data(p)
                        for rate in RATES
                    },
                }
                for name, points in self.found.items()
            },
        }

    @property
    def _first(self) -> Point:
        return at_own_threshold(next(iter(self.found.values())))

    def as_text(self) -> str:
        """Describe what each detector reaches, at its own threshold and at equal rates
        of alarms.
        """
        first = self._first
        lines = [
            f"{self.title}: {first.slips} slips, {first.counted_minutes:.1f} min without slip.",
            "Delays from gross slip to ON, median / 90th percentile, ms; a slip that was not "
            "found is infinitely late.",
            "",
            f"{'':20}{'at its own threshold':^56}"
            + "".join(f"{f'at most {rate:g} alarms/min':^30}" for rate in RATES),
            f"{'detector':20}{'found':>8}{'delay':>15}{'ON':>7}{'alarms/min':>12}{'95 %':>14}"
            + f"{'delay':>15}{'found':>8}{'ON':>7}" * len(RATES),
        ]

        for name, points in self.found.items():
            own = at_own_threshold(points)
            label = self.competitors[name].label
            line = f"{label:20}{_percent(own.found_share):>8}{_delays(own):>15}{own.on_share:>7.3f}"
            low, high = own.alarm_interval

            if self._has_rates:
                line += f"{own.alarms_per_minute:>12.2f}{f'{low:.2g} to {high:.2g}':>14}"
            else:
                line += f"{'-':>12}{'-':>14}"

            for rate in RATES:
                kept = at_rate(points, rate)
                cells = ("-", "-", "-")
                if kept is not None:
                    cells = (_delays(kept), _percent(kept.found_share), f"{kept.on_share:.3f}")

                line += f"{cells[0]:>15}{cells[1]:>8}{cells[2]:>7}"

            lines.append(line)

        if not self._has_rates:
            lines += ["", "No stretch without slip: nothing is known of false alarms."]
        elif first.counted_minutes < 1 / min(RATES):
            shown = join_words(
                [f"{rate:g}" for rate in RATES if first.counted_minutes < 1 / rate], "or"
            )
            minutes = f"{first.counted_minutes:.1f} min without slip"
            lines += [
                "",
                f"{minutes} are too short to show {shown} alarms a minute: one alarm is more.",
            ]

        owns = [at_own_threshold(points) for points in self.found.values()]
        kinds = [kind for kind in first.minutes if any(own.alarms.get(kind) for own in owns)]
        if kinds:
            width = max(len(kind) for kind in kinds)
            names = [f"{self.competitors[name].label:>20}" for name in self.found]
            lines += ["", "Alarms at the own threshold, by what the recording shows:"]
            lines.append(f"  {'':{width}}{'stretches':>11}{'minutes':>9}{''.join(names)}")

            for kind in kinds:
                counts = (own.alarms.get(kind, 0) for own in owns)
                lines.append(
                    f"  {kind:{width}}{first.stretches.get(kind, '-'):>11}"
                    f"{first.minutes[kind]:>9.2f}" + "".join(f"{count:>20}" for count in counts)
                )

        lines += ["", "Work of a sample:"]
        lines += [
            f"  {self.competitors[name].label:20}{self._describe_work(name)}" for name in self.found
        ]
        return "\n".join(lines)

    def _describe_work(self, name: str) -> str:
        competitor = self.competitors[name]
        work = f"{competitor.operations} multiplications and additions, about"
        if competitor.operations == COUNTED:
            work = "not counted at this rate"
            if self.instructions is not None:
                work = f"{self.instructions} instructions in slip, on a Cortex-M4F"

        return f"{work}; {competitor.words}"

    @property
    def _has_rates(self) -> bool:
        return self._first.counted_minutes > 0.0

    def draw(self) -> bytes:
        """Draw the delay over the rate of alarms, one curve for each detector, as PNG."""
        figure = new_figure(11, 5.6)
        panels = figure.subplots(1, 2, sharey=True)
        least = 0.5 / self._first.counted_minutes if self._has_rates else 1.0

        for axes, fraction, words in zip(
            panels, (0.5, 0.9), ("median", "90th percentile"), strict=True
        ):
            for name, points in self.found.items():
                colour, marker = _STYLES.get(name, (TEXT_COLOUR, "*"))
                own = at_own_threshold(points)
                best = (
                    []
                    if name in _WITHOUT_CURVE and "fast" in self.found
                    else best_points(points, fraction)
                )

                for shown, style in (
                    (best, {"linewidth": 1.6}),
                    ([own], {"marker": marker, "markersize": 9}),
                ):
                    rates = [
                        max(point.alarms_per_minute, least) if self._has_rates else least
                        for point in shown
                    ]
                    delays = [max(point.quantile_ms(fraction), _SHOWN_MS[0]) for point in shown]
                    axes.plot(rates, delays, color=colour, **style)

                axes.plot(
                    [],
                    [],
                    color=colour,
                    marker=marker,
                    linewidth=1.6,
                    label=self.competitors[name].label,
                )

            axes.set_xscale("log")
            axes.set_yscale("log")
            axes.set_ylim(*_SHOWN_MS)
            axes.set_yticks(
                [2, 5, 10, 20, 50, 100, 200], ["2", "5", "10", "20", "50", "100", "200"]
            )
            axes.minorticks_off()
            axes.xaxis.set_major_formatter("{x:g}")
            axes.set_xlim(min(least, min(RATES)) / 1.5, max(axes.get_xlim()[1], 2.0 * max(RATES)))
            for rate in RATES:
                axes.axvline(rate, color=REFERENCE, linestyle=":", linewidth=1)

            axes.set_title(f"{words} of the delay", loc="left", fontweight="bold")
            axes.set_xlabel("false alarms per minute")
            style_axes(axes, "both")

        panels[0].set_ylabel("delay from gross slip to ON [ms]")
        figure.legend(
            *panels[1].get_legend_handles_labels(),
            frameon=False,
            fontsize=9,
            loc="outside right upper",
        )
        figure.supxlabel(
            f"{self.title}: {self._first.slips} slips, {self._first.counted_minutes:.3g} min "
            "without slip.\n"
            "Lower left is better. Symbols: each detector's own threshold. "
            f"No alarm at all is drawn at {least:.2g} a minute.",
            x=0.01,
            ha="left",
            fontsize=8,
            color=TEXT_COLOUR,
        )
        return to_png(figure)

    def encode(self) -> tuple[bytes, ...]:
        """Contents of the files, in the order of `FILES`."""
        data = json.dumps(self.as_data(), indent=2, allow_nan=False) + "\n"
        return self.draw(), data.encode(), f"{self.as_text()}\n".encode()


def _point_data(point: Point) -> dict[str, Any]:
    low, high = point.alarm_interval
    return {
        "threshold_factor": point.factor,
        "found_share": _round(point.found_share),
        "delay_median_ms": _round(point.quantile_ms(0.5)),
        "delay_p90_ms": _round(point.quantile_ms(0.9)),
        "motion_delay_median_ms": _round(point.quantile_ms(0.5, since_motion=True)),
        "motion_delay_p90_ms": _round(point.quantile_ms(0.9, since_motion=True)),
        "on_share": _round(point.on_share),
        "alarms_per_minute": _round(point.alarms_per_minute),
        "alarms_per_minute_95": [_round(low), _round(high)],
        "alarms": point.alarms,
    }


def _round(value: float) -> float | None:
    return float(f"{value:.4g}") if math.isfinite(value) else None


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %"


def _delays(point: Point) -> str:
    delays_ms = (point.quantile_ms(fraction) for fraction in (0.5, 0.9))
    return " / ".join(f"{delay:.1f}" if math.isfinite(delay) else "-" for delay in delays_ms)
