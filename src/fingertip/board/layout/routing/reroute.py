"""Makes a board's template anew: `python -m fingertip.board.layout.routing.reroute`.

Run it after a change of placement (the files in `places`), footprints or nets; it takes a minute or two for each. The
pour is made by KiCad's Python module, which belongs to the system's Python; `--python` names that.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import tempfile
from pathlib import Path

from fingertip.board.kicad.project import CLEARANCE_MM, TRACK_MM, VIA_MM, kicad_project
from fingertip.board.layout.file import EDGE_CLEARANCE_MM, kicad_board
from fingertip.board.layout.names import obscured, printed
from fingertip.board.layout.placed_footprint import CORNER_MM
from fingertip.board.layout.placement import crowded, placed_pads
from fingertip.board.layout.routing.grid import Rules
from fingertip.board.layout.routing.router import route
from fingertip.board.layout.tracks import TEMPLATES, Template, template_text
from fingertip.board.output import board_circuit
from fingertip.board.values.board_values import board_values
from fingertip.board.variants import VARIANTS, Variant
from fingertip.design import Design

_FILL = """
import json, sys
import pcbnew
board = pcbnew.LoadBoard(sys.argv[1])
pcbnew.ZONE_FILLER(board).Fill(board.Zones())
fills = {}
for zone in board.Zones():
    layer = zone.GetLayer()
    shapes = zone.GetFilledPolysList(layer)
    outlines = []
    for i in range(shapes.OutlineCount()):
        line = shapes.Outline(i)
        points = [line.CPoint(j) for j in range(line.PointCount())]
        outlines.append([[p.x / 1e6, p.y / 1e6] for p in points])
    fills[board.GetLayerName(layer)] = outlines
print("FILLS" + json.dumps(fills))
"""


def main() -> None:
    """Route, pour, write the template."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--python", default="/usr/bin/python3", help="a Python that has KiCad's module pcbnew")
    parser.add_argument("variant", nargs="*", default=list(VARIANTS), help="which; without any, all")
    arguments = parser.parse_args()
    for name in arguments.variant:
        _reroute(VARIANTS[name], arguments.python)


def _reroute(variant: Variant, python: str) -> None:
    design = Design.load(changes=variant.changes)
    circuit, placement = board_circuit(board_values(design)), variant.placement
    if found := [*(f"{a} overlaps {b}" for a, b in crowded(circuit, placement)), *obscured(circuit, placement)]:
        raise SystemExit(f"{variant.name}: " + "; ".join(found))
    rules = Rules(TRACK_MM, CLEARANCE_MM, VIA_MM, EDGE_CLEARANCE_MM)
    pads, no_vias = list(placed_pads(circuit, placement)), printed(placement).values()
    tracks = route(placement.width, placement.height, pads, rules, no_vias, progress=print)
    with tempfile.TemporaryDirectory() as name:
        board = Path(name) / f"{circuit.name}.kicad_pcb"
        board.write_bytes(kicad_board(circuit, placement, Template(tracks, {})))
        board.with_suffix(".kicad_pro").write_bytes(kicad_project(circuit))
        run = subprocess.run([python, "-c", _FILL, str(board)], capture_output=True, text=True, check=True)
    words = next(line for line in run.stdout.splitlines() if line.startswith("FILLS"))
    fills = {
        layer: tuple(
            tuple((round(x - CORNER_MM[0], 4), round(y - CORNER_MM[1], 4)) for x, y in outline) for outline in outlines
        )
        for layer, outlines in json.loads(words.removeprefix("FILLS")).items()
    }
    path = TEMPLATES / f"{variant.name}.json"
    path.write_text(template_text(Template(tracks, fills), circuit, placement), encoding="utf-8")
    print(f"wrote {path.name}: {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
