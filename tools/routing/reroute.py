"""Route a board and write its template: `python -m tools.routing.reroute`, in the repository's root.

Run it after a change of the placement (a file in `board/layout/placements`), of footprints or of nets. It takes a
minute for each board. KiCad's Python module pcbnew fills the ground pour. It belongs to the system's Python,
which `--python` names.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from fingertip.board import board_circuit, board_values
from fingertip.board.kicad.footprints import Point
from fingertip.board.kicad.layout import EDGE_CLEARANCE_MM, PAGE_OFFSET_MM, kicad_pcb_file
from fingertip.board.kicad.placement import PLACEMENTS, TEMPLATES, Placement, Template, format_template, place_pads
from fingertip.board.kicad.project import (
    BOARD_CONFIGURATIONS,
    CLEARANCE_MM,
    TRACK_MM,
    VIA_MM,
    BoardConfiguration,
    kicad_project_file,
)
from fingertip.board.kicad.silkscreen import silkscreen_boxes
from fingertip.board.parts.circuit import Circuit
from fingertip.design import Design
from tools.placing.label import add_labels
from tools.placing.place import format_placement, list_problems
from tools.routing.copper import fiducial_pads
from tools.routing.grid import DesignRules
from tools.routing.router import route
from tools.routing.stitch import find_stitching
from tools.routing.widen import rail_share, widen_rails

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
    circuit = board_circuit(board_values(Design.load(changes=configuration.changes)))
    placement = configuration.placement
    if problems := list_problems(circuit, placement):
        raise SystemExit(f"{configuration.name}: " + "; ".join(problems))
    template = route_board(circuit, placement, python, print)
    vias = [*template.stitching, *(via for tracks in template.tracks.values() for via in tracks.vias)]
    placement = add_labels(circuit, placement, vias, VIA_MM)
    (PLACEMENTS / f"{configuration.name}.json").write_text(format_placement(placement), encoding="utf-8")
    path = TEMPLATES / f"{configuration.name}.json"
    path.write_text(format_template(template, circuit, placement), encoding="utf-8")
    rails = f"{rail_share(template.tracks, 0.5):.0%} of the rails at least 0.5 mm wide"
    labels = f"{len(placement.reference_labels)} references"
    print(f"{path.name}: {path.stat().st_size} bytes, {len(template.stitching)} stitching vias, {rails}, {labels}")


def route_board(
    circuit: Circuit, placement: Placement, python: str, progress: Callable[[str], None] = lambda message: None
) -> Template:
    """Route a board, widen its rails, fill its pours and join them. Raises RuntimeError if it cannot be routed."""
    rules = DesignRules(TRACK_MM, CLEARANCE_MM, VIA_MM, EDGE_CLEARANCE_MM)
    pads = [*place_pads(circuit, placement), *fiducial_pads(placement, rules)]
    no_vias = list(silkscreen_boxes(placement).values())
    tracks = route(placement.width, placement.height, pads, rules, no_vias, progress=progress)
    tracks = widen_rails(tracks, pads, placement, rules)
    template = Template(tracks, fill_ground_pour(circuit, placement, Template(tracks, {}), python))
    stitching = find_stitching(tracks, template.fills, pads, placement, rules, no_vias)
    template = replace(template, stitching=stitching)
    return replace(template, fills=fill_ground_pour(circuit, placement, template, python))


def fill_ground_pour(
    circuit: Circuit, placement: Placement, template: Template, python: str
) -> dict[str, tuple[tuple[Point, ...], ...]]:
    """Fill the ground pour around the tracks with KiCad; returns the outlines of the filled areas by layer.

    Parameters
    ----------
    circuit, placement, template
        The routed board, whose present fill does not matter.
    python
        Python that has KiCad's module pcbnew.
    """
    with tempfile.TemporaryDirectory() as folder:
        board = Path(folder) / f"{circuit.name}.kicad_pcb"
        board.write_bytes(kicad_pcb_file(circuit, placement, replace(template, fills={})))
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
