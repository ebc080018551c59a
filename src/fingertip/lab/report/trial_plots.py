"""Plots of single trials and manipulations like the article's.

One trial with all its signals (figure 9), one for each surface (figure 12) and grasped object (figure 13), and
manipulations in the closed loop (figures 16 and 17).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.foundation import display as style
from fingertip.lab.campaign.closed_loop import NO_CONTROL, ClosedLoopTrial, any_finger_slips
from fingertip.lab.campaign.plan import HELD_OUT_FROM, Case
from fingertip.lab.campaign.run import scene_surface, simulate_trace
from fingertip.lab.report.plots import COLOURS, NOTE, OTHER_COLOUR, add_legend
from fingertip.sim import SceneFile
from fingertip.sim.runs.scene import SceneRun
from fingertip.sim.simulation import article_trials
from fingertip.slip.detectors.analog_and_digital import ChainSettings, SlipChain
from fingertip.slip.detectors.registry import make_detector, select_inputs
from fingertip.slip.report import draw_bars, shade_encoder_band
from fingertip.slip.traces.trace import Trace
from fingertip.slip.traces.truth import intervals

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_VOLTAGE, _ENVELOPE, _FORCE = style.BLUE, style.ORANGE, style.TEXT_COLOUR
_FINGERS = dict(zip(("thumb", "index", "middle", "ring", "little"), style.SERIES, strict=True))
DETECTORS_SHOWN = ("analog", "digital", "fast")
CLOSED_LOOP_PLOTS = {"closed_loop_power.png": "parallelepiped", "closed_loop_pinch.png": "cylinder"}
"""File -> object, as in the article's figures 16 and 17; `select_pair` may take another one of the same grasp."""


@dataclass(frozen=True, eq=False)
class ExampleTrial:
    """One trial of a surface or an object."""

    label: str
    speed_m_s: float
    trace: Trace
    force_n: float

    @property
    def title(self) -> str:
        return f"{self.label}, {100 * self.speed_m_s:g} cm/s, {self.force_n:.2f} N"


def simulate_examples(design: Design) -> list[ExampleTrial]:
    """Simulate one trial of each surface and grasped object; the speeds alternate."""
    scenes: dict[tuple[str, float], SceneFile] = {}
    for scene, _ in article_trials():
        scenes.setdefault((scene_surface(scene), scene.slide.speed_m_s), scene)
    labels = list(dict.fromkeys(label for label, _ in scenes))
    speeds = sorted({speed for _, speed in scenes})
    examples = []
    for i, label in enumerate(labels):
        speed = speeds[i % len(speeds)]
        case = Case("slip", scenes[(label, speed)], HELD_OUT_FROM + i)
        trace = simulate_trace(design, case, DETECTORS_SHOWN)
        examples.append(ExampleTrial(label, speed, trace, SceneRun(design, case.scene, case.seed).force_n))
    return examples


def plot_trials(design: Design) -> dict[str, bytes]:
    """Plot the examples; returns file name -> PNG."""
    examples = simulate_examples(design)
    objects = [example for example in examples if example.label.startswith("object")]
    surfaces = [example for example in examples if example not in objects]
    wood = next(example for example in examples if example.label == "wood")  # its slip is visible without magnification
    return {
        "trial.png": plot_signals(design, wood),
        "trials_surfaces.png": plot_panels(design, surfaces),
        "trials_objects.png": plot_panels(design, objects),
    }


def plot_signals(design: Design, example: ExampleTrial) -> bytes:
    """Plot force, voltage, the board's output and each detector's ON of one trial, as figure 9; returns a PNG."""
    figure = style.new_figure(10, 9)
    force, voltage, envelope, on = figure.subplots(4, 1, sharex=True, height_ratios=(2, 2, 2, 1.3))
    trace = example.trace
    t = trace.time_s
    force.plot(t, trace.force_n, color=_FORCE, linewidth=0.8)
    force.set_ylabel("normal force [N]")
    voltage.plot(t, trace.voltage_v, color=_VOLTAGE, linewidth=0.7)
    voltage.set_ylabel("tactile voltage [V]")
    mean_mv = 1000 * make_detector("digital", design).process(trace.voltage_v).statistic_v
    threshold_mv = 1000 * design.detector.threshold_v
    (sampled,) = select_inputs(trace, "analog")
    envelope.plot(t, 1000 * sampled, color=_ENVELOPE, linewidth=0.7, label=f"board's output ({design.board.variant})")
    envelope.plot(t, mean_mv, color=COLOURS["digital"], linewidth=1.2, label="digital, mean over the window")
    label = f"threshold {threshold_mv:g} mV"
    envelope.axhline(threshold_mv, color="black", linestyle="--", linewidth=1, label=label)
    highest = max(float(np.max(mean_mv)), threshold_mv, float(np.quantile(1000 * sampled, 0.999)))
    envelope.set_ylim(0, 1.35 * highest)
    envelope.set_ylabel("envelope [mV]")
    flags = {name: make_detector(name, design).process(*select_inputs(trace, name)).on for name in DETECTORS_SHOWN}
    draw_flags(on, trace, flags)
    for axes in (force, voltage, envelope):
        shade(axes, trace)
        style.style_axes(axes)
    touching = np.flatnonzero(np.asarray(trace.force_n) > 0.0)
    for axes in (force, voltage, envelope, on):
        for at in (touching[0], touching[-1]) if touching.size else ():
            axes.axvline(float(t[at]), color=style.REFERENCE, linestyle="--", linewidth=1)
    title = f"{example.title}; grey dashes: contact and release; shaded: slip ({NOTE})"
    force.set_title(title, loc="left", fontsize=10)
    on.set(xlabel="time [s]", xlim=(float(t[0]), float(t[-1])))
    add_legend(envelope, 2, "left")
    figure.align_ylabels()
    return style.to_png(figure)


def plot_panels(design: Design, examples: Sequence[ExampleTrial]) -> bytes:
    """Plot voltage, envelope and ON of the digital chain, one panel per trial, as figures 12 and 13; returns a PNG."""
    columns = 2
    count = -(-len(examples) // columns)
    figure = style.new_figure(11.5, 2.8 * count + 0.4)
    grid = figure.subplots(count, columns, squeeze=False)
    for example, axes in zip(examples, grid.flat, strict=False):
        t, trace = example.trace.time_s, example.trace
        axes.plot(t, trace.voltage_v, color=_VOLTAGE, linewidth=0.6)
        low, high = float(np.min(trace.voltage_v)), float(np.max(trace.voltage_v))
        span = high - low
        axes.set_ylim(low - 1.1 * span, high + 0.45 * span)  # the voltage above, the envelope below
        axes.set_ylabel("tactile voltage [V]", color=_VOLTAGE)
        chain = SlipChain(ChainSettings.from_design(design)).process(trace.voltage_v)
        twin = axes.twinx()
        twin.plot(t, 1000 * chain.envelope_v, color=_ENVELOPE, linewidth=0.6)
        twin.axhline(1000 * design.detector.threshold_v, color="black", linestyle="--", linewidth=0.7)
        slipping = chain.envelope_v[np.asarray(trace.slip)]
        twin.set_ylim(0, 2600 * max(0.04, float(np.max(slipping, initial=0.0))))
        twin.set_ylabel("envelope [mV]", color=_ENVELOPE)
        twin.spines["top"].set_visible(False)
        shade(axes, trace)
        spans = [(i.onset_s, i.end_s - i.onset_s) for i in intervals(t, chain.on)]
        axes.broken_barh(spans, (high + 0.1 * span, 0.1 * span), color=COLOURS["digital"], linewidth=0)
        axes.text(0.005, 0.985, "ON", color=COLOURS["digital"], fontsize=9, va="top", transform=axes.transAxes)
        axes.set_title(example.title, loc="left", fontsize=10)
        axes.set_xlim(float(t[0]), float(t[-1]))
        style.style_axes(axes)
    for axes in list(grid.flat)[len(examples) :]:
        axes.set_visible(False)
    figure.legend(*grid.flat[0].get_legend_handles_labels(), loc="outside upper right", frameon=False, fontsize=9)
    for axes in grid[-1]:
        axes.set_xlabel(f"time [s]; shaded: slip; digital chain ({NOTE})", fontsize=9)
    return style.to_png(figure)


def plot_closed_loop(trials: Sequence[ClosedLoopTrial], detector: str) -> dict[str, bytes]:
    """Plot a manipulation for each of `CLOSED_LOOP_PLOTS`, with and without control; returns name -> PNG."""
    pairs = {name: select_pair(trials, detector, shown) for name, shown in CLOSED_LOOP_PLOTS.items()}
    return {name: plot_manipulation(*pair) for name, pair in pairs.items() if pair}


def select_pair(
    trials: Sequence[ClosedLoopTrial], detector: str, shown: str
) -> tuple[ClosedLoopTrial, ClosedLoopTrial] | None:
    """Select the same manipulation with and without control, of an object or of another in the same grasp.

    The first one is taken that is held with control and lost without: otherwise nothing is seen of what the detector
    does. If there is none, it is the object's first manipulation; None if it has none with both.
    """
    without = {(trial.name, trial.seed): trial for trial in trials if trial.detector == NO_CONTROL}
    pairs = [
        (trial, without[trial.name, trial.seed])
        for trial in trials
        if trial.detector == detector and (trial.name, trial.seed) in without
    ]
    own = [pair for pair in pairs if pair[0].name == shown]
    if not own:
        return None
    grasp = own[0][0].manipulation.scene.grasp.kind
    others = [pair for pair in pairs if pair[0].name != shown and pair[0].manipulation.scene.grasp.kind == grasp]
    return next((pair for pair in (*own, *others) if pair[0].held and not pair[1].held), own[0])


def plot_manipulation(trial: ClosedLoopTrial, uncontrolled: ClosedLoopTrial) -> bytes:
    """Plot forces, detections, closing of the fingers and displacement of the object; returns a PNG."""
    figure = style.new_figure(10, 9)
    panels = figure.subplots(4, 1, sharex=True, height_ratios=(2.2, 0.9, 2.2, 1.4))
    force, detections, closing, displacement = panels
    manipulation = trial.manipulation
    t = manipulation.time_s
    for i, finger in enumerate(manipulation.fingers):
        color = _FINGERS[finger]
        force.plot(t, manipulation.output("force_n")[i], color=color, linewidth=0.8, label=finger)
        closing.plot(t, 1000 * manipulation.signals.closing_m[i], color=color, linewidth=1.1, label=finger)
    force.set_ylabel("normal force [N]")
    add_legend(force, 5)
    closing.set_ylabel("closing [mm]")
    # Show the last millimetres, in which the hand reacts: the initial closing is the same in all manipulations.
    closed = np.searchsorted(t, manipulation.plan.closed_s)
    low = 1000 * float(min(signal[closed] for signal in manipulation.signals.closing_m))
    closing.set_ylim(bottom=max(0.0, 0.85 * low))
    flags = np.array([(decision.detected, decision.suppressed) for decision in trial.decisions], dtype=np.bool_)
    periods = np.array([decision.time_s for decision in trial.decisions])
    rows = (
        ("used", intervals(periods, flags[:, 0] & ~flags[:, 1]), COLOURS.get(trial.detector, OTHER_COLOUR)),
        ("suppressed", intervals(periods, flags[:, 0] & flags[:, 1]), style.REFERENCE),
        ("true slip", intervals(t, any_finger_slips(manipulation)), style.TRUTH),
    )
    draw_bars(detections, rows, 0.01)
    detections.set_ylabel(f"detections\nof {trial.detector}")
    for decision in trial.decisions:
        if decision.tightened:
            for axes in panels:
                axes.axvline(decision.time_s, color=style.TEXT_COLOUR, linestyle=":", linewidth=1)
    displacement.plot(t, 1000 * manipulation.signals.object_m, color=style.BLUE, label="with control")
    other = uncontrolled.manipulation
    label = f"without control: {'held too' if uncontrolled.held else 'lost'}"
    displacement.plot(other.time_s, 1000 * other.signals.object_m, color=style.REFERENCE, label=label)
    displacement.set_ylabel("object [mm]")
    displacement.set_xlabel(f"time [s]; dotted: grip tightened ({NOTE})")
    add_legend(displacement, 2, "left", 0.0)
    for axes in panels:
        style.style_axes(axes)
    displacement.set_xlim(float(t[0]), float(t[-1]))
    reaction = "no reaction" if trial.reaction_s is None else f"reaction {1000 * trial.reaction_s:.0f} ms"
    held = "held" if trial.held else "lost"
    scene = manipulation.scene
    grasp = f"{scene.grasp.kind} grasp of {trial.name.replace('_', ' ')}, {1000 * scene.object.mass_kg:g} g"
    figure.suptitle(f"{grasp}, {trial.detector} in the loop: {held}, {reaction}", x=0.01, ha="left", fontsize=10)
    figure.align_ylabels()
    return style.to_png(figure)


def draw_flags(axes: Axes, trace: Trace, flags: Mapping[str, NDArray[np.bool_]]) -> None:
    """Draw one row of ON intervals per name, the true slip last."""
    assert trace.slip is not None
    rows = [(name, intervals(trace.time_s, on), COLOURS.get(name, style.BLUE)) for name, on in flags.items()]
    draw_bars(axes, [*rows, ("true slip", intervals(trace.time_s, trace.slip), style.TRUTH)], 0.004)
    style.style_axes(axes, "x")


def shade(axes: Axes, trace: Trace) -> None:
    """Shade true slip, and the readings of the encoders that show the motion first."""
    assert trace.slip is not None
    for slip in intervals(trace.time_s, trace.slip):
        axes.axvspan(slip.onset_s, slip.end_s, color=style.TRUTH, alpha=0.25, linewidth=0)
    if trace.origin.motion_s is not None:
        shade_encoder_band(axes, trace.origin.motion_s)
