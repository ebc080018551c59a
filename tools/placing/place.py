"""Place a board: `python -m tools.placing.place comparator_single_3v3`, in the repository's root.

It starts from the stored placement, moves components, rotations and labels, and stores the result. Connectors, mounting
holes, fiducial marks and texts stay where the file has them. Then `python -m tools.routing.reroute` routes the board.
"""

from __future__ import annotations

import argparse
import itertools
import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fingertip.board import board_circuit, board_values
from fingertip.board.kicad.footprints import (
    FIDUCIAL,
    FOOTPRINTS,
    PIN_1_DOT_MM,
    SILK_CLEARANCE_MM,
    SILK_LINE_MM,
    Box,
    Footprint,
)
from fingertip.board.kicad.placement import (
    PLACEMENTS,
    Label,
    Placement,
    Position,
    courtyard_overlaps,
    list_fiducials,
    place_box,
    rotate_offset,
)
from fingertip.board.kicad.project import BOARD_CONFIGURATIONS
from fingertip.board.kicad.silkscreen import label_places, needs_label, print_area, silkscreen_conflicts, text_box
from fingertip.board.parts.circuit import Circuit, Component, Node
from fingertip.design import Design

_TURNS = (0, 90, 180, 270)
_EMPTY: Box = (1e6, 1e6, -1e6, -1e6)
_WEIGHTS = {"VCC": 0.15, "VEE": 0.15, "VMID": 0.4}
_WEIGHTS |= dict.fromkeys(("SENSOR", "REFERENCE", "GAIN_A", "GAIN_B", "STAGE1_IN", "FEEDBACK", "STAGE2_IN"), 1.6)
_WEIGHTS |= dict.fromkeys(("RECT_IN", "LP_IN"), 1.6)
"""Weights of nets in the wire length; 1 for all others.

The rails reach everywhere. Inputs of amplifiers pick up interference and are kept short.
"""
_REPAIRS = 4
"""Number of times that the placer tries to remove what problems are left."""
_DECOUPLING_WEIGHT = 0.8
"""Weight of the way from a decoupling capacitor to the supply pin of its amplifier."""


@dataclass(frozen=True)
class Item:
    """Thing on the board that takes space: a component, a fiducial mark or a text."""

    name: str
    position: Position
    is_movable: bool
    courtyard: Box
    area: Box
    """Area that labels avoid."""
    labels: tuple[tuple[float, float, int], ...]
    """Places of its label: centre relative to the position on the board at no rotation, and angle of the text."""
    component: Component | None = None


def main() -> None:
    """Place the boards named on the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("board", nargs="+", choices=list(BOARD_CONFIGURATIONS))
    parser.add_argument("--moves", type=float, default=10e6)
    parser.add_argument(
        "--hot", type=float, default=4.0, help="temperature at the beginning [mm]; 0.2 keeps most places"
    )
    parser.add_argument("--cold", type=float, default=0.02, help="temperature at the end [mm]")
    parser.add_argument("--gaps", type=float, nargs="+", default=[0.15, 0.2, 0.1], help="clearances of courtyards [mm]")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--few-labels", action="store_true", help="do not try to label resistors and capacitors")
    arguments = parser.parse_args()
    for name in arguments.board:
        configuration = BOARD_CONFIGURATIONS[name]
        circuit = board_circuit(board_values(Design.load(changes=configuration.changes)))
        schedule = int(arguments.moves), arguments.hot, arguments.cold
        # The front shows all references if they fit, else those that it must show.
        best: tuple[int, Placement] | None = None
        for i, (gap, seed) in enumerate(itertools.product(arguments.gaps, arguments.seeds)):
            labels_all = i < len(arguments.seeds) and not arguments.few_labels
            placed, wire, rest = place(circuit, configuration.placement, *schedule, gap, seed, labels_all=labels_all)
            problems = list_problems(circuit, placed)
            which = "all labels" if labels_all else "required labels"
            print(f"{name}: {which}, gap {gap:g} mm, seed {seed}, wire length {wire:.1f} mm, overlap {rest:.2f}")
            print("".join(f"    {problem}\n" for problem in problems), end="", flush=True)
            if best is None or len(problems) < best[0]:
                best = len(problems), placed
                (PLACEMENTS / f"{name}.json").write_text(format_placement(placed), encoding="utf-8")
            if not problems:
                break
        else:
            raise SystemExit(f"{name}: stored the best placement, which has problems; go on from it with --hot 0.3")


def place(
    circuit: Circuit,
    placement: Placement,
    moves: int,
    hot: float,
    cold: float,
    gap: float,
    seed: int,
    labels_all: bool = False,
) -> tuple[Placement, float, float]:
    """Place a board again; returns the placement, its wire length [mm] and the overlap that is left."""
    from tools.placing.anneal import compiled_anneal

    items = list(_list_items(circuit, placement, labels_all))
    most = max(len(item.labels) for item in items)
    courtyards, areas = np.empty((len(items), 4, 4)), np.empty((len(items), 4, 4))
    labels = np.full((len(items), 4, most, 4), 1e6)
    state = np.zeros((len(items), 4))
    for i, item in enumerate(items):
        state[i] = item.position.x, item.position.y, item.position.angle // 90, 0
        label = placement.reference_labels.get(item.name)
        for q, turn in enumerate(_TURNS):
            origin = Position(0.0, 0.0, turn)
            courtyards[i, q] = place_box(origin, item.courtyard) if item.courtyard != _EMPTY else _EMPTY
            areas[i, q] = place_box(origin, item.area) if item.area != _EMPTY else _EMPTY
            for s, (x, y, angle) in enumerate(_turned_labels(item, turn)):
                labels[i, q, s] = text_box(item.name, x, y, angle)
        if label and item.labels:
            offsets = _turned_labels(item, item.position.angle)
            x, y = label.x - item.position.x, label.y - item.position.y
            distances = [abs(a - x) + abs(b - y) + abs(c - label.angle) for a, b, c in offsets]
            state[i, 3] = distances.index(min(distances))
    nets = _list_nets(circuit, items)
    arrays = (
        np.array([item.is_movable for item in items]), courtyards, areas, labels,
        np.array([len(item.labels) for item in items]), placement.width, placement.height,
    )  # fmt: skip
    compiled_anneal(state, *arrays, gap, *nets, moves, hot, cold, 2.0, 40.0, seed)
    # The next stages remove what overlaps are left. They give up the clearance where there is no room for it.
    for stage in range(_REPAIRS):
        warm = cold * 4 * (1 + stage)
        wire, rest = compiled_anneal(state, *arrays, 0.02, *nets, moves // 4, warm, cold / 4, 40.0, 200.0, seed + stage)
        placed = _read_state(items, state.tolist(), placement)
        if not list_problems(circuit, placed):
            break
    return placed, float(wire), float(rest)


def list_problems(circuit: Circuit, placement: Placement) -> list[str]:
    """List what is wrong with a placement: overlaps, and silkscreen that misleads or cannot be read."""
    overlaps = (f"{one} overlaps {other}" for one, other in courtyard_overlaps(circuit, placement))
    return [*overlaps, *silkscreen_conflicts(circuit, placement)]


def _read_state(items: Sequence[Item], state: Sequence[Sequence[float]], placement: Placement) -> Placement:
    positions, references = {}, {}
    for item, (x, y, quarter, s) in zip(items, state, strict=True):
        if item.component:
            turn = _TURNS[int(quarter)]
            positions[item.name] = Position(round(x, 3), round(y, 3), turn)
            if item.labels:
                dx, dy, angle = _turned_labels(item, turn)[int(s)]
                references[item.name] = Label(round(x + dx, 3), round(y + dy, 3), angle)
    return replace(placement, positions=positions, reference_labels=references)


def _list_items(circuit: Circuit, placement: Placement, labels_all: bool) -> Iterator[Item]:
    for component in circuit.components:
        footprint = FOOTPRINTS[component.footprint]
        area, courtyard = _area(footprint), _courtyard(footprint)
        is_labelled = needs_label(component) or (labels_all and bool(component.symbol.pins))
        labels = tuple(label_places(component.reference, area)) if is_labelled else ()
        is_movable = component.reference[0] not in "JH"
        position = placement.positions[component.reference]
        yield Item(component.reference, position, is_movable, courtyard, area, labels, component)
    for name, position in list_fiducials(placement).items():
        footprint = FOOTPRINTS[FIDUCIAL]
        yield Item(name, position, False, footprint.courtyard, _area(footprint), ())
    for text, x, y in placement.texts:
        # A text never moves: its only label is itself.
        yield Item(text, Position(x, y), False, _EMPTY, _EMPTY, ((0.0, 0.0, 0),))


def _courtyard(footprint: Footprint) -> Box:
    """Courtyard of a footprint, with silkscreen that sticks out of it and half its distance from other silkscreen."""
    left, top, right, bottom = footprint.courtyard
    half = (SILK_LINE_MM + SILK_CLEARANCE_MM) / 2
    points = [
        (x + dx, y + dy)
        for line in footprint.silkscreen
        for x, y in line
        for dx in (-half, half)
        for dy in (-half, half)
    ]
    if footprint.pin_1_dot:
        (x, y), half = footprint.pin_1_dot, PIN_1_DOT_MM / 2
        points += [(x - half, y - half), (x + half, y + half)]
    xs, ys = [left, right, *(x for x, _ in points)], [top, bottom, *(y for _, y in points)]
    return (min(xs), min(ys), max(xs), max(ys))


def _area(footprint: Footprint) -> Box:
    left, top, right, bottom = print_area(footprint)
    if footprint.pin_1_dot:
        (x, y), reach = footprint.pin_1_dot, PIN_1_DOT_MM / 2 + SILK_CLEARANCE_MM
        left, top, right, bottom = (
            min(left, x - reach),
            min(top, y - reach),
            max(right, x + reach),
            max(bottom, y + reach),
        )
    return (left, top, right, bottom)


def _turned_labels(item: Item, turn: int) -> Sequence[tuple[float, float, int]]:
    """Places of an item's label when the item is rotated. The text keeps its own direction."""
    if not item.component or not item.labels:
        return item.labels
    left, top, right, bottom = place_box(Position(0.0, 0.0, turn), item.area)
    return label_places(item.name, (left, top, right, bottom))


def _list_nets(circuit: Circuit, items: Sequence[Item]) -> tuple[Any, ...]:
    """Arrays of pins and nets for `anneal`. A decoupling capacitor and its amplifier are one more net."""
    numbers = {item.name: i for i, item in enumerate(items)}
    offsets: list[list[tuple[float, float]]] = []
    first_pin = [0]
    pin_numbers: dict[tuple[str, str], int] = {}
    for item in items:
        if item.component:
            for pad in FOOTPRINTS[item.component.footprint].pads:
                pin_numbers.setdefault((item.name, pad.number), len(offsets))
                offsets.append([rotate_offset(turn, pad.x, pad.y) for turn in _TURNS])
        first_pin.append(len(offsets))
    nets = [(_WEIGHTS.get(net.name, 1.0), list(net.nodes)) for net in circuit.nets if net.name != "GND"]
    for component in circuit.components:
        for pair in _decoupled(circuit, component):
            nets.append((_DECOUPLING_WEIGHT, pair))
    net_pins, first_net_pin = [], [0]
    of_item: list[list[int]] = [[] for _ in items]
    for k, (_, nodes) in enumerate(nets):
        for node in nodes:
            net_pins.append((numbers[node[0]], pin_numbers[node]))
            if k not in of_item[numbers[node[0]]]:
                of_item[numbers[node[0]]].append(k)
        first_net_pin.append(len(net_pins))
    first_own = np.cumsum([0, *map(len, of_item)])
    return (
        np.array(offsets), np.array(first_pin), np.array(net_pins), np.array(first_net_pin),
        np.array([weight for weight, _ in nets]), np.array([k for own in of_item for k in own]), first_own,
    )  # fmt: skip


def _decoupled(circuit: Circuit, component: Component) -> Iterator[list[Node]]:
    """Yield the pin of a decoupling capacitor with the pin of the same rail that it belongs to, if it has one."""
    match = re.search(r"at (U\d+|its entry)$", component.role)
    if not match:
        return
    entries = ("J2", "Q1") if match[1] == "its entry" else (match[1],)
    for net in circuit.nets:
        own = [node for node in net.nodes if node[0] == component.reference]
        others = [node for node in net.nodes if node[0] in entries]
        if net.name != "GND" and own and others:
            yield [own[0], others[0]]


def format_placement(placement: Placement) -> str:
    """Format a placement as the text of its file, one component to a line."""

    def table(rows: dict[str, list[float]]) -> str:
        order = sorted(rows, key=lambda name: (name.rstrip("0123456789"), int(re.sub(r"\D", "", name))))
        return ",\n".join(f"  {json.dumps(name)}: {json.dumps(rows[name])}" for name in order)

    positions = {name: [p.x, p.y, p.angle] for name, p in placement.positions.items()}
    labels = {name: [p.x, p.y, p.angle] for name, p in placement.reference_labels.items()}
    texts = ",\n".join(f"  {json.dumps(list(text))}" for text in placement.texts)
    fiducials = json.dumps([list(point) for point in placement.fiducials])
    return (
        f'{{\n"width": {placement.width},\n"height": {placement.height},\n"positions": {{\n{table(positions)}\n}},\n'
        f'"reference_labels": {{\n{table(labels)}\n}},\n"texts": [\n{texts}\n],\n"fiducials": {fiducials}\n}}\n'
    )


if __name__ == "__main__":
    main()
