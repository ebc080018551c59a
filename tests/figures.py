"""Description of a figure of matplotlib as text: its words, axes,
lines, areas and marks, in the data's units.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.colors import to_hex


def sum_up(values: Any) -> str:
    """Values, or of many their number, first and last, ends,
    mean, and a mean that tells their order.
    """
    numbers = np.asarray(values, dtype=float).ravel()
    if len(numbers) > 8:
        known = numbers[np.isfinite(numbers)] if np.isfinite(numbers).any() else np.zeros(1)
        order = np.linspace(0.0, 1.0, len(known)) ** 2
        ends = (
            *known[[0, -1]],
            known.min(),
            known.max(),
            known.mean(),
            float((order * known).mean()),
        )
        return f"{len(numbers)} values " + " ".join(f"{value:.4g}" for value in ends)
    return " ".join(f"{value + 0.0:.4g}" for value in numbers)


@contextlib.contextmanager
def keep_figures() -> Iterator[list[Any]]:
    """Keep the figures that would be written, and draw none of them."""
    kept: list[Any] = []

    def keep(canvas: Any, *args: Any, **named: Any) -> None:
        kept.append(canvas.figure)

    def state_labels(axes: Axes, lines: Any, **look: Any) -> tuple[()]:
        axes.set_label(f"isochrones with labels {sorted(look.items())}")
        return ()

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(FigureCanvasAgg, "print_png", keep)
        patch.setattr(FigureCanvasSVG, "print_svg", keep)
        # Where they stand depends on matplotlib and its fonts.
        patch.setattr(Axes, "clabel", state_labels)
        yield kept


def describe_figure(figure: Any) -> Iterator[str]:
    """Every text, line, area and mark of a figure, with its style and its data."""
    yield f"figure {sum_up(figure.get_size_inches())}"
    yield from (_describe_text(text) for text in figure.texts)
    yield from (line for legend in figure.legends for line in _describe_legend(legend))
    for axes in figure.axes:
        if not axes.get_visible():
            continue
        place = axes.get_subplotspec()
        yield (
            f"axes of {sum_up(place.get_position(figure).bounds) if place else 'a bar'} "
            f"{_label(axes)}"
        )
        yield from (
            f"  title {_describe_text(one)}"
            for one in (axes._left_title, axes.title)
            if one.get_text()
        )
        for name in "xy":
            axis = getattr(axes, f"{name}axis")
            limits = getattr(axes, f"get_{name}lim")()
            seen = (
                zip(axis.get_ticklocs(), axis.get_ticklabels(), strict=False)
                if axis.get_visible()
                else ()
            )
            ticks = [tick.get_text() for at, tick in seen if min(limits) <= at <= max(limits)]
            yield (
                f"  {name} {axis.get_label_text()!r} {axis.get_scale()} {sum_up(limits)} ticks "
                f"{' | '.join(ticks)}"
            )
        for line in axes.lines:
            look = (
                f"{to_hex(line.get_color())} {line.get_linestyle()} {line.get_linewidth():g} "
                f"{_describe_layer(line)}"
            )
            look += f" {line.get_marker()} {line.get_markersize():g}"
            yield (
                f"  line {_label(line)} {look} x {sum_up(line.get_xdata())} y "
                f"{sum_up(line.get_ydata())}"
            )
        for mark in axes.collections:
            colours = sorted(
                {to_hex(colour, True) for colour in (*mark.get_facecolor(), *mark.get_edgecolor())}
            )
            corners = np.concatenate(
                [path.vertices for path in mark.get_paths()] or [np.zeros((0, 2))]
            )
            shape = f"of {sum_up(corners)}"
            if hasattr(mark, "levels"):  # a contour, whose number of corners is matplotlib's affair
                shape = (
                    f"levels {sum_up(mark.levels)} within "
                    f"{sum_up([corners.min(axis=0), corners.max(axis=0)])}"
                )
            array = (
                np.ma.masked_all(0)
                if mark.get_array() is None
                else np.ma.asarray(mark.get_array()).astype(float)
            )
            scale = (
                f"{_name(mark.get_cmap())} of {mark.get_cmap().N} from {sum_up(mark.get_clim())}"
                if array.size
                else ""
            )
            values = f" values {sum_up(array.filled(np.nan))} in {scale}" if array.size else ""
            clip = "" if mark.get_clip_on() else "beyond the axes "
            sizes = sum_up(
                [
                    *(mark.get_sizes()[:1] if hasattr(mark, "get_sizes") else ()),
                    *mark.get_linewidths()[:2],
                ]
            )
            clip += f"{sizes} {_describe_layer(mark)} "
            yield (
                f"  area {clip}{_label(mark)} {' '.join(colours[:9])} at "
                f"{sum_up(mark.get_offsets())} {shape}{values}"
            )
        alike: dict[str, list[float]] = {}
        for patch in axes.patches:
            corners = patch.get_path().transformed(patch.get_patch_transform()).vertices
            colours = " ".join(
                to_hex(colour, True) for colour in (patch.get_facecolor(), patch.get_edgecolor())
            )
            look = f"{_label(patch)} {colours} {_describe_layer(patch)} {patch.get_linewidth():g}"
            alike.setdefault(look, []).extend((*corners.min(axis=0), *corners.max(axis=0)))
        yield from (
            f"  {len(ends) // 4} patches {look} {sum_up(ends)}" for look, ends in alike.items()
        )
        for image in axes.images:
            yield (
                f"  image {sum_up(image.get_array())} in {image.get_cmap().name} from "
                f"{sum_up(image.get_clim())}"
            )
        yield from (f"  {_describe_text(text)}" for text in axes.texts)
        if axes.get_legend():
            yield from _describe_legend(axes.get_legend())


def list_words(figures: Iterable[Any]) -> Iterator[str]:
    """Sizes, texts, titles, legends, lines and named axes of figures, those that are alike once."""
    kinds = ("figure", "text '", 'text "', "  title", "  plain legend", "  x '", "  y '", "  line")
    found = dict.fromkeys(line for figure in figures for line in describe_figure(figure))
    return (
        line
        for line in found
        if line.startswith(kinds) and not line.startswith(("  x ''", "  y ''", "text ''"))
    )


def _name(colours: Any) -> str:
    """Name of a colour map; of a list of colours, none, as it depends on the version of
    matplotlib.
    """
    return "colours" if colours.name in ("from_list", "unnamed") else str(colours.name)


def _label(item: Any) -> str:
    """Label of an item; none of those that matplotlib gives by itself."""
    label = str(item.get_label())
    return "" if label.startswith("_") else repr(label)


def _describe_layer(item: Any) -> str:
    """Opacity, and the place among what lies above it."""
    return f"{1.0 if item.get_alpha() is None else item.get_alpha():g} over {item.get_zorder():g}"


def _describe_text(text: Any) -> str:
    beside = sum_up(text.xyann) if hasattr(text, "xyann") and text.xyann else ""
    look = f"{text.get_ha()} {text.get_va()} {text.get_fontsize():g} {to_hex(text.get_color())}"
    look += f" {text.get_rotation():g} {text.get_weight()}"
    return f"text {text.get_text()!r} {sum_up(text.get_position())} {beside} {look}"


def _describe_legend(legend: Any) -> Iterator[str]:
    texts = [f"{text.get_text()} {text.get_fontsize():g}" for text in legend.get_texts()]
    frame = "framed" if legend.get_frame_on() else "plain"
    yield f"  {frame} legend at {legend._loc} of {legend._ncols} columns: {' | '.join(texts)}"
