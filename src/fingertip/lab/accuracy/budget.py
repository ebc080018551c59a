"""Budget of errors: what steps, grids, meshes and samples cost at three settings, and how wrong named outputs then are.

Errors of steps, grids, sections and meshes are differences from a reference that is at least four times as fine as the
setting in use; those of samples are intervals that hold the true value with 95 %. Model errors are those that another
model or a data sheet has shown. Other outputs of sweeps are listed by kind.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from fingertip.board import board_circuit
from fingertip.board.analysis.response import model_filter
from fingertip.board.analysis.tolerance import YIELD_BOARDS, compute_yields
from fingertip.board.circuits.network import build_network
from fingertip.board.components.values import select_components
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.parts import PARTS
from fingertip.cad.verification.skin import min_thickness
from fingertip.cad.verification.strength import STATIONS, assess_strength
from fingertip.casting.sheet import compute_batch, measure_poured_cm3
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from fingertip.foundation import extras
from fingertip.foundation.jit import compiled
from fingertip.foundation.numerics import Pair, binomial_interval
from fingertip.foundation.progress import ReportProgress, Work
from fingertip.lab.accuracy.measure import REFERENCE, measure_steps
from fingertip.lab.campaign.plan import Case
from fingertip.lab.campaign.run import DetectorResult, TrialResult, evaluate, simulate_trace
from fingertip.pad.layer import GRID_MM, find_contacts
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.survey import GRASP_DEG, TILTS_DEG, WIDE_DEG, try_contacts
from fingertip.pad.touch import Pose
from fingertip.sim import run_scene
from fingertip.sim.runs.scene import SceneRun
from fingertip.sim.signal.grid import BASE_HZ, Grid
from fingertip.sim.simulation import Trial, article_trials

_SHARES, _STRESSES = "0.011 rms, 0.024 worst (finite elements)", "-21 to +7 % (finite elements)"
MODEL_ERRORS = {
    "pad_share": _SHARES, "pad_share_wide": _SHARES, "pad_evenness": _SHARES,
    "pad_stiffness_n_per_mm": "3 % in the median, 17 % in one of ten (finite elements)",
    "grip_safety_factor": _STRESSES, "knock_safety_factor": _STRESSES,
    "tactile_v": "6 % of the force from part to part (data sheet)",
}  # fmt: skip
"""Output -> model error where one is known; docs/pad.md and docs/designs.md state how each was found."""
KINDS = {
    "closed forms": ("lengths", "board", "noise", "circuit", "acceptance"),
    "counted": ("checks", "set_checks"),
    "from trials, with intervals as above": ("detection",),
    "from a table": ("controller",),
    "from meshes, with errors as above": (
        "skin",
        "bone",
        "mold",
        "casting",
        "walls",
        "strength",
        "printing",
        "core",
        "set",
    ),
    "from the pad layer, with errors as above": ("pad",),
}
"""Kind -> groups of outputs of sweeps, where no line of the budget names them."""
OTHER_KINDS = {
    "counted": ("slips", "unconfirmed_lines", "odd_capacitors", "set_forms", "set_mixtures", "set_days"),
    "closed forms": ("tendon_force_n", "pad_own_mode_hz", "mold_plunge_pressure_kpa", "mold_creep_mm3"),
}
"""Kind -> outputs that are not of the kind of their group."""
DETECTOR = "fast"
_TRIALS, _STEPPED = 120, 12
"""Trials that a validation runs, and those of them whose steps are refined."""


@dataclass(frozen=True)
class Curve:
    """Errors of some outputs at three settings of what they are computed with, and the cost of each."""

    source: str
    unit: str
    settings: tuple[float, ...]
    used: int
    """Index of the setting in use."""
    compared: str
    """What errors are measured against."""
    cpu_s: tuple[float, ...]
    values: Mapping[str, float]
    """Output -> value at the setting in use; for signals, the largest one."""
    errors: Mapping[str, tuple[float, ...]]
    """Output -> error at each setting; for samples, half of the interval."""
    intervals: Mapping[str, tuple[Pair, ...]] = field(default_factory=dict)
    """Output -> interval at each setting that holds the true value with 95 %; samples alone have one."""


def measure_budget(design: Design, progress: ReportProgress | None = None) -> tuple[Curve, ...]:
    """Measure the curves of a design. Raises FingertipError."""
    extras.require("fingertip accuracy", "scipy", "numba", "matplotlib")
    stages: dict[str, tuple[float, Callable[[Design], Iterator[Curve]]]] = {
        "time steps": (6.0, _refine_steps), "pad layer": (2.0, _refine_pad), "meshes": (4.0, _refine_meshes),
        "boards": (2.0, _draw_boards), "trials": (14.0, _draw_trials),
    }  # fmt: skip
    work, found = Work("accuracy", {name: weight for name, (weight, _) in stages.items()}, progress), list[Curve]()
    with compiled():
        for name, (_, measure) in stages.items():
            work.begin(name)
            found += measure(design)
    return tuple(found)


def _refine(
    source: str, unit: str, settings: tuple[float, ...], used: int, finest: float,
    compute: Callable[[float], dict[str, float]],
) -> Curve:  # fmt: skip
    """Measure a curve against the finest setting."""
    compute(settings[0])  # loads what is computed once
    found, cpu_s = [], []
    for setting in settings:
        begin = time.process_time()
        found.append(compute(setting))
        cpu_s.append(time.process_time() - begin)
    exact = compute(finest)
    errors = {name: tuple(abs(one[name] - value) for one in found) for name, value in exact.items()}
    return Curve(source, unit, settings, used, f"{finest:g} {unit}", tuple(cpu_s), found[used], errors)


def _refine_steps(design: Design) -> Iterator[Curve]:
    scene = Trial().scene
    steps = measure_steps(design, "trial", scene)
    quiet = scene.sensing.model_copy(update={"noise": False})
    largest = run_scene(design, scene.model_copy(update={"outputs": [*steps[0].errors], "sensing": quiet})).columns
    settings = tuple(1e6 * step.step_s for step in steps)
    yield Curve(
        "time step", "us", settings, 0, f"steps / {REFERENCE}", tuple(step.cpu_s for step in steps),
        {name: float(np.abs(values).max()) for name, values in largest.items()},
        {name: tuple(step.errors[name] for step in steps) for name in steps[0].errors},
    )  # fmt: skip
    trials = [*article_trials()][:: _TRIALS // _STEPPED]

    def detect(step_us: float) -> dict[str, float]:
        found = []
        for scene, seed in trials:
            base = (SceneRun(design, scene, seed).grid or Grid()).refinement
            grid, case = Grid(base * round(1e6 / BASE_HZ / step_us)), Case("slip", scene, seed)
            found += evaluate(case, simulate_trace(design, case, [DETECTOR], grid), DETECTOR, design, [1.0])
        result = DetectorResult(1.0, tuple(found))
        onset_s = result.motion_delay_s(0.5) - result.delay_s(0.5)
        delays = {"delay_ms": 1e3 * result.delay_s(0.5), "slip_onset_ms": 1e3 * onset_s}
        return delays | {"found_share": result.found_share}

    yield _refine("time step", "us", (100.0, 50.0, 25.0), 0, 100.0 / REFERENCE, detect)


def _refine_pad(design: Design) -> Iterator[Curve]:
    form = PadForm.of_design(design)

    def press(grid_mm: float) -> dict[str, float]:
        pressed = {tilt: try_contacts(form, Pose(tilt), 1.0, grid_mm=grid_mm) for tilt in TILTS_DEG}
        shares = {tilt: found[0].share if found else 0.0 for tilt, found in pressed.items()}
        low, high, firm = find_contacts(form, Pose(2.0), (0.9, 1.1, 5.0), np.inf, grid_mm)
        wide, grasp = ([s for t, s in shares.items() if a <= t <= b] for a, b in (WIDE_DEG, GRASP_DEG))
        stiffness = (high.force_n - low.force_n) / (high.depth_mm - low.depth_mm)
        return {
            "pad_share": min(grasp), "pad_share_wide": min(wide), "pad_evenness": min(grasp) / (max(grasp) or 1.0),
            "pad_stiffness_n_per_mm": stiffness, "pad_strain": firm.strain,
        }  # fmt: skip

    yield _refine("pad layer, grid", "mm", (0.5, GRID_MM, 0.125), 1, GRID_MM / 4, press)


def _refine_meshes(design: Design) -> Iterator[Curve]:
    def measure(tolerance_mm: float) -> dict[str, float]:
        evaluator = MeshEvaluator(tolerance_mm)
        skin, bone, palmar, dorsal = (
            evaluator.mesh(PARTS[name].solid(design)) for name in ("skin", "bone", "mold_palmar", "mold_dorsal")
        )
        batch = compute_batch(design.silicone.material, measure_poured_cm3(design, evaluator))
        return {
            "skin_volume_mm3": skin.volume(), "skin_area_mm2": skin.area(), "bone_volume_mm3": bone.volume(),
            "mold_palmar_volume_mm3": palmar.volume(), "mold_dorsal_volume_mm3": dorsal.volume(),
            "min_skin_thickness_mm": min_thickness(design, evaluator),
            "silicone_in_mold_g": batch.in_cup_g, "silicone_g": batch.total_g,
        }  # fmt: skip

    yield _refine("mesh, tolerance", "mm", (0.08, 0.02, 0.005), 1, 0.00125, measure)

    def load(evaluator: MeshEvaluator, stations: float) -> dict[str, float]:
        found = assess_strength(design, evaluator, round(stations))
        return {name: getattr(found, name) for name in ("grip_safety_factor", "knock_safety_factor")}

    fine = MeshEvaluator(0.01)
    yield _refine("strength, sections", "", (40.0, STATIONS, 640.0), 1, 16.0 * STATIONS, partial(load, fine))
    meshed = lambda tolerance_mm: load(MeshEvaluator(tolerance_mm), STATIONS)  # noqa: E731
    yield _refine("strength, mesh", "mm", (0.04, 0.01, 0.005), 1, 0.00125, meshed)


def _draw_boards(design: Design) -> Iterator[Curve]:
    if not design.board.has_filter:
        return
    circuit = board_circuit(select_components(design))
    model, values = model_filter(circuit), build_network(circuit, find_gain_bandwidth_hz(design.board)).values

    def draw(boards: float) -> dict[str, float]:
        return {"filter_yield": min(compute_yields(model, values, circuit, design.board, round(boards)).values())}

    sizes = (1000.0, float(YIELD_BOARDS), 16_000.0)
    curve = _refine("Monte Carlo, boards", "", sizes, 1, 64_000.0, draw)
    counts = [round(size * draw(size)["filter_yield"]) for size in sizes]
    intervals = [binomial_interval(count, round(size)) for count, size in zip(counts, sizes, strict=True)]
    yield _sample(curve, {"filter_yield": intervals})


def _draw_trials(design: Design) -> Iterator[Curve]:
    sizes, cpu_s, found = (_TRIALS // 4, _TRIALS, 2 * _TRIALS), list[float](), list[TrialResult]()
    trials = [trial for first in range(4) for trial in [*article_trials()][first::4]]
    cases = [Case("slip", scene, seed + first) for first in (0, _TRIALS) for scene, seed in trials]
    intervals: dict[str, list[Pair]] = {}
    values: dict[str, float] = {}
    begin = time.process_time()
    for number, case in enumerate(cases, start=1):
        found += evaluate(case, simulate_trace(design, case, [DETECTOR]), DETECTOR, design, [1.0])
        if number in sizes:
            cpu_s.append(time.process_time() - begin)
            result = DetectorResult(1.0, tuple(found))
            delays = {
                "delay_ms": (result.delay_s, result.delay_interval, 0.5),
                "delay_p90_ms": (result.delay_s, result.delay_interval, 0.9),
                "motion_delay_ms": (result.motion_delay_s, result.motion_delay_interval, 0.5),
            }
            now = {name: interval(fraction) for name, (_, interval, fraction) in delays.items()}
            spans = {name: (1e3 * low, 1e3 * high) for name, (low, high) in now.items()}
            spans |= {"found_share": result.found_interval, "false_alarms_per_min": result.alarm_interval}
            for name, span in spans.items():
                intervals.setdefault(name, []).append(span)
            if number == _TRIALS:
                values = {name: 1e3 * delay_s(fraction) for name, (delay_s, _, fraction) in delays.items()}
                values |= {"found_share": result.found_share, "false_alarms_per_min": result.alarms_per_minute}
    curve = Curve("detection, trials", "", tuple(map(float, sizes)), 1, "", tuple(cpu_s), values, {})
    yield _sample(curve, intervals)


def _sample(curve: Curve, intervals: Mapping[str, list[Pair]]) -> Curve:
    """Return a curve whose errors are half of the intervals."""
    halves = {name: tuple((high - low) / 2 for low, high in spans) for name, spans in intervals.items()}
    spans = {name: tuple(found) for name, found in intervals.items()}
    return Curve(
        curve.source, curve.unit, curve.settings, curve.used, "95 % interval", curve.cpu_s, curve.values, halves, spans
    )
