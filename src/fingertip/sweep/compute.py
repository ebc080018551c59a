"""Computation of each group of outputs for one point.

Each function imports the heavy packages that it needs when it is called. A sweep of boards never loads a geometry
kernel.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, TypeAlias

from fingertip.design.model import Design
from fingertip.foundation.errors import Issue
from fingertip.sweep.outputs import GROUPS, load_outputs
from fingertip.sweep.sweep_file import SweepFile

if TYPE_CHECKING:
    from fingertip.cad.kernel.mesh import Mesh
    from fingertip.design.finger_set import FingerSet
    from fingertip.sim.runs.files import SceneFile
    from fingertip.slip.traces.trace import Trace
    from fingertip.sweep.designs import CachedEvaluator

OutputValues: TypeAlias = dict[str, Any]
"""Output -> number, and under `ISSUE` what is wrong with a point that could be computed."""
ISSUE = "issue"


@dataclass(frozen=True)
class PointContext:
    """One point of a sweep, and what it shares with other points."""

    design: Design
    scene: SceneFile | None
    file: SweepFile
    evaluator: Callable[[], CachedEvaluator]
    """Function that gives the mesh kernel. The kernel is loaded at its first call."""
    load_trial: Callable[[int, Callable[[], Trace]], Trace] = lambda seed, record: record()
    """Function of a seed and of what records its trial. It returns a cached trial where points share it."""
    fingers: FingerSet | None = None
    """Set of a sweep of sets; `design` is that of its first finger."""


def compute_lengths(context: PointContext) -> OutputValues:
    design = context.design
    m = design.mold_layout
    return {
        "finger_length_mm": design.skin.length_mm + design.bone.base_length_mm,
        "sensor_rim_mm": design.dimensions.sensor_rim_margin(design.bone.rim_mm, design.sensor.clearance_mm),
        "mold_width_mm": 2 * m.half_width,
        "mold_height_mm": m.palmar_height + m.dorsal_height,
        "mold_length_mm": m.overall_height,
    }


def compute_board(context: PointContext) -> OutputValues:
    from fingertip.board.analysis.board_values import compute_filter

    board = context.design.board
    selection, achieved = compute_filter(board)
    fitted = selection.preferred
    resistors = ("r1_ohm", "r2_ohm", "r3_ohm", "r4_ohm", "r5_ohm")
    r_lp_ohm, c_lp_uf = (fitted.r_lp_ohm, 1e6 * fitted.c_lp_f) if board.has_envelope else (math.nan, math.nan)
    return {f"board.{name}": getattr(fitted, name) for name in resistors} | {
        "board.r_lp_ohm": r_lp_ohm,
        "board.c_uf": 1e6 * fitted.c_f,
        "board.c_lp_uf": c_lp_uf,
        "gain": achieved.passband_gain,
        "gain_db": achieved.passband_gain_db,
        "first_pole_hz": achieved.first_pole_hz,
        "section_hz": achieved.section_hz,
        "q": achieved.section_quality,
        "cutoff_3db_hz": achieved.cutoff_hz,
        "upper_cutoff_hz": achieved.upper_cutoff_hz,
        "cutoff_error_percent": 100.0 * (achieved.cutoff_hz / board.cutoff_hz - 1.0),
        "envelope_pole_hz": achieved.envelope_pole_hz,
        "envelope_decay_ms": 1e3 * achieved.envelope_decay_s,
        "amplifier_bandwidth_hz": achieved.amplifier_bandwidth_hz,
    }


def compute_circuit(context: PointContext) -> OutputValues:
    from fingertip.board import board_circuit, board_values
    from fingertip.board.analysis import gate
    from fingertip.board.fabrication.bom import count_unconfirmed

    values = board_values(context.design)
    spread = values.threshold_spread
    return {
        "filter_noise_v": values.noise.filtered_v,
        "max_ripple_v": values.supply_ripple.max_v,
        "max_envelope_offset_v": values.output_offset.max_v if values.output_offset else math.nan,
        "vibration_peak_v": values.voltage_limits.vibration_peak_v,
        "sensor_amplifier_margin_v": values.voltage_limits.sensor_amplifier_margin_v,
        "filter_load_ohm": values.filter_load_ohm,
        "gate_margin": gate.find_smallest_margin(values.gate),
        "output_current_margin": gate.find_smallest_margin(values.gate, gate.CURRENT),
        "offset_margin": gate.find_smallest_margin(values.gate, gate.OFFSET),
        "gain_bandwidth_margin": gate.find_smallest_margin(values.gate, gate.BANDWIDTH),
        "phase_margin_deg": min(c.value for c in values.gate if c.name == gate.MARGIN),
        "peaking_db": max(c.value for c in values.gate if c.name == gate.PEAKING),
        "adc_margin": gate.find_smallest_margin(values.gate, gate.HIGHEST, gate.CLAMP),
        "filter_yield": min(c.value for c in values.gate if c.name == gate.YIELD),
        "unconfirmed_lines": count_unconfirmed(board_circuit(values, context.design.board.channels)),
        "board_current_a": values.shared.supply_current_a if values.shared else math.nan,
        "crosstalk_db": values.shared.crosstalk_db if values.shared else math.nan,
        "odd_capacitors": max(c.value for c in values.gate if c.name == gate.SERIES),
        "mean_threshold_v": spread.mean_v if spread else math.nan,
        "min_threshold_worst_v": spread.min_v if spread else math.nan,
        "max_threshold_worst_v": spread.max_v if spread else math.nan,
    }


def compute_noise(context: PointContext) -> OutputValues:
    from fingertip.slip.detectors.analog_and_digital import noise_level

    level = noise_level(context.design)
    return {"noise_level_v": level.mean_v, "min_threshold_v": level.threshold_v}


def compute_detection(context: PointContext) -> OutputValues:
    """Compute delays and alarms of the detector on simulated trials of the scene, each with its own seed."""
    from fingertip.foundation.jit import compiled
    from fingertip.lab.campaign import run
    from fingertip.lab.campaign.plan import Case

    assert context.scene is not None
    detector, design = context.file.detector, context.design
    results, onsets_s, vibrations_n, shares = [], [], [], []
    with compiled():
        for seed in range(context.file.first_seed, context.file.first_seed + context.file.trials):
            case = Case("slip", context.scene, seed)
            trace = context.load_trial(seed, partial(run.simulate_trace, design, case, [detector]))
            results += run.evaluate(case, trace, detector, design, [1.0])
            if "slip_onset_ms" in context.file.outputs:
                onsets_s.append(run.find_onset_s(design, case, trace))
            if "slip_vibration_n" in context.file.outputs:
                vibrations_n.append(run.measure_vibration_n(trace))
            if "out_of_contact_share" in context.file.outputs:
                shares.append(run.measure_out_of_contact_share(trace))
    pooled = run.DetectorResult(1.0, tuple(results))
    minutes = sum(result.duration_s for result in results) / 60.0
    return {
        "delay_ms": 1e3 * pooled.delay_s(0.5),
        "delay_p90_ms": 1e3 * pooled.delay_s(0.9),
        "motion_delay_ms": 1e3 * pooled.motion_delay_s(0.5),
        "motion_delay_p90_ms": 1e3 * pooled.motion_delay_s(0.9),
        "found_share": pooled.found_share,
        "false_alarms_per_min": sum(pooled.alarms().values()) / minutes,
        "slips": pooled.slips,
        "slip_onset_ms": 1e3 * run.median_of_known(onsets_s),
        "slip_vibration_n": run.median_of_known(vibrations_n),
        "out_of_contact_share": run.median_of_known(shares),
    }


def compute_simulation(context: PointContext) -> OutputValues:
    """Compute what the time step changes in the first trial, by a comparison with a much finer step."""
    from fingertip.foundation.jit import compiled
    from fingertip.lab.campaign.grids import compare_grids
    from fingertip.lab.campaign.plan import Case

    assert context.scene is not None
    case, detector = Case("slip", context.scene, context.file.first_seed), context.file.detector
    with compiled():
        errors, shifts_samples = compare_grids(context.design, case, (detector,))
    return {
        "simulation.force_error_mn": 1e3 * errors["force_n"],
        "simulation.voltage_error_mv": 1e3 * errors["voltage_v"],
        "simulation.envelope_error_mv": 1e3 * errors.get("envelope_v", math.nan),
        "simulation.delay_shift_samples": shifts_samples[detector],
    }


def compute_skin(context: PointContext) -> OutputValues:
    mesh = _mesh(context, "skin")
    return {"skin_volume_mm3": mesh.volume(), "skin_area_mm2": mesh.area()}


def compute_bone(context: PointContext) -> OutputValues:
    volume = _mesh(context, "bone").volume()
    return {"bone_volume_mm3": volume, "bone_mass_g": volume / 1e3 * context.file.print_density_g_cm3}


def compute_strength(context: PointContext) -> OutputValues:
    from fingertip.cad.verification.strength import assess_strength

    found = assess_strength(context.design, context.evaluator())
    return {
        "grip_safety_factor": found.grip_safety_factor,
        "knock_safety_factor": found.knock_safety_factor,
        "weakest_z_mm": found.weakest.z_mm,
        "tendon_force_n": found.tendon_force_n,
    }


def compute_pad(context: PointContext) -> OutputValues:
    from fingertip.pad.survey import GRASP_DEG, WIDE_DEG, find_own_mode_hz, survey_pad

    found, loose = survey_pad(context.design), survey_pad(context.design, is_loose=True)

    def finite(force_n: float) -> float:
        return force_n if math.isfinite(force_n) else math.nan

    return {
        "pad_share": found.least_share(*GRASP_DEG),
        "pad_share_wide": found.least_share(*WIDE_DEG),
        "pad_share_rolled": found.rolled_share,
        "pad_evenness": found.evenness,
        "pad_turn_on_n": finite(found.worst_turn_on_n),
        "pad_stiffness_n_per_mm": found.stiffness_n_per_mm,
        "pad_strain": found.strain,
        "pad_own_mode_hz": find_own_mode_hz(context.design),
        "pad_rest_n": found.rest_n,
        "pad_loose_share": loose.least_share(*GRASP_DEG),
        "pad_loose_share_wide": loose.least_share(*WIDE_DEG),
        "pad_dead_zone_n": finite(loose.dead_zone_n(*GRASP_DEG)),
        "pad_dead_zone_wide_n": finite(loose.dead_zone_n(*WIDE_DEG)),
    }


def compute_mold(context: PointContext) -> OutputValues:
    palmar, dorsal = (_mesh(context, f"mold_{half}").volume() for half in ("palmar", "dorsal"))
    mass = (palmar + dorsal) / 1e3 * context.file.print_density_g_cm3
    return {"mold_palmar_volume_mm3": palmar, "mold_dorsal_volume_mm3": dorsal, "mold_mass_g": mass}


def compute_casting(context: PointContext) -> OutputValues:
    from fingertip.cad.verification.lying_skin import pull_off_n, slide_mm
    from fingertip.casting.quantities import compute_batch, measure_poured_cm3

    poured_cm3 = measure_poured_cm3(context.design, context.evaluator())
    batch = compute_batch(context.design.silicone.material, poured_cm3)
    pull, is_lying = pull_off_n(context.design), not context.design.skin.bonded
    lying = {
        "skin_pull_off_glued_n": pull_off_n(context.design, is_glued=True) if is_lying else math.nan,
        "skin_slide_mm": slide_mm(context.design) if is_lying else 0.0,
    }
    return {"silicone_in_mold_g": batch.in_mold_g, "silicone_g": batch.total_g, "skin_pull_off_n": pull, **lying}


_CASTING_CHECKS = {
    "mold_trapped_air_mm3": "mold.trapped_air", "mold_palmar_error_mm": "mold.palmar_error",
    "mold_plunge_pressure_kpa": "mold.plunge_pressure", "mold_creep_mm3": "mold.creep",
    "mold_seat_film_mm": "mold.seat_film", "mold_stretch_percent": "skin.fitting_stretch",
    "vent_open_percent": "sensor.vent_open", "stand_gap_mm": "stand.post_gap",
}  # fmt: skip


def compute_core(context: PointContext) -> OutputValues:
    from fingertip.cad.shapes.parts import parts_by_name
    from fingertip.cad.verification.bench import check_stand
    from fingertip.cad.verification.laid_in import check_laid_in
    from fingertip.cad.verification.mold import check_mold

    design, parts, evaluator = context.design, parts_by_name(context.design), context.evaluator()
    checks = [*check_mold(design, evaluator, parts), *check_laid_in(design, evaluator)]
    checks += check_stand(design, evaluator) if "stand" in parts else ()
    values = {check.name: check.value for check in checks}
    return {output: values.get(check, math.nan) for output, check in _CASTING_CHECKS.items()}


def compute_thickness(context: PointContext) -> OutputValues:
    """Compute the minimum thickness of the skin above the plane where it is cut square."""
    from fingertip.cad.verification.skin import min_thickness

    return {"min_skin_thickness_mm": min_thickness(context.design, context.evaluator())}


def compute_walls(context: PointContext) -> OutputValues:
    from fingertip.cad.verification.assembly import check_joint
    from fingertip.cad.verification.bone import check_bone

    checks = (*check_bone(context.design, context.evaluator()), *check_joint(context.design, context.evaluator()))
    walls = [check.value for check in checks if check.name.startswith("bone.wall.")]
    return {"min_bone_wall_mm": min(walls)}


def compute_printing(context: PointContext) -> OutputValues:
    from fingertip.cad.printing.estimate import estimate_print
    from fingertip.cad.shapes.parts import parts_by_name
    from fingertip.cad.verification.printing import check_overhang

    printed = [name for name, part in parts_by_name(context.design).items() if part.is_printed]
    meshes = {name: _mesh(context, name) for name in printed}
    overhangs = [check_overhang(context.design, context.evaluator(), name, mesh) for name, mesh in meshes.items()]
    estimate = estimate_print(context.design)
    return {
        "max_overhang_mm2": max(check.value for check in overhangs),
        "print_h": estimate.minutes / 60.0, "filament_cm3": estimate.filament_cm3,
    }  # fmt: skip


def compute_acceptance(context: PointContext) -> OutputValues:
    from fingertip.documents.acceptance import expect_change_ratio, expect_open_v, expect_readings

    weights = {f"tactile_{reading.mass_g:g}g_v": reading.tactile_v for reading in expect_readings(context.design)}
    ratio = expect_change_ratio(context.design).expected
    return {"tactile_open_v": expect_open_v(context.design), "tactile_change_ratio": ratio, **weights}


def compute_controller(context: PointContext) -> OutputValues:
    """Compute what detectors of several fingers ask of the controller that `fingertip firmware` proposes for them."""
    from fingertip.catalogues.controllers import NAMES
    from fingertip.firmware.fingers import count_fingers, find_controller, find_load

    board, rate_hz = find_controller(context.design), context.design.detector.sample_rate_hz
    assert board
    load = find_load(board, rate_hz, len(NAMES))
    return {
        "controller_fingers": count_fingers(board, rate_hz, not context.design.board.has_filter),
        "controller_load_percent": 100 * load.mean / load.available,
        "controller_peak_percent": 100 * load.longest / load.available,
    }


def compute_checks(context: PointContext) -> OutputValues:
    return _run_checks(context, [context.design], "")


def compute_set_checks(context: PointContext) -> OutputValues:
    assert context.fingers is not None
    return _run_checks(context, [form.design for form in context.fingers.forms], "set_")


def compute_set(context: PointContext) -> OutputValues:
    """Compute what a whole set takes, as `fingertip make` states it."""
    from fingertip.cad.shapes.parts import PARTS, parts_by_name
    from fingertip.casting.sheet import casting_sheet
    from fingertip.documents.finger_set.sheets import FormSheets, plan_set

    assert context.fingers is not None
    forms, evaluator = context.fingers.forms, context.evaluator()
    plan = plan_set([FormSheets(form, casting_sheet(form.design, evaluator)) for form in forms])
    cm3 = {"set_fingers_g": 0.0, "set_molds_g": 0.0}
    for form in forms:
        for name, part in parts_by_name(form.design).items():
            if part.is_printed:
                group = "set_fingers_g" if PARTS[name].is_in_finger else "set_molds_g"
                cm3[group] += form.count * evaluator.mesh(part.solid(form.design)).volume() / 1000.0
    return {
        "set_forms": len(forms),
        "set_mixtures": len(plan.cups),
        "set_silicone_g": sum(cup.batch.total_g for cup in plan.cups),
        "set_days": plan.days,
        **{name: volume * context.file.print_density_g_cm3 for name, volume in cm3.items()},
    }


def _run_checks(context: PointContext, designs: Iterable[Design], prefix: str) -> OutputValues:
    """Run every check of `fingertip check`, at the sweep's tolerance."""
    from fingertip.cad.shapes.parts import parts_by_name
    from fingertip.cad.verification.verify import verify

    verified = (verify(design, parts_by_name(design), ("stl",), context.evaluator()) for design in designs)
    checks = [check for each in verified for check in each.checks]
    failed = [check for check in checks if not check.passed]
    counts = {"checks_failed": len(failed), "checks_run": len(checks)}
    values: OutputValues = {prefix + name: count for name, count in counts.items()}
    if failed:
        first, *others = failed
        more = f" (and {len(others)} more: {', '.join(check.name for check in others)})" if others else ""
        unit = f" {first.unit}" if first.unit else ""
        message = f"is {first.value:.6g}{unit}, but must be {first.relation} {first.limit:.6g}{unit}{more}."
        values[ISSUE] = Issue(first.name, message)
    return values


def _mesh(context: PointContext, part: str) -> Mesh:
    from fingertip.cad.shapes.parts import PARTS

    return context.evaluator().mesh(PARTS[part].solid(context.design))


def _compute_of_a_board(group: str, context: PointContext) -> OutputValues:
    """Compute outputs that are NaN where a divider takes the place of a board."""
    if context.design.board.has_filter:
        values: OutputValues = globals()[f"compute_{group}"](context)
        return values
    return {name: math.nan for name, output in load_outputs().items() if output.group == group}


GROUP_FUNCTIONS: dict[str, Callable[[PointContext], OutputValues]] = {
    group: globals()[f"compute_{group}"] for group in GROUPS
}
GROUP_FUNCTIONS |= {group: partial(_compute_of_a_board, group) for group in ("board", "circuit", "noise")}
