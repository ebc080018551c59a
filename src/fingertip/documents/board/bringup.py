"""Data of the bring-up sheet and of its sketch, whose texts are `bringup.md` and `bringup.ino`: places and limits."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from fingertip.board.analysis.board_values import BoardValues
from fingertip.board.bringup import bench
from fingertip.board.bringup import plan as limits
from fingertip.board.bringup.plan import PROBES, BringUp, Limits
from fingertip.board.circuits.channels import describe_sockets
from fingertip.board.kicad.placement import Pad, Placement, view_channel
from fingertip.board.kicad.project import load_project
from fingertip.board.parts import nets
from fingertip.board.parts.circuit import CapacitorRequirement, Circuit, format_component_value
from fingertip.board.parts.symbols import LOCKING_CONNECTORS
from fingertip.catalogues.electronics import NAMES
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import DIODE_V
from fingertip.documents.board.readme import collect_board
from fingertip.documents.template import format_ohm, render
from fingertip.foundation.errors import join_words

Row = tuple[str, ...]

_LETTERS = {nets.ADC_TACTILE: "T", nets.ADC_FILTERED: "S", nets.FILTERED: "TP3"}
_TOP_DEPENDS = {nets.ADC_TACTILE: "R8, R9, C9, C19", nets.ADC_FILTERED: "C20, R27, C25"}
"""Parts on which the highest tone at a pin depends beside the filter's."""


def render_sheet(plan: BringUp, values: BoardValues, design: Design, wiring: str) -> str:
    """Render the bring-up sheet of a design's board as Markdown, with the file of its wiring diagram."""
    return render("board/bringup.md", **_collect(plan, values, design), wiring=wiring).rstrip() + "\n"


def render_sketch(plan: BringUp, values: BoardValues, design: Design) -> str:
    """Render the sketch that plays the tones and, where the controller samples the board, compares the readings."""
    return render("board/bringup.ino", **_collect(plan, values, design))


def _collect(plan: BringUp, values: BoardValues, design: Design) -> dict[str, Any]:
    circuit = plan.board.circuit
    # Of a board for several fingers, the first one.
    placement = view_channel(load_project(values.variant, design.board.channels).placement, 1)
    parts = {part.reference: part for part in circuit.components}
    small = [name for name, part in parts.items() if "SOT-23" in part.footprint]
    has_slip = nets.SLIP in circuit.net_by_pin.values()
    c1 = parts["C1"].requirement
    return collect_board(values, design) | {
        "plan": plan,
        "limits": limits,
        "row": _row,
        "bench": bench,
        "setup": plan.board.bench,
        "name": design.name,
        "letters": _LETTERS,
        "orientation": "J1 and J2" if design.board.channels == 1 else "the sensors' sockets",
        "fingers": NAMES[: design.board.channels],
        "sockets": "; ".join(describe_sockets()[: design.board.channels]),
        "parts": parts,
        # Three times what the board should draw, in tens.
        "limit_ma": 10.0 * math.ceil(0.3 * plan.supply_ma.expected),
        "tap_v": design.detector.threshold_v if plan.pins_v else 0.5 * DIODE_V,
        "is_class_2": isinstance(c1, CapacitorRequirement) and "C0G" not in c1.dielectrics,
        "gain": values.achieved_response.passband_gain,
        "coupling_capacitor": format_component_value(bench.COUPLING_FARAD),
        "ground_end": find_widest(circuit, placement, nets.GND),
        "slip_end": find_end(placement, "R21", nets.SLIP) if has_slip else "",
        "threshold_end": find_end(placement, "R20", nets.THRESHOLD) if has_slip else "",
        "dotted": _join([name for name in parts if name.startswith("U") and name not in small]),
        "diodes": _join([name for name, part in parts.items() if part.symbol.name == "1N4148W"]),
        "small": _join(small),
        "is_locking": parts["J1"].footprint in LOCKING_CONNECTORS,
        "resistances": list(_list_resistances(plan, placement)),
        "voltages": list(_list_voltages(plan, placement)),
        "tones": list(_list_tones(plan)),
    }


def _list_resistances(plan: BringUp, placement: Placement) -> Iterator[Row]:
    where = "J2: red probe at plus, black at ground"
    # Behind the MOSFET that blocks a reversed supply, because without power it blocks the meter too.
    if "Q1" in placement.parts:
        plus = find_end(placement, "C10", nets.VCC)
        where = f"C10: red probe at its {plus.removesuffix(' of C10')}, black at the other"
    yield _row(where, plan.supply_ohm, "ohm", "a short: do not apply power")
    if plan.negative_ohm:
        yield _row("J2: ground to minus", plan.negative_ohm, "ohm", "a short: do not apply power")
        yield _row("J1: between its pins", plan.sensor_ohm, "ohm", "R10 to R13, C7")
    else:
        yield _row("J1 pin 1 to TP1", plan.sensor_ohm, "ohm", "R28 to R30, D6")


def _list_voltages(plan: BringUp, placement: Placement) -> Iterator[Row]:
    front_end = "bridge" if nets.REFERENCE in plan.open_v else "stage"
    for net, limit in plan.open_v.items():
        yield _row(_find_probe(placement, net), limit, "V", PROBES[net][front_end])
    for ohm, limit in plan.dummy_v.items():
        yield _row(f"TP1, {format_ohm(ohm)} at J1", limit, "V", "TP1")


def _list_tones(plan: BringUp) -> Iterator[Row]:
    for net, limit in plan.pins_v.items():
        yield _LETTERS[net], "none: mean", *_figures(limit, "V"), "the voltages above"
    if plan.pins_v:
        yield "S", "none: RMS", *_figures(plan.quiet_v, "V", 4), "hum, oscillation"
    for tone in plan.tones:
        is_top = tone.samples == plan.board.bench.periods[-1]
        depends = _TOP_DEPENDS[tone.net] if is_top else f"R1 to R5, C1 to C3{', C14' if plan.pins_v else ''}"
        yield _LETTERS[tone.net], f"{tone.hz:.1f} Hz", *_figures(tone.limits, "V", 4), depends


def _row(where: str, limit: Limits, unit: str, last: str) -> Row:
    return where, *_figures(limit, unit), last


def _figures(limit: Limits, unit: str, digits: int = 3) -> tuple[str, str]:
    if unit == "ohm":
        if math.isinf(limit.high):
            return "-", f"above {format_ohm(limit.low)}"
        return format_ohm(limit.expected), f"{limit.low:.0f} to {limit.high:.0f} ohm"
    values = (f"{value + 0.0:.{digits if unit == 'V' else 1}f}" for value in (limit.expected, limit.low, limit.high))
    expected, low, high = (value.replace("-0.000", "0.000") for value in values)
    return f"{expected} {unit}", f"{low} to {high} {unit}"


def _join(words: list[str]) -> str:
    return join_words(words) if words else ""


# Places for the probes where no test point is: an end of a part, named by its side as seen from the front, with sensor
# and supply on the left.


def _find_probe(placement: Placement, net: str) -> str:
    """Name the place of the red probe, and what is there."""
    point, pin = PROBES[net]["point"], PROBES[net]["pin"]
    place = find_end(placement, point, net) if pin == "end" else f"{point}{pin}"
    return f"{place}, {PROBES[net]['name']}"


def find_end(placement: Placement, reference: str, net: str) -> str:
    """Name the end of a two-terminal part that is at a net, such as "right end of C10"."""
    here, other = sorted(placement.parts[reference].pads, key=lambda pad: pad.net != net)
    return f"{_name_side(here, other)} end of {reference}"


def find_widest(circuit: Circuit, placement: Placement, net: str) -> str:
    """Find the two-terminal part whose pad at a net is the largest, and name that end."""
    references = (component.reference for component in circuit.components)
    by_part = {name: placement.parts[name].pads for name in references if name[0] in "RC" and name[1:].isdigit()}
    at_net = {
        reference: pads[0].width * pads[0].height
        for reference, pads in by_part.items()
        if sum(pad.net == net for pad in pads) == 1
    }
    return find_end(placement, max(at_net, key=lambda reference: at_net[reference]), net)


def _name_side(pad: Pad, other: Pad) -> str:
    (x, y), (other_x, other_y) = pad.centre, other.centre
    dx, dy = x - other_x, y - other_y
    if abs(dx) > abs(dy):
        return "right" if dx > 0 else "left"
    return "lower" if dy > 0 else "upper"
