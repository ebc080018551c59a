"""Notes on the signals, in the README of a board: levels, clipping, loads, and what an ADC may draw."""

from __future__ import annotations

from fingertip.amplifiers import ARTICLE_AMPLIFIER, CATALOGUE
from fingertip.board.analysis.figures import format_figure
from fingertip.board.analysis.limits import describe_adc_range
from fingertip.board.analysis.loads import signal_band_hz
from fingertip.board.analysis.touches import describe_touches
from fingertip.board.board_values import BoardValues
from fingertip.board.circuits.front_end_and_supply import CABLE_OHM
from fingertip.board.components.anti_aliasing import CLAMP_A, LOW_LEAKAGE_CLAMP, MAX_CLAMP_A, MAX_LOW_LEAKAGE_A
from fingertip.board.components.bridge import VREF_RATIO
from fingertip.board.readme_parts.connectors import has_mid_supply
from fingertip.board.readme_parts.text import capitalize
from fingertip.board.supplies import SUPPLIES
from fingertip.design import Design
from fingertip.design.amplifier_stages import DIODE_V

NEEDED_PINS = "Firmware and detector `fast` need T and S (2 analog inputs). A threshold on the envelope needs E and M."
"""Outputs that a controller samples, by what it runs."""
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
