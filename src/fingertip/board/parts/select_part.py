"""Selection of the part for a component of the circuit, and of an alternate, from the parts table."""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace

from fingertip.board.circuit import Component, parse_component_value
from fingertip.board.parts.ordering_code import load_ordering_codes
from fingertip.board.parts.requirement import CapacitorRequirement, ResistorRequirement
from fingertip.board.parts.table import (
    ChipCapacitor,
    ChipResistor,
    Part,
    load_capacitors,
    load_named_parts,
    load_resistors,
)

_PACKAGE = re.compile(r"[RC]_(\d{4})_")
_ROUNDING = 1e-9
"""Relative difference of equal values."""
NO_LCSC = "no document that was read gives an LCSC number"
NO_MANUFACTURER = "the source names no manufacturer"


@dataclass(frozen=True)
class Selection:
    """Part for a component, an alternate, and the reason for whatever is missing."""

    part: Part | None
    alternate: Part | None
    reason: str
    """Reason why a number is missing; empty if none is."""

    @property
    def fields(self) -> dict[str, str]:
        """Fields of the symbol in the schematic; empty where there is no number."""
        part = self.part or Part("", "", "", "")
        return {"Manufacturer": part.manufacturer, "MPN": part.number, "LCSC": part.lcsc}


@functools.cache
def select_part(component: Component) -> Selection:
    """Select the part for a purchased component. The function never raises; a missing part has its reason."""
    reason = ""
    match component.requirement:
        case ResistorRequirement() as requirement:
            resistors = find_resistors(parse_component_value(component.value), requirement)
            # The loosest that will do is the cheapest.
            found = [item.part for item in sorted(resistors, key=lambda item: -item.tolerance_percent)]
        case CapacitorRequirement() as capacitor:
            value, package = parse_component_value(component.value), find_package(component.footprint)
            found = [item.part for item in find_capacitors(value, package, capacitor)]
            reason = _explain_missing(component.value, package, capacitor)
        case None:
            named = [
                item
                for item in load_named_parts()
                if (item.value, item.footprint) == (component.value, component.footprint.split(":")[1])
            ]
            found = [item.part for item in named if item.part]
            reason = next((item.reason for item in named if item.reason), "")
    if not found:
        return Selection(None, None, reason or f"the parts table has no {component.value} with {component.rating}")
    part, alternate = found[0], found[1] if len(found) > 1 else None
    gaps = ((NO_MANUFACTURER, part.manufacturer), (NO_LCSC, part.lcsc))
    return Selection(part, alternate, "; ".join(gap for gap, text in gaps if not text))


def symbol_fields(component: Component) -> dict[str, str]:
    """Fields of a component's symbol and footprint apart from KiCad's own: its role, and the numbers of its part."""
    return {"Role": component.role, **(select_part(component).fields if component.rating else {})}


def find_resistors(ohm: float, requirement: ResistorRequirement) -> Iterator[ChipResistor]:
    """Find the chip resistors that meet a requirement: those of the table first, then those with an ordering code.

    The table's resistor is also found by its ordering code; it is yielded once.
    """
    listed = [item for item in load_resistors() if abs(item.ohm / ohm - 1.0) < _ROUNDING]
    composed = [code.compose(ohm) for code in load_ordering_codes() if code.is_made(ohm)]
    numbers: set[str] = set()
    for item in (*listed, *composed):
        is_precise = item.tolerance_percent <= requirement.tolerance_percent * (1.0 + _ROUNDING)
        is_stable = requirement.drift_ppm_per_k is None or item.drift_ppm_per_k <= requirement.drift_ppm_per_k
        if is_precise and is_stable and item.power_w >= requirement.power_w and item.part.number not in numbers:
            numbers.add(item.part.number)
            yield item


def find_capacitors(farad: float, package: str, requirement: CapacitorRequirement) -> Iterator[ChipCapacitor]:
    """Find the chip capacitors of the table that meet a requirement, in a package by its inch code."""
    for item in load_capacitors():
        if (
            abs(item.farad / farad - 1.0) < _ROUNDING
            and item.package == package
            and item.dielectric in requirement.dielectrics
            and item.voltage_v >= requirement.voltage_v
            and item.tolerance_percent <= requirement.tolerance_percent * (1.0 + _ROUNDING)
        ):
            yield item


def find_package(footprint: str) -> str:
    """Find the inch code of a chip resistor's or capacitor's size in the name of its footprint."""
    match = _PACKAGE.search(footprint)
    return match[1] if match else ""


def _explain_missing(value: str, package: str, requirement: CapacitorRequirement) -> str:
    """Explain why the table has no capacitor, with a remedy: a looser tolerance, or values that it has."""
    looser = replace(requirement, tolerance_percent=math.inf)
    sold = next(find_capacitors(parse_component_value(value), package, looser), None)
    what = f"{value} {' or '.join(requirement.dielectrics)} {requirement.voltage_v:g} V in {package}"
    if sold:
        return (
            f"the parts table has {what} with {sold.tolerance_percent:g} %, not {requirement.tolerance_percent:g} %; "
            "board.capacitor_tolerance_percent=0 accepts the tolerance that is sold"
        )
    return f"the parts table has no {what}; board.capacitor_series=preferred selects values that it has"
