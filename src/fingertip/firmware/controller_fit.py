"""Fit of a design's board and converter to the inputs of a controller."""

from __future__ import annotations

import math
from collections.abc import Iterator

from fingertip.board.components.values import SUPPLIES, VARIANT_CHANGES
from fingertip.catalogues.electronics import ControllerBoard
from fingertip.design import Design

_LEAST_PIN_V = 3.6
"""Voltage that a pin of any controller bears [V]."""
_CONTROLLER_SUPPLY = SUPPLIES["precision"]


def find_warnings(design: Design, controller: ControllerBoard | None = None) -> Iterator[str]:
    """Warn of a board or a converter that the inputs of a controller do not fit; without one, of
    what fits none.
    """
    if controller:
        yield from _warn_of_range(design, controller)
        yield from _warn_of_bits(design, controller)

    yield from _warn_of_pin_voltage(design, controller)
    yield from _warn_of_variant_and_polarity(design)


def _warn_of_range(design: Design, controller: ControllerBoard) -> Iterator[str]:
    """Warn of codes that mean other voltages; the sketch of a divider scales them itself."""
    fits = math.isclose(controller.adc_to_v, design.detector.adc_range_v, rel_tol=1e-6)
    if design.board.has_filter and not fits:
        yield (
            f"{controller.name} converts {controller.converter}, not "
            f"{design.detector.adc_range_text}: voltages and forces would be wrong; with "
            f"--set detector.adc_range_v={controller.adc_to_v:g} they are right."
        )


def _warn_of_bits(design: Design, controller: ControllerBoard) -> Iterator[str]:
    bits = controller.adc_bits
    if bits < design.detector.adc_bits:
        yield (
            f"{controller.name} converts {bits} bits, not {design.detector.adc_bits}: its steps "
            "are noise that the detector does not expect; with "
            f"--set detector.adc_bits={bits} it does."
        )


def _warn_of_pin_voltage(design: Design, controller: ControllerBoard | None) -> Iterator[str]:
    """Warn of a divider, which has no filter, whose voltage stands at the pin itself."""
    if design.board.has_filter:
        return

    bears_v = max(_LEAST_PIN_V, controller.adc_to_v) if controller else _LEAST_PIN_V
    if design.board.supply_v > bears_v:
        yield (
            f"the sensor's {design.board.supply_v:g} V may destroy a pin, which bears "
            f"{bears_v:g} V; with --set board.supply_v={_CONTROLLER_SUPPLY.nominal_v:g} it does "
            "not."
        )


def _warn_of_variant_and_polarity(design: Design) -> Iterator[str]:
    """Warn of a board and of a converter that are made for other computers."""
    problems = []
    if design.board.has_filter and not design.board.is_for_controller:
        problems.append(
            f"the outputs of a board with board.variant={design.board.variant} may exceed the "
            f"inputs of a controller of {_CONTROLLER_SUPPLY.nominal_v:g} V"
        )

    polarity = design.detector.adc_polarity
    if polarity != "unipolar":
        problems.append(
            f"detector.adc_polarity={polarity} is no converter of a controller, which reads from "
            "0 V up"
        )

    if problems:
        changes = " ".join(f"--set {change}" for change in controller_changes())
        yield f"{', and '.join(problems)}; with {changes} the board fits a controller."


def controller_changes() -> tuple[str, ...]:
    """Return the changes that select a board and a converter for a controller."""
    return (
        *VARIANT_CHANGES["precision"],
        "detector.adc_polarity=unipolar",
        f"detector.adc_range_v={_CONTROLLER_SUPPLY.nominal_v:g}",
        "detector.adc_bits=12",
    )
