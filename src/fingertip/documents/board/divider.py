"""Files of a divider: one circuit as netlist, SPICE deck, wiring, bill
of materials, expected readings and README.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from fingertip.board.analysis.tactile_response import IDLE_TOLERANCE_V
from fingertip.board.circuits.board_circuit import divider_circuit
from fingertip.board.circuits.spice import divider_deck
from fingertip.board.components.front_end import (
    MAX_CURRENT_A_PER_CM2,
    MAX_FORCE_N,
    sensor_conductance_s,
)
from fingertip.board.fabrication.bom import COLUMNS, list_bom
from fingertip.board.kicad.netlist import kicad_netlist_file
from fingertip.catalogues.output_files import BOM, DECK, NETLIST, README, VALUES, WIRING
from fingertip.design import Design
from fingertip.design.formulas.filter import find_preferred_neighbours
from fingertip.documents.acceptance import WeightReading, expect_open_v, expect_readings
from fingertip.documents.template import WIDTH, render, render_page
from fingertip.foundation.files import encode_json, format_csv


def list_readings(design: Design) -> list[dict[str, Any]]:
    """List voltage, limits and counts of the pin: untouched, and
    under each weight whose voltage is known.
    """
    idle_v = expect_open_v(design)
    weights = expect_readings(design)
    weights = () if design.force_curve.find_doubt(design.sensor.model) else weights
    idle = WeightReading(0.0, math.inf, idle_v, (idle_v, idle_v + IDLE_TOLERANCE_V))

    return [
        {
            "mass_g": one.mass_g,
            "tactile_v": round(one.tactile_v, 2),
            "limits_v": [round(limit, 2) for limit in one.limits_v],
            "counts": round(
                (one.tactile_v - design.detector.adc_low_v) / design.detector.adc_step_v
            ),
        }
        for one in (idle, *weights)
    ]


def describe_readings(readings: Iterable[Mapping[str, Any]]) -> list[str]:
    form = "{}: {tactile_v:.2f} V ({limits_v[0]:.2f} to {limits_v[1]:.2f}), {counts} counts"
    return [
        form.format(f"pressed by {one['mass_g']:g} g" if one["mass_g"] else "untouched", **one)
        for one in readings
    ]


def divider_files(design: Design) -> dict[str, bytes]:
    circuit = divider_circuit(design)
    current = compute_current_ratio(design)
    readings = list_readings(design)
    low_ohm, high_ohm = sorted(one.sensor_ohm for one in expect_readings(design))
    rows = [
        (str(len(one.components)), " ".join(one.references), one.value, one.rating)
        for one in list_bom(circuit)
    ]
    parameters = design.board.model_dump(include={"variant", "divider_ohm", "supply_v"})
    values = {
        "parameters": parameters,
        "readings": readings,
        "current_over_limit": round(current, 3),
    }
    readme = render_page(
        "board/divider.md",
        WIDTH,
        design=design,
        readings=describe_readings(readings),
        current=current,
        safe_ohm=find_preferred_neighbours(design.board.divider_ohm * current, "E24")[1],
    )

    return {
        # The wiring picture stands for a schematic.
        NETLIST: kicad_netlist_file(circuit).replace(b"divider.kicad_sch", WIRING.encode()),
        DECK: divider_deck(circuit, design.board.supply_v, low_ohm, high_ohm),
        WIRING: render(
            "board/divider.svg", design=design, ohm=circuit.component("R1").value
        ).encode(),
        BOM: format_csv((*COLUMNS[:3], "Rating"), rows),
        VALUES: encode_json(values),
        README: readme.encode(),
    }


def compute_current_ratio(design: Design) -> float:
    """Largest current through the sensor, over what its maker allows for its active area."""
    board = design.board
    area_cm2 = math.pi / 4 * (design.dimensions.sensor.active_diameter_mm / 10) ** 2
    ohm = board.divider_ohm + 1.0 / sensor_conductance_s(MAX_FORCE_N)

    return board.supply_v / ohm / (MAX_CURRENT_A_PER_CM2 * area_cm2)
