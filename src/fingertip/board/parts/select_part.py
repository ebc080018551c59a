"""Selection of a component's part, and of an alternate, from the parts table."""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace

from fingertip.board.parts.circuit import (
    CapacitorRequirement,
    Component,
    ResistorRequirement,
    format_component_value,
    parse_component_value,
)
from fingertip.board.parts.table import (
    UNCONFIRMED,
    ChipCapacitor,
    ChipResistor,
    NamedPart,
    Part,
    load_table,
)
from fingertip.design.formulas.filter import MAX_1206_F, find_preferred_neighbours

# Part numbers of chip resistors by their makers' published ordering codes.
#
# The resistance is written with its letter R, K or M in the place of the decimal point, and zeros
# after it are left out: 120 ohm is 120R, 1.24 kohm is 1K24, 10 kohm is 10K (the data sheets in
# `sources.csv`).


@dataclass(frozen=True)
class OrderingCode:
    manufacturer: str
    prefix: str
    suffix: str
    tolerance_percent: float
    drift_ppm_per_k: float
    """Temperature coefficient [ppm/K]; infinite where the code states none."""
    power_w: float
    package: str
    min_ohm: float
    max_ohm: float
    series: tuple[str, ...]
    """Series of values that it is made in."""
    price: str
    source: str

    def is_made(self, ohm: float) -> bool:
        if not self.min_ohm <= ohm <= self.max_ohm:
            return False

        return any(
            low == high
            for low, high in (find_preferred_neighbours(ohm, series) for series in self.series)
        )

    def compose(self, ohm: float) -> ChipResistor:
        number = f"{self.prefix}{resistance_code(ohm)}{self.suffix}"
        part = Part(
            manufacturer=self.manufacturer,
            number=number,
            lcsc="",
            price=self.price,
            sources=(self.source,),
        )
        return ChipResistor(
            ohm=ohm,
            tolerance_percent=self.tolerance_percent,
            drift_ppm_per_k=self.drift_ppm_per_k,
            power_w=self.power_w,
            package=self.package,
            part=part,
        )


def resistance_code(ohm: float) -> str:
    """Write a resistance [ohm] as in an ordering code: 1240 is "1K24", 82 is "82R"."""
    text = format_component_value(ohm)
    digits, letter = (text[:-1], text[-1].upper()) if text[-1] in "kM" else (text, "R")
    whole, _, fraction = digits.partition(".")

    return f"{whole}{letter}{fraction}"


_PACKAGE = re.compile(r"[RC]_(\d{4})_")
_ROUNDING = 1e-9
NO_LCSC = "no document that was read gives an LCSC number"
ONE_SOURCE = "only one document gives the LCSC number"


@dataclass(frozen=True)
class Selection:
    """Part for a component, an alternate, and the reason for whatever is missing."""

    part: Part | None
    alternate: Part | None
    reason: str
    """Reason for a missing or unsure LCSC number; empty if two documents agree on it."""

    @property
    def note(self) -> str:
        """Task before ordering; empty if there is none."""
        if not self.part or not self.reason:
            return self.reason

        look = (
            f"what the house shows for {self.part.lcsc} must be"
            if self.part.lcsc
            else "search the house for"
        )
        return f"{UNCONFIRMED}: {self.reason}; {look} {self.part.number}"

    @property
    def fields(self) -> dict[str, str]:
        """Fields of the symbol in the schematic; empty where there is no number."""
        part = self.part or Part(
            manufacturer="",
            number="",
            lcsc="",
            price="",
            sources=(),
        )
        return {"Manufacturer": part.manufacturer, "MPN": part.number, "LCSC": part.lcsc}


@functools.cache
def select_part(component: Component) -> Selection:
    """Select the part for a purchased component.

    The function never raises; a missing part has its reason.
    """
    reason = ""
    match component.requirement:
        case ResistorRequirement() as requirement:
            resistors = find_resistors(parse_component_value(component.value), requirement)
            # The loosest that will do is the cheapest.
            parts = [
                item.part for item in sorted(resistors, key=lambda item: -item.tolerance_percent)
            ]
        case CapacitorRequirement() as capacitor:
            value = parse_component_value(component.value)
            package = find_package(component.footprint)
            parts = [item.part for item in find_capacitors(value, package, capacitor)]
            reason = "" if parts else _explain_missing(component.value, package, capacitor)
        case None:
            named_parts = [
                item
                for item in load_table(NamedPart, "named_parts.csv")
                if (item.value, item.footprint)
                == (component.value, component.footprint.split(":")[1])
            ]
            parts = [item.part for item in named_parts if item.part]
            reason = next((item.reason for item in named_parts if item.reason), "")

    if not parts:
        return Selection(
            None,
            None,
            reason or f"the parts table has no {component.value} with {component.rating}",
        )

    part = parts[0]
    alternate = parts[1] if len(parts) > 1 else None
    unsure = ONE_SOURCE if len(part.sources) < 2 else ""
    return Selection(part, alternate, unsure if part.lcsc else reason or NO_LCSC)


def find_resistors(ohm: float, requirement: ResistorRequirement) -> Iterator[ChipResistor]:
    """Yield the chip resistors that meet a requirement: the table's, then by ordering code."""
    in_table = [
        item
        for item in load_table(ChipResistor, "resistors.csv")
        if abs(item.ohm / ohm - 1.0) < _ROUNDING
    ]
    composed = [
        code.compose(ohm)
        for code in load_table(OrderingCode, "ordering_codes.csv")
        if code.is_made(ohm)
    ]
    numbers: set[str] = set()

    for item in (*in_table, *composed):
        is_precise = item.tolerance_percent <= requirement.tolerance_percent * (1.0 + _ROUNDING)
        is_stable = (
            requirement.drift_ppm_per_k is None
            or item.drift_ppm_per_k <= requirement.drift_ppm_per_k
        )
        if (
            is_precise
            and is_stable
            and item.power_w >= requirement.power_w
            and item.part.number not in numbers
        ):
            numbers.add(item.part.number)
            yield item


def find_capacitors(
    farad: float, package: str, requirement: CapacitorRequirement
) -> Iterator[ChipCapacitor]:
    """Yield the chip capacitors that meet a requirement, in a package by its inch code."""
    for item in load_table(ChipCapacitor, "capacitors.csv"):
        if (
            abs(item.farad / farad - 1.0) < _ROUNDING
            and item.package == package
            and item.dielectric in requirement.dielectrics
            and item.voltage_v >= requirement.voltage_v
            and item.tolerance_percent <= requirement.tolerance_percent * (1.0 + _ROUNDING)
        ):
            yield item


def find_package(footprint: str) -> str:
    """Return the inch code in the name of a chip part's footprint; empty if it has none."""
    match = _PACKAGE.search(footprint)
    return match[1] if match else ""


def _explain_missing(value: str, package: str, requirement: CapacitorRequirement) -> str:
    """Explain a missing capacitor, with a remedy: a looser tolerance, or other values."""
    looser = replace(requirement, tolerance_percent=math.inf)
    sold = next(find_capacitors(parse_component_value(value), package, looser), None)
    what = (
        f"{value} {' or '.join(requirement.dielectrics)} {requirement.voltage_v:g} V in {package}"
    )

    if sold:
        return (
            f"the parts table has {what} with {sold.tolerance_percent:g} %, not "
            f"{requirement.tolerance_percent:g} %; "
            "board.capacitor_tolerance_percent=0 accepts the tolerance that is sold"
        )

    return (
        f"the parts table has no {what}; board.capacitor_series=preferred selects values that "
        "it has"
    )


# Capacitors of the board: which dielectric a value needs, which tolerance is sold, and which values
# the table has.
#
# C0G is made up to some capacitance in each size. Above it X7R is required, whose capacitance falls
# with direct voltage and age, and which is sold with 10 %. Capacitors of 5 % are C0G.

MAX_C0G_F = {"1206": 100e-9, "0603": 10e-9}
"""Largest capacitance [F] that each size is made with as C0G."""
SOLD_PERCENT = {"C0G": 5.0, "X7R": 10.0, "X5R": 20.0}
"""Tolerance [%] to expect of a dielectric where the parts table does not have the value."""

_C0G = CapacitorRequirement(("C0G",), 25.0, 0.0)
_X7R = CapacitorRequirement(("X7R",), 16.0, 0.0)
_LARGE = CapacitorRequirement(("X7R",), 6.3, 0.0)
_LARGEST = CapacitorRequirement(("X5R", "X7R"), 6.3, 0.0)
"""Large capacitors, without direct voltage or cutoff; above `_MAX_X7R_F` only X5R exists."""
_MAX_X7R_F = 22e-6
SUPPLY_CAPACITOR = CapacitorRequirement(("X7R",), 25.0, 10.0)
BULK_CAPACITOR = CapacitorRequirement(("X7R",), 16.0, 10.0)
"""Large capacitors at the entry of the supply and across dividers, whose capacitance matters
little. Voltages of the dividers are amplified: X5R, which is the better microphone, is left out.
"""


def require_capacitor(
    farad: float, package: str, stated_percent: float = 0.0
) -> CapacitorRequirement:
    """Return the requirement for a capacitor of the signal path. Units: `farad` [F]."""
    if farad > MAX_1206_F * (1.0 + _ROUNDING):
        large = _LARGE if farad <= _MAX_X7R_F * (1.0 + _ROUNDING) else _LARGEST
        return replace(large, tolerance_percent=find_sold_percent(farad, package, large))

    kind = _C0G if farad <= MAX_C0G_F[package] * (1.0 + _ROUNDING) else _X7R
    return replace(
        kind, tolerance_percent=stated_percent or find_sold_percent(farad, package, kind)
    )


def find_sold_percent(farad: float, package: str, kind: CapacitorRequirement) -> float:
    """Return the sold tolerance [%] of a capacitor [F]: the table's, or its dielectric's."""
    any_tolerance = replace(kind, tolerance_percent=math.inf)
    capacitor = next(find_capacitors(farad, package, any_tolerance), None)
    if capacitor:
        return capacitor.tolerance_percent

    return max(SOLD_PERCENT[name] for name in kind.dielectrics)


@functools.cache
def list_capacitances(package: str) -> tuple[float, ...]:
    """List the capacitances [F] for the signal path in a package, in ascending order."""
    farads = {
        item.farad
        for item in load_table(ChipCapacitor, "capacitors.csv")
        if item.package == package
    }
    return tuple(
        sorted(f for f in farads if any(find_capacitors(f, package, require_capacitor(f, package))))
    )
