"""Variant `precision`: a rectifier without dead zone, a true pole for the envelope, no offset ahead of C2.

As `paper` up to FILTERED but for C14, which blocks R4's direct current, so that the first stage does not amplify its
own offset. Behind it an inverting half-wave rectifier (U3a, D1, D4) drives an inverting low-pass (U3b): both inputs are
virtual grounds, so R_LP and C_LP give the article's 36.17 Hz whether a diode conducts or not. Two inversions: the
envelope is positive, of the positive half waves. Its mean for a sine is 1/pi of the peak.
"""

from __future__ import annotations

import math

from fingertip.board import symbols
from fingertip.board.bridge import Bridge
from fingertip.board.circuit import Circuit
from fingertip.board.paper_circuit import (
    ENVELOPE,
    FILTERED,
    GND,
    SUPPLY_F,
    VCC,
    VEE,
    Wiring,
    filter_resistor,
    high_passes,
    part,
    signal_capacitor,
    supply_capacitor,
    whole_board,
)  # fmt: skip
from fingertip.design.filter_components import Components, series_capacitor_f

SERIES = "SERIES"
RECT_IN = "RECT_IN"
RECT_OUT = "RECT_OUT"
RECTIFIED = "RECTIFIED"
LP_IN = "LP_IN"

RECTIFIER_OHM = 10e3
"""Both resistors of the rectifier: gain -1."""


def precision_circuit(values: Components, bridge: Bridge) -> Circuit:
    """The board with these component values, checked."""
    return whole_board(bridge, precision_path(values))


def precision_path(values: Components) -> Wiring:
    """From TACTILE to ENVELOPE."""
    cutoff_hz = 1.0 / (math.tau * values.r1_ohm * values.c_f)
    amplifier = part("U3", "TL082", symbols.TL082, symbols.SOIC_8, "rectifier and envelope")
    diodes = [
        part(name, "1N4148W", symbols.DIODE_1N4148W, symbols.SOD_123, role)
        for name, role in (("D1", "rectifier: positive half wave"), ("D4", "rectifier: negative half wave"))
    ]
    rectifier = {
        signal_capacitor("C14", series_capacitor_f(values.r4_ohm, cutoff_hz), "first stage: blocks its offset"): {
            "1": GND, "2": SERIES,
        },
        filter_resistor("R15", RECTIFIER_OHM, "rectifier: input"): {"1": FILTERED, "2": RECT_IN},
        filter_resistor("R16", RECTIFIER_OHM, "rectifier: feedback"): {"1": RECT_IN, "2": RECTIFIED},
        diodes[0]: {"1": RECT_OUT, "2": RECTIFIED},
        diodes[1]: {"1": RECT_IN, "2": RECT_OUT},
        filter_resistor("R17", values.r_lp_ohm, "envelope: input, as R_LP"): {"1": RECTIFIED, "2": LP_IN},
        filter_resistor("R6", values.r_lp_ohm, "envelope: R_LP"): {"1": LP_IN, "2": ENVELOPE},
        signal_capacitor("C4", values.c_lp_f, "envelope: C_LP"): {"1": LP_IN, "2": ENVELOPE},
        amplifier: {
            "3": GND, "2": RECT_IN, "1": RECT_OUT, "5": GND, "6": LP_IN, "7": ENVELOPE, "8": VCC, "4": VEE,
        },
        supply_capacitor("C15", SUPPLY_F, "plus supply, at U3", symbols.C_0603): {"1": VCC, "2": GND},
        supply_capacitor("C16", SUPPLY_F, "minus supply, at U3", symbols.C_0603): {"1": GND, "2": VEE},
    }  # fmt: skip
    return {**high_passes(values, SERIES), **rectifier}
