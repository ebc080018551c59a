"""Data of the bring-up sheet, whose text is `bringup.md`: places of the probes, limits, and what a failure means."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

from fingertip.board.analysis.board_values import BoardValues
from fingertip.board.bringup import bench
from fingertip.board.bringup import plan as readings
from fingertip.board.bringup.diagnosis import list_hidden_faults, list_unsimulated
from fingertip.board.bringup.plan import BringUp
from fingertip.board.bringup.prediction import POINTS, PROBES, Limits, list_levels, name_ripple, name_tone, name_voltage
from fingertip.board.bringup.resistances import NEGATIVE_OHM, SENSOR_OHM, SUPPLY_OHM
from fingertip.board.circuits.channels import describe_sockets
from fingertip.board.kicad.placement import Pad, Placement, view_channel
from fingertip.board.kicad.project import load_project
from fingertip.board.parts import nets
from fingertip.board.parts.circuit import Circuit, format_component_value
from fingertip.board.parts.symbols import LOCKING_CONNECTORS
from fingertip.catalogues.electronics import NAMES
from fingertip.design import Design
from fingertip.documents.board.readme import collect_board
from fingertip.documents.template import format_ohm, render
from fingertip.foundation.errors import join_words

Row = tuple[str, ...]


def render_sheet(plan: BringUp, values: BoardValues, design: Design, wiring: str) -> str:
    """Render the bring-up sheet of a design's board as Markdown, with the file of its wiring diagram."""
    circuit, setup = plan.board.circuit, plan.board.bench
    # Of a board for several fingers, the first one.
    placement = view_channel(load_project(values.variant, design.board.channels).placement, 1)
    parts = {part.reference: part for part in circuit.components}
    small = [name for name, part in parts.items() if "SOT-23" in part.footprint]
    has_slip = nets.SLIP in circuit.net_by_pin.values()
    front_end = "bridge" if nets.REFERENCE in circuit.net_by_pin.values() else "stage"
    return render(
        "board/bringup.md",
        **collect_board(values, design),
        readings=readings,
        row=partial(_row, plan),
        bench=bench,
        setup=setup,
        name=design.name,
        orientation="J1 and J2" if design.board.channels == 1 else "the sensors' sockets",
        fingers=NAMES[: design.board.channels],
        sockets="; ".join(describe_sockets()[: design.board.channels]),
        wiring=wiring,
        parts=parts,
        # Three times what the board should draw, in tens.
        limit_ma=10.0 * math.ceil(0.3 * plan.current[readings.SUPPLY_MA].expected_v),
        coupling_capacitor=format_component_value(bench.COUPLING_FARAD),
        fiducials=placement.fiducials,
        ground_end=find_widest(circuit, placement, nets.GND),
        slip_end=find_end(placement, "R21", nets.SLIP) if has_slip else "",
        threshold_end=find_end(placement, "R20", nets.THRESHOLD) if has_slip else "",
        dotted=_join([name for name in parts if name.startswith("U") and name not in small]),
        diodes=_join([name for name, part in parts.items() if part.symbol.name == "1N4148W"]),
        small=_join(small),
        is_locking=parts["J1"].footprint in LOCKING_CONNECTORS,
        resistances=list(_list_resistances(plan, placement)),
        voltages=[
            _row(plan, name_voltage(net), _find_probe(placement, net), PROBES[net][front_end])
            for net in plan.board.nets
        ],
        dummy_voltages=[
            _row(plan, name_voltage(nets.TACTILE, ohm), f"TP1, with {format_ohm(ohm)} at J1", "the same")
            for ohm in setup.dummy_ohm
        ],
        pin_1_end=find_pin_1_end(placement, bench.HOST),
        output_points=", ".join(f"{pin.letter}: {POINTS[pin.source]}" for pin in bench.list_output_pins(circuit)),
        drop_v=bench.largest_drop_v(circuit, {name: limits.expected_v for name, limits in plan.levels.items()}),
        outputs=list(_list_outputs(plan)),
        tones=list(_list_tones(plan, placement)),
        output_tones=[
            (name.split("_")[1].upper(), 100.0 * ratio) for name, ratio in bench.attenuate_tones(circuit).items()
        ],
        hidden=[(what.capitalize(), _join(names)) for what, names in list_hidden_faults(plan).items()],
        clamps=_join(list_unsimulated(plan)),
    )


def _list_resistances(plan: BringUp, placement: Placement) -> Iterator[Row]:
    where = "J2: red probe at plus, black at ground"
    # Behind the MOSFET that blocks a reversed supply, because without power it blocks the meter too.
    if "Q1" in placement.parts:
        plus = find_end(placement, "C10", nets.VCC)
        where = f"C10: red probe at its {plus.removesuffix(' of C10')}, black at the other"
    yield _row(plan, SUPPLY_OHM, where, "a short: do not apply power")
    if NEGATIVE_OHM in plan.before_power:
        yield _row(plan, NEGATIVE_OHM, "J2: ground to minus", "a short: do not apply power")
    if nets.REFERENCE in plan.board.circuit.net_by_pin.values():
        yield _row(plan, SENSOR_OHM, "J1: between its pins", "R10 to R13, C7")
    else:
        yield _row(plan, SENSOR_OHM, "J1 pin 1 to TP1", "R28 to R30, D6")


def _list_outputs(plan: BringUp) -> Iterator[Row]:
    circuit = plan.board.circuit
    pins = {pin.net: pin for pin in bench.list_output_pins(circuit)}
    for number, net in circuit.list_wires(circuit.component(bench.HOST)):
        if pin := pins.get(net):
            yield _row(plan, pin.constant_name, f"{pin.letter}, pin {number}", PROBES[pin.source]["output"])


def _list_tones(plan: BringUp, placement: Placement) -> Iterator[Row]:
    high_hz = plan.board.bench.tones_hz[-1]
    found = [(name_tone(net, hz), hz, _find_probe(placement, net)) for net, hz in list_levels(plan.board.bench)]
    if plan.board.has_envelope:
        probe = _find_probe(placement, nets.ENVELOPE)
        found.append((name_tone(nets.ENVELOPE, high_hz), high_hz, f"{probe}, direct voltage"))
        found.append((name_ripple(high_hz), high_hz, f"{probe}, alternating"))
    if (name := name_tone(nets.RECT_OUT, high_hz)) in plan.levels:
        found.append((name, high_hz, f"{_find_probe(placement, nets.RECT_OUT)}, direct voltage"))
    for pin in filter(bench.has_tone, bench.list_output_pins(plan.board.circuit)):
        found.append((pin.tone_name, bench.TOP_HZ, f"{pin.letter} at {bench.HOST}, alternating"))
    for name, hz, where in found:
        yield f"`{name}`", f"{hz:g} Hz", where, *_figures(plan.all[name], "V")


def _row(plan: BringUp, name: str, where: str, last: str) -> Row:
    unit = {"v": "V", "ohm": "ohm", "ma": "mA"}[name.rpartition("_")[2]]
    return (f"`{name}`", where, *_figures(plan.all[name], unit), last)


def _figures(limits: Limits, unit: str) -> tuple[str, str]:
    if unit == "ohm":
        if math.isinf(limits.high_v):
            return "-", f"above {format_ohm(limits.low_v)}"
        return format_ohm(limits.expected_v), f"{limits.low_v:.0f} to {limits.high_v:.0f} ohm"
    digits = 3 if unit == "V" else 1
    values = (f"{value + 0.0:.{digits}f}" for value in (limits.expected_v, limits.low_v, limits.high_v))
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


def find_pin_1_end(placement: Placement, reference: str) -> str:
    """Name the end of a connector at which pin 1 lies, such as "lower"."""
    pads = {pad.name: pad for pad in placement.parts[reference].pads}
    last = max((name for name in pads if name.isdigit()), key=int)
    return _name_side(pads["1"], pads[last])


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
