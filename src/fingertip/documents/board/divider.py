"""Divider of a design as its folder states it: expected readings, bill of materials and README."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from fingertip.board.circuits.divider import DIVIDER_RESISTOR, RATING, compute_current_ratio, divider_circuit
from fingertip.board.fabrication.bom import COLUMNS
from fingertip.catalogues.output_files import DECK, NETLIST, VALUES, WIRING
from fingertip.design import Design
from fingertip.design.formulas.filter import find_preferred_neighbours
from fingertip.documents.acceptance import IDLE_TOLERANCE_V, expect_open_v, expect_readings
from fingertip.documents.template import WIDTH, render_page
from fingertip.foundation.files import format_csv


@dataclass(frozen=True)
class DividerReading:
    """Voltage that the pin must show [V], and its converter's counts."""

    mass_g: float
    tactile_v: float
    limits_v: tuple[float, float]
    counts: int
    limit_counts: tuple[int, int]


def count(design: Design, volts: float) -> int:
    """Convert a voltage [V] to the nearest count of the design's converter."""
    converter = design.detector
    code: int = round((volts - converter.adc_low_v) / converter.adc_step_v)
    return min(max(code, 0), int(2**converter.adc_bits) - 1)


def list_readings(design: Design) -> Iterator[DividerReading]:
    """List the readings of the untouched finger and under each weight, with the spread of single sensors."""
    open_v = expect_open_v(design)
    expected = [(0.0, open_v, (open_v, open_v + IDLE_TOLERANCE_V))]
    expected += [(each.mass_g, each.tactile_v, each.limits_v) for each in expect_readings(design)]
    for mass_g, volts, (low_v, high_v) in expected:
        limits_v = round(low_v, 3), round(high_v, 3)
        limit_counts = count(design, low_v), count(design, high_v)
        yield DividerReading(mass_g, round(volts, 3), limits_v, count(design, volts), limit_counts)


def divider_bom(design: Design) -> bytes:
    """Bill of materials with the columns of a board's."""
    resistor, converter = divider_circuit(design).component(DIVIDER_RESISTOR), design.detector
    rows = [
        {
            "Quantity": "1", "References": resistor.reference, "Value": f"{resistor.value} ohm",
            "Footprint": resistor.footprint.split(":")[1], "Rating": RATING, "Note": "any maker",
        },
        {
            "Quantity": "1", "References": "J3", "Value": "controller",
            "Rating": f"analog input of {converter.adc_bits} bits, {converter.adc_range_text}",
            "Note": "fingertip firmware names those that it is compiled for",
        },
    ]  # fmt: skip
    return format_csv(COLUMNS, [tuple(row.get(column, "") for column in COLUMNS) for row in rows])


def divider_readme(design: Design) -> bytes:
    current = compute_current_ratio(design)
    safe_ohm = find_preferred_neighbours(design.board.divider_ohm * current, "E24")[1]
    page = render_page(
        "board/divider.md", WIDTH, design=design, readings=list(list_readings(design)), current=current,
        safe_ohm=safe_ohm, wiring=WIRING, netlist=NETLIST, deck=DECK, values=VALUES,
    )  # fmt: skip
    return page.encode()
