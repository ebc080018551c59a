"""Plot of a simulation: a panel for each recorded output, with slips and events marked."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation.display import SERIES, TEXT_COLOUR, TRUTH, new_figure, style_axes, to_png
from fingertip.sim.runs.manipulation import ManipulationResult
from fingertip.sim.runs.scene import SceneResult
from fingertip.sim.signal.parameters import OUTPUTS
from fingertip.sim.simulation_summary import has_event, name_event
from fingertip.slip.plots import draw_bars
from fingertip.slip.traces.truth import intervals

AnyArray = NDArray[Any]


def draw(result: SceneResult | ManipulationResult, title: str) -> bytes:
    """Plot the outputs over a common time axis. Shading marks true slip."""
    names = result.scene.outputs
    fingers = result.fingers if isinstance(result, ManipulationResult) else ("",)
    ratios = [0.25 + 0.15 * len(fingers) if name == "slip" else 1.0 for name in names]
    figure = new_figure(10, 1.4 + 1.9 * sum(ratios))
    panels = figure.subplots(len(names), 1, sharex=True, squeeze=False, height_ratios=ratios)[:, 0]
    figure.suptitle(
        title,
        x=0.01,
        ha="left",
        fontweight="bold",
        fontsize=12,
    )

    for axes, name in zip(panels, names, strict=True):
        signal = (
            result.output(name) if isinstance(result, ManipulationResult) else result.columns[name]
        )
        rows = signal if signal.ndim == 2 else signal[None, :]
        style_axes(axes, "both")
        output = OUTPUTS[name]

        if name == "slip":
            slips = (intervals(result.time_s, row.astype(np.bool_)) for row in rows)
            draw_bars(
                axes,
                [
                    (finger or "true slip", slip, TRUTH)
                    for finger, slip in zip(fingers, slips, strict=True)
                ],
            )
            axes.tick_params(axis="y", length=0)
            if len(rows) > 1:
                axes.set_ylabel("true slip")
        else:
            slip = result.columns.get("slip")
            for part in () if slip is None else intervals(result.time_s, slip.astype(np.bool_)):
                axes.axvspan(part.onset_s, part.end_s, color=TRUTH, alpha=0.25, linewidth=0)

            for i, row in enumerate(rows):
                axes.plot(
                    result.time_s,
                    output.factor * row,
                    color=SERIES[i % len(SERIES)],
                    linewidth=0.8,
                    zorder=3 - 0.1 * i,
                )

            axes.set_ylabel(output.label)

    if isinstance(result, ManipulationResult):
        _add_legend(panels, names, fingers)
        _mark_events(panels, result)

    panels[-1].set_xlabel("time [s]")
    panels[-1].set_xlim(float(result.time_s[0]), float(result.time_s[-1]))
    figure.align_ylabels()
    return to_png(figure)


def _add_legend(panels: AnyArray, names: list[str], fingers: tuple[str, ...]) -> None:
    for axes, name in zip(panels, names, strict=True):
        if name not in ("slip", "object_m", "pin_n"):
            frame: dict[str, Any] = {"loc": "upper left", "framealpha": 1.0, "edgecolor": "none"}
            axes.legend(axes.get_lines(), fingers, ncols=len(fingers), fontsize=9, **frame)
            low, high = axes.get_ylim()
            axes.set_ylim(low, high + 0.2 * (high - low))
            return


def _mark_events(panels: AnyArray, result: ManipulationResult) -> None:
    events = [("let go", result.plan.released_s - result.scene.grasp.let_go_s)]
    if has_event(result):
        events.append((name_event(result), result.plan.knock_s))
    if result.lost_s is not None:
        events.append(("lost", result.lost_s))

    for label, time_s in events:
        for axes in panels:
            axes.axvline(time_s, color=TEXT_COLOUR, linewidth=0.9, linestyle=":")

        panels[0].annotate(
            label,
            (time_s, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(0, 3),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=9,
            color=TEXT_COLOUR,
        )
