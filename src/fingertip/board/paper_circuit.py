"""The article's circuit (figure 3): two high-pass stages, a diode, an envelope, on a split supply.

The tactile voltage enters at J1, from a bridge and instrumentation amplifier that the article does not show.
"""

from __future__ import annotations

from fingertip.board import symbols
from fingertip.board.circuit import Circuit, Part, connected, engineering
from fingertip.design.filter_components import Components

DECOUPLING = "100n"

# Net names.
TACTILE = "TACTILE"
GND = "GND"
VCC = "VCC"
VEE = "VEE"
STAGE1_IN = "STAGE1_IN"
STAGE1_FEEDBACK = "STAGE1_FEEDBACK"
STAGE1_OUT = "STAGE1_OUT"
STAGE2_MID = "STAGE2_MID"
STAGE2_IN = "STAGE2_IN"
FILTERED = "FILTERED"
ENVELOPE = "ENVELOPE"


def paper_circuit(values: Components) -> Circuit:
    """The circuit of figure 3 with these component values, checked.

    References end in a digit, as KiCad's annotation wants: the article's R_LP and C_LP are R6 and C4.
    """

    def resistor(reference: str, ohm: float, role: str) -> Part:
        return Part(reference, engineering(ohm), symbols.RESISTOR, symbols.R_0603, role)

    def capacitor(reference: str, farad: float, role: str) -> Part:
        return Part(reference, engineering(farad), symbols.CAPACITOR, symbols.C_1206, role)

    def decoupling(reference: str, role: str) -> Part:
        return Part(reference, DECOUPLING, symbols.CAPACITOR, symbols.C_0603, role)

    tactile = Part("J1", "TACTILE", symbols.CONNECTOR_2, symbols.HEADER_2, "tactile voltage in, ground")
    power = Part("J2", "POWER", symbols.CONNECTOR_3, symbols.HEADER_3, "supply: plus, ground, minus")
    envelope = Part("J3", "ENVELOPE", symbols.CONNECTOR_2, symbols.HEADER_2, "envelope to the ADC, ground")
    amplifier = Part("U1", "TL082", symbols.TL082, symbols.SOIC_8, "first stage and Sallen-Key stage")
    diode = Part("D1", "1N4148", symbols.DIODE_1N4148, symbols.DO_35, "half-wave rectifier")
    return connected(
        "slip_filter",
        {
            tactile: {"1": TACTILE, "2": GND},
            # First-order high-pass, gain 1 + R5/R4 (eqs. 1, 2).
            capacitor("C1", values.c_f, "first stage: in series"): {"1": TACTILE, "2": STAGE1_IN},
            resistor("R1", values.r1_ohm, "first stage: pole, with C1"): {"1": STAGE1_IN, "2": GND},
            resistor("R4", values.r4_ohm, "first stage: to ground"): {"1": STAGE1_FEEDBACK, "2": GND},
            resistor("R5", values.r5_ohm, "first stage: feedback"): {"1": STAGE1_OUT, "2": STAGE1_FEEDBACK},
            amplifier: {
                "3": STAGE1_IN, "2": STAGE1_FEEDBACK, "1": STAGE1_OUT,
                "5": STAGE2_IN, "6": FILTERED, "7": FILTERED,
                "8": VCC, "4": VEE,
            },
            # Unity-gain Sallen-Key high-pass (eqs. 3, 4): R2 from between the capacitors to the output.
            capacitor("C2", values.c_f, "second stage: first in series"): {"1": STAGE1_OUT, "2": STAGE2_MID},
            capacitor("C3", values.c_f, "second stage: last in series"): {"1": STAGE2_MID, "2": STAGE2_IN},
            resistor("R2", values.r2_ohm, "second stage: feedback"): {"1": STAGE2_MID, "2": FILTERED},
            resistor("R3", values.r3_ohm, "second stage: to ground"): {"1": STAGE2_IN, "2": GND},
            # Peak detector (eq. 11): the diode feeds R_LP parallel to C_LP.
            diode: {"2": FILTERED, "1": ENVELOPE},
            resistor("R6", values.r_lp_ohm, "envelope: R_LP"): {"1": ENVELOPE, "2": GND},
            capacitor("C4", values.c_lp_f, "envelope: C_LP"): {"1": ENVELOPE, "2": GND},
            envelope: {"1": ENVELOPE, "2": GND},
            power: {"1": VCC, "2": GND, "3": VEE},
            decoupling("C5", "decoupling of the plus supply"): {"1": VCC, "2": GND},
            decoupling("C6", "decoupling of the minus supply"): {"1": GND, "2": VEE},
        },
    )  # fmt: skip
