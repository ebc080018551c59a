"""Signal paths of the variants from TACTILE to ENVELOPE, and the circuits with them.

`article` is the article's circuit (figure 3): two high-pass stages, a diode and an envelope detector. It keeps the
article's references, except that R_LP and C_LP are R6 and C4, because KiCad requires references that end in a digit.

`precision` equals `article` up to FILTERED except for two capacitors. C14 couples R4 to signal ground for AC only, so
that the first stage does not amplify its own offset. C20 across R5 is a low-pass above the band of the vibrations,
where the bridge's amplifier contributes only noise. After FILTERED a precision half-wave rectifier (U3a, D1, D4), which
inverts, drives an inverting first-order low-pass (U3b). Both inputs are virtual grounds, so R_LP and C_LP give the
article's 36.17 Hz whether a diode conducts or not. After two inversions the envelope is positive and follows the
positive half waves. For a sine its mean is 1/pi of the peak.

`comparator` is `precision` with the article's future work: threshold, hysteresis and an ON/OFF pin. The comparator has
an open-collector output: SLIP is low (asserted) while slip is detected and high (VCC) otherwise.
"""

from __future__ import annotations

from fingertip.board.circuits.blocks import (
    DECOUPLING_F,
    SelectedComponents,
    Wiring,
    amplifier,
    complete_circuit,
    component,
    supply_capacitor,
)
from fingertip.board.components.values import SUPPLIES, ComponentValues, Supply
from fingertip.board.parts import symbols
from fingertip.board.parts.circuit import (
    ENVELOPE,
    FEEDBACK,
    FILTERED,
    GND,
    STAGE1_IN,
    STAGE1_OUT,
    STAGE2_IN,
    STAGE2_MID,
    TACTILE,
    VCC,
    VEE,
    Circuit,
    Component,
    format_component_value,
)
from fingertip.foundation.errors import BoardError

SERIES = "SERIES"
RECT_IN = "RECT_IN"
RECT_OUT = "RECT_OUT"
RECTIFIED = "RECTIFIED"
LP_IN = "LP_IN"
MEAN = "MEAN"
TRIM_TOP = "TRIM_TOP"
THRESHOLD = "THRESHOLD"
SLIP = "SLIP"


def board_circuit(values: ComponentValues) -> Circuit:
    """Build the checked circuit of a board with these values. Raises BoardError if it is inconsistent."""
    return CIRCUITS[values.variant](values)


def article_circuit(values: ComponentValues) -> Circuit:
    """Build the checked circuit of variant `article` with these values."""
    return complete_circuit(values, {**_high_passes(values), **_peak_detector(values)})


def precision_circuit(values: ComponentValues) -> Circuit:
    """Build the checked circuit of variant `precision` with these values."""
    return complete_circuit(values, _precision_path(values))


def comparator_circuit(values: ComponentValues) -> Circuit:
    """Build the checked circuit of variant `comparator` with these values."""
    return complete_circuit(values, {**_precision_path(values), **_comparator(values)}, fourth_pin=SLIP)


def _high_passes(values: ComponentValues, r4_net: str = "") -> Wiring:
    """Both filters of the article's figure 3. R4 is connected to the signal ground unless another net is given."""
    supply = SUPPLIES[values.supply]
    ground, parts = supply.signal_ground, SelectedComponents(values)
    return {
        # First-order high-pass, gain 1 + R5/R4 (eqs. 1, 2).
        parts.capacitor("C1", "first stage: in series"): {"1": TACTILE, "2": STAGE1_IN},
        parts.resistor("R1", "first stage: pole, with C1"): {"1": STAGE1_IN, "2": ground},
        parts.resistor("R4", "first stage: gain, with R5"): {"1": FEEDBACK, "2": r4_net or ground},
        parts.resistor("R5", "first stage: feedback"): {"1": STAGE1_OUT, "2": FEEDBACK},
        amplifier("U1", values.amplifier, "first stage and Sallen-Key stage"): {
            "3": STAGE1_IN, "2": FEEDBACK, "1": STAGE1_OUT,
            "5": STAGE2_IN, "6": FILTERED, "7": FILTERED,
            "8": VCC, "4": supply.negative_rail,
        },
        # Unity-gain Sallen-Key high-pass (eqs. 3, 4): R2 from between the capacitors to the output.
        parts.capacitor("C2", "second stage: first in series"): {"1": STAGE1_OUT, "2": STAGE2_MID},
        parts.capacitor("C3", "second stage: last in series"): {"1": STAGE2_MID, "2": STAGE2_IN},
        parts.resistor("R2", "second stage: feedback"): {"1": STAGE2_MID, "2": FILTERED},
        parts.resistor("R3", "second stage: pole, with R2"): {"1": STAGE2_IN, "2": ground},
    }  # fmt: skip


def _peak_detector(values: ComponentValues) -> Wiring:
    """The diode and, after it, R_LP parallel to C_LP (eq. 11)."""
    ground, parts = SUPPLIES[values.supply].signal_ground, SelectedComponents(values)
    diode = component("D1", "1N4148W", symbols.DIODE_1N4148W, symbols.SOD_123, "half-wave rectifier")
    return {
        diode: {"2": FILTERED, "1": ENVELOPE},
        parts.resistor("R6", "envelope: R_LP"): {"1": ENVELOPE, "2": ground},
        parts.capacitor("C4", "envelope: C_LP"): {"1": ENVELOPE, "2": ground},
    }


def _precision_path(values: ComponentValues) -> Wiring:
    """The filters without offset and with a band limit, the precision rectifier and the envelope's low-pass."""
    supply = SUPPLIES[values.supply]
    if values.first_stage_capacitors is None:
        raise BoardError("the values are for variant article; compute them for the variant of this circuit.")
    ground, parts = supply.signal_ground, SelectedComponents(values)
    diodes = [
        component(name, "1N4148W", symbols.DIODE_1N4148W, symbols.SOD_123, role)
        for name, role in (("D1", "rectifier: positive half wave"), ("D4", "rectifier: negative half wave"))
    ]
    path: Wiring = {
        parts.capacitor("C14", "first stage: blocks its offset"): {
            "1": ground, "2": SERIES,
        },
        parts.small_capacitor("C20", "first stage: low-pass"): {
            "1": STAGE1_OUT, "2": FEEDBACK,
        },
        parts.resistor("R15", "rectifier: input"): {"1": FILTERED, "2": RECT_IN},
        parts.resistor("R16", "rectifier: feedback"): {"1": RECT_IN, "2": RECTIFIED},
        diodes[0]: {"1": RECT_OUT, "2": RECTIFIED},
        diodes[1]: {"1": RECT_IN, "2": RECT_OUT},
        parts.resistor("R17", "envelope: input, as R_LP"): {"1": RECTIFIED, "2": LP_IN},
        parts.resistor("R6", "envelope: R_LP"): {"1": LP_IN, "2": ENVELOPE},
        parts.capacitor("C4", "envelope: C_LP"): {"1": LP_IN, "2": ENVELOPE},
        amplifier("U3", values.amplifier, "rectifier and envelope"): {
            "3": ground, "2": RECT_IN, "1": RECT_OUT, "5": ground, "6": LP_IN, "7": ENVELOPE, "8": VCC,
            "4": supply.negative_rail,
        },
        supply_capacitor("C15", DECOUPLING_F, f"{_positive_supply(supply)}, at U3"): {"1": VCC, "2": GND},
    }  # fmt: skip
    if supply.negative_rail == VEE:
        path = {**path, supply_capacitor("C16", DECOUPLING_F, "minus supply, at U3"): {"1": GND, "2": VEE}}
    return {**_high_passes(values, SERIES), **path}


def _positive_supply(supply: Supply) -> str:
    """Name of the supply at VCC, for roles."""
    return "plus supply" if supply.negative_rail == VEE else "supply"


def _comparator(values: ComponentValues) -> Wiring:
    """The averaging low-pass, the threshold and the comparator with hysteresis."""
    supply = SUPPLIES[values.supply]
    ground = supply.signal_ground
    if values.comparator_stage is None:
        raise BoardError("the values are for a variant without comparator; compute them with board.variant=comparator.")
    parts = SelectedComponents(values)
    comparator = component("U4", "LMV331", symbols.LMV331, symbols.SOT_23_5, "comparator of the slip output")
    trimmer = Component(
        "RV1",
        format_component_value(values.by_reference["RV1"]),
        symbols.TRIMMER,
        symbols.TC33X,
        "threshold",
        "trimmer 3 mm, one turn, top",
    )
    return {
        parts.resistor("R18", "averaging low-pass of the envelope"): {"1": ENVELOPE, "2": MEAN},
        parts.small_capacitor("C17", "averaging low-pass of the envelope"): {"1": MEAN, "2": ground},
        parts.resistor("R19", "threshold's range"): {"1": VCC, "2": TRIM_TOP},
        trimmer: {"1": TRIM_TOP, "2": THRESHOLD, "3": ground},
        parts.resistor("R20", "hysteresis"): {"1": THRESHOLD, "2": SLIP},
        parts.resistor("R21", "pull-up of the slip output (active low)"): {"1": VCC, "2": SLIP},
        comparator: {"1": THRESHOLD, "3": MEAN, "4": SLIP, "5": VCC, "2": GND},
        supply_capacitor("C18", DECOUPLING_F, f"{_positive_supply(supply)}, at U4"): {"1": VCC, "2": GND},
    }


CIRCUITS = {"article": article_circuit, "precision": precision_circuit, "comparator": comparator_circuit}
"""Function that builds the circuit of a variant."""
