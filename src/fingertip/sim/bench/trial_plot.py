"""Plot of the error of whole trials, over the step and over the CPU time."""

from __future__ import annotations

import numpy as np

from fingertip.foundation.plot_style import BLUE, RED, REFERENCE, TEAL, TEXT_COLOUR, new_figure, style_axes, to_png
from fingertip.sim.bench.trial import QUANTITIES, TARGETS, VARIANTS, TrialAccuracy

_STYLES = {"article": (RED, "o"), "precision": (BLUE, "s"), "comparator": (TEAL, "x")}
_LABELS = {"force_n": "normal force [N]", "tactile_v": "tactile voltage [V]", "envelope_v": "envelope [V]"}


def draw_trials(found: TrialAccuracy, footnote: str) -> bytes:
    """Draw two rows of panels, one column for each quantity: largest error over the step, and over the CPU time."""
    figure = new_figure(13, 8)
    panels = figure.subplots(2, len(QUANTITIES), squeeze=False)
    for column, name in enumerate(QUANTITIES):
        over_step, over_time = panels[:, column]
        for variant in VARIANTS:
            points = [p for p in found.points if p.variant == variant]
            errors = [p.errors[name] for p in points]
            colour, marker = _STYLES[variant]
            label = f"{variant}: order {found.order(variant, name):.1f}"
            over_step.loglog([1e6 * p.step_s for p in points], errors, color=colour, marker=marker, label=label)
            over_time.loglog([1e3 * p.cpu_s for p in points], errors, color=colour, marker=marker, label=variant)
        steps = np.array(sorted(1e6 * p.step_s for p in found.points if p.variant == VARIANTS[0]))
        largest = max(p.errors[name] for p in found.points)
        slope = largest * (steps / steps[-1]) ** 2
        over_step.loglog(steps, 2 * slope, color=REFERENCE, linestyle="--", linewidth=1, label="order 2")
        for axes in (over_step, over_time):
            if name in TARGETS:
                axes.axhline(TARGETS[name], color=REFERENCE, linestyle=":", linewidth=1.2)
                axes.annotate(
                    f"target {TARGETS[name]:g}", (0.02, TARGETS[name]), xycoords=("axes fraction", "data"),
                    xytext=(0, 3), textcoords="offset points", fontsize=8, color=TEXT_COLOUR,
                )  # fmt: skip
            axes.set_ylabel("largest error at a sample")
            style_axes(axes, "both")
            axes.xaxis.set_minor_formatter("")
            axes.legend(frameon=False, fontsize=8)
        over_step.set_xticks(steps, [f"{step:g}" for step in steps])
        over_time.set_xticks([20, 50, 100, 200], ["20", "50", "100", "200"])
        over_step.set_title(_LABELS[name], loc="left", fontweight="bold")
        over_step.set_xlabel("step [us]")
        over_time.set_xlabel("CPU time of the whole trial [ms]")
    figure.supxlabel(footnote, x=0.01, ha="left", fontsize=8, color=TEXT_COLOUR)
    return to_png(figure)
