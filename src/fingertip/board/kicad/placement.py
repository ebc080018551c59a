"""Placement of a board's components, with its outline [mm].

The origin is the upper left corner and the y axis points down. The folder `placements` holds one JSON file for each
variant and supply. The boards are 40 x 25 mm, with all components on the front. Sensor and supply enter on the left,
signals leave on the right. `python -m tools.placing.place` in the repository moves the components apart and places the
labels. After a change run `python -m tools.routing.reroute`, which routes the tracks again.
"""

from __future__ import annotations

import functools
import hashlib
import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from fingertip.board.kicad.footprints import FIDUCIAL, FOOTPRINTS, Box, Pad, Point
from fingertip.board.parts.circuit import Circuit
from fingertip.foundation.errors import BoardError

PLACEMENTS = Path(__file__).parent / "placements"


@dataclass(frozen=True)
class Position:
    """Position of a component: the origin of its footprint, and its anticlockwise rotation [degree]."""

    x: float
    y: float
    angle: int = 0


@dataclass(frozen=True)
class Label:
    """Printed reference of a component: its centre, and 90 where it reads upwards, else 0 [degree]."""

    x: float
    y: float
    angle: int = 0


@dataclass(frozen=True)
class Placement:
    """Outline of a board, positions of its components, and positions of its silkscreen text."""

    width: float
    height: float
    positions: dict[str, Position]
    """Positions of the components by reference."""
    reference_labels: dict[str, Label]
    """Printed references on the front, by reference."""
    texts: tuple[tuple[str, float, float], ...] = ()
    """Other printed texts on the front with their centres; beside the connectors they name the pins."""
    fiducials: tuple[Point, ...] = ()
    """Centres of the fiducial marks, by which a pick-and-place machine finds the board's position."""


@dataclass(frozen=True)
class PlacedPad:
    """Pad of a component on the board."""

    reference: str
    pad: Pad
    x: float
    y: float
    half_width: float
    half_height: float
    net: str
    """Name of its net; empty for a hole, or for a pin of no net."""


@functools.cache
def load_placement(name: str) -> Placement:
    """Load the placement of this name, such as "article_split"."""
    data = json.loads((PLACEMENTS / f"{name}.json").read_text("utf-8"))
    return Placement(
        data["width"],
        data["height"],
        {reference: Position(x, y, angle) for reference, (x, y, angle) in data["positions"].items()},
        {reference: Label(*label) for reference, label in data["reference_labels"].items()},
        tuple((text, x, y) for text, x, y in data["texts"]),
        tuple((x, y) for x, y in data["fiducials"]),
    )


def rotate_offset(angle: int, x: float, y: float) -> tuple[float, float]:
    """Convert an offset within a footprint that is rotated by `angle` [degree] to an offset on the board."""
    return {0: (x, y), 90: (y, -x), 180: (-x, -y), 270: (-y, x)}[angle]


def place_pads(circuit: Circuit, placement: Placement) -> Iterator[PlacedPad]:
    """Yield every pad of the board."""
    for component in circuit.components:
        position = placement.positions[component.reference]
        for pad in FOOTPRINTS[component.footprint].pads:
            dx, dy = rotate_offset(position.angle, pad.x, pad.y)
            width, height = (pad.width, pad.height) if position.angle % 180 == 0 else (pad.height, pad.width)
            yield PlacedPad(
                component.reference,
                pad,
                position.x + dx,
                position.y + dy,
                width / 2,
                height / 2,
                circuit.net_by_pin.get((component.reference, pad.number), ""),
            )


def list_fiducials(placement: Placement) -> dict[str, Position]:
    """List the fiducial marks of a board by name, FID1 and so on."""
    return {f"FID{i}": Position(x, y) for i, (x, y) in enumerate(placement.fiducials, start=1)}


def place_box(position: Position, box: Box) -> Box:
    """Place a box of a footprint on the board."""
    left, top, right, bottom = box
    xs, ys = zip(*(rotate_offset(position.angle, x, y) for x, y in ((left, top), (right, bottom))), strict=True)
    return (position.x + min(xs), position.y + min(ys), position.x + max(xs), position.y + max(ys))


def courtyard_overlaps(circuit: Circuit, placement: Placement) -> Iterator[tuple[str, str]]:
    """Yield pairs of components or fiducial marks whose courtyards overlap.

    A component that sticks out beyond the edge of the board is paired with "edge".
    """
    boxes = {
        component.reference: place_box(
            placement.positions[component.reference], FOOTPRINTS[component.footprint].courtyard
        )
        for component in circuit.components
    }
    for name, position in list_fiducials(placement).items():
        boxes[name] = place_box(position, FOOTPRINTS[FIDUCIAL].courtyard)
    references = list(boxes)
    for i, one in enumerate(references):
        a = boxes[one]
        if min(a[0], a[1], placement.width - a[2], placement.height - a[3]) < -1e-9:
            yield one, "edge"
        for other in references[:i]:
            if _overlap(one, a, other, boxes[other]):
                yield one, other


def _overlap(one: str, a: Box, other: str, b: Box) -> bool:
    if min(a[2], b[2]) - max(a[0], b[0]) <= 1e-9 or min(a[3], b[3]) - max(a[1], b[1]) <= 1e-9:
        return False
    # The courtyard of a mounting hole is round: it may not reach into the corner of its box.
    if one.startswith("H"):
        return _circle_overlaps(a, b)
    if other.startswith("H"):
        return _circle_overlaps(b, a)
    return True


def _circle_overlaps(circle: Box, box: Box) -> bool:
    x, y = (circle[0] + circle[2]) / 2, (circle[1] + circle[3]) / 2
    nearest = (min(max(x, box[0]), box[2]), min(max(y, box[1]), box[3]))
    return math.dist((x, y), nearest) < (circle[2] - circle[0]) / 2


# Template of a board: tracks routed once, and the ground pour KiCad filled around them.
#
# It depends on placement and nets alone. `python -m tools.routing.reroute` in the repository makes a new one.

Segment = tuple[int, Point, Point, float]
"""Layer (0 is the front, 1 the back), both ends and width [mm]."""

TEMPLATES = Path(__file__).parent / "templates"


@dataclass(frozen=True)
class Tracks:
    """Copper of one net [mm]."""

    segments: tuple[Segment, ...]
    vias: tuple[Point, ...]


@dataclass(frozen=True)
class Template:
    """Copper between the pads."""

    tracks: dict[str, Tracks]
    """Tracks by net."""
    fills: dict[str, tuple[tuple[Point, ...], ...]]
    """Outlines of the filled ground pour, by layer."""
    stitching: tuple[Point, ...] = ()
    """Vias that join both ground pours, apart from those of the pads [mm]."""


def fingerprint(circuit: Circuit, placement: Placement) -> str:
    """Hash of everything a template depends on: outline, fiducial marks, pads and nets."""
    pads = sorted(
        (p.reference, p.pad.number, *(round(v, 4) for v in (p.x, p.y, p.half_width, p.half_height)), p.net)
        for p in place_pads(circuit, placement)
    )
    text = json.dumps([placement.width, placement.height, placement.fiducials, pads])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def load_template(name: str, circuit: Circuit, placement: Placement) -> Template:
    """Load the template of this name, such as "article_split". Raises BoardError."""
    data = json.loads((TEMPLATES / f"{name}.json").read_text("utf-8"))
    if data["fingerprint"] != fingerprint(circuit, placement):
        raise BoardError(
            f"the tracks of {name} were routed for another placement or other nets; run "
            f"python -m tools.routing.reroute {name} in the repository."
        )
    tracks = {
        net: Tracks(
            tuple((s[0], (s[1], s[2]), (s[3], s[4]), s[5]) for s in item["segments"]),
            tuple((x, y) for x, y in item["vias"]),
        )
        for net, item in data["tracks"].items()
    }
    fills = {
        layer: tuple(tuple((x, y) for x, y in outline) for outline in outlines)
        for layer, outlines in data["fills"].items()
    }
    return Template(tracks, fills, tuple((x, y) for x, y in data["stitching"]))


def format_template(template: Template, circuit: Circuit, placement: Placement) -> str:
    """Format a template as the text of its file."""
    data = {
        "fingerprint": fingerprint(circuit, placement),
        "tracks": {
            net: {"segments": [[layer, *a, *b, width] for layer, a, b, width in t.segments], "vias": t.vias}
            for net, t in template.tracks.items()
        },
        "stitching": template.stitching,
        "fills": template.fills,
    }
    return json.dumps(data, separators=(",", ":")) + "\n"
