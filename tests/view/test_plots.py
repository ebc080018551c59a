"""Plots of every command, drawn from small data that stand here: the figures are compared whole with approved ones.

An approved figure lists its lines, areas, marks and texts with their data, scales and styles. Where a number in it
follows from the data, it was compared with them when it was approved.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fingertip.board.analysis.tolerance import ResponseBand, compute_response_band, draw_response
from fingertip.design import Design
from fingertip.lab.campaign.closed_loop import NO_CONTROL
from fingertip.lab.campaign.plan import CampaignPlan, Case, generate_cases
from fingertip.lab.campaign.run import CampaignResult, DetectorResult, TrialResult
from fingertip.lab.report import plots, trial_plots
from fingertip.lab.report.trial_plots import ExampleTrial
from fingertip.sim import report as sim_report
from fingertip.sim.runs.grip import GripDecision
from fingertip.sim.runs.manipulation import ManipulationResult
from fingertip.slip import report as slip_report
from fingertip.slip.detection import detect
from fingertip.slip.traces.trace import Trace
from fingertip.slip.traces.truth import Origin
from fingertip.sweep.report import plots as sweep_plots
from fingertip.sweep.report.feasibility_plot import draw_feasibility
from fingertip.sweep.report.statistics import AxisSensitivity, OutputSensitivity, PointClasses
from fingertip.sweep.report.summary import Objective
from tests.approved import check_figures
from tests.figures import describe_figure, keep_figures
from tests.slip.recordings import burst
from tests.tools import require_module
from tools.article import plots as study_plots
from tools.article.protocol import Spectrum, WindowResult

APPROVED = Path(__file__).parent / "approved"
DESIGN = Design(board={"variant": "precision"})
PLOTS: dict[str, Callable[[], Any]] = {}


def plot(function: Callable[[], Any]) -> Callable[[], Any]:
    PLOTS[function.__name__] = function
    return function


# Campaigns


def make_trial(case: Case, delays_s: tuple[float, ...], alarms: tuple[str, ...] = ()) -> TrialResult:
    return TrialResult(case, 30.0, 1 if case.cause == "slip" else 0, delays_s, 0.9, alarms, 0.004, 1.0)


def make_results(slower_s: float, alarms: int) -> DetectorResult:
    cases = list(generate_cases(CampaignPlan(8, 0.5)))
    slides = [case for case in cases if case.cause == "slip"]
    delays_s = [(0.008 * i + slower_s,) if i != 3 else () for i in range(len(slides))]
    trials = [make_trial(case, delay_s, ("contact",) * (i < alarms)) for i, (case, delay_s) in
              enumerate(zip(slides, delays_s, strict=True))]  # fmt: skip
    return DetectorResult(1.0 + 100.0 * slower_s, tuple(trials))


def make_campaign() -> CampaignResult:
    found = {
        "digital": tuple(make_results(slower_s, alarms) for slower_s, alarms in ((0.0, 3), (0.002, 1), (0.01, 0))),
        "other": (make_results(0.0, 0),),
    }
    return CampaignResult(CampaignPlan(8, 0.5), 1, found)


@plot
def campaign() -> None:
    plots.plot_delays(make_campaign())
    plots.plot_surfaces(make_campaign(), "digital")
    plots.plot_comparison(make_campaign())
    rows = [(0.01, 0.012, 0.02, 9.0), (0.03, 0.02, 0.04, 1.0), (0.06, 0.035, math.inf, 0.0)]
    study_plots.plot_windows([WindowResult(w, 0.01, 0.9, median, p90, rate) for w, median, p90, rate in rows])
    hz = np.linspace(0.0, 500.0, 51)
    study_plots.plot_spectra([Spectrum("fsr", hz, 1e-8 / (1.0 + hz)), Spectrum("other", hz, 1e-9 * (1.0 + hz))])


# Traces


def make_trace() -> Trace:
    """One second with slip from 0.5 to 0.7 s, contact at 0.1 s and release at 0.9 s."""
    time_s, voltage_v = burst()
    force_n = np.where((time_s >= 0.1) & (time_s < 0.9), 1.5, 0.0)
    envelope_v = np.where((time_s >= 0.51) & (time_s < 0.71), 0.052, 0.002)
    slip = (time_s >= 0.5) & (time_s < 0.7)
    return Trace(time_s, voltage_v, force_n, slip, envelope_v, 0.1 * envelope_v, Origin(True, 0.48))


def make_example(label: str) -> ExampleTrial:
    return ExampleTrial(label, 0.03, make_trace(), 1.234)


@plot
def trials() -> None:
    examples = [make_example(label) for label in ("smooth", "wood", "object, paper")]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(trial_plots, "simulate_examples", lambda design: examples)
        trial_plots.plot_trials(DESIGN)
        study_plots.plot_window_rows(DESIGN, study_plots.find_contact_alarm(DESIGN, examples))


@plot
def detection() -> None:
    slip_report.draw_trace(make_trace())
    slip_report.draw(make_trace(), detect(make_trace(), DESIGN, detector="digital"), "title")
    time_s, voltage_v = burst()
    unknown = Trace(time_s, voltage_v)
    slip_report.draw(unknown, detect(unknown, DESIGN), "true slip is unknown")


# Simulations


@plot
def scene() -> None:
    found = make_trace()
    columns = {"voltage_v": found.voltage_v, "velocity_m_s": np.where(found.slip, 0.01, 0.0), "slip": found.slip}
    result: Any = SimpleNamespace(scene=SimpleNamespace(outputs=[*columns]), columns=columns, time_s=found.time_s)
    sim_report.draw(result, "scene")


def make_manipulation(lost_s: float | None) -> ManipulationResult:
    """Thumb and index hold an object that slips from 0.5 s on."""
    t = np.arange(400) / 400.0
    two, slip = np.array([[1.0], [0.7]]), (t >= 0.5) & (t < (0.6 if lost_s is None else 0.9))
    signals: dict[str, Any] = {
        "force_n": two * (1.0 + (t > 0.55)), "closing_m": two * np.minimum(0.02, 0.1 * t),
        "slip": np.array([slip, ~slip]), "object_m": 0.01 * np.cumsum(slip) / 400.0,
    }  # fmt: skip
    grasp = SimpleNamespace(kind="pinch", let_go_s=0.25)
    scene: Any = SimpleNamespace(
        outputs=[*signals],
        fingers=("thumb", "index"),
        grasp=grasp,
        object=SimpleNamespace(mass_kg=0.25),
        knock=SimpleNamespace(attached=False),
    )
    plan: Any = SimpleNamespace(released_s=0.65, pin=True, knock_s=0.5, closed_s=0.3)
    found: Any = SimpleNamespace(time_s=t, find=signals.get, **signals)
    return ManipulationResult(scene, 1, plan, found, lost_s, ())


@plot
def manipulation() -> None:
    sim_report.draw(make_manipulation(0.9), "manipulation")


@plot
def closed_loop() -> None:
    """The first manipulation is lost with control too, so that another one in the same grasp is shown."""
    decisions = [GripDecision(k / 100.0, 50 <= k < 70, 60 <= k < 65, k == 52) for k in range(100)]
    trials: list[Any] = [
        SimpleNamespace(
            detector=detector, name=name, seed=1, manipulation=make_manipulation(None if held else 0.9), held=held,
            decisions=decisions, reaction_s=0.031 if held else None,
        )
        for detector, names_held in ((NO_CONTROL, ()), ("fast", ("small_cylinder",)))
        for name in ("cylinder", "small_cylinder")
        for held in (name in names_held,)
    ]  # fmt: skip
    trial_plots.plot_closed_loop(trials, "fast")


# Board


@plot
def board() -> None:
    f_hz = np.logspace(1.0, 6.0, 51)
    target = 100.0 / np.sqrt(1.0 + (67.0 / f_hz) ** 6)
    nominal = 1.01 * target / np.sqrt(1.0 + (f_hz / 3e4) ** 2)
    percent = {"R1": 1.0, "C1": 5.0, "C2": 5.0}
    band = ResponseBand(
        f_hz, target, nominal, 0.9 * nominal, 1.1 * nominal, 67.0, 66.5, (63.1, 70.2), 3.01e4, (2.5e4, 3.5e4), percent
    )
    draw_response(band, "board", ".svg")
    draw_response(compute_response_band(DESIGN, 20), "20 boards", ".png")


# Sweeps


def make_columns() -> dict[str, Any]:
    """Points with two numbers, one of them logarithmic, a category and an output."""
    rng = np.random.default_rng(0)
    width, cutoff = rng.uniform(15.0, 23.0, 100), 10.0 ** rng.uniform(1.0, 3.0, 100)
    series = np.array(["E12", "E96"], dtype=object)[np.arange(100) % 2]
    return {"skin.width_mm": width, "board.cutoff_hz": cutoff, "board.series": series, "delay": width + 900.0 / cutoff}


def find_feasible(columns: dict[str, Any]) -> Any:
    return columns["skin.width_mm"] > 17.0


@plot
def scatter_matrix() -> None:
    columns = make_columns()
    sweep_plots.draw_scatter_matrix(columns, find_feasible(columns), ["force_n"])


@plot
def heat_map() -> None:
    columns = make_columns()
    axes = {name: columns[name] for name in ("skin.width_mm", "board.cutoff_hz", "board.series")}
    for minimise in (True, False):
        sweep_plots.draw_heat_map(
            axes, "skin.width_mm", "board.cutoff_hz", "delay", columns["delay"], find_feasible(columns), minimise
        )
    grid, rows = (values.ravel() for values in np.meshgrid([1.0, 2.0, 4.0], [5.0, 6.0]))
    few = {"x": grid, "y": rows}
    sweep_plots.draw_heat_map(few, "x", "y", "delay", grid * rows, grid + rows < 10.0, None)


@plot
def sensitivities() -> None:
    rows = [("delay", 0.7, 0.95, 0.2, -0.4), ("a_long_name_of_an_output_in_mm", 0.0, math.nan, 0.1, 0.05)]
    found = [
        OutputSensitivity(
            name, 60, 0.01, (AxisSensitivity("skin.width_mm", a, b), AxisSensitivity("board.cutoff_hz", c, d))
        )
        for name, a, b, c, d in rows
    ]
    sweep_plots.draw_sensitivities(found, ["skin.width_mm", "board.cutoff_hz", "board.series"])


@plot
def pareto_front() -> None:
    x = np.linspace(1.0, 3.0, 9)
    y = np.where(np.arange(9) % 2, 9.0 / x, 12.0 / x)
    for extra in ((), (Objective("force", 1),)):
        sweep_plots.draw_pareto_front(
            [Objective("delay", 1), Objective("area", -1), *extra], (x, y), np.array([5, 1, 3]), 3
        )


@plot
def feasibility() -> None:
    columns = make_columns()
    names = ("feasible", "skin.width_mm", "failed", "mold.wall_mm", *(f"field_{i}" for i in range(9)))
    classes = PointClasses(names, np.where(find_feasible(columns), 0, 1 + np.arange(100) % 12))
    axes = {name: columns[name] for name in ("skin.width_mm", "board.cutoff_hz", "board.series")}
    draw_feasibility(axes, classes, [*axes])
    draw_feasibility(axes, classes, ["board.cutoff_hz", "skin.width_mm"])
    grid, rows = (values.ravel() for values in np.meshgrid(np.arange(10.0), np.arange(10.0)))
    draw_feasibility({"x": grid, "y": rows}, classes, ["y", "x"])


@pytest.mark.every_case
@pytest.mark.parametrize("name", PLOTS)
def test_plot_is_the_approved_one(name: str) -> None:
    require_module("matplotlib")
    with keep_figures() as figures:
        PLOTS[name]()
    assert figures
    check_figures(APPROVED / f"plot_{name}.txt", (line for figure in figures for line in describe_figure(figure)))
