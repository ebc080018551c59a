"""Picture of a filling: when the silicone arrives where, with gate, vents, last points and air pockets.

Three maps show the same arrival times: the skin cut open along the middle of the palmar side and unrolled, and the
dorsal and the palmar side as the mold maker sees them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fingertip.arrays import Array
from fingertip.filling.predict import FillingPrediction, Opening, Point3
from fingertip.filling.skin_grid import SkinGrid
from fingertip.filling.surface_links import Layer
from fingertip.plot_style import TEXT_COLOUR, new_figure, to_png

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_BANDS = 12
"""Approximate number of bands between isochrones."""
_COLOURS = "YlGnBu"
_CLOSED_COLOUR = "#b9bec3"


@dataclass(frozen=True)
class _Symbol:
    """Marker of one kind of point, and its entry in the legend."""

    marker: str
    colour: str
    size: float
    legend: str


_GATE = _Symbol("^", "#2e7d5b", 150, "gate: silicone enters")
_VENT = _Symbol("o", "#ffffff", 90, "vent: air leaves")
_LAST = _Symbol("*", "#f2b134", 230, "last point: fills later than all around it")
_AIR = _Symbol("X", "#c0271c", 130, "air pocket: a bubble stays here")


@dataclass(frozen=True)
class _Mark:
    """Point with its symbol and its text."""

    point_mm: Point3
    symbol: _Symbol
    text: str


def draw_filling(
    grid: SkinGrid, prediction: FillingPrediction, gate: Opening, vents: Sequence[Opening], title: str
) -> bytes:
    """Draw a filling as a PNG.

    Raises
    ------
    MissingLibraryError
        If matplotlib is not installed.
    """
    from matplotlib.ticker import MaxNLocator

    figure = new_figure(14.0, 8.2)
    layer, rows = grid.layer, grid.layer.network.shape[0]
    seconds = prediction.arrival_s
    levels = MaxNLocator(_BANDS, steps=[1, 2, 2.5, 5, 10]).tick_values(0.0, prediction.fill_s)
    levels = levels[levels < prediction.fill_s * 1.0001]
    levels = np.append(levels, prediction.fill_s)
    axes = figure.subplots(1, 3, width_ratios=(1.75, 1.0, 1.0))
    marks = _list_marks(prediction, gate, vents)
    filled: Any = None
    for view, its_axes in zip((_unroll(layer), _look(layer, 1), _look(layer, -1)), axes, strict=True):
        values = _grid_values(layer, seconds)[:, view.columns]
        its_axes.set_facecolor("white")
        _draw_closed(its_axes, view, values)
        filled = its_axes.contourf(view.x, view.y, values, levels=levels, cmap=_COLOURS)
        lines = its_axes.contour(view.x, view.y, values, levels=levels[1:-1], colors="#34495e", linewidths=0.7)
        its_axes.clabel(lines, fmt="%g s", fontsize=8, inline_spacing=2)
        border_x = np.concatenate((view.x[0], view.x[1:, -1], view.x[-1, -2::-1], view.x[-2::-1, 0]))
        border_y = np.concatenate((view.y[0], view.y[1:, -1], view.y[-1, -2::-1], view.y[-2::-1, 0]))
        its_axes.plot(border_x, border_y, color=TEXT_COLOUR, linewidth=1.4)
        for mark in marks:
            _draw_mark(its_axes, view, layer, mark)
        _label_axes(its_axes, view)
    bar = figure.colorbar(filled, ax=axes, shrink=0.75, pad=0.015, ticks=levels)
    bar.set_label("time at which the silicone arrives [s]")
    bar.ax.set_yticklabels([*(f"{level:g}" for level in levels[:-1]), f"{levels[-1]:.1f}, full"])
    used = dict.fromkeys(mark.symbol for mark in marks)
    handles = [
        axes[0].scatter([], [], marker=s.marker, color=s.colour, edgecolors="black", s=0.6 * s.size, label=s.legend)
        for s in used
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), frameon=False, fontsize=10)
    figure.suptitle(f"{title}\n{_summarise(prediction)}", fontsize=12)
    return to_png(figure)


def _summarise(prediction: FillingPrediction) -> str:
    pockets = prediction.air_pockets
    air = (
        f"{len(pockets)} air pocket{'s' if len(pockets) > 1 else ''}, the largest {pockets[0].volume_mm3:.0f} mm³"
        if pockets
        else "no air pocket"
    )
    return (
        f"{prediction.volume_mm3 / 1000:.2f} cm³ in {prediction.fill_s:.1f} s at {prediction.pressure_pa / 1000:.0f} "
        f"kPa and {prediction.viscosity_pa_s:g} Pa s; {air}"
    )


def _list_marks(prediction: FillingPrediction, gate: Opening, vents: Sequence[Opening]) -> list[_Mark]:
    marks = [_Mark(gate.point_mm, _GATE, "gate")]
    marks += [_Mark(vent.point_mm, _VENT, "vent") for vent in vents]
    trapped = [air.point_mm for air in prediction.air_pockets]
    marks += [
        _Mark(point.point_mm, _LAST, f"last, {point.arrival_s:.1f} s")
        for point in prediction.last_points
        if point.point_mm not in trapped
    ]
    marks += [
        _Mark(air.point_mm, _AIR, f"air {air.volume_mm3:.0f} mm³,\ntrapped at {air.time_s:.1f} s")
        for air in prediction.air_pockets
    ]
    return marks


@dataclass(frozen=True, eq=False)
class _View:
    """Map of a layer: plane coordinates of the nodes of some columns."""

    title: str
    x: Array
    y: Array
    columns: Any
    ends: tuple[str, str]
    """What lies at the left and at the right."""
    middle: str
    """What lies in the middle."""


def _grid_values(layer: Layer, values: Array) -> Array:
    """Arrange node values by row and column, the pole as a last row."""
    rows, columns = layer.network.shape
    return np.concatenate((values[:-1].reshape(rows, columns), np.full((1, columns), values[-1])))


def _grid_points(layer: Layer) -> Array:
    return np.stack([_grid_values(layer, layer.points_mm[:, k]) for k in range(3)], axis=2)


def _unroll(layer: Layer) -> _View:
    """Unroll the layer around the middle of the dorsal side, with true lengths along each row."""
    columns = layer.network.shape[1]
    quarter = columns // 4
    order = (np.arange(columns + 1) - quarter) % columns  # from the palmar middle over +x, dorsal and -x back to it
    points = _grid_points(layer)[:, order]
    steps = np.linalg.norm(np.diff(points, axis=1), axis=2)
    around = np.concatenate((np.zeros((len(points), 1)), np.cumsum(steps, axis=1)), axis=1)
    around -= around[:, columns // 2][:, None]
    along = np.linalg.norm(np.diff(points, axis=0), axis=2).mean(axis=1)
    height = np.concatenate(([0.0], np.cumsum(along)))
    return _View(
        "Skin cut open along the palm and unrolled", -around, np.broadcast_to(height[:, None], around.shape), order,
        ("palm, −x half", "palm, +x half"), "back of the finger",
    )  # fmt: skip


def _look(layer: Layer, side: int) -> _View:
    """Look at the dorsal (side 1) or palmar side (-1), with the tip up."""
    columns = layer.network.shape[1]
    half = columns // 2
    order = np.arange(half + 1) if side > 0 else np.arange(half, columns + 1) % columns
    points = _grid_points(layer)[:, order]
    title = "Dorsal side (back)" if side > 0 else "Palmar side (pad)"
    ends = ("+x", "−x") if side > 0 else ("−x", "+x")
    return _View(title, -side * points[..., 0], points[..., 2], order, ends, "")


def _draw_closed(axes: Axes, view: _View, values: Array) -> None:
    """Fill what no silicone reaches."""
    if np.isnan(values).any():
        axes.contourf(view.x, view.y, np.zeros_like(values), levels=[-1, 1], colors=[_CLOSED_COLOUR])


def _draw_mark(axes: Axes, view: _View, layer: Layer, mark: _Mark) -> None:
    """Draw a mark in a view that shows its place."""
    points = _grid_points(layer)
    away = ((points - np.array(mark.point_mm)) ** 2).sum(axis=2)
    if away[:, view.columns].min() > away.min() + 1e-9:
        return
    i, j = np.unravel_index(int(np.argmin(away[:, view.columns])), (len(points), len(view.columns)))
    x, y = float(view.x[i, j]), float(view.y[i, j])
    axes.scatter(
        x, y, marker=mark.symbol.marker, s=mark.symbol.size, color=mark.symbol.colour, edgecolors="black", zorder=5,
        clip_on=False,
    )  # fmt: skip
    side = 1 if x <= 0.5 * float(view.x.min() + view.x.max()) else -1
    axes.annotate(
        mark.text, (x, y), (9 * side, 0), textcoords="offset points", ha="left" if side > 0 else "right", va="center",
        fontsize=9, zorder=6, bbox={"boxstyle": "round,pad=0.2", "facecolor": "white", "alpha": 0.85, "linewidth": 0},
    )  # fmt: skip


def _label_axes(axes: Axes, view: _View) -> None:
    axes.set_aspect("equal")
    axes.set_title(view.title, fontsize=11)
    axes.spines[["top", "right", "left", "bottom"]].set_visible(False)
    axes.set_xticks([float(view.x[0].min()), float(view.x[0].max())], view.ends)
    axes.tick_params(length=0)
    axes.set_ylabel("distance from the collar [mm]")
    axes.set_xlabel("collar" + (f"; in the middle: {view.middle}" if view.middle else ""))
