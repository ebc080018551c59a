"""Bring-up sheet: what to look at, to measure and to feed in, in this order, with limits and what a failure means."""

from __future__ import annotations

import math
from collections.abc import Iterable

from fingertip.board.analysis.board_values import BoardValues
from fingertip.board.bringup.bench import (
    COUPLING_FARAD,
    HOST,
    METER_OHM,
    TONE_V,
    TOP_HZ,
    attenuate_tones,
    has_tone,
    largest_drop_v,
    list_output_pins,
)
from fingertip.board.bringup.diagnosis import list_hidden_faults, list_unsimulated
from fingertip.board.bringup.idle_level import describe_idle_level
from fingertip.board.bringup.limits import BOARDS, METER_AC, METER_DC, SUPPLY_PERCENT, Limits
from fingertip.board.bringup.plan import (
    NEGATIVE_OHM,
    QUIET,
    SENSOR_OHM,
    SLIP_TONE,
    SUPPLY_MA,
    SUPPLY_OHM,
    BringUp,
)
from fingertip.board.bringup.prediction import POINTS, list_levels, name_tone, name_voltage
from fingertip.board.bringup.wiring import list_pins as list_connector_pins
from fingertip.board.circuits.signal_paths import RECT_OUT, SLIP, THRESHOLD
from fingertip.board.kicad.placement import PlacedPad, Placement, place_pads
from fingertip.board.kicad.variants import find_configuration
from fingertip.board.parts.circuit import (
    ADC_ENVELOPE,
    ADC_FILTERED,
    ADC_TACTILE,
    ENVELOPE,
    FILTERED,
    GND,
    REFERENCE,
    SENSOR,
    STAGE1_OUT,
    STAGE2_MID,
    TACTILE,
    VCC,
    VMID,
    VMID_OUT,
    Circuit,
    format_component_value,
)
from fingertip.board.parts.symbols import LOCKING_CONNECTORS
from fingertip.design import Design
from fingertip.documents.board.signals import trimming_procedure
from fingertip.foundation.errors import BoardError

# Places for the probes where no test point is: an end of a part, named by its side as seen from the front.
#
# Sides are those of the board with sensor and supply on the left.


FRONT = "Sides of parts are as seen from the front, with J1 and J2 on the left."


def find_end(circuit: Circuit, placement: Placement, reference: str, net: str) -> str:
    """Name the end of a two-terminal part that is at a net, such as "right end of C10". Raises BoardError."""
    pads = [pad for pad in place_pads(circuit, placement) if pad.reference == reference]
    here = next((pad for pad in pads if pad.net == net), None)
    other = next((pad for pad in pads if pad.net != net), None)
    if here is None or other is None:
        raise BoardError(f"no end of {reference} alone is at {net}; this is a fault of the program.")
    return f"{_name_side(here, other)} end of {reference}"


def find_pin_1_end(circuit: Circuit, placement: Placement, reference: str) -> str:
    """Name the end of a connector at which pin 1 lies, such as "lower"."""
    pads = {pad.pad.number: pad for pad in place_pads(circuit, placement) if pad.reference == reference}
    last = max((name for name in pads if name.isdigit()), key=int)
    return _name_side(pads["1"], pads[last])


def find_widest(circuit: Circuit, placement: Placement, net: str) -> str:
    """Find the two-terminal part whose pad at a net is the largest, and name that end."""
    by_part: dict[str, list[PlacedPad]] = {}
    for pad in place_pads(circuit, placement):
        if pad.reference[0] in "RC" and pad.reference[1:].isdigit():
            by_part.setdefault(pad.reference, []).append(pad)
    at_net = {
        reference: pads[0].half_width * pads[0].half_height
        for reference, pads in by_part.items()
        if sum(pad.net == net for pad in pads) == 1
    }
    if not at_net:
        raise BoardError(f"no resistor or capacitor is at {net}; this is a fault of the program.")
    return find_end(circuit, placement, max(at_net, key=lambda reference: at_net[reference]), net)


def _name_side(pad: PlacedPad, other: PlacedPad) -> str:
    dx, dy = pad.x - other.x, pad.y - other.y
    if abs(dx) > abs(dy):
        return "right" if dx > 0 else "left"
    return "lower" if dy > 0 else "upper"


_PROBES = {
    TACTILE: "TP1, tactile voltage",
    STAGE1_OUT: "TP2, first stage",
    FILTERED: "TP3, filtered signal",
    ENVELOPE: "TP4, envelope",
    VMID: "TP5, signal ground; black probe at supply ground",
    SENSOR: "J1 pin 1, sensor",
    RECT_OUT: "U3 pin 1, rectifier",
}
"""Place of the red probe for each net that has a test point or a pin of its own."""
_ENDS = {REFERENCE: ("R13", "reference"), STAGE2_MID: ("R2", "second stage")}
"""Part whose end is the place of the red probe for the other nets, and their name."""
_MEANINGS = {
    TACTILE: "bridge R10 to R13, its amplifier U2 with R14",
    STAGE1_OUT: "U1, R4, R5",
    FILTERED: "U1, R2, R3",
    ENVELOPE: "rectifier and envelope",
    VMID: "R22, R23, U5",
    SENSOR: "R10, R11, C7",
    REFERENCE: "R12, R13",
}
"""Parts that a constant voltage depends on."""
_OUTPUT_PARTS = {
    ADC_TACTILE: "R8, R9, D3; C9 and C19 bridged",
    ADC_FILTERED: "R27, D5; C25 bridged",
    ADC_ENVELOPE: "R7, D2; C8 bridged",
    VMID_OUT: "R24",
}
"""Parts between a test point and its pin of J3."""


def render_sheet(plan: BringUp, values: BoardValues, design: Design, wiring: str) -> str:
    """Render the bring-up sheet of a design's board as Markdown, with the file of its wiring diagram."""
    bench, board = plan.board.bench, plan.board
    light, firm = bench.dummy_ohm
    low, middle, high = bench.tones_hz
    placement = find_configuration(values).placement
    ground = "TP5 (signal ground)" if board.signal_ground == VMID else "TP5 (ground)"
    sections = [
        f"# Bring-up of board `{design.name}`",
        "This sheet tests a soldered board with a multimeter and the tone of a phone, from the first look on. The "
        f"limits of a reading are the extremes of {BOARDS} simulated boards, whose resistors, capacitors and offsets "
        f"lie anywhere within their tolerances, on a supply within {SUPPLY_PERCENT:g} %, and the error of a simple "
        f"meter ({100 * METER_DC[0]:g} % and {1e3 * METER_DC[1]:g} mV; alternating {100 * METER_AC[0]:g} % and "
        f"{1e3 * METER_AC[1]:g} mV).",
        "Write every reading into a copy of `bringup_readings.toml`. If one fails, `fingertip board DESIGN --readings "
        "FILE` says which part is the likely fault.",
        "## What you need",
        _bullets(
            [
                "A multimeter with a range of millivolts that reads alternating voltage up to 400 Hz.",
                f"A supply of {_describe_supply(plan)} within {SUPPLY_PERCENT:g} %, with a current limit of "
                f"{_limit_ma(plan):.0f} mA if it has one.",
                *(["Plugs with wires for J1 and J2: README.md, What else to buy."] if _is_protected(plan) else []),
                f"Resistors of {_ohm(light)} and {_ohm(firm)} (1 %) in place of the sensor.",
                "A tone generator, or a phone with an app for tones and a headphone cable; "
                f"{_ohm(bench.coupling_ohm)} (1 %) and {format_component_value(COUPLING_FARAD)}F in series from its "
                "signal to J1 pin 1. Its ground goes to supply ground.",
            ]
        ),
        "## Where there is no test point",
        f"{FRONT} Not every part has its reference printed beside it: the assembly drawing, `fab/"
        f"{board.circuit.name}_assembly.pdf` of `--fab`, shows all of them. {_warn_of_fiducials(placement)}",
        _table(("net", "place"), _list_places(plan, placement)),
        "## Wiring",
        f"![Wiring of sensor, supply and controller]({wiring})",
        "The supply alone is connected for these tests. Connect the controller, and the sensor in place of the "
        "resistors, when the board has passed.",
        "## 1. Look",
        _bullets(_list_looks(plan)),
        "## 2. Ohmmeter, without power",
        _table(("reading", "where", "expected", "accept", "else"), _list_resistances(plan, placement)),
        "Wait until the reading stands still: it charges the capacitors. The amplifiers lie in parallel with the "
        "resistors: a meter may read less than the resistors alone would give. With the red probe at plus expect "
        "kilohms or more. With the probes exchanged the meter drives the diodes of the amplifiers: it reads less, and "
        "0.4 to 0.7 V on its diode range. That is no short.",
        "## 3. First power",
        f"Nothing at J1 and J3. {_describe_reversal(plan)}",
        _table(
            ("reading", "where", "expected", "accept", "else"),
            [
                _row(
                    plan,
                    SUPPLY_MA,
                    "mA, into the positive supply",
                    "more: switch off, an amplifier is rotated or bridged",
                )
            ],
        ),
        "## 4. Voltages",
        f"Black probe at {ground}. First with J1 open, then with each resistor in the sensor's place.",
        _table(("reading", "red probe", "expected", "accept", "depends on"), _list_voltages(plan, placement)),
        "## 5. Outputs",
        _describe_outputs(plan, placement),
        _table(("reading", "red probe", "expected", "accept", "depends on"), _list_outputs(plan)),
        "## 6. Tone",
        f"{_ohm(light)} at J1. Set the tone to {TONE_V:g} V RMS, measured at the generator while it is connected; the "
        "file takes another value too. Meter at alternating voltage, except where direct voltage is stated.",
        _table(("reading", "tone", "red probe", "expected", "accept"), _list_tones(plan, placement)),
        f"The filter passes {high:g} Hz and stops what is well below {middle:g} Hz, so the readings must rise from "
        f"{low:g} Hz to {high:g} Hz. {_warn_of_range(low)}".rstrip(),
        *_describe_output_tones(plan),
        "## 7. Quiet",
        "The tone off, the resistor still at J1, with the cables as long as in the hand.",
        _table(
            ("reading", "where", "expected", "accept", "else"),
            [_row(plan, QUIET, "TP3, alternating", "hum or oscillation: shorten and twist the wires, try a battery")],
        ),
        "## 8. Threshold",
        _describe_threshold(plan, values, design),
        "## When a reading fails",
        "Fill in what you have: three voltages are enough for a diagnosis, more tell more faults apart.",
        "    fingertip board DESIGN --readings FILE",
        "## What no reading reveals",
        _describe_hidden(plan),
    ]
    return "\n\n".join(sections) + "\n"


def _describe_supply(plan: BringUp) -> str:
    volts = plan.board.rails_v["VCC"]
    return f"plus and minus {volts:g} V" if plan.board.signal_ground == GND else f"{volts:g} V"


def _limit_ma(plan: BringUp) -> float:
    """Current limit of the supply [mA]: three times what the board should draw, in tens."""
    return 10.0 * math.ceil(0.3 * plan.current[SUPPLY_MA].expected_v)


def _describe_reversal(plan: BringUp) -> str:
    if _is_protected(plan):
        return "A reversed supply does no harm: Q1 blocks it, and the current stays 0."
    return "Nothing protects against a reversed supply: check its polarity at J2 with the meter before you plug it in."


def _is_protected(plan: BringUp) -> bool:
    return any(part.symbol.name == "AO3401A" for part in plan.board.circuit.components)


def _list_looks(plan: BringUp) -> list[str]:
    parts = {part.reference: part for part in plan.board.circuit.components}
    diodes = [r for r, part in parts.items() if part.symbol.name == "1N4148W"]
    amplifiers = [r for r, part in parts.items() if r.startswith("U")]
    small = [r for r, part in parts.items() if "SOT-23" in part.footprint]
    looks = [
        "No bridge of solder between the pins of the amplifiers, no part beside its pads or on its edge.",
        f"The dot of {_join([r for r in amplifiers if r not in small])} at pin 1, which the silkscreen shows.",
        f"The bar of {_join(diodes)} at the cathode, pin 1.",
    ]
    if small:
        looks.append(f"The side of {_join(small)} with two or three legs where the board has two or three pads.")
    if parts["J1"].footprint in LOCKING_CONNECTORS:
        looks.append("The tabs of the connectors soldered too: they take the pull of the cables.")
    return looks


def _list_resistances(plan: BringUp, placement: Placement) -> list[tuple[str, ...]]:
    # Behind the MOSFET that blocks a reversed supply, because without power it blocks the meter too.
    if _is_protected(plan):
        plus = find_end(plan.board.circuit, placement, "C10", VCC)
        where = f"C10: red probe at its {plus.removesuffix(' of C10')}, black at the other"
    else:
        where = "J2: red probe at plus, black at ground"
    rows = [_row(plan, SUPPLY_OHM, where, "a short: do not apply power")]
    if NEGATIVE_OHM in plan.before_power:
        rows.append(_row(plan, NEGATIVE_OHM, "J2: ground to minus", "a short: do not apply power"))
    return [*rows, _row(plan, SENSOR_OHM, "J1: between its pins", "R10 to R13, C7")]


def _list_voltages(plan: BringUp, placement: Placement) -> list[tuple[str, ...]]:
    rows = []
    for net in plan.board.nets:
        rows.append(_row(plan, name_voltage(net), _find_probe(plan, placement, net), _MEANINGS[net]))
    for ohm in plan.board.bench.dummy_ohm:
        rows.append(_row(plan, name_voltage(TACTILE, ohm), f"TP1, with {_ohm(ohm)} at J1", "the same"))
    return rows


def _list_tones(plan: BringUp, placement: Placement) -> list[tuple[str, ...]]:
    high = plan.board.bench.tones_hz[-1]
    rows: list[tuple[str, ...]] = []
    found = [*list_levels(plan.board.bench), (ENVELOPE, high)]
    if name_tone(RECT_OUT, high) in plan.levels:
        found.append((RECT_OUT, high))
    for net, hz in found:
        where = _find_probe(plan, placement, net) + (", direct voltage" if net in (ENVELOPE, RECT_OUT) else "")
        rows.append((f"`{name_tone(net, hz)}`", f"{hz:g} Hz", where, *_figures(plan.all[name_tone(net, hz)], "V")))
    for pin in filter(has_tone, list_output_pins(plan.board.circuit)):
        where = f"{pin.letter} at {HOST}, alternating"
        rows.append((f"`{pin.tone_name}`", f"{TOP_HZ:g} Hz", where, *_figures(plan.all[pin.tone_name], "V")))
    return rows


def _describe_outputs(plan: BringUp, placement: Placement) -> str:
    """Say where the pins of J3 are, and by how much they may differ from their test points."""
    pins, circuit = list_output_pins(plan.board.circuit), plan.board.circuit
    drop_v = largest_drop_v(circuit, {name: limits.expected_v for name, limits in plan.levels.items()})
    points = ", ".join(f"{pin.letter}: {POINTS[pin.source]}" for pin in pins)
    return (
        f"J1 open again. Black probe at supply ground, red probe at the legs of {HOST}: pin 1 is its "
        f"{find_pin_1_end(circuit, placement, HOST)} end. A probe that bridges two legs does no harm: a resistor lies "
        f"ahead of each signal. Each pin equals its test point ({points}), measured from supply ground too, within "
        f"{1e3 * (drop_v + 2.0 * METER_DC[1]):.0f} mV: a meter of {METER_OHM / 1e6:g} Mohm takes up to "
        f"{1e3 * drop_v:.1f} mV in the resistors ahead, and may be off by {1e3 * METER_DC[1]:g} mV in both readings."
    )


def _list_outputs(plan: BringUp) -> list[tuple[str, ...]]:
    circuit = plan.board.circuit
    pins = {pin.net: pin for pin in list_output_pins(circuit)}
    rows = []
    for number, net in list_connector_pins(circuit, circuit.component(HOST)):
        if net in pins:
            where = f"{pins[net].letter}, pin {number}"
            rows.append(_row(plan, pins[net].constant_name, where, _OUTPUT_PARTS[net]))
    return rows


def _describe_output_tones(plan: BringUp) -> list[str]:
    """Describe how much of the filtered signal's tone its pin has."""
    return [
        f"At {TOP_HZ:g} Hz {HOST} pin {letter} has {100.0 * ratio:.0f} % of the tone at TP3: R27 and C25 take the rest."
        for name, ratio in attenuate_tones(plan.board.circuit).items()
        for letter in [name.split("_")[1].upper()]
    ]


def _describe_hidden(plan: BringUp) -> str:
    """Name the faults that the readings cannot show."""
    items = [f"{what.capitalize()}: {_join(references)}." for what, references in list_hidden_faults(plan).items()]
    return _bullets(
        [
            *items,
            f"Missing: {_join(list_unsimulated(plan))}, which clamp the outputs.",
            "Values that are off by less than the limits allow, and everything at frequencies above those measured.",
        ]
    )


def _find_probe(plan: BringUp, placement: Placement, net: str) -> str:
    """Find the place of the red probe for a net."""
    if net in _PROBES:
        return _PROBES[net]
    reference, name = _ENDS[net]
    return f"{find_end(plan.board.circuit, placement, reference, net)}, {name}"


def _list_places(plan: BringUp, placement: Placement) -> list[tuple[str, str]]:
    """List where a probe reaches what has no test point."""
    circuit = plan.board.circuit
    supply = "J2 pin 2, on the back, where it comes through"
    places = [("supply ground (GND)", f"{supply}; or {find_widest(circuit, placement, GND)}")]
    if SLIP in circuit.net_by_pin.values():
        places += [
            ("SLIP", find_end(circuit, placement, "R21", SLIP)),
            (
                "THRESHOLD",
                f"wiper of RV1, the pin alone on its side; or {find_end(circuit, placement, 'R20', THRESHOLD)}",
            ),
        ]
    return places


def _warn_of_fiducials(placement: Placement) -> str:
    count = len(placement.fiducials)
    return f"The {count} ringed dots of bare copper are fiducials, marks for the assembly: nothing is connected there."


def _warn_of_range(low_hz: float) -> str:
    if low_hz >= 40.0:
        return ""
    return f"Simple meters read too little below 40 Hz: take {low_hz:g} Hz with an oscilloscope, or leave it out."


def _describe_threshold(plan: BringUp, values: BoardValues, design: Design) -> str:
    levels = values.comparator_levels
    if SLIP_TONE not in plan.others or levels is None:
        text = (
            "The threshold of this board lies in the detector's software: `fingertip detect` states it. Press the "
            "sensor, stroke it, and look at the recorded signal."
        )
        if values.output_offset is None:
            return text
        return f"{text}\n\n{describe_idle_level(plan, design.detector.threshold_v)}"
    hz, high_v = plan.board.bench.tones_hz[-1], 0.8 * design.board.supply_v
    row = _row(plan, SLIP_TONE, f"tone of {hz:g} Hz, at the generator", "trim as below; else R19 to R21, U4")
    table = _table(("reading", "where", "expected", "accept", "else"), [row])
    return (
        "RV1 at its midpoint, the tone off. SLIP must be above "
        f"{high_v:.1f} V. If it is not, turn RV1 anticlockwise until it is. Raise the tone from 0 until SLIP falls, "
        f"and note the tone. Lower the tone: SLIP must rise again at about {100 * levels.off_v / levels.on_v:.0f} % of "
        f"it. If SLIP never falls, or never rises, check R18 to R21 and U4.\n\n{table}\n\n## 9. "
        f"Trim\n\n{trimming_procedure(levels, values, design)}"
    )


def _row(plan: BringUp, name: str, where: str, last: str) -> tuple[str, ...]:
    unit = {"v": "V", "ohm": "ohm", "ma": "mA"}[name.rpartition("_")[2]]
    return (f"`{name}`", where, *_figures(plan.all[name], unit), last)


def _figures(limits: Limits, unit: str) -> tuple[str, str]:
    """Expected reading and limits as text."""
    if unit == "ohm":
        if math.isinf(limits.high_v):
            return "-", f"above {_ohm(limits.low_v)}"
        return _ohm(limits.expected_v), f"{limits.low_v:.0f} to {limits.high_v:.0f} ohm"
    digits = 3 if unit == "V" else 1
    values = (f"{value + 0.0:.{digits}f}" for value in (limits.expected_v, limits.low_v, limits.high_v))
    expected, low, high = (value.replace("-0.000", "0.000") for value in values)
    return f"{expected} {unit}", f"{low} to {high} {unit}"


def _ohm(value: float) -> str:
    size, prefix = next(unit for unit in ((1e6, "M"), (1e3, "k"), (1.0, "")) if value >= unit[0] or not unit[1])
    return f"{value / size:.3g} {prefix}ohm"


def _join(words: list[str]) -> str:
    return f"{', '.join(words[:-1])} and {words[-1]}" if len(words) > 1 else words[0]


def _bullets(items: Iterable[str]) -> str:
    return "\n".join(f"- {item}" for item in items)


def _table(heading: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = [heading, ("---",) * len(heading), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
