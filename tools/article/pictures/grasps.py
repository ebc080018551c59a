"""Real manipulation with the grip in the loop, over time (the article's figures 16 and 17)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.foundation import display as style
from fingertip.lab.campaign.closed_loop import FIRST_SEED, evaluate_manipulation, run_with_grip
from fingertip.lab.report.plots import NOTE, add_legend
from fingertip.sim.runs.manipulation import ManipulationResult
from fingertip.sim.simulation import Simulation, article_manipulations
from fingertip.slip.detectors.registry import make_detector
from fingertip.slip.plots import draw_bars
from fingertip.slip.traces.truth import intervals
from tools.article.pictures.figure import Figure, Statement

DETECTOR = "analog"
THUMB = 0
REACTION_S = 0.2
"""Longest reaction in the article [s]."""
STEADY_S = 0.5
"""Time ahead of the knock, and at the end, over which forces are averaged [s]."""
FLUCTUATES = 0.05
"""Standard deviation of a force over its mean from which it fluctuates evidently. Assumption."""
_OUTPUTS = ["voltage_v", "force_n", "slip", "closing_m", "sampled_envelope_v"]
_FILES = {"parallelepiped": "article_grasp_power.png", "cylinder": "article_grasp_pinch.png"}


@dataclass(frozen=True, eq=False)
class Grasp:
    """A manipulation, where the thumb's detector is ON, and when the grip was tightened [s]."""

    result: ManipulationResult
    on: NDArray[np.bool_]
    tightened_s: tuple[float, ...]

    @property
    def reaction_s(self) -> float:
        """Time from the first slip after the knock until a finger moves [s]; infinite if none."""
        found_s = evaluate_manipulation(DETECTOR, self.result, ()).reaction_s
        return math.inf if found_s is None else found_s

    @property
    def reports_while_closing(self) -> int:
        """Number of times that the thumb's detector turns ON before the experimenter lets go."""
        begun = self.on & (self.result.time_s < self.result.plan.released_s)
        return len(intervals(self.result.time_s, begun))

    def mean_force_n(self, end_s: float) -> NDArray[np.float64]:
        """Mean force of each finger over the time that ends there [N]."""
        return np.asarray(self._select_force(end_s).mean(axis=1))

    @property
    def fluctuation(self) -> float:
        """Largest standard deviation of a finger's force ahead of the knock, over its mean."""
        force_n = self._select_force(self.result.plan.knock_s)
        return float(np.max(force_n.std(axis=1) / force_n.mean(axis=1)))

    def _select_force(self, end_s: float) -> NDArray[np.float64]:
        time_s = self.result.time_s
        force_n: NDArray[np.float64] = self.result.output("force_n")
        return force_n[:, (time_s > end_s - STEADY_S) & (time_s <= end_s)]


def run_grasp(design: Design, name: str) -> Grasp:
    """Run the first of the article's manipulations of an object."""
    scene, seed = next(pair for pair in article_manipulations(FIRST_SEED) if pair[0].name == name)
    recorded = scene.model_copy(update={"outputs": _OUTPUTS})
    result, tightened_s = run_with_grip(Simulation(design, recorded, seed), DETECTOR)
    envelope_v = result.output("sampled_envelope_v")[THUMB]

    return Grasp(result, make_detector(DETECTOR, design).process(envelope_v).on, tightened_s)


def draw_grasps(design: Design) -> tuple[Figure, Figure]:
    """Draw figures 16 and 17."""
    grasps = {name: run_grasp(design, name) for name in _FILES}
    return _draw_power(grasps), _draw_pinch(grasps)


def _state_reaction(grasp: Grasp) -> Statement:
    return Statement(
        "the slip is followed by a movement of the fingers, within 200 ms",
        f"after {1e3 * grasp.reaction_s:.0f} ms",
        grasp.reaction_s < REACTION_S,
    )


def _compare_forces(grasp: Grasp) -> tuple[str, NDArray[np.float64]]:
    """Describe the forces ahead of the knock and at the end; return their ratio by finger."""
    before_n = grasp.mean_force_n(grasp.result.plan.knock_s)
    after_n = grasp.mean_force_n(grasp.result.duration_s)
    words = f"the thumb's from {before_n[THUMB]:.2f} to {after_n[THUMB]:.2f} N"
    return words, after_n / before_n


def _draw_power(grasps: Mapping[str, Grasp]) -> Figure:
    grasp = grasps["parallelepiped"]
    words, ratios = _compare_forces(grasp)
    statements = (
        _state_reaction(grasp),
        Statement(
            "the force of all fingers grows after the slip",
            f"{words}, each finger's by a factor of {ratios.min():.2f} at least",
            bool(ratios.min() > 1.05),
        ),
        Statement(
            "no false positive",
            f"detections while the hand closes: {grasp.reports_while_closing}",
            grasp.reports_while_closing == 0,
        ),
    )
    return Figure(
        _FILES["parallelepiped"],
        "Fig. 16: real manipulation, parallelepiped, power grasp",
        "Force and closing of each finger, ON of the thumb's detector; dotted: the pin hits.",
        _plot(grasp),
        statements,
    )


def _draw_pinch(grasps: Mapping[str, Grasp]) -> Figure:
    grasp = grasps["cylinder"]
    words, ratios = _compare_forces(grasp)
    reports = grasp.reports_while_closing
    false_grips = sum(at_s < grasp.result.plan.knock_s for at_s in grasp.tightened_s)
    statements = (
        _state_reaction(grasp),
        Statement(
            "a false positive at the contact, which the hand disregards",
            f"detections while the hand closes: {reports}, of which it follows {false_grips}",
            reports > 0 and false_grips == 0,
        ),
        Statement(
            "the slip takes force away, which the controller then corrects",
            f"{words}, a factor of {ratios.min():.2f} at least",
            None if ratios.min() > 1.05 else False,
        ),
        Statement(
            "the force fluctuates evidently, as the contact is small",
            f"its standard deviation before the pin hits is {100 * grasp.fluctuation:.1f} % of its "
            f"mean ({100 * grasps['parallelepiped'].fluctuation:.1f} % in the power grasp)",
            grasp.fluctuation > FLUCTUATES,
        ),
    )
    return Figure(
        _FILES["cylinder"],
        "Fig. 17: real manipulation, cylinder, pinch grasp",
        "Force and closing of each finger, ON of the thumb's detector; dotted: the pin hits.",
        _plot(grasp),
        statements,
    )


def _plot(grasp: Grasp) -> bytes:
    result = grasp.result
    figure = style.new_figure(8, 5)
    force, bars, closing = figure.subplots(3, 1, sharex=True, height_ratios=(1.3, 0.7, 1.2))
    for i, finger in enumerate(result.fingers):
        colour = style.SERIES[i]
        force.plot(
            result.time_s, result.output("force_n")[i], color=colour, linewidth=0.7, label=finger
        )
        closing.plot(
            result.time_s, 1e3 * result.output("closing_m")[i], color=colour, linewidth=1.2
        )

    slip = np.logical_or.reduce(result.output("slip"), axis=0)
    rows = [
        ("true slip", intervals(result.time_s, slip), style.TRUTH),
        ("ON, thumb", intervals(result.time_s, grasp.on), style.BLUE),
    ]
    for axes in (force, bars, closing):
        style.style_axes(axes, "both")
        axes.axvline(result.plan.knock_s, color=style.TEXT_COLOUR, linestyle=":", linewidth=0.9)

    draw_bars(bars, rows)
    bars.tick_params(axis="y", length=0)
    force.set_ylabel("normal\nforce [N]")
    closing.set_ylabel("finger\nclosing [mm]")
    closing.set_xlabel(f"time [s] ({NOTE})")
    closing.set_xlim(float(result.time_s[0]), float(result.time_s[-1]))
    add_legend(force, len(result.fingers))
    figure.align_ylabels()
    return style.to_png(figure)
