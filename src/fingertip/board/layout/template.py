"""Template of a board: tracks routed once, and the ground pour KiCad filled around them.

It depends on placement and nets alone. `python -m tools.routing.reroute` in the repository makes a new one.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path

from fingertip.board.circuit import Circuit
from fingertip.board.kicad.footprints import Point
from fingertip.board.layout.placement import Placement, place_pads
from fingertip.errors import BoardError

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
    """Load the template of this name, such as "article_split".

    Raises
    ------
    BoardError
        If it was routed for another placement or other nets.
    """
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
