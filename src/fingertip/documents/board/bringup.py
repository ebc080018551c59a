"""Data of the bring-up sheet and of its sketch, whose texts are
`bringup.md` and `bringup.ino`: places and limits.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from fingertip.board.analysis.board_values import BoardValues
from fingertip.board.bringup import expected_readings as limits
from fingertip.board.bringup import stimulus
from fingertip.board.bringup.expected_readings import PROBES, BringUp, Limits
from fingertip.board.bringup.resistance import resistance_between
from fingertip.board.circuits.channels import describe_sockets
from fingertip.board.kicad.placement import Placement, view_channel
from fingertip.board.kicad.project import load_project
from fingertip.board.parts import nets
from fingertip.board.parts.circuit import (
    CapacitorRequirement,
    format_component_value,
    reference_sort_key,
)
from fingertip.board.parts.symbols import LOCKING_CONNECTORS
from fingertip.catalogues.electronics import NAMES
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import DIODE_V
from fingertip.documents.board.readme import collect_board
from fingertip.documents.template import format_ohm, render
from fingertip.foundation.errors import join_words

Row = tuple[str, ...]

_LETTERS = {
    nets.ADC_TACTILE: "T",
    nets.ADC_FILTERED: "S",
    nets.ADC_ENVELOPE: "E",
    nets.FILTERED: "TP3",
}
_OUTPUTS = (
    (nets.ADC_TACTILE, nets.TACTILE, "T of J3 to TP1", "R8, R9, J3"),
    (nets.ADC_FILTERED, nets.FILTERED, "S of J3 to TP3", "R27, J3"),
    (nets.ADC_ENVELOPE, nets.ENVELOPE, "E of J4 to TP4", "R7, J4"),
    (nets.VMID_OUT, "VMID", "M of J4 to TP5", "R24, J4"),
)
_HIDDEN = ("R7", "R8", "R9")
"""Resistors that only an ohmmeter shows when open."""


def render_sheet(plan: BringUp, values: BoardValues, design: Design, wiring: str) -> str:
    """Render the bring-up sheet of a design's board as Markdown,
    with the file of its wiring diagram.
    """
    return (
        render("board/bringup.md", **_collect(plan, values, design), wiring=wiring).rstrip() + "\n"
    )


def render_sketch(plan: BringUp, values: BoardValues, design: Design) -> str:
    """Render the sketch that plays the tones and, where the
    controller samples the board, compares the readings.
    """
    return render("board/bringup.ino", **_collect(plan, values, design))


def _collect(plan: BringUp, values: BoardValues, design: Design) -> dict[str, Any]:
    circuit = plan.board.circuit
    # Of a board for several fingers, the first one.
    placement = view_channel(load_project(values.variant, design.board.channels).placement, 1)
    parts = {part.reference: part for part in circuit.components}
    small = [name for name, part in parts.items() if "SOT-23" in part.footprint]
    c1 = parts["C1"].requirement

    return collect_board(values, design) | {
        "plan": plan,
        "limits": limits,
        "stimulus": stimulus,
        "setup": plan.board.stimulus,
        "name": design.name,
        "letters": _LETTERS,
        "fingers": NAMES[: design.board.channels],
        "sockets": "; ".join(describe_sockets()[: design.board.channels]),
        "parts": parts,
        # Three times what the board should draw, in tens.
        "limit_ma": 10.0 * math.ceil(0.3 * plan.supply_ma.expected),
        "tap_v": design.detector.threshold_v if plan.pins_v else 0.5 * DIODE_V,
        "is_class_2": isinstance(c1, CapacitorRequirement) and "C0G" not in c1.dielectrics,
        "gain": values.achieved_response.passband_gain,
        "coupling_capacitor": format_component_value(stimulus.COUPLING_FARAD),
        "dotted": _join([name for name in parts if name.startswith("U") and name not in small]),
        "diodes": _join([name for name, part in parts.items() if part.symbol.name == "1N4148W"]),
        "is_locking": parts["J1"].footprint in LOCKING_CONNECTORS,
        "unseen": join_words(list_unseen(plan)),
        "resistances": list(_list_resistances(plan, placement)),
        "supplies": list(_list_supplies(plan, placement)),
        "voltages": list(_list_voltages(plan, placement)),
        "tones": list(_list_tones(plan)),
    }


def _list_resistances(plan: BringUp, placement: Placement) -> Iterator[Row]:
    circuit = plan.board.circuit
    plus = _find_plus(placement)
    yield _row(
        f"{plus} (red probe) to supply ground",
        plan.supply_ohm,
        "ohm",
        "a short: do not apply power",
    )

    if plan.negative_ohm:
        yield _row("J2: ground to minus", plan.negative_ohm, "ohm", "a short: do not apply power")
        yield _row("J1: between its pins", plan.sensor_ohm, "ohm", "R10 to R13, C7")
        where = f"diode range: ground to T and E of J3; these to {plus} (red probe first)"
        yield where, "0.15 to 0.4 V each", "D2, D3"
        return

    yield _row("J1 pin 1 to TP1", plan.sensor_ohm, "ohm", "R28 to R30")
    known = {net.name for net in circuit.nets}
    for pin, point, where, parts in _OUTPUTS:
        if pin in known:
            ohm = resistance_between(circuit, pin, point)
            yield _row(where, Limits(ohm, 0.9 * ohm, 1.1 * ohm), "ohm", parts)


def _list_supplies(plan: BringUp, placement: Placement) -> Iterator[Row]:
    places = {nets.VCC: _find_plus(placement)} | (
        {nets.VEE: "J2 minus"} if plan.negative_ohm else {}
    )
    for volts, place in ((plan.board.rails_v[net], place) for net, place in places.items()):
        margin_v = 0.01 * limits.SUPPLY_PERCENT * abs(volts)
        yield _row(
            f"{place} to supply ground",
            Limits(volts, volts - margin_v, volts + margin_v),
            "V",
            "supply",
        )

    yield _row(
        "mA, into the positive supply",
        plan.supply_ma,
        "mA",
        "an amplifier rotated, bridged or not soldered",
    )


def list_unseen(plan: BringUp) -> list[str]:
    """List the parts that no reading shows when they are open."""
    seen = {"C1", "C2", "C3"} | (
        {"C9", "C14", "C19", "C20", "C25", "R7", "R8", "R9"} if plan.pins_v else set()
    )
    parts = sorted(plan.board.circuit.components, key=reference_sort_key)
    hidden = (
        part.reference
        for part in parts
        if part.symbol.name in ("C", "D_TVS") or part.reference in _HIDDEN
    )

    return [name for name in hidden if name not in seen]


def _find_plus(placement: Placement) -> str:
    """Name the place of the positive supply, behind Q1 if there is
    one: without power it blocks the meter.
    """
    return "TP7" if "Q1" in placement.parts else "J2 plus"


def _list_voltages(plan: BringUp, placement: Placement) -> Iterator[Row]:
    front_end = "bridge" if nets.REFERENCE in plan.open_v else "stage"
    for net, limit in plan.open_v.items():
        probe = PROBES[net]
        place = (
            find_end(placement, probe["point"], net)
            if probe["pin"] == "end"
            else f"{probe['point']}{probe['pin']}"
        )
        yield _row(f"{place}, {probe['name']}", limit, "V", probe[front_end])

    for ohm, limit in plan.dummy_v.items():
        yield _row(
            f"TP1, {format_ohm(ohm)} at J1",
            limit,
            "V",
            "R28 to R30" if front_end == "stage" else "R10 to R14",
        )


def _list_tones(plan: BringUp) -> Iterator[Row]:
    for tone in plan.tones:
        depends = "R1 to R5, C1 to C3" if tone is plan.tones[0] else "as above"
        yield _LETTERS[tone.net], f"{tone.hz:.1f} Hz", _accept(tone.limits, "V", 4), depends


def _row(where: str, limit: Limits, unit: str, last: str) -> Row:
    return where, _accept(limit, unit), last


def _accept(limit: Limits, unit: str, digits: int = 3) -> str:
    if unit == "ohm":
        if math.isinf(limit.high):
            return f"above {format_ohm(limit.low)}"

        return f"{limit.low:.0f} to {limit.high:.0f} ohm"

    values = (
        f"{value + 0.0:.{digits if unit == 'V' else 1}f}" for value in (limit.low, limit.high)
    )
    low, high = (value.replace("-0.000", "0.000") for value in values)
    return f"{low} to {high} {unit}"


def _join(words: list[str]) -> str:
    return join_words(words) if words else ""


# Places for the probes where no test point is: an end of a part, named by its side as seen from the
# front, with sensor and supply on the left.


def find_end(placement: Placement, reference: str, net: str) -> str:
    """Name the end of a two-terminal part that is at a net, such as "right end of C10"."""
    here, other = sorted(placement.parts[reference].pads, key=lambda pad: pad.net != net)
    dx, dy = (a - b for a, b in zip(here.centre, other.centre, strict=True))

    if abs(dx) > abs(dy):
        side = "right" if dx > 0 else "left"
    elif dy > 0:
        side = "lower"
    else:
        side = "upper"

    return f"{side} end of {reference}"
