"""Variant `comparator`: `precision`, and the article's future work: threshold, hysteresis and an ON/OFF pin.

The comparator's output is an open collector: SLIP is low while it slips, high (VCC) otherwise.
"""

from __future__ import annotations

from fingertip.board.circuit import Circuit, Part, engineering
from fingertip.board.circuits.parts import Rated, part, supply_capacitor
from fingertip.board.circuits.precision import precision_path
from fingertip.board.circuits.surroundings import SUPPLY_F, whole_board
from fingertip.board.kicad import symbols
from fingertip.board.nets import ENVELOPE, GND, VCC
from fingertip.board.supplies import SUPPLIES
from fingertip.board.values.board_values import BoardValues
from fingertip.board.values.decision import PULL_UP_OHM, TRIMMER_OHM
from fingertip.errors import BoardError

MEAN = "MEAN"
TRIM_TOP = "TRIM_TOP"
THRESHOLD = "THRESHOLD"
SLIP = "SLIP"


def comparator_circuit(values: BoardValues) -> Circuit:
    """The board with these values, checked."""
    decision, zero = values.decision, SUPPLIES[values.supply].zero
    if decision is None:
        raise BoardError("the values are of a variant without comparator; compute them with board.variant=comparator.")
    rated = Rated(values.tolerance)
    comparator = part("U4", "LMV331", symbols.LMV331, symbols.SOT_23_5, "slip or no slip")
    trimmer = Part(
        "RV1", engineering(TRIMMER_OHM), symbols.TRIMMER, symbols.TC33X, "threshold", "trimmer 3 mm, one turn, top"
    )
    deciding = {
        rated.resistor("R18", decision.mean_ohm, "mean of the envelope"): {"1": ENVELOPE, "2": MEAN},
        rated.small_capacitor("C17", decision.mean_f, "mean of the envelope"): {"1": MEAN, "2": zero},
        rated.resistor("R19", decision.top_ohm, "threshold's range"): {"1": VCC, "2": TRIM_TOP},
        trimmer: {"1": TRIM_TOP, "2": THRESHOLD, "3": zero},
        rated.resistor("R20", decision.hysteresis_ohm, "hysteresis"): {"1": THRESHOLD, "2": SLIP},
        rated.resistor("R21", PULL_UP_OHM, "pull-up of the output"): {"1": VCC, "2": SLIP},
        comparator: {"1": THRESHOLD, "3": MEAN, "4": SLIP, "5": VCC, "2": GND},
        supply_capacitor("C18", SUPPLY_F, "plus supply, at U4"): {"1": VCC, "2": GND},
    }
    return whole_board(values, {**precision_path(values), **deciding}, fourth_pin=SLIP)
