"""Budget of errors: what steps, grids, meshes and samples cost at three settings, and how wrong
named outputs then are.

Errors of steps, grids, sections and meshes are differences from a reference that is at least four
times as fine as the setting in use; those of samples are intervals that hold the true value with 95
%. Model errors are those that another model or a data sheet has shown. Other outputs of sweeps are
listed by kind.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import chain
from typing import TypeAlias

import numpy as np

from fingertip.board.analysis.response import model_filter
from fingertip.board.analysis.tolerance import YIELD_BOARDS, compute_yields
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.network import build_network
from fingertip.board.components.values import select_components
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.verification.skin import min_thickness
from fingertip.cad.verification.strength import STATIONS, assess_strength
from fingertip.casting.mixture import compute_batch, measure_poured_cm3
from fingertip.catalogues.stated_errors import load_errors
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from fingertip.foundation import extras
from fingertip.foundation.jit import compiled
from fingertip.foundation.numerics import Pair, binomial_interval
from fingertip.foundation.progress import ReportProgress, Work
from fingertip.lab.accuracy.measure import REFERENCE, measure_steps
from fingertip.lab.campaign.campaign import Case
from fingertip.lab.campaign.run import DetectorResult, TrialResult, evaluate, simulate_trace
from fingertip.models.parts import PARTS
from fingertip.pad.layer import GRID_MM, find_contacts
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.survey import GRASP_DEG, TILTS_DEG, WIDE_DEG, try_contacts
from fingertip.pad.touch import Pose
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.signal.grid import BASE_HZ, Grid
from fingertip.sim.simulation import Trial, article_trials

_ERRORS = load_errors()
_SHARES = f"{_ERRORS['share'].bounds}; {_ERRORS['share_lying'].bounds}; finite elements"
_STRESSES = f"{_ERRORS['strength'].bounds} (finite elements)"
MODEL_ERRORS = {
    "pad_share": _SHARES,
    "pad_share_wide": _SHARES,
    "pad_evenness": _SHARES,
    "pad_stiffness_n_per_mm": "3 % in the median, 17 % in one of ten (finite elements)",
    "grip_safety_factor": _STRESSES,
    "knock_safety_factor": _STRESSES,
    "tactile_v": "6 % of the force from part to part (data sheet)",
}
"""Output -> model error where one is known; docs/pad.md and docs/designs.md tell the methods."""
KINDS = {
    "closed forms": (
        *("lengths", "board", "noise", "circuit", "acceptance"),
        *("tendon_force_n", "pad_own_mode_hz", "mold_plunge_pressure_kpa", "mold_creep_mm3"),
    ),
    "counted": (
        *("checks", "set_checks"),
        *("slips", "unconfirmed_lines", "odd_capacitors", "set_forms", "set_mixtures", "set_days"),
    ),
    "from a table": ("controller",),
    "from trials, with intervals as above": ("detection",),
    "from meshes, with errors as above": (
        *("skin", "bone", "mold", "casting", "walls", "strength", "printing", "core", "set"),
    ),
    "from the pad layer, with errors as above": ("pad",),
}
"""Kind of outputs that the budget does not name -> groups of that kind, and single outputs."""
DETECTOR = "fast"
_TRIALS = 120
"""Trials that a validation runs."""
_STEPPED = 12
"""Number of these trials whose time steps are refined."""
Values: TypeAlias = Mapping[str, float]


@dataclass(frozen=True)
class Curve:
    """Errors of some outputs at three or four settings of step, grid or sample, and the cost of
    each.
    """

    source: str
    settings: tuple[float, ...]
    used: int
    """Index of the setting in use."""
    cpu_s: tuple[float, ...]
    values: Values
    """Output -> value at the setting in use; for signals, the largest one."""
    errors: Mapping[str, tuple[float, ...]]
    """Output -> error at each setting; for samples, half of the interval."""
    intervals: Mapping[str, tuple[Pair, ...]] = field(default_factory=dict)
    """Output -> interval at each setting that holds the true value with 95 %; for samples alone."""


def measure_budget(design: Design, progress: ReportProgress | None = None) -> tuple[Curve, ...]:
    """Measure the curves of a design. Raises FingertipError."""
    extras.require("fingertip accuracy", "numba")
    stages = {
        "time steps": 6.0,
        "pad layer": 2.0,
        "meshes": 4.0,
        "boards": 2.0,
        "trials": 14.0,
    }
    measures = (_refine_steps, refine_pad, refine_meshes, _draw_boards, _draw_trials)
    work = Work("accuracy", stages, progress)
    curves = list[Curve]()

    with compiled():
        for name, measure in zip(stages, measures, strict=True):
            work.begin(name)
            curves += measure(design)

    return tuple(curves)


def _refine(
    source: str,
    settings: tuple[float, ...],
    used: int,
    finest: float,
    compute: Callable[[float], Values],
) -> Curve:
    """Measure a curve against the finest setting."""
    compute(settings[0])  # loads what is computed once
    values_by_setting = list[Values]()
    cpu_s = list[float]()

    for setting in settings:
        begin = time.process_time()
        values_by_setting.append(compute(setting))
        cpu_s.append(time.process_time() - begin)

    errors = {
        name: tuple(abs(values[name] - exact) for values in values_by_setting)
        for name, exact in compute(finest).items()
    }
    return Curve(
        source=source,
        settings=settings,
        used=used,
        cpu_s=tuple(cpu_s),
        values=values_by_setting[used],
        errors=errors,
    )


def _sample(curve: Curve, intervals_by_setting: Sequence[Mapping[str, Pair]]) -> Curve:
    """Add the intervals of each setting; the errors are half of them."""
    intervals = {
        name: tuple(by_output[name] for by_output in intervals_by_setting)
        for name in intervals_by_setting[0]
    }
    errors = {
        name: tuple((high - low) / 2 for low, high in by_setting)
        for name, by_setting in intervals.items()
    }
    return replace(curve, errors=errors, intervals=intervals)


def _refine_steps(design: Design) -> Iterator[Curve]:
    scene = Trial().scene
    steps = measure_steps(design, "trial", scene)
    largest = run_scene(design, scene.model_copy(update={"outputs": [*steps[0].errors]})).columns
    yield Curve(
        source="time step [us]",
        settings=tuple(1e6 * step.step_s for step in steps),
        used=0,
        cpu_s=tuple(step.cpu_s for step in steps),
        values={name: float(np.abs(values).max()) for name, values in largest.items()},
        errors={name: tuple(step.errors[name] for step in steps) for name in steps[0].errors},
    )
    trials_to_refine = [*article_trials()][:: _TRIALS // _STEPPED]
    cases = [Case("slip", scene, seed) for scene, seed in trials_to_refine]

    def detect(step_us: float) -> Values:
        grid = Grid(round(1e6 / BASE_HZ / step_us))
        trials = chain.from_iterable(_detect(design, case, grid) for case in cases)
        result = DetectorResult(1.0, tuple(trials))
        onset_s = result.motion_delay_s(0.5) - result.delay_s(0.5)

        return {
            "delay_ms": 1e3 * result.delay_s(0.5),
            "slip_onset_ms": 1e3 * onset_s,
            "found_share": result.found_share,
        }

    yield _refine("time step [us]", (100.0, 50.0, 25.0), 0, 100.0 / REFERENCE, detect)


def _detect(design: Design, case: Case, grid: Grid | None = None) -> list[TrialResult]:
    return evaluate(
        case,
        trace=simulate_trace(design, case, [DETECTOR], grid),
        detector=DETECTOR,
        design=design,
        scales=[1.0],
    )


def refine_pad(design: Design) -> Iterator[Curve]:
    """Yield the errors of the pad's figures by the grid of its layer model."""
    form = PadForm.of_design(design)

    def press(grid_mm: float) -> Values:
        shares = {}
        for tilt in TILTS_DEG:
            contacts = try_contacts(form, Pose(tilt), 1.0, grid_mm=grid_mm)
            shares[tilt] = contacts[0].share if contacts else 0.0

        low, high, firm = find_contacts(
            form,
            pose=Pose(2.0),
            forces_n=(0.9, 1.1, 5.0),
            max_strain=np.inf,
            grid_mm=grid_mm,
        )
        wide = [share for tilt, share in shares.items() if WIDE_DEG[0] <= tilt <= WIDE_DEG[1]]
        grasp = [share for tilt, share in shares.items() if GRASP_DEG[0] <= tilt <= GRASP_DEG[1]]

        return {
            "pad_share": min(grasp),
            "pad_share_wide": min(wide),
            "pad_evenness": min(grasp) / (max(grasp) or 1.0),
            "pad_stiffness_n_per_mm": (high.force_n - low.force_n) / (high.depth_mm - low.depth_mm),
            "pad_strain": firm.strain,
        }

    yield _refine("pad layer, grid [mm]", (0.5, GRID_MM, 0.125), 1, GRID_MM / 4, press)


def refine_meshes(design: Design) -> Iterator[Curve]:
    """Yield the errors of volumes by the tolerance of meshes, and of strength by its sections."""

    def load(evaluator: MeshEvaluator, stations: float) -> Values:
        strength = assess_strength(design, evaluator, round(stations))
        return {
            "grip_safety_factor": strength.grip_safety_factor,
            "knock_safety_factor": strength.knock_safety_factor,
        }

    def measure(tolerance_mm: float) -> Values:
        evaluator = MeshEvaluator(tolerance_mm)
        parts = ("skin", "bone", "mold_palmar", "mold_dorsal")
        meshes = {name: evaluator.mesh(PARTS[name].solid(design)) for name in parts}
        batch = compute_batch(design.silicone.material, measure_poured_cm3(design, evaluator))

        return {
            **{f"{name}_volume_mm3": mesh.volume() for name, mesh in meshes.items()},
            "skin_area_mm2": meshes["skin"].area(),
            "min_skin_thickness_mm": min_thickness(design, evaluator),
            "silicone_in_mold_g": batch.in_cup_g,
            "silicone_g": batch.total_g,
            **load(evaluator, STATIONS),
        }

    # Files and checks have 0.01 mm, sweeps 0.02 mm.
    yield _refine("mesh, tolerance [mm]", (0.08, 0.02, 0.01, 0.005), 2, 0.00125, measure)
    sections = (40.0, float(STATIONS), 640.0)
    yield _refine(
        "strength, sections", sections, 1, 16.0 * STATIONS, partial(load, MeshEvaluator(0.01))
    )


def _draw_boards(design: Design) -> Iterator[Curve]:
    if not design.board.has_filter:
        return

    circuit = board_circuit(select_components(design))
    model = model_filter(circuit)
    values = build_network(circuit, find_gain_bandwidth_hz(design.board)).values

    def draw(boards: float) -> Values:
        yields = compute_yields(
            model,
            values=values,
            circuit=circuit,
            board=design.board,
            boards=round(boards),
        )
        return {"filter_yield": min(yields.values())}

    sizes = (1000.0, float(YIELD_BOARDS), 16_000.0)
    counts = [round(size * draw(size)["filter_yield"]) for size in sizes]
    spans = [
        binomial_interval(count, round(size)) for count, size in zip(counts, sizes, strict=True)
    ]
    curve = _refine("Monte Carlo, boards", sizes, 1, 64_000.0, draw)
    yield _sample(curve, [{"filter_yield": span} for span in spans])


def _draw_trials(design: Design) -> Iterator[Curve]:
    # Every fourth trial first, so that a quarter of them has all surfaces and speeds.
    trials = list(article_trials())
    trials = [*trials[0::4], *trials[1::4], *trials[2::4], *trials[3::4]]
    cases = [Case("slip", scene, seed) for scene, seed in trials]
    cases += [Case("slip", scene, seed + _TRIALS) for scene, seed in trials]
    begin = time.process_time()
    cpu_s = list[float]()
    trial_results = list[TrialResult]()

    for case in cases:
        trial_results += _detect(design, case)
        cpu_s.append(time.process_time() - begin)

    sizes = _TRIALS // 4, _TRIALS, 2 * _TRIALS
    results = [DetectorResult(1.0, tuple(trial_results[:size])) for size in sizes]
    values = {
        "delay_ms": 1e3 * results[1].delay_s(0.5),
        "delay_p90_ms": 1e3 * results[1].delay_s(0.9),
        "motion_delay_ms": 1e3 * results[1].motion_delay_s(0.5),
        "found_share": results[1].found_share,
        "false_alarms_per_min": results[1].alarms_per_minute,
    }
    spans = []

    for result in results:
        delays = (
            result.delay_interval(0.5),
            result.delay_interval(0.9),
            result.motion_delay_interval(0.5),
        )
        ends = [(1e3 * low, 1e3 * high) for low, high in delays]
        spans.append(
            dict(zip(values, [*ends, result.found_interval, result.alarm_interval], strict=True))
        )

    cost = tuple(cpu_s[size - 1] for size in sizes)
    yield _sample(
        Curve(
            source="detection, trials",
            settings=tuple(map(float, sizes)),
            used=1,
            cpu_s=cost,
            values=values,
            errors={},
        ),
        spans,
    )
