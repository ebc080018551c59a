"""What a figure of matplotlib shows, as text: its words, its axes, and where its lines and areas lie."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip.foundation import plot_style
from tests.tools import require_module

MOST_POINTS = 12
"""Number of points up to which a line is described by all of them."""


def collect_figures(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Collect figures in place of pictures."""
    require_module("matplotlib")
    figures: list[Any] = []

    def keep(figure: Any) -> bytes:
        figures.append(figure)
        return b""

    monkeypatch.setattr(plot_style, "to_png", keep)
    return figures


def describe_figure(figure: Any) -> Iterator[str]:
    """Yield a line for each axes, and one for each thing that is drawn in it."""
    yield f"figure {figure.get_size_inches()} {_say(figure._suptitle)}".rstrip()
    for legend in figure.legends:
        yield f"  legend: {[text.get_text() for text in legend.get_texts()]}"
    for axes in figure.axes:
        if not axes.get_visible():
            yield "  hidden axes"
            continue
        yield f"  axes {axes.get_title(loc='left')!r}"
        for axis, scale, ends in ((axes.xaxis, axes.get_xscale(), axes.get_xlim()),
                                  (axes.yaxis, axes.get_yscale(), axes.get_ylim())):  # fmt: skip
            named = [text.get_text() for text in axis.get_ticklabels()] if _has_names(axis) else ""
            yield f"    {axis.axis_name}: {axis.get_label_text()!r} {scale} {_numbers(ends)} {named}".rstrip()
        for artist in axes.get_children():
            if described := _describe(artist, axes):
                yield f"    {described}"


def _describe(artist: Any, axes: Any) -> str:
    from matplotlib import collections, colors, legend, lines, patches, spines, text

    if isinstance(artist, lines.Line2D):
        x, y = (np.asarray(data, dtype=float) for data in artist.get_data())
        style = (colors.to_hex(artist.get_color()), artist.get_linestyle(), artist.get_marker())
        return f"line {_name(artist)} {style}: {_series(x)}; {_series(y)}"
    if isinstance(artist, patches.Patch) and artist is not axes.patch and not isinstance(artist, spines.Spine):
        box = artist.get_path().transformed(artist.get_patch_transform()).get_extents()
        return f"area {_name(artist)} {colors.to_hex(artist.get_facecolor())}: {_numbers(box.extents)}"
    if isinstance(artist, collections.PolyCollection | collections.LineCollection):
        boxes = [_numbers(path.get_extents().extents) for path in artist.get_paths()]
        return f"areas {[colors.to_hex(c) for c in artist.get_edgecolor()[:1]]}: {' '.join(boxes)}"
    if isinstance(artist, text.Annotation):
        return f"note {artist.get_text()!r} at {_numbers(artist.xy)} from {_numbers(artist.get_position())}"
    if isinstance(artist, legend.Legend):
        return f"legend: {[one.get_text() for one in artist.get_texts()]}"
    return (
        f"text {artist.get_text()!r}"
        if isinstance(artist, text.Text) and artist.get_text() not in _titles(axes)
        else ""
    )


def _has_names(axis: Any) -> bool:
    return type(axis.get_major_formatter()).__name__ == "FixedFormatter"


def _titles(axes: Any) -> set[str]:
    return {"", *(axes.get_title(loc=where) for where in ("left", "center", "right"))}


def _name(artist: Any) -> str:
    label = str(artist.get_label())
    return "" if label.startswith("_") else repr(label)


def _say(text: Any) -> str:
    return repr(text.get_text()) if text else ""


def _numbers(values: Any) -> str:
    return "[" + " ".join(f"{value if abs(value) > 1e-10 else 0:.5g}" for value in values) + "]"


def _series(values: np.ndarray) -> str:
    """All values of a short line; number, ends, extremes and mean of a long one."""
    if len(values) <= MOST_POINTS:
        return _numbers(values)
    few = (values[0], values[-1], np.nanmin(values), np.nanmax(values), np.nanmean(values))
    return f"{len(values)} points {_numbers(few)}"


def assert_approved(path: Path, text: str) -> None:
    """Compare a text with a file; `FINGERTIP_APPROVE=1` writes the file."""
    if os.environ.get("FINGERTIP_APPROVE"):
        path.write_text(text, encoding="utf-8")
    assert text == path.read_text(encoding="utf-8")
