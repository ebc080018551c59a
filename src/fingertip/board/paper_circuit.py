"""The whole board of variant `paper`, on a split supply: the article's circuit (figure 3) and what it needs around it.

Bridge and amplifier, two high-pass stages, a diode, an envelope; anti-alias and clamp towards the converter; supply.
The article draws the part from TACTILE to ENVELOPE, and its references stand there (R_LP and C_LP are R6 and C4,
because KiCad's annotation wants references that end in a digit).
"""

from __future__ import annotations

from collections.abc import Mapping

from fingertip.board import symbols
from fingertip.board.bridge import Bridge
from fingertip.board.circuit import Circuit, Part, Symbol, connected, engineering
from fingertip.design.filter_components import Components

NAME = "slip_filter"

# Net names.
GND = "GND"
VCC = "VCC"
VEE = "VEE"
SENSOR = "SENSOR"
REFERENCE = "REFERENCE"
GAIN_A = "GAIN_A"
GAIN_B = "GAIN_B"
TACTILE = "TACTILE"
STAGE1_IN = "STAGE1_IN"
FEEDBACK = "FEEDBACK"
STAGE1_OUT = "STAGE1_OUT"
STAGE2_MID = "STAGE2_MID"
STAGE2_IN = "STAGE2_IN"
FILTERED = "FILTERED"
ENVELOPE = "ENVELOPE"
ADC_TACTILE = "ADC_TACTILE"
ADC_ENVELOPE = "ADC_ENVELOPE"

# Values that no parameter of the design moves.
SUPPLY_F = 100e-9
"""Beside each supply pin."""
BULK_F = 10e-6
"""Where the supply enters."""
CABLE_F = 100e-9
"""Across the sensor: with the bridge's 230 ohm, a pole at 7 kHz against what the cable picks up."""
ALIAS_OHM = 10e3
"""Ahead of the converter: also limits the current into the clamp to 1 mA at 10 V beyond the rails."""
ALIAS_F = 22e-9
"""With `ALIAS_OHM` a pole at 723 Hz, for the default 2 kHz of sampling. It loads the envelope by 1 % of C_LP."""

Wiring = Mapping[Part, Mapping[str, str]]

_FILTER_RATING = "1 % or better, 0.1 W"
_BRIDGE_RATING = "0.1 %, 25 ppm/K, 0.1 W"
_SIGNAL_RATING = "film or C0G where the size allows, else X7R 16 V 10 % or better"
_HEADER_RATING = "pin header 2.54 mm, one row; or solder the wires"
_SUPPLY_RATING = "X7R 25 V 10 %"


def paper_circuit(values: Components, bridge: Bridge) -> Circuit:
    """The board with these component values, checked."""
    return whole_board(bridge, {**high_passes(values), **_peak_detector(values)})


def whole_board(bridge: Bridge, signal_path: Wiring, fourth_pin: str = GND) -> Circuit:
    """A variant's parts from TACTILE on, with what all variants have around them; checked."""
    wiring: dict[Part, Mapping[str, str]] = {}
    for block in (_front_end(bridge), signal_path, _converter(fourth_pin), _supply(), _test_points(), _holes()):
        wiring.update(block)
    return connected(NAME, wiring)


def _front_end(bridge: Bridge) -> Wiring:
    """Sensor, bridge, instrumentation amplifier."""

    def arm(reference: str, ohm: float, role: str) -> Part:
        return _resistor(reference, ohm, role, _BRIDGE_RATING)

    sensor = part("J1", "FSR", symbols.CONNECTOR_2, symbols.HEADER_2, "force-sensing resistor")
    amplifier = part("U2", "AD623ARMZ", symbols.AD623, symbols.MSOP_8, "instrumentation amplifier of the bridge")
    return {
        sensor: {"1": SENSOR, "2": GND},
        arm("R10", bridge.top_ohm, "bridge: supply to sensor"): {"1": VCC, "2": SENSOR},
        arm("R11", bridge.shunt_ohm, "bridge: parallel to the sensor"): {"1": SENSOR, "2": GND},
        arm("R12", bridge.high_ohm, "bridge: supply to reference"): {"1": VCC, "2": REFERENCE},
        arm("R13", bridge.low_ohm, "bridge: reference to ground"): {"1": REFERENCE, "2": GND},
        arm("R14", bridge.gain_ohm, "bridge: gain of its amplifier"): {"1": GAIN_A, "2": GAIN_B},
        _capacitor("C7", CABLE_F, "sensor's cable: radio interference", symbols.C_0603): {"1": SENSOR, "2": GND},
        amplifier: {
            "1": GAIN_A, "8": GAIN_B, "2": REFERENCE, "3": SENSOR, "5": GND, "6": TACTILE, "7": VCC, "4": VEE,
        },
    }  # fmt: skip


def high_passes(values: Components, r4_returns_to: str = GND) -> Wiring:
    """Both filters of the article's figure 3."""
    amplifier = part("U1", "TL082", symbols.TL082, symbols.SOIC_8, "first stage and Sallen-Key stage")
    return {
        # First-order high-pass, gain 1 + R5/R4 (eqs. 1, 2).
        signal_capacitor("C1", values.c_f, "first stage: in series"): {"1": TACTILE, "2": STAGE1_IN},
        filter_resistor("R1", values.r1_ohm, "first stage: pole, with C1"): {"1": STAGE1_IN, "2": GND},
        filter_resistor("R4", values.r4_ohm, "first stage: to ground"): {"1": FEEDBACK, "2": r4_returns_to},
        filter_resistor("R5", values.r5_ohm, "first stage: feedback"): {"1": STAGE1_OUT, "2": FEEDBACK},
        amplifier: {
            "3": STAGE1_IN, "2": FEEDBACK, "1": STAGE1_OUT,
            "5": STAGE2_IN, "6": FILTERED, "7": FILTERED,
            "8": VCC, "4": VEE,
        },
        # Unity-gain Sallen-Key high-pass (eqs. 3, 4): R2 from between the capacitors to the output.
        signal_capacitor("C2", values.c_f, "second stage: first in series"): {"1": STAGE1_OUT, "2": STAGE2_MID},
        signal_capacitor("C3", values.c_f, "second stage: last in series"): {"1": STAGE2_MID, "2": STAGE2_IN},
        filter_resistor("R2", values.r2_ohm, "second stage: feedback"): {"1": STAGE2_MID, "2": FILTERED},
        filter_resistor("R3", values.r3_ohm, "second stage: to ground"): {"1": STAGE2_IN, "2": GND},
    }  # fmt: skip


def _peak_detector(values: Components) -> Wiring:
    """The diode feeds R_LP parallel to C_LP (eq. 11)."""
    diode = part("D1", "1N4148W", symbols.DIODE_1N4148W, symbols.SOD_123, "half-wave rectifier")
    return {
        diode: {"2": FILTERED, "1": ENVELOPE},
        filter_resistor("R6", values.r_lp_ohm, "envelope: R_LP"): {"1": ENVELOPE, "2": GND},
        signal_capacitor("C4", values.c_lp_f, "envelope: C_LP"): {"1": ENVELOPE, "2": GND},
    }  # fmt: skip


def _converter(fourth_pin: str) -> Wiring:
    """Anti-alias poles and clamps to ground and VCC, for the envelope and for the tactile voltage."""
    output = part("J3", "ADC", symbols.CONNECTOR_4, symbols.HEADER_4, "to the converter: tactile voltage, envelope")
    return {
        filter_resistor("R7", ALIAS_OHM, "anti-alias of the envelope"): {"1": ENVELOPE, "2": ADC_ENVELOPE},
        _capacitor("C8", ALIAS_F, "anti-alias of the envelope", symbols.C_0603): {"1": ADC_ENVELOPE, "2": GND},
        _clamp("D2", "clamp of the envelope"): {"1": GND, "2": VCC, "3": ADC_ENVELOPE},
        filter_resistor("R8", ALIAS_OHM, "anti-alias of the tactile voltage"): {
            "1": TACTILE, "2": ADC_TACTILE,
        },
        _capacitor("C9", ALIAS_F, "anti-alias of the tactile voltage", symbols.C_0603): {"1": ADC_TACTILE, "2": GND},
        _clamp("D3", "clamp of the tactile voltage"): {"1": GND, "2": VCC, "3": ADC_TACTILE},
        output: {"1": ADC_TACTILE, "2": ADC_ENVELOPE, "3": GND, "4": fourth_pin},
    }  # fmt: skip


def _supply() -> Wiring:
    """Connector and decoupling."""
    plus, minus = {"1": VCC, "2": GND}, {"1": GND, "2": VEE}
    power = part("J2", "POWER", symbols.CONNECTOR_3, symbols.HEADER_3, "supply: plus, ground, minus")
    return {
        power: {"1": VCC, "2": GND, "3": VEE},
        _capacitor("C10", BULK_F, "plus supply, at its entry", symbols.C_0805): plus,
        _capacitor("C11", BULK_F, "minus supply, at its entry", symbols.C_0805): minus,
        _capacitor("C5", SUPPLY_F, "plus supply, at U1", symbols.C_0603): plus,
        _capacitor("C6", SUPPLY_F, "minus supply, at U1", symbols.C_0603): minus,
        _capacitor("C12", SUPPLY_F, "plus supply, at U2", symbols.C_0603): plus,
        _capacitor("C13", SUPPLY_F, "minus supply, at U2", symbols.C_0603): minus,
    }


def _test_points() -> Wiring:
    nets = {"TP1": TACTILE, "TP2": STAGE1_OUT, "TP3": FILTERED, "TP4": ENVELOPE, "TP5": GND}
    return {
        Part(reference, net, symbols.TEST_POINT, symbols.TEST_PAD, f"test point: {net.lower()}"): {"1": net}
        for reference, net in nets.items()
    }


def _holes() -> Wiring:
    return {Part(f"H{i}", "M2", symbols.MOUNTING_HOLE, symbols.M2_HOLE, "mounting hole"): {} for i in range(1, 5)}


def part(reference: str, value: str, symbol: Symbol, footprint: str, role: str) -> Part:
    """A part bought by its name."""
    rating = _HEADER_RATING if reference.startswith("J") else symbol.description
    return Part(reference, value, symbol, footprint, role, rating)


def filter_resistor(reference: str, ohm: float, role: str) -> Part:
    """A resistor of the signal path."""
    return _resistor(reference, ohm, role, _FILTER_RATING)


def signal_capacitor(reference: str, farad: float, role: str) -> Part:
    """A capacitor of the signal path."""
    return _capacitor(reference, farad, role, symbols.C_1206, _SIGNAL_RATING)


def supply_capacitor(reference: str, farad: float, role: str, footprint: str) -> Part:
    """A capacitor between rails."""
    return _capacitor(reference, farad, role, footprint)


def _resistor(reference: str, ohm: float, role: str, rating: str) -> Part:
    return Part(reference, engineering(ohm), symbols.RESISTOR, symbols.R_0603, role, rating)


def _capacitor(reference: str, farad: float, role: str, footprint: str, rating: str = _SUPPLY_RATING) -> Part:
    return Part(reference, engineering(farad), symbols.CAPACITOR, footprint, role, rating)


def _clamp(reference: str, role: str) -> Part:
    return part(reference, "BAT54S", symbols.BAT54S, symbols.SOT_23, role)
