"""Parts of the table, read from the package's data: resistors, capacitors, parts bought by name, and their sources.

Every number is copied from the source that is named beside it. Nothing here can tell what is in stock.
"""

from __future__ import annotations

import csv
import functools
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

FOLDER = Path(__file__).parent
_EXPONENTS = {"M": 6, "k": 3, "u": -6, "n": -9, "p": -12}


@dataclass(frozen=True)
class Source:
    """Document from which numbers were copied."""

    key: str
    title: str
    address: str
    """Address of the document, or of the part's page that it names; empty if neither was stated."""


@dataclass(frozen=True)
class Part:
    """Part as it is ordered."""

    manufacturer: str
    """Name of the manufacturer; empty where the source names none."""
    number: str
    """Manufacturer's part number."""
    lcsc: str
    """Number of the distributor LCSC, which is the assembly house's too; empty where no source gives it."""
    source: str
    """Key of the source of both numbers."""


@dataclass(frozen=True)
class ChipResistor:
    """Chip resistor of the table."""

    ohm: float
    tolerance_percent: float
    drift_ppm_per_k: float
    power_w: float
    package: str
    """Size by its inch code, such as 0603."""
    part: Part


@dataclass(frozen=True)
class ChipCapacitor:
    """Chip capacitor of the table."""

    farad: float
    dielectric: str
    voltage_v: float
    tolerance_percent: float
    package: str
    """Size by its inch code, such as 1206."""
    part: Part


@dataclass(frozen=True)
class NamedPart:
    """Part that is bought by its name: a semiconductor, a connector or a trimmer."""

    value: str
    """Value of the component in the circuit."""
    footprint: str
    """Name of the footprint without its library."""
    part: Part | None
    reason: str
    """Reason why there is no part."""


@functools.cache
def load_sources() -> dict[str, Source]:
    """Load all sources by key."""
    return {row["key"]: Source(**row) for row in read_rows("sources.csv")}


@functools.cache
def load_resistors() -> tuple[ChipResistor, ...]:
    """Load the chip resistors. Of several that fit, the first is to be preferred."""
    return tuple(
        ChipResistor(
            parse_value(row["resistance_ohm"]),
            float(row["tolerance_percent"]),
            float(row["drift_ppm_per_k"]),
            float(row["power_w"]),
            row["package"],
            _part(row),
        )
        for row in read_rows("resistors.csv")
    )


@functools.cache
def load_capacitors() -> tuple[ChipCapacitor, ...]:
    """Load the chip capacitors. Of several that fit, the first is to be preferred."""
    return tuple(
        ChipCapacitor(
            parse_value(row["capacitance"]),
            row["dielectric"],
            float(row["voltage_v"]),
            float(row["tolerance_percent"]),
            row["package"],
            _part(row),
        )
        for row in read_rows("capacitors.csv")
    )


@functools.cache
def load_named_parts() -> tuple[NamedPart, ...]:
    """Load the parts that are bought by name. Of several that fit, the first is to be preferred."""
    return tuple(
        NamedPart(row["value"], row["footprint"], _part(row) if row["number"] else None, row["reason"])
        for row in read_rows("named_parts.csv")
    )


def parse_value(text: str) -> float:
    """Parse a value of the table [ohm or F], correctly rounded: "100n" is the float nearest to 1e-7."""
    exponent = _EXPONENTS.get(text[-1])
    return float(text) if exponent is None else float(f"{text[:-1]}e{exponent}")


def read_rows(name: str) -> Iterator[dict[str, str]]:
    """Read the rows of one of the table's files, each by column."""
    with (FOLDER / name).open(encoding="utf-8", newline="") as file:
        yield from csv.DictReader(file)


def _part(row: dict[str, str]) -> Part:
    return Part(row["manufacturer"], row["number"], row["lcsc"], row["source"])
