"""Tables that `fingertip board` prints: conditions, components, response, limits and forces."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fingertip.board.analysis.board_analysis import Analysis
    from fingertip.board.analysis.board_values import BoardValues
    from fingertip.design import Design

_FORCES_N = (0.0, 0.2, 0.8, 1.3, 3.0, 8.0, 20.0)


def table_lines(design: Design, values: BoardValues) -> list[str]:
    from fingertip.board.analysis.limits import describe_adc_range, describe_filter_swing

    aliasing = values.aliasing
    limits = values.voltage_limits
    sign = "" if design.board.is_for_controller else "plus and minus "

    return [
        *_component_lines(design, values),
        "",
        *_response_lines(values),
        "",
        f"supply of {sign}{design.board.supply_v:g} V: signal ground is at "
        f"{limits.signal_ground_v:g} V, "
        f"{describe_filter_swing(limits)}",
        f"at {aliasing.nyquist_hz:g} Hz, half the ADC's sampling rate, the tactile voltage is "
        "attenuated by "
        f"{-aliasing.tactile_nyquist_db:.1f} dB and the "
        f"{'envelope' if design.board.has_envelope else 'filtered signal'} by "
        f"{-aliasing.output_nyquist_db:.1f} dB",
        describe_adc_range(limits),
        "",
        *_force_lines(design, values),
    ]


def gate_lines(values: BoardValues) -> list[str]:
    """Return lines of the conditions that the board must meet to work."""
    from fingertip.board.analysis.gate import describe_condition
    from fingertip.board.analysis.thresholds import describe_threshold_spread
    from fingertip.catalogues.electronics import AMPLIFIER_CATALOGUE

    amplifier = AMPLIFIER_CATALOGUE[values.amplifier]
    lines = [
        f"Conditions with {amplifier.order_name} (unverified: {', '.join(amplifier.unverified)}):"
    ]
    required = {
        (condition.name, condition.subject, condition.relation)
        for condition in values.gate
        if condition.level == "required" and condition.passed
    }

    for condition in values.gate:
        is_repeated = condition.level == "advised" and condition.passed
        key = (condition.name, condition.subject, condition.relation)
        if not is_repeated or key not in required:
            verdict = "" if condition.passed else "FAILS: "
            lines.append(f"  {verdict}{describe_condition(condition)}")

    if values.threshold_spread:
        lines.append(describe_threshold_spread(values.threshold_spread))

    return lines


def channel_lines(design: Design, values: BoardValues) -> Iterator[str]:
    """Yield the figures that the channels of several fingers share."""
    shared = values.shared
    if shared:
        yield (
            f"{design.board.channels} fingers: {1e3 * shared.supply_current_a:.1f} mA at rest, "
            "crosstalk at most "
            f"{shared.crosstalk_db:.0f} dB (at {shared.crosstalk_hz:.0f} Hz); the parts below are "
            "those of each finger"
        )


def _component_lines(design: Design, values: BoardValues) -> list[str]:
    from fingertip.board.parts.circuit import format_component_value

    ideal = values.ideal
    preferred = values.preferred
    adc = values.adc_interface
    has_envelope = design.board.has_envelope
    filter_resistors = [
        ("R1", ideal.r1_ohm, preferred.r1_ohm, "first stage, pole"),
        ("R2", ideal.r2_ohm, preferred.r2_ohm, "Sallen-Key, feedback"),
        ("R3", ideal.r3_ohm, preferred.r3_ohm, "Sallen-Key, to ground"),
        ("R4", ideal.r4_ohm, preferred.r4_ohm, "gain, to ground"),
        ("R5", ideal.r5_ohm, preferred.r5_ohm, "gain, feedback"),
    ]
    if has_envelope:
        filter_resistors.append(("R6", ideal.r_lp_ohm, preferred.r_lp_ohm, "R_LP, envelope"))

    single = adc.output_ohm, adc.output_f
    other_rows = [
        ("C1 C2 C3", (preferred.c_f,), "both filters"),
        *([("C4", (preferred.c_lp_f,), "C_LP, envelope")] if has_envelope else []),
        *_front_end_rows(values),
        *([("R7 C8", single, "anti-aliasing filter, envelope")] if has_envelope else []),
        *(
            [("R27 C25", single, "anti-aliasing filter, filtered signal")]
            if design.board.is_for_controller
            else []
        ),
        (
            "R8 C9",
            (adc.first_ohm, adc.first_f),
            "anti-aliasing filter, tactile voltage: first pole",
        ),
        (
            "R9 C19",
            (adc.second_ohm, adc.second_f),
            "anti-aliasing filter, tactile voltage: second pole",
        ),
    ]
    added = values.first_stage_capacitors

    if added:
        capacitors = (added.series_capacitor_f, added.limiting_capacitor_f)
        other_rows.append(("C14 C20", capacitors, "first stage, AC coupling of R4 and low-pass"))

    lines = [f"{'component':10} {'ideal':>14} {design.board.series:>10} {'deviation':>9}  function"]
    lines += [
        f"{name:10} {ohm:10.1f} ohm {format_component_value(fitted):>10} "
        f"{_format_deviation(fitted / ohm)}  {function}"
        for name, ohm, fitted, function in filter_resistors
    ]
    lines += [
        f"{names:10} {'':14} {' '.join(map(format_component_value, components)):>10} {'':9}  "
        f"{function}"
        for names, components, function in other_rows
    ]
    return lines


def _front_end_rows(values: BoardValues) -> list[tuple[str, tuple[float, ...], str]]:
    bridge = values.bridge
    if bridge:
        return [
            ("R10", (bridge.sensor_top_ohm,), "bridge, supply to sensor"),
            ("R11", (bridge.sensor_shunt_ohm,), "bridge, parallel to the sensor"),
            ("R12", (bridge.reference_top_ohm,), "bridge, supply to reference"),
            ("R13", (bridge.reference_bottom_ohm,), "bridge, reference to ground"),
            ("R14", (bridge.gain_ohm,), f"bridge amplifier, gain {bridge.gain:.2f}"),
        ]

    fitted = values.by_reference
    return [
        ("R28 C26", (fitted["R28"], fitted["C26"]), "sensor's cable, behind the suppressor D6"),
        ("R29", (fitted["R29"],), "transimpedance stage, input"),
        ("R30 C27", (fitted["R30"], fitted["C27"]), "transimpedance stage, feedback"),
        ("R31 R32", (fitted["R31"], fitted["R32"]), "sensor's bias"),
        ("R33", (fitted["R33"],), "sensor's bias, low-pass"),
        ("C28 C29", (fitted["C28"], fitted["C29"]), "sensor's bias, low-pass"),
    ]


def _response_lines(values: BoardValues) -> list[str]:
    from fingertip.foundation.files import format_figure

    target = values.target_response
    achieved = values.achieved_response
    quantities = [
        ("maximum gain", target.passband_gain, achieved.passband_gain, ""),
        ("maximum gain", target.passband_gain_db, achieved.passband_gain_db, "dB"),
        ("first pole", target.first_pole_hz, achieved.first_pole_hz, "Hz"),
        ("Sallen-Key f0", target.section_hz, achieved.section_hz, "Hz"),
        ("Sallen-Key Q", target.section_quality, achieved.section_quality, ""),
        ("lower -3 dB", target.cutoff_hz, achieved.cutoff_hz, "Hz"),
        ("upper -3 dB", target.upper_cutoff_hz, achieved.upper_cutoff_hz, "Hz"),
        ("envelope corner", target.envelope_pole_hz, achieved.envelope_pole_hz, "Hz"),
        (
            "envelope time constant",
            1e3 * target.envelope_decay_s,
            1e3 * achieved.envelope_decay_s,
            "ms",
        ),
        (
            "amplifier bandwidth",
            target.amplifier_bandwidth_hz,
            achieved.amplifier_bandwidth_hz,
            "Hz",
        ),
    ]
    lines = [f"{'response':22} {'target':>12} {'achieved':>12}"]
    lines += [
        f"{name:22} {format_figure(target_value):>12} {format_figure(value):>12} {unit}".rstrip()
        for name, target_value, value, unit in quantities
    ]
    software = ""
    if values.voltage_limits.max_envelope_v is None:
        software = "; software computes the envelope"

    lines.append(
        "achieved: preferred values; gain and -3 dB with the finite bandwidth and gain of the "
        f"amplifiers{software}"
    )

    return lines


def _format_deviation(ratio: float) -> str:
    """Format the deviation of a ratio from 1 in percent; zero has no sign."""
    text = f"{100 * (ratio - 1):+.2f}%"
    return f"{text[1:] if text[1:] == '0.00%' else text:>9}"


def _force_lines(design: Design, values: BoardValues) -> list[str]:
    """Return lines of sensor resistance and tactile voltage at a few forces."""
    from fingertip.board.components.front_end import sensor_conductance_s

    conductance_of = sensor_conductance_s

    if design.force_curve.curve == "calibrated":
        from fingertip.sim.signal.bridge import ConductanceCurve  # needs numpy

        conductance_of = ConductanceCurve.of_design(design).conductance_s

    lines = [
        "bare sensor; in a finger, skin and bone take part of a force",
        f"{'force':>8} {'sensor':>10} {'tactile voltage':>16}",
    ]
    for force_n in _FORCES_N:
        conductance_s = conductance_of(force_n)
        resistance = f"{1 / conductance_s:.0f} ohm" if conductance_s else "open"
        tactile_v = values.tactile_response.tactile_v(conductance_s)
        lines.append(f"{force_n:6g} N {resistance:>10} {tactile_v:14.2f} V")

    return [*lines, design.force_curve.describe(design.sensor.model)]


_LABELS = {
    "cutoff_hz": "lower -3 dB [Hz]",
    "section_quality": "Sallen-Key Q",
    "passband_gain": "maximum gain",
    "first_pole_hz": "first pole [Hz]",
    "section_hz": "Sallen-Key f0 [Hz]",
}


def analysis_text(design: Design, analysis: Analysis) -> str:
    """Return the tables of a board's analysis, from the template `analysis.txt`."""
    from fingertip.board.analysis import interference, limits, noise
    from fingertip.board.analysis.board_values import board_values
    from fingertip.board.components.front_end import MAX_FORCE_N, sensor_conductance_s
    from fingertip.design.formulas import filter as formulas
    from fingertip.documents.template import render

    values = board_values(design)
    text = render(
        "board/analysis.txt",
        values=values,
        analysis=analysis,
        threshold_v=design.detector.threshold_v,
        pressed_v=values.tactile_response.tactile_v(sensor_conductance_s(MAX_FORCE_N)),
        labels=_LABELS,
        noise=noise,
        interference=interference,
        limits=limits,
        formulas=formulas,
        has_bridge=not values.voltage_limits.has_filtered_output,
        is_in_software=values.voltage_limits.max_envelope_v is None,
        tolerances=_group_tolerances(analysis.component_percent),
    )

    return text.rstrip("\n")


def _group_tolerances(percent: Mapping[str, float]) -> str:
    """List the tolerances by kind of component; by component where a kind has several."""
    groups: dict[tuple[str, float], list[str]] = {}
    for name, value in percent.items():
        kind = "filter resistors" if name.startswith("R") else "capacitors"
        groups.setdefault((kind, value), []).append(name)

    kinds = [kind for kind, _ in groups]
    return ", ".join(
        f"{kind if kinds.count(kind) == 1 else ' '.join(names)} {value:g} %"
        for (kind, value), names in groups.items()
    )
