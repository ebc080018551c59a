"""Curves of delay against alarms, one for each detector: as points and as a picture."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from benchmarks.slip.competitors import LONG_REST_S, Row
from benchmarks.slip.scores import Tally, known
from fingertip.foundation.display import BLUE, ORANGE, PURPLE, RED, REFERENCE, SKY, TEAL
from fingertip.page.html import Markup, element
from fingertip.page.svg import Axis, Frame, figure_svg, line, number, text, write_svg

_COLOURS = {
    "fast": RED,
    "incipient": ORANGE,
    "digital": TEAL,
    "fft": BLUE,
    "plain_fft": SKY,
    "cusum": PURPLE,
    "ratio": REFERENCE,
}
_OTHER = "#222222"
_DELAYS_MS = 1.0, 300.0
"""Delays that the picture shows [ms]."""
_WIDTH = 430.0
_HEIGHT = 300.0
_LEFT = 60.0
_TOP = 36.0
_LINE = 18.0
"""Size of a panel, its place, and the height of a line of the legend [px]."""


@dataclass(frozen=True)
class CurvePoint:
    """What a detector reaches at one factor of its threshold."""

    factor: float
    alarms_per_minute: float
    median_ms: float
    p90_ms: float

    def as_data(self) -> dict[str, float | None]:
        return {name: known(value) for name, value in vars(self).items()}

    def delay_ms(self, fraction: float) -> float:
        return self.median_ms if fraction == 0.5 else self.p90_ms


@dataclass(frozen=True)
class Panel:
    """Curves over one mix of signals, at one fraction of the slips."""

    title: str
    fraction: float
    curves: Mapping[Row, Sequence[CurvePoint]]


def make_point(factor: float, slips: Tally, quiet: Tally) -> CurvePoint:
    """Make a point of the delays in some recordings and of the alarms in others."""
    return CurvePoint(
        factor, quiet.alarms_per_minute, slips.quantile_ms(0.5), slips.quantile_ms(0.9)
    )


def best_points(points: Sequence[CurvePoint], fraction: float) -> list[CurvePoint]:
    """Select the points that no other one beats in delay and alarms, by rate of alarms."""
    best = list[CurvePoint]()
    for point in sorted(points, key=lambda one: (one.alarms_per_minute, one.delay_ms(fraction))):
        least_ms = best[-1].delay_ms(fraction) if best else math.inf
        if point.delay_ms(fraction) < least_ms:
            best.append(point)

    return best


def at_rate(
    points: Sequence[CurvePoint], rate_per_minute: float, minutes: float
) -> CurvePoint | None:
    """Find the threshold with the shortest 90th percentile that keeps a rate of alarms.

    Recordings in which this rate means less than one alarm show none.
    """
    kept = [point for point in points if point.alarms_per_minute <= rate_per_minute]
    if not kept or minutes * rate_per_minute < 1.0:
        return None

    return min(kept, key=lambda point: (point.p90_ms, point.median_ms))


def draw(panels: Sequence[Panel], least_per_minute: float) -> bytes:
    """Draw panels side by side as SVG; no alarm at all stands at `least_per_minute`."""
    rows = list(dict.fromkeys(row for panel in panels for row in panel.curves))
    rates = [
        point.alarms_per_minute
        for panel in panels
        for one in panel.curves.values()
        for point in one
    ]
    x = Axis(
        least_per_minute,
        max([10.0 * least_per_minute, 10.0, *filter(math.isfinite, rates)]),
        "alarms a minute",
        True,
    )
    parts = list[Markup]()

    for place, panel in enumerate(panels):
        percent = f"{100 * panel.fraction:g} % of the slips found after [ms]"
        y = Axis(*_DELAYS_MS, f"{panel.title}: {percent}", True)
        left = _LEFT + place * (_WIDTH + _LEFT)
        frame = Frame(x, y, left, _TOP, _WIDTH, _HEIGHT)
        parts += [frame.axes(), *(_draw_curve(frame, panel, row) for row in panel.curves)]

    top = _TOP + _HEIGHT + 60
    parts += [_describe(row, top + _LINE * place) for place, row in enumerate(rows)]
    width = len(panels) * (_WIDTH + _LEFT) + 20
    title = "Delay of slip detectors over their alarms a minute"
    return write_svg(figure_svg(width, top + _LINE * len(rows), title, *parts))


def _draw_curve(frame: Frame, panel: Panel, row: Row) -> Markup:
    """Draw a detector's curve, and a mark at its own threshold."""
    points = panel.curves[row]
    best = best_points(points, panel.fraction)
    own = [point for point in points if point.factor == 1.0]
    places = [
        (max(point.alarms_per_minute, frame.x.low), point.delay_ms(panel.fraction))
        for point in best
    ]
    marks = [
        _mark(frame, max(one.alarms_per_minute, frame.x.low), one.delay_ms(panel.fraction), row)
        for one in own
        if math.isfinite(one.delay_ms(panel.fraction))
    ]
    curve = [frame.line(_within(places), _colour(row), 1.8, _dashes(row))] if places else []
    return element("g", *curve, *marks)


def _within(places: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    low_ms, high_ms = _DELAYS_MS
    return [(rate, min(max(delay_ms, low_ms), high_ms)) for rate, delay_ms in places]


def _mark(frame: Frame, rate: float, delay_ms: float, row: Row) -> Markup:
    ((rate, delay_ms),) = _within([(rate, delay_ms)])
    x, y = frame.point(rate, delay_ms)
    return element("circle", cx=number(x), cy=number(y), r=4, fill=_colour(row))


def _describe(row: Row, y: float) -> Markup:
    """Draw one line of the legend."""
    mark = line((_LEFT, y - 4), (_LEFT + 30, y - 4), _colour(row), 2, _dashes(row))
    return element("g", mark, text(_LEFT + 38, y, row.label))


def _colour(row: Row) -> str:
    return _COLOURS.get(row.name, _OTHER)


def _dashes(row: Row) -> str:
    return "5 3" if row.rest_s == LONG_REST_S else ""
