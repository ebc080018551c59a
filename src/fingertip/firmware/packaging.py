"""Library's descriptions for Arduino and PlatformIO, measured costs, and warnings."""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Iterator
from importlib import resources
from typing import Any

from fingertip import __version__
from fingertip.board.components.values import SUPPLIES, VARIANT_CHANGES
from fingertip.catalogues.electronics import ControllerBoard
from fingertip.design import Design
from fingertip.foundation.files import encode_json

NAME = "FingertipSlip"
_SUMMARY = "Slip detector of a prosthetic fingertip."
_CONTROLLER_SUPPLY = SUPPLIES["precision"]


def library_properties(design: Design) -> bytes:
    """Return the library's description for Arduino."""
    fields = {
        "name": NAME,
        "version": _semantic_version(),
        "author": "The fingertip contributors",
        "maintainer": "The fingertip contributors",
        "sentence": _SUMMARY,
        "paragraph": _describe(design),
        "category": "Sensors",
        "url": "https://doi.org/10.1109/TMRB.2021.3060032",
        "architectures": "*",
        "includes": "slip_detector.h",
    }
    return "".join(f"{key}={value}\n" for key, value in fields.items()).encode()


def library_manifest(design: Design) -> bytes:
    """Return the library's description for PlatformIO."""
    data = {
        "name": NAME,
        "version": _semantic_version(),
        "description": f"{_SUMMARY} {_describe(design)}",
        "keywords": ["slip", "tactile", "prosthetics"],
        "license": "Apache-2.0",
        "frameworks": "*",
        "platforms": "*",
        "headers": "slip_detector.h",
        "build": {"flags": ["-ffp-contract=off"]},
    }
    return encode_json(data)


def _describe(design: Design) -> str:
    rate = design.detector.sample_rate_hz
    bits = design.detector.adc_bits
    return (
        f"Made by fingertip for the design {design.name}: {rate:g} samples per second, "
        f"converter of {bits} bits."
    )


def _semantic_version() -> str:
    """Return the version without a suffix, which Arduino does not accept."""
    numbers = __version__.split("+")[0].split(".")[:3]
    digits = ("".join(filter(str.isdigit, number)) for number in numbers)
    return ".".join(number or "0" for number in digits)


TABLE = "measured_costs.json"
"""File of the library's costs on controllers; written by `tools/firmware/measure.py`."""
_COLUMNS = (
    "processor",
    "flash",
    "state",
    "stack",
    "constant force",
    "campaign",
    "slip that lasts",
    "longest step",
)


@functools.cache
def read_costs() -> dict[str, Any]:
    data: dict[str, Any] = json.loads(
        resources.files(__package__).joinpath(TABLE).read_text(encoding="utf-8")
    )
    return data


def cost_table() -> str:
    """Return the table of measurements, in Markdown: bytes, and instructions per sample."""
    costs = read_costs()
    rows = [_COLUMNS, ("---", *["---:"] * (len(_COLUMNS) - 1))]

    for name, target in costs["targets"].items():
        sizes = (target["flash_bytes"], costs["state_bytes"], target["stack_bytes"])
        means = (target["instructions"][signal] for signal in ("quiet", "campaign", "slip"))
        rows.append(
            (
                name,
                *(f"{size} B" for size in sizes),
                *map(str, means),
                str(target["max_instructions"]),
            )
        )

    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def find_warnings(design: Design, controller: ControllerBoard | None = None) -> Iterator[str]:
    """Warn of a board or a converter that the inputs of a controller do not fit."""
    has_divider = not design.board.has_filter
    if controller and not has_divider and not _fits_range(controller, design):
        range_v = f"{controller.adc_to_v:g}"
        yield (
            f"{controller.name} converts {controller.converter}, not "
            f"{design.detector.adc_range_text}: voltages and "
            f"forces would be wrong; with --set detector.adc_range_v={range_v} they are right."
        )

    if controller and controller.adc_bits < design.detector.adc_bits:
        bits = controller.adc_bits
        yield (
            f"{controller.name} converts {bits} bits, not {design.detector.adc_bits}: its steps "
            "are noise that the "
            f"detector does not expect; with --set detector.adc_bits={bits} it does."
        )

    detector = design.detector
    problems = []
    if has_divider:
        bears_v = max(_LEAST_PIN_V, controller.adc_to_v) if controller else _LEAST_PIN_V
        if design.board.supply_v > bears_v:
            yield (
                f"the sensor's {design.board.supply_v:g} V may destroy a pin, which bears "
                f"{bears_v:g} V; with "
                f"--set board.supply_v={_CONTROLLER_SUPPLY.nominal_v:g} it does not."
            )
    elif not design.board.is_for_controller:
        problems.append(
            f"the outputs of a board with board.variant={design.board.variant} may exceed the "
            "inputs of a "
            f"controller of {_CONTROLLER_SUPPLY.nominal_v:g} V"
        )

    if detector.adc_polarity != "unipolar":
        problems.append(
            f"detector.adc_polarity={detector.adc_polarity} is no converter of a controller, "
            "which reads from 0 V up"
        )

    if problems:
        changes = " ".join(f"--set {change}" for change in controller_changes())
        yield f"{', and '.join(problems)}; with {changes} the board fits a controller."


_LEAST_PIN_V = 3.6
"""Voltage that a pin of any controller bears [V]."""


def _fits_range(controller: ControllerBoard, design: Design) -> bool:
    """Return whether the converter has the range that the design states."""
    return math.isclose(controller.adc_to_v, design.detector.adc_range_v, rel_tol=1e-6)


def controller_changes() -> tuple[str, ...]:
    """Return the changes that select a board and a converter for a controller."""
    return (
        *VARIANT_CHANGES["precision"],
        "detector.adc_polarity=unipolar",
        f"detector.adc_range_v={_CONTROLLER_SUPPLY.nominal_v:g}",
        "detector.adc_bits=12",
    )
