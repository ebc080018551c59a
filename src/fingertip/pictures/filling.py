"""Picture of a filling: when the silicone arrives where, with gate, vents, last points and air pockets.

Three maps show the same arrival times: the skin cut open along the middle of the palmar side and unrolled, and the
dorsal and the palmar side as the mold maker sees them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fingertip.design import Design
from fingertip.filling.mold_filling import build_grid, gate_opening, list_openings, place_vents, predict_mold_filling
from fingertip.filling.predict import FillingPrediction, Opening, Point3
from fingertip.filling.surface_links import Layer, SkinGrid
from fingertip.foundation.numerics import Array
from fingertip.foundation.plot_style import RED, REFERENCE, TEAL, TEXT_COLOUR, YELLOW, new_figure, to_png

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_BANDS = 12
"""Approximate number of bands between isochrones."""
_COLOURS = "YlGnBu"
_LINE_MM = 1.7
"""Height of a line of text beside a mark, in the picture's mm."""


@dataclass(frozen=True)
class _Symbol:
    marker: str
    colour: str
    size: float
    legend: str


_GATE = _Symbol("^", TEAL, 150, "gate: silicone enters")
_VENT = _Symbol("o", "white", 90, "vent: air leaves")
_LAST = _Symbol("*", YELLOW, 230, "last point: fills later than all around it")
_AIR = _Symbol("X", RED, 130, "air pocket: a bubble stays here")


_Mark = tuple[Point3, _Symbol, str]
"""Place [mm], symbol and text of a mark."""


def draw_mold_filling(design: Design) -> bytes:
    silicone, prediction = design.silicone.material, predict_mold_filling(design)
    how = f"{design.mold.thumb_force_n:g} N on a syringe of {design.mold_layout.inlet.syringe.volume_ml:g} ml"
    filled = f"{prediction.viscosity_pa_s:g} Pa s, {how}: full after {prediction.fill_s:.0f} s"
    title = f"{design.name}: {silicone.label}, {filled}"
    vents = list_openings(place_vents(design))
    return draw_filling(build_grid(design), prediction, gate_opening(design), vents, title)


def draw_filling(
    grid: SkinGrid, prediction: FillingPrediction, gate: Opening, vents: Sequence[Opening], title: str
) -> bytes:
    figure = new_figure(14.0, 7.4)
    levels = _choose_levels(prediction.fill_s)
    views = (_unroll(grid.layer), _look(grid.layer, 1), _look(grid.layer, -1))
    axes = figure.subplots(1, 3, width_ratios=[float(np.ptp(view.x)) for view in views])
    marks = [*_list_marks(prediction, gate, vents)]
    for view, its_axes in zip(views, axes, strict=True):
        filled = _draw_map(its_axes, view, _grid_values(grid.layer, prediction.arrival_s)[:, view.columns], levels)
        _draw_marks(its_axes, view, grid.layer, marks)
        its_axes.set_aspect("equal", anchor="S")
        its_axes.set_title(view.title, fontsize=11, pad=10)
        its_axes.spines[["top", "right", "left", "bottom"]].set_visible(False)
        its_axes.set_xticks([float(view.x[0].min()), float(view.x[0].max())], view.ends)
        its_axes.tick_params(length=0)
        its_axes.tick_params(axis="x", pad=9)
        its_axes.set_ylabel("distance from the collar [mm]")
        its_axes.set_xlabel(view.edge)
    bar = figure.colorbar(filled, ax=axes, shrink=0.8, pad=0.015, ticks=levels)
    bar.set_label("time at which the silicone arrives [s]")
    bar.ax.set_yticklabels([*(f"{level:g}" for level in levels[:-1]), f"{levels[-1]:.1f}, full"])
    handles: list[Any] = [
        axes[0].scatter([], [], marker=s.marker, color=s.colour, edgecolors="black", s=0.6 * s.size, label=s.legend)
        for s in dict.fromkeys(symbol for _, symbol, _ in marks)
    ]
    if np.isnan(prediction.arrival_s).any():
        handles.append(
            axes[0].scatter([], [], marker="s", color=REFERENCE, s=110, label="no silicone: insert and mold touch")
        )
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), frameon=False, fontsize=10)
    figure.suptitle(f"{title}\n", x=0.01, ha="left", fontweight="bold", fontsize=13)  # the second line is the summary
    figure.text(0.01, 0.935, _summarise(prediction), fontsize=10.5, color=TEXT_COLOUR)
    return to_png(figure)


def _choose_levels(fill_s: float) -> Array:
    """Choose the times of the isochrones: round numbers, and the end."""
    from matplotlib.ticker import MaxNLocator  # noqa: PLC0415

    levels = np.array(MaxNLocator(_BANDS, steps=[1, 2, 2.5, 5, 10]).tick_values(0.0, fill_s))
    rounded = levels[levels < fill_s - 0.25 * (levels[1] - levels[0])]
    return np.append(rounded, fill_s)


def _summarise(prediction: FillingPrediction) -> str:
    pockets = prediction.air_pockets
    air = "no air pocket"
    if pockets:
        air = f"{len(pockets)} air pocket{'s' if len(pockets) > 1 else ''}, the largest {pockets[0].volume_mm3:.0f} mm³"
    return (
        f"{prediction.volume_mm3 / 1000:.2f} cm³ in {prediction.fill_s:.1f} s at {prediction.pressure_pa / 1000:.0f} "
        f"kPa and {prediction.viscosity_pa_s:g} Pa s; {air}"
    )


def _list_marks(prediction: FillingPrediction, gate: Opening, vents: Sequence[Opening]) -> Iterator[_Mark]:
    yield gate.point_mm, _GATE, "gate"
    yield from ((vent.point_mm, _VENT, "vent") for vent in vents)
    trapped = [air.point_mm for air in prediction.air_pockets]
    for point in prediction.last_points:
        if point.point_mm not in trapped:
            yield point.point_mm, _LAST, f"last, {point.arrival_s:.1f} s"
    for air in prediction.air_pockets:
        yield air.point_mm, _AIR, f"air {air.volume_mm3:.0f} mm³,\ntrapped at {air.time_s:.1f} s"


@dataclass(frozen=True, eq=False)
class _View:
    """Map of a layer: plane coordinates of the nodes of some columns."""

    title: str
    x: Array
    y: Array
    columns: Any
    ends: tuple[str, str]
    edge: str


def _grid_values(layer: Layer, values: Array) -> Array:
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
        "Skin cut open along the palm and unrolled", around, np.broadcast_to(height[:, None], around.shape), order,
        ("palm, +x half", "palm, −x half"), "collar, in the middle of the back",
    )  # fmt: skip


def _look(layer: Layer, side: int) -> _View:
    """Look at the dorsal (side 1) or palmar side (-1), with the tip up."""
    columns = layer.network.shape[1]
    half = columns // 2
    order = np.arange(half + 1) if side > 0 else np.arange(half, columns + 1) % columns
    points = _grid_points(layer)[:, order]
    title = "Dorsal side (back)" if side > 0 else "Palmar side (pad)"
    ends = ("+x", "−x") if side > 0 else ("−x", "+x")
    return _View(title, -side * points[..., 0], points[..., 2], order, ends, "collar")


def _draw_map(axes: Axes, view: _View, seconds: Array, levels: Array) -> Any:
    from matplotlib.patheffects import withStroke  # noqa: PLC0415

    if np.isnan(seconds).any():
        axes.contourf(view.x, view.y, np.zeros_like(seconds), levels=[-1, 1], colors=[REFERENCE])
    filled = axes.contourf(view.x, view.y, seconds, levels=levels, cmap=_COLOURS)
    lines = axes.contour(view.x, view.y, seconds, levels=levels[1:-1], colors=TEXT_COLOUR, linewidths=0.7)
    for label in axes.clabel(lines, fmt="%g s", fontsize=8.5, inline_spacing=1, colors="black"):
        label.set_path_effects([withStroke(linewidth=2.5, foreground="white")])
    border = [np.concatenate((v[0], v[1:, -1], v[-1, -2::-1], v[-2::-1, 0])) for v in (view.x, view.y)]
    axes.plot(*border, color=TEXT_COLOUR, linewidth=1.4)
    return filled


def _draw_marks(axes: Axes, view: _View, layer: Layer, marks: Sequence[_Mark]) -> None:
    """Draw the marks whose place a view shows. Their texts stand beside them, and move up where two would overlap."""
    points = _grid_points(layer)
    width, middle = float(np.ptp(view.x)), 0.5 * float(view.x.min() + view.x.max())
    placed: list[tuple[float, int, float, _Symbol, str]] = []
    for point, symbol, text in marks:
        away = ((points - np.array(point)) ** 2).sum(axis=2)
        if away[:, view.columns].min() > away.min() + 1e-9:
            continue
        i, j = np.unravel_index(int(np.argmin(away[:, view.columns])), (len(points), len(view.columns)))
        x, y = float(view.x[i, j]), float(view.y[i, j])
        outwards = 1 if x >= middle else -1
        placed.append((y, outwards if abs(x - middle) < 0.3 * width else -outwards, x, symbol, text))
    taken = {1: -np.inf, -1: -np.inf}
    for y, side, x, s, text in sorted(placed, key=lambda item: item[0]):
        axes.scatter(x, y, marker=s.marker, s=s.size, color=s.colour, edgecolors="black", zorder=6, clip_on=False)
        half = _LINE_MM * (1 + text.count("\n")) / 2
        text_y = max(y, taken[side] + half)
        taken[side] = text_y + half
        axes.annotate(
            text, (x, y), (x + side * 1.1, text_y), ha="left" if side > 0 else "right", va="center", fontsize=9,
            zorder=5, bbox={"boxstyle": "round,pad=0.15", "facecolor": "white", "alpha": 0.85, "linewidth": 0},
            arrowprops={"arrowstyle": "-", "color": "black", "linewidth": 0.8} if text_y > y + 0.1 else None,
        )  # fmt: skip
