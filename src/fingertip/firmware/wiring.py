"""Wiring between the board and a controller that runs the library, and what the board or the converter lacks for it."""

from __future__ import annotations

from collections.abc import Iterator

from fingertip.board import board_circuit
from fingertip.board.bringup.wiring import HOST_CONNECTOR, SKETCH_PINS, list_notes, list_pins, name_signals
from fingertip.board.components.values import SUPPLIES, select_components
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.board.parts.circuit import GND, VMID_OUT
from fingertip.design import Design

READ_NETS = SKETCH_PINS
"""Nets of the connector that the library reads -> pin of the controller at which the examples expect them."""
_CONTROLLER_SUPPLY = next(supply for supply in SUPPLIES.values() if supply.is_for_controller)
_CONTROLLER_BOARD = BOARD_CONFIGURATIONS[f"precision_{_CONTROLLER_SUPPLY.name}"]


def wiring_table(design: Design) -> str:
    """Table of the pins of the board's output connector, in Markdown."""
    circuit = board_circuit(select_components(design))
    signals = name_signals(circuit, design.board.supply_v)
    rows = [(f"pin of {HOST_CONNECTOR}", "print", "signal", "to the controller"), ("---:", "---", "---", "---")]
    for number, net in list_pins(circuit, circuit.component(HOST_CONNECTOR)):
        signal = signals[net]
        rows.append((number, signal.print, signal.far_end, _describe_use(net)))
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def wiring_notes(design: Design) -> list[str]:
    """List what to observe when the cables are made."""
    circuit = board_circuit(select_components(design))
    notes = list(list_notes(circuit, design.board.supply_v))
    if VMID_OUT in {net for _, net in list_pins(circuit, circuit.component(HOST_CONNECTOR))}:
        notes.append("The detector needs no M: only changes of T and S count.")
    return notes


def find_warnings(design: Design) -> Iterator[str]:
    """Warn of a board or a converter that the inputs of a controller do not fit."""
    supply, detector = SUPPLIES[design.board.supply], design.detector
    problems = []
    if not supply.is_for_controller:
        problems.append(
            f"the outputs of a board with board.supply={supply.name} may exceed the inputs of a controller of "
            f"{_CONTROLLER_SUPPLY.nominal_v:g} V"
        )
    if detector.adc_polarity != "unipolar":
        problems.append(
            f"detector.adc_polarity={detector.adc_polarity} is no converter of a controller, which reads from 0 V up"
        )
    if problems:
        changes = " ".join(f"--set {change}" for change in controller_changes())
        yield f"{', and '.join(problems)}; with {changes} the board fits a controller."


def controller_changes() -> tuple[str, ...]:
    """Changes to a design that select a board and a converter for a controller."""
    return (
        *_CONTROLLER_BOARD.changes,
        "detector.adc_polarity=unipolar",
        f"detector.adc_range_v={_CONTROLLER_SUPPLY.nominal_v:g}",
        "detector.adc_bits=12",
    )


def _describe_use(net: str) -> str:
    if net in READ_NETS:
        return f"analog input {READ_NETS[net]}: the detector reads it"
    return "ground" if net == GND else "not needed"
