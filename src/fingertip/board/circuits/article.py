"""Variant `article`: the article's circuit (figure 3) from TACTILE to ENVELOPE.

Two high-pass stages, a diode, an envelope. The article's references stand here; its R_LP and C_LP are R6 and C4,
because KiCad's annotation wants references that end in a digit.
"""

from __future__ import annotations

from fingertip.board.circuit import Circuit
from fingertip.board.circuits.parts import Rated, Wiring, amplifier, part
from fingertip.board.circuits.surroundings import whole_board
from fingertip.board.kicad import symbols
from fingertip.board.nets import (
    ENVELOPE,
    FEEDBACK,
    FILTERED,
    STAGE1_IN,
    STAGE1_OUT,
    STAGE2_IN,
    STAGE2_MID,
    TACTILE,
    VCC,
)
from fingertip.board.supplies import SUPPLIES
from fingertip.board.values.board_values import BoardValues


def article_circuit(values: BoardValues) -> Circuit:
    """The board with these values, checked."""
    return whole_board(values, {**high_passes(values), **_peak_detector(values)})


def high_passes(values: BoardValues, r4_returns_to: str = "") -> Wiring:
    """Both filters of the article's figure 3; R4 returns to where signals rest unless another net is named."""
    c, supply = values.preferred, SUPPLIES[values.supply]
    zero, rated = supply.zero, Rated(values.tolerance)
    return {
        # First-order high-pass, gain 1 + R5/R4 (eqs. 1, 2).
        rated.capacitor("C1", c.c_f, "first stage: in series"): {"1": TACTILE, "2": STAGE1_IN},
        rated.resistor("R1", c.r1_ohm, "first stage: pole, with C1"): {"1": STAGE1_IN, "2": zero},
        rated.resistor("R4", c.r4_ohm, "first stage: gain, with R5"): {"1": FEEDBACK, "2": r4_returns_to or zero},
        rated.resistor("R5", c.r5_ohm, "first stage: feedback"): {"1": STAGE1_OUT, "2": FEEDBACK},
        amplifier("U1", values.amplifier, "first stage and Sallen-Key stage"): {
            "3": STAGE1_IN, "2": FEEDBACK, "1": STAGE1_OUT,
            "5": STAGE2_IN, "6": FILTERED, "7": FILTERED,
            "8": VCC, "4": supply.minus,
        },
        # Unity-gain Sallen-Key high-pass (eqs. 3, 4): R2 from between the capacitors to the output.
        rated.capacitor("C2", c.c_f, "second stage: first in series"): {"1": STAGE1_OUT, "2": STAGE2_MID},
        rated.capacitor("C3", c.c_f, "second stage: last in series"): {"1": STAGE2_MID, "2": STAGE2_IN},
        rated.resistor("R2", c.r2_ohm, "second stage: feedback"): {"1": STAGE2_MID, "2": FILTERED},
        rated.resistor("R3", c.r3_ohm, "second stage: pole, with R2"): {"1": STAGE2_IN, "2": zero},
    }  # fmt: skip


def _peak_detector(values: BoardValues) -> Wiring:
    """The diode feeds R_LP parallel to C_LP (eq. 11)."""
    c, zero, rated = values.preferred, SUPPLIES[values.supply].zero, Rated(values.tolerance)
    diode = part("D1", "1N4148W", symbols.DIODE_1N4148W, symbols.SOD_123, "half-wave rectifier")
    return {
        diode: {"2": FILTERED, "1": ENVELOPE},
        rated.resistor("R6", c.r_lp_ohm, "envelope: R_LP"): {"1": ENVELOPE, "2": zero},
        rated.capacitor("C4", c.c_lp_f, "envelope: C_LP"): {"1": ENVELOPE, "2": zero},
    }
