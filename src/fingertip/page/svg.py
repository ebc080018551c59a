"""Plots as SVG elements: axes with ticks, lines, bands and marks.

Colours are the page's, so they follow its theme.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from fingertip.page.html import Markup, element, join, read_asset

Points = Iterable[tuple[float, float]]
_TICK_STEPS = (1.0, 2.0, 5.0, 10.0)
_CHARACTER = 6.4
"""Mean width of a character of the labels [px]."""


@dataclass(frozen=True)
class Axis:
    """Axis of a plot between two values."""

    low: float
    high: float
    label: str
    is_log: bool = False

    def share(self, value: float) -> float:
        """Return the place of a value: 0 at the low end, 1 at the high one."""
        if self.is_log:
            return math.log(value / self.low) / math.log(self.high / self.low)

        return (value - self.low) / (self.high - self.low)

    def ticks(self, count: int) -> list[float]:
        """List round values in the range: powers of ten if logarithmic, else about `count`."""
        if self.is_log:
            first = math.ceil(math.log10(self.low) - 1e-9)
            last = math.floor(math.log10(self.high) + 1e-9)
            return [10.0**exponent for exponent in range(first, last + 1)]

        rough = (self.high - self.low) / count
        power = 10.0 ** math.floor(math.log10(rough))
        step = power * next(
            factor for factor in _TICK_STEPS if factor * power >= rough * (1 - 1e-9)
        )
        first = math.ceil(self.low / step - 1e-9)
        last = math.floor(self.high / step + 1e-9)

        return [round(multiple * step, 9) + 0.0 for multiple in range(first, last + 1)]


@dataclass(frozen=True)
class Frame:
    """Rectangle of a plot within a figure [px], with its axes."""

    x: Axis
    y: Axis
    left: float
    top: float
    width: float
    height: float

    def point(self, x: float, y: float) -> tuple[float, float]:
        """Place of a point in the figure [px]; beyond the rectangle it is moved to its border."""
        across, up = (min(1.0, max(0.0, share)) for share in (self.x.share(x), self.y.share(y)))
        return self.left + across * self.width, self.top + (1.0 - up) * self.height

    def axes(self, *, label_x: bool = True, ticks_y: int = 5) -> Markup:
        right = self.left + self.width
        bottom = self.top + self.height
        parts = []

        for value in self.x.ticks(8):
            px = self.point(value, self.y.low)[0]
            parts.append(line((px, self.top), (px, bottom), "var(--line)", 1))
            if label_x:
                parts.append(text(px, bottom + 17, format_tick(value), "middle"))

        for value in self.y.ticks(ticks_y):
            py = self.point(self.x.low, value)[1]
            parts.append(line((self.left, py), (right, py), "var(--line)", 1))
            parts.append(text(self.left - 6, py + 4, format_tick(value), "end"))

        if label_x:
            parts.append(text(self.left + self.width / 2, bottom + 36, self.x.label, "middle"))

        parts.append(text(self.left, self.top - 8, self.y.label))
        return join(parts)

    def line(
        self,
        points: Points,
        colour: str,
        width: float = 1.5,
        dashes: str = "",
    ) -> Markup:
        placed = [self.point(x, y) for x, y in points]
        return element(
            "path",
            d=path(placed),
            fill="none",
            stroke=colour,
            stroke_width=width,
            stroke_dasharray=dashes or None,
            stroke_linejoin="round",
        )

    def band(
        self,
        upper: Sequence[tuple[float, float]],
        lower: Sequence[tuple[float, float]],
        colour: str,
    ) -> Markup:
        """Fill what lies between two lines."""
        placed = [self.point(x, y) for x, y in (*upper, *reversed(lower))]
        return element(
            "path",
            d=path(placed) + "Z",
            fill=colour,
            fill_opacity="0.22",
            stroke="none",
        )

    def span(
        self,
        start: float,
        end: float,
        colour: str,
        opacity: float = 0.18,
    ) -> Markup:
        """Fill a range of x over the whole height."""
        x0, y0 = self.point(start, self.y.high)
        x1, y1 = self.point(end, self.y.low)
        return element(
            "rect",
            x=number(x0),
            y=number(y0),
            width=number(x1 - x0),
            height=number(y1 - y0),
            fill=colour,
            fill_opacity=opacity,
        )


def figure_svg(width: float, height: float, title: str, *parts: str) -> Markup:
    """Build a plot with a title for those who do not see it."""
    return element(
        "svg",
        element("title", title),
        *parts,
        viewBox=f"0 0 {number(width)} {number(height)}",
        role="img",
        width=number(width),
        height=number(height),
        class_="plot",
        font_size="12",
    )


def write_svg(plot: Markup) -> bytes:
    """Write a plot as a file of its own, in the light colours of the page and on its ground."""
    light = read_asset("page.css").partition("@media")[0]
    colours = dict(re.findall(r"(--[\w-]+): ([^;]+);", light))
    ground = element("rect", width="100%", height="100%", fill="var(--ground)")
    whole = plot.replace(
        "<svg ", '<svg xmlns="http://www.w3.org/2000/svg" font-family="sans-serif" ', 1
    )
    whole = whole.replace("</title>", f"</title>{ground}", 1)

    return re.sub(r"var\((--[\w-]+)\)", lambda name: colours[name[1]], whole).encode()


def text(
    x: float,
    y: float,
    content: str,
    anchor: str = "start",
    weight: str = "",
) -> Markup:
    return element(
        "text",
        content,
        x=number(x),
        y=number(y),
        text_anchor=None if anchor == "start" else anchor,
        font_weight=weight or None,
    )


def line(
    start: tuple[float, float],
    end: tuple[float, float],
    colour: str,
    width: float,
    dashes: str = "",
) -> Markup:
    x0, y0 = start
    x1, y1 = end
    return element(
        "line",
        x1=number(x0),
        y1=number(y0),
        x2=number(x1),
        y2=number(y1),
        stroke=colour,
        stroke_width=width,
        stroke_dasharray=dashes or None,
    )


def legend(x: float, y: float, entries: Iterable[tuple[str, str, str]]) -> Markup:
    """List lines with their names in one row: colour, dashes ("band" for a band) and name."""
    parts = []
    for colour, dashes, name in entries:
        if dashes == "band":
            parts.append(
                element(
                    "rect",
                    x=number(x),
                    y=number(y - 9),
                    width=24,
                    height=10,
                    fill=colour,
                    fill_opacity="0.3",
                )
            )
        else:
            parts.append(
                line(
                    (x, y - 4),
                    end=(x + 24, y - 4),
                    colour=colour,
                    width=2,
                    dashes=dashes,
                )
            )

        parts.append(text(x + 30, y, name))
        x += 30 + _CHARACTER * len(name) + 22

    return join(parts)


def path(points: Iterable[tuple[float, float]], places: int = 1) -> str:
    return "M" + "L".join(f"{number(x, places)} {number(y, places)}" for x, y in points)


def number(value: float, places: int = 1) -> str:
    """Format a length to some decimals, which the last bits of a computation do not reach."""
    return f"{round(value, places) + 0.0:.{places}f}".rstrip("0").rstrip(".")


def format_tick(value: float) -> str:
    """Format the value of a tick, in words of thousands above 1000."""
    return f"{value / 1000:g} k" if abs(value) >= 1000 else f"{value:g}"
