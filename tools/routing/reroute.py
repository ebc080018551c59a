"""Route a board and write its template: `python -m tools.routing.reroute`, in the repository's root.

Run it after a change of the placement (a file in `board/layout/placements`), of footprints or of nets. It takes a
minute or two for each board. KiCad's Python module pcbnew fills the ground pour. It belongs to the system's Python,
which `--python` names.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import tempfile
from pathlib import Path

from fingertip.board import board_circuit, board_values
from fingertip.board.circuit import Circuit
from fingertip.board.kicad.footprints import Point
from fingertip.board.kicad.project import CLEARANCE_MM, TRACK_MM, VIA_MM, kicad_project_file
from fingertip.board.layout.pcb_file import EDGE_CLEARANCE_MM, PAGE_OFFSET_MM, kicad_pcb_file
from fingertip.board.layout.placement import Placement, courtyard_overlaps, place_pads
from fingertip.board.layout.silkscreen import silkscreen_boxes, silkscreen_conflicts
from fingertip.board.layout.template import TEMPLATES, Template, Tracks, format_template
from fingertip.board.variants import BOARD_CONFIGURATIONS, BoardConfiguration
from fingertip.design import Design
from tools.routing.grid import DesignRules
from tools.routing.router import route

_FILL_SCRIPT = """
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
    """Route the boards named on the command line, fill their pours and write their templates."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--python", default="/usr/bin/python3", help="Python that has KiCad's module pcbnew")
    parser.add_argument(
        "board", nargs="*", default=list(BOARD_CONFIGURATIONS), help="boards such as article_split; default: all"
    )
    arguments = parser.parse_args()
    for name in arguments.board:
        _reroute(BOARD_CONFIGURATIONS[name], arguments.python)


def _reroute(configuration: BoardConfiguration, python: str) -> None:
    design = Design.load(changes=configuration.changes)
    circuit, placement = board_circuit(board_values(design)), configuration.placement
    overlaps = [f"{one} overlaps {other}" for one, other in courtyard_overlaps(circuit, placement)]
    if problems := [*overlaps, *silkscreen_conflicts(circuit, placement)]:
        raise SystemExit(f"{configuration.name}: " + "; ".join(problems))
    rules = DesignRules(TRACK_MM, CLEARANCE_MM, VIA_MM, EDGE_CLEARANCE_MM)
    pads, no_vias = list(place_pads(circuit, placement)), silkscreen_boxes(placement).values()
    tracks = route(placement.width, placement.height, pads, rules, no_vias, progress=print)
    fills = fill_ground_pour(circuit, placement, tracks, python)
    path = TEMPLATES / f"{configuration.name}.json"
    path.write_text(format_template(Template(tracks, fills), circuit, placement), encoding="utf-8")
    print(f"wrote {path.name}: {path.stat().st_size} bytes")


def fill_ground_pour(
    circuit: Circuit, placement: Placement, tracks: dict[str, Tracks], python: str
) -> dict[str, tuple[tuple[Point, ...], ...]]:
    """Fill the ground pour around the tracks with KiCad; returns the outlines of the filled areas by layer.

    Parameters
    ----------
    circuit, placement, tracks
        The routed board.
    python
        Python that has KiCad's module pcbnew.
    """
    with tempfile.TemporaryDirectory() as folder:
        board = Path(folder) / f"{circuit.name}.kicad_pcb"
        board.write_bytes(kicad_pcb_file(circuit, placement, Template(tracks, {})))
        board.with_suffix(".kicad_pro").write_bytes(kicad_project_file(circuit))
        process = subprocess.run([python, "-c", _FILL_SCRIPT, str(board)], capture_output=True, text=True, check=True)
    # pcbnew prints messages of its own, so the script marks its line.
    line = next(line for line in process.stdout.splitlines() if line.startswith("FILLS"))
    left, top = PAGE_OFFSET_MM
    return {
        layer: tuple(tuple((round(x - left, 4), round(y - top, 4)) for x, y in outline) for outline in outlines)
        for layer, outlines in json.loads(line.removeprefix("FILLS")).items()
    }


if __name__ == "__main__":
    main()
