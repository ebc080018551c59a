"""Computation of each group of outputs for one point.

Each function imports the heavy packages that it needs when it is called. A sweep of boards never
loads a geometry kernel.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, TypeAlias

from fingertip.design.design import Design
from fingertip.foundation.errors import Issue
from fingertip.sweep.outputs import load_outputs
from fingertip.sweep.sweep_file import SweepFile

if TYPE_CHECKING:
    from fingertip.cad.kernel.mesh import Mesh
    from fingertip.cad.verification.check import Check
    from fingertip.design.finger_set import FingerSet
    from fingertip.sim.runs.scene_and_manipulation_files import SceneFile
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
    """Function of a seed and of what records its trial.
    It returns a cached trial where points share it.
    """
    fingers: FingerSet | None = None
    """Set of a sweep of sets; `design` is that of its first finger."""


def compute_lengths(context: PointContext) -> OutputValues:
    m = context.design.mold_layout
    design = context.design
    return {
        "finger_length_mm": design.skin.length_mm + design.bone.base_length_mm,
        "sensor_rim_mm": design.sensor_rim_margin,
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
    r_lp_ohm, c_lp_uf = (
        (fitted.r_lp_ohm, 1e6 * fitted.c_lp_f) if board.has_envelope else (math.nan, math.nan)
    )
    values = {f"board.{name}": getattr(fitted, name) for name in resistors}
    values |= {"board.r_lp_ohm": r_lp_ohm, "board.c_uf": 1e6 * fitted.c_f, "board.c_lp_uf": c_lp_uf}
    values |= {
        "gain": achieved.passband_gain,
        "gain_db": achieved.passband_gain_db,
        "q": achieved.section_quality,
    }
    same = (
        "first_pole_hz",
        "section_hz",
        "upper_cutoff_hz",
        "envelope_pole_hz",
        "amplifier_bandwidth_hz",
    )
    values |= {name: getattr(achieved, name) for name in same}

    return values | {
        "cutoff_3db_hz": achieved.cutoff_hz,
        "cutoff_error_percent": 100.0 * (achieved.cutoff_hz / board.cutoff_hz - 1.0),
        "envelope_decay_ms": 1e3 * achieved.envelope_decay_s,
    }


def compute_circuit(context: PointContext) -> OutputValues:
    from fingertip.board.analysis import gate
    from fingertip.board.analysis.board_values import board_values
    from fingertip.board.circuits.board_circuit import board_circuit
    from fingertip.board.fabrication.bom import list_unconfirmed

    values = board_values(context.design)
    spread = values.threshold_spread
    limits = values.voltage_limits
    margins = {
        "gate_margin": (),
        "output_current_margin": (gate.CURRENT,),
        "offset_margin": (gate.OFFSET,),
        "gain_bandwidth_margin": (gate.BANDWIDTH,),
        "adc_margin": (gate.HIGHEST, gate.CLAMP),
    }

    def known(part: Any, figure: str) -> float:
        return math.nan if part is None else getattr(part, figure)

    return {
        name: gate.find_smallest_margin(values.gate, *checks) for name, checks in margins.items()
    } | {
        "filter_noise_v": values.noise.filtered_v,
        "max_ripple_v": values.supply_ripple.max_v,
        "max_envelope_offset_v": known(values.output_offset, "max_v"),
        "vibration_peak_v": limits.vibration_peak_v,
        "filter_load_ohm": values.filter_load_ohm,
        "sensor_amplifier_margin_v": limits.sensor_amplifier_margin_v,
        "phase_margin_deg": min(c.value for c in values.gate if c.name == gate.MARGIN),
        "peaking_db": max(c.value for c in values.gate if c.name == gate.PEAKING),
        "filter_yield": min(c.value for c in values.gate if c.name == gate.YIELD),
        "unconfirmed_lines": len(
            list_unconfirmed(board_circuit(values, context.design.board.channels))
        ),
        "board_current_a": known(values.shared, "supply_current_a"),
        "crosstalk_db": known(values.shared, "crosstalk_db"),
        "odd_capacitors": max(c.value for c in values.gate if c.name == gate.SERIES),
        "mean_threshold_v": known(spread, "mean_v"),
        "min_threshold_worst_v": known(spread, "min_v"),
        "max_threshold_worst_v": known(spread, "max_v"),
    }


def compute_noise(context: PointContext) -> OutputValues:
    from fingertip.slip.detectors.analog_and_digital import noise_level

    level = noise_level(context.design)
    return {"noise_level_v": level.mean_v, "min_threshold_v": level.threshold_v}


def compute_detection(context: PointContext) -> OutputValues:
    """Compute delays and alarms of the detector on simulated trials of the scene, each with its own
    seed.
    """
    from fingertip.foundation.jit import compiled
    from fingertip.lab.campaign import run
    from fingertip.lab.campaign.campaign import Case

    assert context.scene is not None
    detector = context.file.detector
    design = context.design
    measures: dict[str, Callable[[Case, Trace], float]] = {
        "slip_onset_ms": lambda case, trace: 1e3 * run.find_onset_s(design, case, trace),
        "slip_vibration_n": lambda _, trace: run.measure_vibration_n(trace),
        "out_of_contact_share": lambda _, trace: run.measure_out_of_contact_share(trace),
        "clip_share": lambda _, trace: (
            math.nan if trace.origin.clip_share is None else trace.origin.clip_share
        ),
    }
    # The board runs where a detector reads it.
    is_clip_asked = "clip_share" in context.file.outputs and design.board.has_filter
    read = [detector, "analog"] if is_clip_asked else [detector]
    results = []
    measured = {name: list[float]() for name in measures}

    with compiled():
        for seed in range(context.file.first_seed, context.file.first_seed + context.file.trials):
            case = Case("slip", context.scene, seed)
            trace = context.load_trial(seed, partial(run.simulate_trace, design, case, read))
            results += run.evaluate(
                case,
                trace=trace,
                detector=detector,
                design=design,
                scales=[1.0],
            )
            for name in measures.keys() & set(context.file.outputs):
                measured[name].append(measures[name](case, trace))

    pooled = run.DetectorResult(1.0, tuple(results))
    return {
        "delay_ms": 1e3 * pooled.delay_s(0.5),
        "delay_p90_ms": 1e3 * pooled.delay_s(0.9),
        "motion_delay_ms": 1e3 * pooled.motion_delay_s(0.5),
        "motion_delay_p90_ms": 1e3 * pooled.motion_delay_s(0.9),
        "found_share": pooled.found_share,
        "slips": pooled.slips,
        "false_alarms_per_min": 60.0
        * sum(pooled.alarms().values())
        / sum(result.duration_s for result in results),
        **{name: run.median_of_known(values) for name, values in measured.items()},
    }


def compute_skin(context: PointContext) -> OutputValues:
    from fingertip.cad.verification.skin import min_thickness

    mesh = _mesh(context, "skin")
    thinnest_mm = min_thickness(context.design, context.evaluator())
    return {
        "skin_volume_mm3": mesh.volume(),
        "skin_area_mm2": mesh.area(),
        "min_skin_thickness_mm": thinnest_mm,
    }


def compute_bone(context: PointContext) -> OutputValues:
    volume = _mesh(context, "bone").volume()
    return {
        "bone_volume_mm3": volume,
        "bone_mass_g": volume / 1e3 * context.file.print_density_g_cm3,
    }


def compute_strength(context: PointContext) -> OutputValues:
    from fingertip.cad.verification.strength import assess_strength

    strength = assess_strength(context.design, context.evaluator())
    same = ("grip_safety_factor", "knock_safety_factor", "tendon_force_n")
    return {name: getattr(strength, name) for name in same} | {
        "weakest_z_mm": strength.weakest.z_mm
    }


def compute_pad(context: PointContext) -> OutputValues:
    from fingertip.pad.survey import GRASP_DEG, WIDE_DEG, find_own_mode_hz, survey_pad

    survey = survey_pad(context.design)
    loose = survey_pad(context.design, is_loose=True)

    def finite(force_n: float) -> float:
        return force_n if math.isfinite(force_n) else math.nan

    return {
        "pad_share": survey.least_share(*GRASP_DEG),
        "pad_share_wide": survey.least_share(*WIDE_DEG),
        "pad_loose_share": loose.least_share(*GRASP_DEG),
        "pad_loose_share_wide": loose.least_share(*WIDE_DEG),
        "pad_dead_zone_n": finite(loose.dead_zone_n(*GRASP_DEG)),
        "pad_dead_zone_wide_n": finite(loose.dead_zone_n(*WIDE_DEG)),
        "pad_share_rolled": survey.rolled_share,
        "pad_evenness": survey.evenness,
        "pad_strain": survey.strain,
        "pad_stiffness_n_per_mm": survey.stiffness_n_per_mm,
        "pad_own_mode_hz": find_own_mode_hz(context.design),
        "pad_turn_on_n": finite(survey.worst_turn_on_n),
        "pad_rest_n": survey.rest_n,
    }


def compute_mold(context: PointContext) -> OutputValues:
    palmar, dorsal = (_mesh(context, f"mold_{half}").volume() for half in ("palmar", "dorsal"))
    mass = (palmar + dorsal) / 1e3 * context.file.print_density_g_cm3
    return {"mold_palmar_volume_mm3": palmar, "mold_dorsal_volume_mm3": dorsal, "mold_mass_g": mass}


def compute_casting(context: PointContext) -> OutputValues:
    from fingertip.cad.verification.skin import pull_off_n, slide_mm
    from fingertip.casting.mixture import compute_batch, measure_poured_cm3
    from fingertip.models.making import making_of

    poured_cm3 = measure_poured_cm3(context.design, context.evaluator())
    batch = compute_batch(context.design.silicone.material, poured_cm3)
    is_bonded = making_of(context.design).is_bonded

    return {
        "silicone_in_mold_g": batch.in_cup_g,
        "silicone_g": batch.total_g,
        "skin_pull_off_n": pull_off_n(context.design),
        "skin_pull_off_glued_n": math.nan
        if is_bonded
        else pull_off_n(context.design, is_glued=True),
        "skin_slide_mm": 0.0 if is_bonded else slide_mm(context.design),
    }


_CASTING_CHECKS = {
    "mold_trapped_air_mm3": "mold.trapped_air",
    "mold_palmar_error_mm": "mold.palmar_error",
    "mold_plunge_pressure_kpa": "mold.plunge_pressure",
    "mold_creep_mm3": "mold.creep",
    "mold_seat_film_mm": "mold.seat_film",
    "mold_stretch_percent": "skin.fitting_stretch",
    "vent_open_percent": "sensor.vent_open",
    "stand_gap_mm": "stand.post_gap",
}


def compute_core(context: PointContext) -> OutputValues:
    from fingertip.cad.verification.bone import check_laid_in, check_stand
    from fingertip.cad.verification.check import Solids
    from fingertip.cad.verification.mold import check_mold
    from fingertip.models.parts import parts_by_name

    design, solids = (
        context.design,
        Solids.of(context.design, context.evaluator(), parts_by_name(context.design)),
    )
    checks = [*check_mold(design, solids), *check_laid_in(design, solids)]
    checks += check_stand(design, solids) if "stand" in solids.parts else ()
    values = {check.name: check.value for check in checks}

    return {output: values.get(check, math.nan) for output, check in _CASTING_CHECKS.items()}


def compute_walls(context: PointContext) -> OutputValues:
    from fingertip.cad.verification.bone import check_bone
    from fingertip.cad.verification.check import Solids
    from fingertip.cad.verification.joint import check_joint

    solids = Solids.of(context.design, context.evaluator(), ("bone", "skin"))
    checks = (*check_bone(context.design, solids), *check_joint(context.design, solids))

    return {
        "min_bone_wall_mm": min(
            check.value for check in checks if check.name.startswith("bone.wall.")
        )
    }


def compute_printing(context: PointContext) -> OutputValues:
    from fingertip.cad.printing.settings import estimate_print
    from fingertip.cad.verification.check import Solids
    from fingertip.cad.verification.printing import check_overhang
    from fingertip.models.parts import parts_by_name

    printed = [name for name, part in parts_by_name(context.design).items() if part.is_printed]
    solids = Solids.of(context.design, context.evaluator(), printed)
    overhangs = [check_overhang(context.design, solids, name) for name in printed]
    estimate = estimate_print(context.design)
    overhang_mm2 = max(check.value for check in overhangs)
    estimated = {"print_h": estimate.minutes / 60.0, "filament_cm3": estimate.filament_cm3}

    return {"max_overhang_mm2": overhang_mm2, **estimated}


def compute_acceptance(context: PointContext) -> OutputValues:
    from fingertip.documents.acceptance import expect_change_ratio, expect_open_v, expect_readings

    weights = {
        f"tactile_{reading.mass_g:g}g_v": reading.tactile_v
        for reading in expect_readings(context.design)
    }
    ratio = expect_change_ratio(context.design)
    return {
        "tactile_open_v": expect_open_v(context.design),
        "tactile_change_ratio": ratio,
        **weights,
    }


def compute_controller(context: PointContext) -> OutputValues:
    """Compute what detectors of several fingers ask of the controller that `fingertip firmware`
    proposes for them.
    """
    from fingertip.catalogues.electronics import NAMES
    from fingertip.firmware.fingers import count_fingers, find_controller, find_load

    board = find_controller(context.design)
    rate_hz = context.design.detector.sample_rate_hz
    assert board
    load = find_load(board, rate_hz, len(NAMES))
    fingers = count_fingers(board, rate_hz, not context.design.board.has_filter)
    percent = {
        "load": 100 * load.mean / load.available,
        "peak": 100 * load.longest / load.available,
    }

    return {"controller_fingers": fingers} | {
        f"controller_{name}_percent": value for name, value in percent.items()
    }


def compute_set(context: PointContext) -> OutputValues:
    """Compute what a whole set takes, as `fingertip make` states it."""
    from fingertip.casting.sheet import casting_sheet
    from fingertip.documents.set_sheets import plan_set
    from fingertip.models.parts import parts_by_name

    assert context.fingers is not None
    forms = context.fingers.forms
    evaluator = context.evaluator()
    plan = plan_set([(form, casting_sheet(form.design, evaluator)) for form in forms])
    cm3 = {"set_fingers_g": 0.0, "set_molds_g": 0.0}
    for form in forms:
        for part in parts_by_name(form.design).values():
            if part.is_printed:
                group = "set_fingers_g" if part.is_in_finger else "set_molds_g"
                volume_mm3 = evaluator.mesh(part.solid(form.design)).volume()
                cm3[group] += form.count * volume_mm3 / 1000.0

    return {
        "set_forms": len(forms),
        "set_mixtures": len(plan.cups),
        "set_days": plan.days,
        "set_silicone_g": sum(cup.total_g for cup in plan.cups),
        **{name: volume * context.file.print_density_g_cm3 for name, volume in cm3.items()},
    }


def compute_checks(context: PointContext) -> OutputValues:
    """Run every check of `fingertip check` on the design, or all of a set, at the sweep's
    tolerance.
    """
    from fingertip.cad.verification.verify import verify
    from fingertip.models.parts import parts_by_name

    designs = [context.design]
    if context.fingers:
        designs = [form.design for form in context.fingers.forms]

    prefix = "set_" if context.fingers else ""
    checks: list[Check] = []
    for design in designs:
        checks += verify(design, parts_by_name(design), ("stl",), context.evaluator()).checks

    failed = [check for check in checks if not check.passed]
    values: OutputValues = {
        f"{prefix}checks_failed": len(failed),
        f"{prefix}checks_run": len(checks),
    }
    values[f"{prefix}margin_percent"] = min(check.margin_percent for check in checks)

    if failed:
        first, *further = failed
        more = ""
        if further:
            more = f" (and {len(further)} more: {', '.join(check.name for check in further)})"

        unit = f" {first.unit}" if first.unit else ""
        message = (
            f"is {first.value:.6g}{unit}, but must be {first.relation} "
            f"{first.limit:.6g}{unit}{more}."
        )
        values[ISSUE] = Issue(first.name, message)

    return values


def _mesh(context: PointContext, part: str) -> Mesh:
    from fingertip.models.parts import PARTS

    return context.evaluator().mesh(PARTS[part].solid(context.design))


def _compute_with_board(
    group: str, compute: Callable[[PointContext], OutputValues], context: PointContext
) -> OutputValues:
    """Compute outputs that are NaN where a divider takes the place of a board."""
    if context.design.board.has_filter:
        return compute(context)

    return {name: math.nan for name, output in load_outputs().items() if output.group == group}


GROUP_FUNCTIONS: dict[str, Callable[[PointContext], OutputValues]] = {
    "lengths": compute_lengths,
    "board": partial(_compute_with_board, "board", compute_board),
    "controller": compute_controller,
    "acceptance": compute_acceptance,
    "noise": partial(_compute_with_board, "noise", compute_noise),
    "pad": compute_pad,
    "circuit": partial(_compute_with_board, "circuit", compute_circuit),
    "detection": compute_detection,
    "skin": compute_skin,
    "bone": compute_bone,
    "mold": compute_mold,
    "strength": compute_strength,
    "core": compute_core,
    "walls": compute_walls,
    "printing": compute_printing,
    "casting": compute_casting,
    "checks": compute_checks,
    "set": compute_set,
    "set_checks": compute_checks,
}
"""Group of outputs -> function that computes them.
`outputs.GROUPS` says what each reads and costs.
"""
