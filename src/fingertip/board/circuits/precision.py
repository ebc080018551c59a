"""Variant `precision`: a rectifier without dead zone, a true pole for the envelope, no offset ahead of C2, less noise.

As `article` up to FILTERED but for two capacitors: C14 blocks R4's direct current, so that the first stage does not
amplify its own offset; C20 across R5 ends its gain above the vibrations, where the bridge's amplifier has only noise.
Behind FILTERED an inverting half-wave rectifier (U3a, D1, D4) drives an inverting low-pass (U3b): both inputs are
virtual grounds, so R_LP and C_LP give the article's 36.17 Hz whether a diode conducts or not. Two inversions: the
envelope is positive, of the positive half waves. Its mean for a sine is 1/pi of the peak.
"""

from __future__ import annotations

from fingertip.board.circuit import Circuit
from fingertip.board.circuits.article import high_passes
from fingertip.board.circuits.parts import (
    Rated,
    Wiring,
    amplifier,
    part,
    supply_capacitor,
)
from fingertip.board.circuits.surroundings import SUPPLY_F, whole_board
from fingertip.board.kicad import symbols
from fingertip.board.nets import ENVELOPE, FEEDBACK, FILTERED, GND, STAGE1_OUT, VCC, VEE
from fingertip.board.supplies import SUPPLIES
from fingertip.board.values.board_values import BoardValues
from fingertip.board.values.rest import RECTIFIER_OHM
from fingertip.errors import BoardError

SERIES = "SERIES"
RECT_IN = "RECT_IN"
RECT_OUT = "RECT_OUT"
RECTIFIED = "RECTIFIED"
LP_IN = "LP_IN"


def precision_circuit(values: BoardValues) -> Circuit:
    """The board with these values, checked."""
    return whole_board(values, precision_path(values))


def precision_path(values: BoardValues) -> Wiring:
    """From TACTILE to ENVELOPE."""
    c, supply, extra = values.preferred, SUPPLIES[values.supply], values.first_stage
    if extra is None:
        raise BoardError("the values are of variant article; compute them with the variant that is built.")
    zero, rated = supply.zero, Rated(values.tolerance)
    diodes = [
        part(name, "1N4148W", symbols.DIODE_1N4148W, symbols.SOD_123, role)
        for name, role in (("D1", "rectifier: positive half wave"), ("D4", "rectifier: negative half wave"))
    ]
    rectifier: Wiring = {
        rated.capacitor("C14", extra.series_f, "first stage: blocks its offset"): {"1": zero, "2": SERIES},
        rated.small_capacitor("C20", extra.limit_f, "first stage: ends its gain above the vibrations"): {
            "1": STAGE1_OUT, "2": FEEDBACK,
        },
        rated.resistor("R15", RECTIFIER_OHM, "rectifier: input"): {"1": FILTERED, "2": RECT_IN},
        rated.resistor("R16", RECTIFIER_OHM, "rectifier: feedback"): {"1": RECT_IN, "2": RECTIFIED},
        diodes[0]: {"1": RECT_OUT, "2": RECTIFIED},
        diodes[1]: {"1": RECT_IN, "2": RECT_OUT},
        rated.resistor("R17", c.r_lp_ohm, "envelope: input, as R_LP"): {"1": RECTIFIED, "2": LP_IN},
        rated.resistor("R6", c.r_lp_ohm, "envelope: R_LP"): {"1": LP_IN, "2": ENVELOPE},
        rated.capacitor("C4", c.c_lp_f, "envelope: C_LP"): {"1": LP_IN, "2": ENVELOPE},
        amplifier("U3", values.amplifier, "rectifier and envelope"): {
            "3": zero, "2": RECT_IN, "1": RECT_OUT, "5": zero, "6": LP_IN, "7": ENVELOPE, "8": VCC, "4": supply.minus,
        },
        supply_capacitor("C15", SUPPLY_F, "plus supply, at U3"): {"1": VCC, "2": GND},
    }  # fmt: skip
    if supply.minus == VEE:
        rectifier = {**rectifier, supply_capacitor("C16", SUPPLY_F, "minus supply, at U3"): {"1": GND, "2": VEE}}
    return {**high_passes(values, SERIES), **rectifier}
