"""Notes on the signals, in the README of a board: levels, clipping, loads, and what an ADC may draw."""

from __future__ import annotations

from fingertip.board.analysis.board_values import BoardValues
from fingertip.board.analysis.errata import describe_touches
from fingertip.board.analysis.interference import describe_sensor
from fingertip.board.analysis.limits import describe_adc_range
from fingertip.board.analysis.loads import signal_band_hz
from fingertip.board.analysis.thresholds import ComparatorLevels, OutputOffset
from fingertip.board.bringup.wiring import NEEDED_PINS
from fingertip.board.circuits.blocks import CABLE_OHM
from fingertip.board.circuits.spice import MAX_SWITCH_OHM
from fingertip.board.components.bridge import VREF_RATIO
from fingertip.board.components.supplies import SUPPLIES
from fingertip.board.components.values import CLAMP_A, LOW_LEAKAGE_CLAMP, MAX_CLAMP_A, MAX_LOW_LEAKAGE_A, PULL_UP_OHM
from fingertip.catalogues.amplifiers import ARTICLE_AMPLIFIER, CATALOGUE
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import DIODE_V
from fingertip.design.formulas.filter import COMPARATOR_OFFSET_V, MAX_COMPARATOR_OFFSET_V
from fingertip.design.rules.amplifiers import SUPPLY_RANGES_V
from fingertip.foundation.files import format_figure

MAX_PIN_LEAK_V = 1e-3
"""Shift by an ADC's leakage current for which that current is stated [V]."""


def signal_notes(values: BoardValues, design: Design) -> list[str]:
    """Signal levels, clipping and the interface to the ADC."""
    limits, supply_v = values.voltage_limits, design.board.supply_v
    amplifier = CATALOGUE[values.amplifier].order_name
    vibration_mv = 1e3 * limits.vibration_peak_v
    if has_mid_supply(values):
        signal_ground = (
            f"Signal ground is VMID (buffered mid-supply), {limits.signal_ground_v:.2f} V above supply ground, at pin "
            "M. The envelope is the voltage between E and M. The sensor's second pin is at signal ground too: connect "
            "it neither to supply ground nor to grounded metal."
        )
    else:
        signal_ground = "Signal ground is supply ground (0 V)."
    if values.amplifier == ARTICLE_AMPLIFIER:
        swing = (
            f"U1 is a {amplifier}: the article's {ARTICLE_AMPLIFIER} in a grade with at most "
            f"{1e3 * CATALOGUE[values.amplifier].max_offset_v:g} mV of offset. The filtered signal can swing "
            f"{limits.filter_peak_v:.1f} V up but only {limits.filter_trough_v:.1f} V down (typical, into 10 kohm; "
            f"{limits.filter_guaranteed_trough_v:.1f} V down guaranteed), where the input common-mode range of the "
            f"second stage ends. A vibration of {vibration_mv:.0f} mV (peak, where the gain is largest) in the tactile "
            "voltage reaches this limit. Below it the output jumps up (phase reversal), and E jumps with it for some "
            f"milliseconds. A fast press or a knock causes this: {describe_touches()}. The amplifiers of the variants "
            "`precision` and `comparator` do not do this."
        )
    else:
        up, down = (f"{volts:.1f}" for volts in (limits.filter_peak_v, limits.filter_trough_v))
        swings = f"{up} V up and down" if up == down else f"{up} V up and {down} V down"
        first = "" if up == down else f", {'downwards' if float(down) < float(up) else 'upwards'} first"
        swing = (
            f"The amplifiers are {amplifier}, with rail-to-rail inputs and outputs. The filtered signal swings "
            f"{swings} (typical, into 10 kohm): it clips vibrations of more than {vibration_mv:.0f} mV (peak, where "
            f"the gain is largest) in the tactile voltage{first}."
        )
    adc_range = describe_adc_range(limits)
    notes = [
        signal_ground,
        f"{capitalize(adc_range)}.",
        f"T lies between {limits.min_tactile_v:.2f} V (20 N) and {limits.max_tactile_v:.2f} V (no force) above supply "
        f"ground. E rises to about {limits.max_envelope_v:.1f} V above signal ground: the rectifier's diode takes "
        f"{DIODE_V:g} V of the amplifier's typical swing.",
        swing,
        _load_note(values, design),
        f"D3 clamps T and D2 clamps E to within a diode drop of ground and +{supply_v:g} V. R7 to R9 limit the clamp "
        "current.",
        f"R8, C9, R9 and C19 (T) and R7 and C8 (E) are anti-aliasing filters for {design.detector.sample_rate_hz:g} "
        f"samples per second. In T they attenuate frequencies that alias to {values.aliasing.band_hz:.0f} Hz, the "
        f"upper end of the vibration band, by {-values.aliasing.tactile_alias_db:.0f} dB. For another sampling rate "
        "set `detector.sample_rate_hz`.",
        _source_note(values),
        _leak_note(values),
    ]
    return [*notes, *_controller_notes(values, design)] if SUPPLIES[values.supply].is_for_controller else notes


def _source_note(values: BoardValues) -> str:
    """State the source resistances of the pins, and what an ADC may draw from them."""
    limits, part = values.voltage_limits, values.by_reference
    pins = f"T {limits.tactile_pin_ohm / 1e3:.3g}k, E {limits.envelope_pin_ohm / 1e3:.3g}k"
    if SUPPLIES[values.supply].is_for_controller:
        pins += f", S {part['R27'] / 1e3:.3g}k, M {CABLE_OHM / 1e3:g}k"
    largest_ohm = max(limits.tactile_pin_ohm, limits.envelope_pin_ohm)
    return (
        f"Source resistances at the pins: {pins}. C8 and C19 lie at the pins and feed the sampling capacitor of an "
        f"ADC; it may be some pF. A leakage current of {1e9 * MAX_PIN_LEAK_V / largest_ohm:.0f} nA into a pin shifts "
        f"it by {1e3 * MAX_PIN_LEAK_V:g} mV, and an input resistance of 10 Mohm by {100 * largest_ohm / 1e7:.1f} %: "
        "look up both in the ADC's data sheet."
    )


def _leak_note(values: BoardValues) -> str:
    """Describe the shifts that the reverse currents of the clamps cause."""
    pins_ohm = values.voltage_limits.envelope_pin_ohm, values.voltage_limits.tactile_pin_ohm
    beginning = (
        "The reverse currents of the clamps flow through the resistors ahead of them: D2 shifts E in R7"
        f"{' and R6' if values.output_offset is None else ''}, and D3 shifts T in R8 and R9."
    )
    if SUPPLIES[values.supply].is_for_controller:
        worst = [1e3 * ohm * MAX_LOW_LEAKAGE_A for ohm in pins_ohm]
        return (
            f"{beginning} With {1e9 * MAX_LOW_LEAKAGE_A:g} nA (maximum of a {LOW_LEAKAGE_CLAMP}; unverified) these "
            f"shifts are {worst[0]:.2f} mV and {worst[1]:.2f} mV. {_leak_directions(values)}"
        )
    leaks = [[1e3 * ohm * current for ohm in pins_ohm] for current in (CLAMP_A, MAX_CLAMP_A)]
    return (
        f"{beginning} With the "
        f"{1e6 * CLAMP_A:g} uA of the SPICE model these shifts are at most {leaks[0][0]:.1f} mV and "
        f"{leaks[0][1]:.1f} mV, with {1e6 * MAX_CLAMP_A:g} uA (maximum of a BAT54; unverified) {leaks[1][0]:.0f} mV "
        f"and {leaks[1][1]:.0f} mV. {_leak_directions(values)}"
    )


def _controller_notes(values: BoardValues, design: Design) -> list[str]:
    """Describe what a controller reads beside tactile voltage and envelope."""
    supply_v, detector, aliasing = design.board.supply_v, design.detector, values.aliasing
    filtered_gain = aliasing.filtered_gain or 1.0
    return [
        NEEDED_PINS,
        f"S is the filtered signal ahead of the rectifier, centred at M ({values.voltage_limits.signal_ground_v:.2f} "
        f"V), with the pole of R27 and C25 and the clamp D5. From T to S the gain is {filtered_gain:.1f} at most: a "
        f"step of the ADC ({1e3 * detector.adc_step_v:.2g} mV) is "
        f"{format_figure(1e6 * detector.adc_step_v / filtered_gain, 2)} uV of the tactile voltage there. What aliases "
        f"to {aliasing.band_hz:.0f} Hz is {-(aliasing.filtered_alias_db or 0.0):.0f} dB below what is there itself.",
        f"All amplifiers are supplied from 0 and +{supply_v:g} V, so T, S, E and M cannot leave this range, whatever "
        "the sensor does: while the supply rises, with the sensor open or shorted, and in a hard press.",
        f"T and M are fixed ratios of the supply (VREF, which feeds the bridge, is {VREF_RATIO:g} of it, M is "
        f"{SUPPLIES[values.supply].signal_ground_ratio:.3g} of it). If the ADC's reference is not the supply, read M "
        "and use the ratio T / M.",
    ]


def _leak_directions(values: BoardValues) -> str:
    """Describe where the reverse currents of both diodes of a clamp oppose each other."""
    if has_mid_supply(values):
        return "Both diodes of each clamp block, and their currents oppose each other."
    return (
        "E, which lies near ground, is shifted upwards. At T both diodes block, and their currents oppose each other."
    )


def _load_note(values: BoardValues, design: Design) -> str:
    """Describe the loads of the amplifiers and their peak currents."""
    low_hz, high_hz = signal_band_hz(design.board.cutoff_hz)
    loads = ", ".join(
        f"{load.amplifier} {format_figure(load.min_ohm, 3)} ohm ({format_figure(1e3 * load.max_current_a, 2)} mA)"
        for load in values.amplifier_loads
    )
    if values.output_offset is None:
        rectifier = (
            "U1b also charges C4 through D1 while the diode conducts: its figures include this as an upper bound."
        )
    else:
        rectifier = "U3a drives R16 and R17 through D1; U3b drives R6 and C4, and its voltage falls as its load does."
    return (
        f"Between {low_hz:.4g} Hz and {high_hz:.4g} Hz, the band of the vibrations, the amplifiers drive at least "
        f"these loads, with these peak currents for the largest vibrations that are not clipped: {loads}. {rectifier} "
        "The output swing stated above holds for a lighter load, so the amplifiers may clip somewhat earlier."
        f"{_buffers_note(values)}"
    )


def _buffers_note(values: BoardValues) -> str:
    """Name the buffers whose load is not stated."""
    if SUPPLIES[values.supply].is_for_controller:
        return " The loads of U5 and U6, which buffer VMID and VREF, are not included."
    return " The load of U5, which buffers VMID, is not included." if has_mid_supply(values) else ""


# Section on the envelope offset, in the README of a board, and how to trim the threshold.


def offset_section(values: BoardValues, design: Design) -> str:
    """Section on the envelope offset, with the trimming procedure of variant comparator. Empty for variant article."""
    if values.output_offset is None:
        return ""
    offset = paragraph(_describe_offset(values.output_offset, values, design))
    if values.comparator_levels:
        title, procedure = (
            "Envelope offset and threshold",
            trimming_procedure(values.comparator_levels, values, design),
        )
    else:
        is_single = has_mid_supply(values)
        title = "Envelope offset"
        procedure = paragraph(
            "Measure the idle level of the envelope at pin E of J3, with the ADC connected and nothing touching the "
            f"sensor: the mean of E against {'M' if is_single else 'ground'}. (TP4 lies ahead of R7, in which the "
            "reverse current of D2 shifts E.) This level consists of the envelope offset, the shift in R7 and the "
            f"mean due to noise ({1e3 * (values.noise.mean_envelope_v or 0.0):.1f} mV), for which the threshold "
            f"allows. The detector `analog` compares the envelope reading {'(E minus M) ' if is_single else ''}with "
            "`detector.threshold_v` and subtracts no offset: take the mean due to noise off the measured level, and "
            "subtract the rest from the readings, or add it to the threshold for `analog` alone (`--detector analog "
            "--set detector.threshold_v=...`). Never change the threshold for `digital`, the default: its envelope is "
            "computed from T and has no offset of the board."
        )
    return f"\n## {title}\n\n{offset}\n\n{procedure}\n"


def _describe_offset(offset: OutputOffset, values: BoardValues, design: Design) -> str:
    amplifier = CATALOGUE[values.amplifier]
    text = (
        f"The offset voltages of U1 and U3 appear in the envelope. With {1e3 * amplifier.max_offset_v:g} mV each, the "
        f"maximum of a {amplifier.order_name}, the envelope offset lies between "
        f"{round(1e3 * offset.min_v, 1) + 0.0:.1f} and "
        f"+{1e3 * offset.max_v:.1f} mV (typical offsets cause {format_figure(1e3 * offset.typical_v, 2)} mV, "
        f"the root of the sum of their squares). The design's threshold is {1e3 * design.detector.threshold_v:g} mV."
    )
    if offset.max_v <= offset.max_low_offset_v:
        return text
    return (
        f"{text} With an {offset.low_offset_amplifier} (`board.amplifier`), which has the same pins, the envelope "
        f"offset stays below {1e3 * offset.max_low_offset_v:.1f} mV."
    )


def trimming_procedure(levels: ComparatorLevels, values: BoardValues, design: Design) -> str:
    """Describe how to trim the threshold of variant comparator, as a Markdown paragraph and numbered steps."""
    reference_point = "M or TP5, not against ground" if has_mid_supply(values) else "ground (TP5)"
    slip = slip_pin(values)
    threshold = f"{1e3 * design.detector.threshold_v:g} mV"
    introduction = (
        f"With RV1 at its midpoint, {slip} goes low when the mean of E rises above {1e3 * levels.on_v:.1f} mV, and "
        f"high again when it falls below {1e3 * levels.off_v:.1f} mV. The range of RV1 ends at "
        f"{1e3 * levels.max_on_v:.0f} mV. The comparator adds its own errors: its input current raises the mean by "
        f"{1e3 * levels.bias_v:.1f} mV in R18 (at most {1e3 * levels.max_bias_v:.1f} mV), of which "
        f"{1e3 * levels.threshold_bias_v:.1f} mV are compensated at the threshold if both inputs draw the same "
        f"current, and its offset voltage is {1e3 * COMPARATOR_OFFSET_V:g} mV (at most "
        f"{1e3 * MAX_COMPARATOR_OFFSET_V:g} mV). "
        "One procedure compensates the envelope offset and these errors:"
    )
    steps = (
        "Make sure that nothing touches the sensor. Measure the threshold with a voltmeter at RV1's wiper, the pin "
        f"alone on its side, against {reference_point}.",
        f"Turn RV1 anticlockwise, towards the pin beside R19, until {slip} is high. The reading rises if you turn in "
        "the right direction.",
        f"Turn RV1 back slowly until {slip} goes low. Note the last reading before that: it is the idle level "
        f"(envelope offset and noise) as the comparator sees it. If {slip} is still high at the end stop, this level "
        "is negative: note the reading at the end stop, about 0. The board is then less sensitive than intended, by as "
        "much as the level lies below that reading.",
        f"Turn RV1 anticlockwise until {slip} is high again, and on until the reading is the noted level + "
        f"{threshold}. Read the voltmeter only while {slip} is high: while {slip} is low, the hysteresis lowers the "
        f"reading by about {1e3 * (levels.on_v - levels.off_v):.0f} mV.",
        f"If the noted level + {threshold} exceeds the range of RV1, choose a higher `detector.threshold_v` for the "
        "board, or better amplifiers.",
    )
    numbered = "\n".join(paragraph(step, f"{i}. ", "   ") for i, step in enumerate(steps, start=1))
    return f"{paragraph(introduction)}\n\n{numbered}"


# Notes on the supply, in the README of a board, and its known limitations.


POWER_UP_S = 2.0
"""Time after power-up in which the voltages of a board for a controller settle [s]: eight time constants."""


def power_notes(values: BoardValues, design: Design) -> list[str]:
    """Requirements on the supply and, for variant comparator, on the input that S is connected to."""
    ripple, supply_v = values.supply_ripple, design.board.supply_v
    if SUPPLIES[values.supply].is_for_controller:
        return _controller_power_notes(values, design)
    effect = "makes the diode conduct" if values.output_offset is None else "counts as slip at the design's threshold"
    notes = [
        "The board has no reverse polarity protection: a reversed supply destroys it. Check the polarity of the plug "
        "for J2 with a meter before you connect the board.",
        f"The bridge is fed from +{supply_v:g} V. Ripple on this supply reaches the rectifier amplified up to "
        f"{ripple.gain:.0f} times, most at {format_figure(ripple.worst_hz, 2)} Hz (sensor open). Between "
        f"{ripple.low_hz:.3g} Hz and {ripple.high_hz / 1e3:g} kHz its peak must stay below {1e3 * ripple.max_v:.2g} "
        f"mV: more {effect}. Use a low-noise linear regulator near the board, and supply nothing else from it.",
    ]
    if values.comparator_levels:
        notes.append(
            f"S is an active-low logic output: low while slip is detected, and pulled up to +{supply_v:g} V by R21 "
            f"({PULL_UP_OHM / 1e3:g}k) otherwise. A 3.3 V input needs a divider or a level shifter."
        )
    return notes


def _controller_power_notes(values: BoardValues, design: Design) -> list[str]:
    """Describe protection and ripple of a board for a controller, and its slip output."""
    ripple, supply_v = values.supply_ripple, design.board.supply_v
    low_v, high_v = SUPPLY_RANGES_V[values.supply]
    effect = "makes the diode conduct" if values.output_offset is None else "counts as slip at the design's threshold"
    notes = [
        f"Supply {low_v:g} to {high_v:g} V at J2. Q1 blocks a reversed supply. It costs {1e3 * MAX_SWITCH_OHM:.0f} uV "
        f"per mA at most ({1e3 * MAX_SWITCH_OHM:g} mohm).",
        "The plugs of J1, J2 and J3 differ in size, and each fits one way round only.",
        "A divider, C23 and U6 feed the bridge with VREF, which follows the supply below 0.7 Hz only. Ripple on the "
        f"supply reaches the rectifier multiplied by {ripple.gain:.2f} at most, at "
        f"{format_figure(ripple.worst_hz, 2)} Hz ({describe_sensor(ripple)}). Between "
        f"{ripple.low_hz:.3g} Hz and "
        f"{ripple.high_hz / 1e3:g} kHz its peak must stay below {format_figure(1e3 * ripple.max_v, 2)} mV: more "
        f"{effect}. The supply rejection of the amplifiers themselves is not part of these figures.",
        f"After power-up VMID and VREF rise with a time constant of a quarter of a second: wait {POWER_UP_S:g} s.",
        "Feed the controller from the same 3.3 V. Then no signal exceeds its supply, and both go on and off together. "
        "The clamps lead to the supply of this board: they do not protect a controller that is off, or on less.",
    ]
    if values.comparator_levels:
        notes.append(
            f"SLIP is an active-low open collector with a pull-up to +{supply_v:g} V (R21, {PULL_UP_OHM / 1e3:g}k), "
            "which the hysteresis needs. Do not join the SLIP lines of two boards: each would change the threshold of "
            "the other."
        )
    return notes


def limitation_notes(values: BoardValues) -> list[str]:
    """Limitations that a user should know."""
    if SUPPLIES[values.supply].is_for_controller:
        return [
            "There is no protection against an excessive supply voltage.",
            "The filtered signal has less headroom than on the boards for 5 V: a fast press clips it for some "
            "milliseconds.",
        ]
    return [
        "There is no filter for the bridge's supply. A filter that rejects ripple at 30 Hz does not fit on this board.",
        "There is no protection against a reversed supply or an excessive supply voltage.",
    ]
