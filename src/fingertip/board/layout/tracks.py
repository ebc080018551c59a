"""Tracks of a board that were routed once, and the ground pour KiCad filled around them: kept as a template.

They depend on placement and nets alone. `python -m fingertip.board.layout.routing.reroute` makes a template anew.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path

from fingertip.board.circuit import Circuit
from fingertip.board.layout.placement import Placement, placed_pads
from fingertip.board.layout.routing.paths import Tracks
from fingertip.errors import BoardError

Point = tuple[float, float]

TEMPLATES = Path(__file__).parent / "templates"


@dataclass(frozen=True)
class Template:
    """Copper between the pads."""

    tracks: dict[str, Tracks]
    fills: dict[str, tuple[tuple[Point, ...], ...]]
    """Layer -> outlines of the filled pour."""


def fingerprint(circuit: Circuit, placement: Placement) -> str:
    """What a template depends on, as a hash: outline, pads, nets."""
    pads = sorted(
        (p.reference, p.pad.number, *(round(v, 4) for v in (p.x, p.y, p.half_width, p.half_height)), p.net)
        for p in placed_pads(circuit, placement)
    )
    text = json.dumps([placement.width, placement.height, pads])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def load_template(name: str, circuit: Circuit, placement: Placement) -> Template:
    """The template of this name.

    Raises
    ------
    BoardError
        If it was routed for another placement or other nets.
    """
    data = json.loads((TEMPLATES / f"{name}.json").read_text("utf-8"))
    if data["fingerprint"] != fingerprint(circuit, placement):
        raise BoardError(
            f"the tracks of {name} belong to another placement: run python -m fingertip.board.layout.routing.reroute."
        )
    tracks = {
        net: Tracks(
            tuple((s[0], (s[1], s[2]), (s[3], s[4])) for s in item["segments"]), tuple((x, y) for x, y in item["vias"])
        )
        for net, item in data["tracks"].items()
    }
    fills = {
        layer: tuple(tuple((x, y) for x, y in outline) for outline in outlines)
        for layer, outlines in data["fills"].items()
    }
    return Template(tracks, fills)


def template_text(template: Template, circuit: Circuit, placement: Placement) -> str:
    """A template's file."""
    data = {
        "fingerprint": fingerprint(circuit, placement),
        "tracks": {
            net: {"segments": [[layer, *a, *b] for layer, a, b in t.segments], "vias": t.vias}
            for net, t in template.tracks.items()
        },
        "fills": template.fills,
    }
    return json.dumps(data, separators=(",", ":")) + "\n"
