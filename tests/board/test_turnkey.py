"""Set for a turnkey order (gerbers, drill files, placement, parts),
as an independent reader of gerbers sees it.
"""

from __future__ import annotations

import csv
import io
import json
import subprocess
from pathlib import Path

import pytest

from fingertip.board.analysis.board_values import board_values
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.board.fabrication.bom import assembly_bom_file, placement_file
from fingertip.board.fabrication.fabrication_files import export_gerbers, kicad_session
from fingertip.board.kicad.project import load_project
from fingertip.tasks.board_files import board_files
from tests.board.kicad import HOW_TO_INSTALL_KICAD
from tests.designs import load_article
from tests.tools import require_tool

MIN_TRACK_MM = 0.127
MIN_HOLE_MM = 0.3
MAX_HOLE_MM = 6.3
MIN_RING_MM = 0.13
"""Limits that board houses commonly state for two layers without
surcharge; not copied from one of them.
"""

READER = """
import json, sys, warnings
warnings.simplefilter("ignore")
from gerbonara import LayerStack
from gerbonara.apertures import CircleAperture
from gerbonara.graphic_objects import Flash, Line
stack = LayerStack.open(sys.argv[1])
(left, bottom), (right, top) = stack.board_bounds()
pen = max(o.aperture.equivalent_width("mm") for o in stack["mechanical", "outline"].objects)
copper = [stack[side, "copper"].objects for side in ("top", "bottom")]
json.dump({
    "size": [right - left - pen, top - bottom - pen],
    "corner": [left + pen / 2, bottom + pen / 2],
    "tracks": sorted({o.aperture.diameter for side in copper for o in side
                      if isinstance(o, Line) and isinstance(o.aperture, CircleAperture)}),
    "lands": [[o.x, o.y, o.aperture.diameter] for o in copper[1]
              if isinstance(o, Flash) and isinstance(o.aperture, CircleAperture)],
    "holes": [[o.x, o.y, o.tool.diameter, "NPTH" in str(d)] for d in stack.drill_layers for o in d.objects],
    "paste": [[o.x, o.y] for o in stack["top", "paste"].objects if isinstance(o, Flash)],
}, sys.stdout)
"""  # noqa: E501


@pytest.mark.parametrize("name", [*VARIANT_CHANGES, "channels"])
def test_pads_lie_a_millimetre_from_the_edge(name: str) -> None:
    """All but those of the sockets, whose plugs enter at the edge: rails and V-cuts
    need as much.
    """
    placement = (
        load_project("precision", 5).placement
        if name == "channels"
        else load_project(name).placement
    )
    pads = [
        p
        for part, placed in placement.parts.items()
        if part[0] != "J"
        for p in placed.pads
        if p.is_plated
    ]
    width = placement.width
    height = placement.height
    assert min(min(p.box[0], p.box[1], width - p.box[2], height - p.box[3]) for p in pads) >= 1.0


@pytest.mark.full
@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_gerbers_keep_the_houses_rules_and_lie_where_the_placement_says(
    tmp_path: Path, name: str
) -> None:
    require_tool("kicad-cli", HOW_TO_INSTALL_KICAD)
    python = require_tool(
        "/opt/gerbonara/bin/python", "run `sh .ci/install-gerbonara` as root on Debian"
    )
    design = load_article(VARIANT_CHANGES[name])
    with kicad_session(board_files(design), lambda message: None) as (folder, run):
        (tmp_path / "gerbers.zip").write_bytes(export_gerbers(folder, run, "slip_filter"))
    done = subprocess.run(
        [python, "-c", READER, tmp_path / "gerbers.zip"], capture_output=True, text=True, check=True
    )
    board = json.loads(done.stdout)
    placement = load_project(name).placement
    assert board["size"] == pytest.approx([placement.width, placement.height], abs=1e-3)
    assert board["corner"] == pytest.approx([0, 0], abs=1e-3)
    assert board["tracks"][0] >= MIN_TRACK_MM
    assert all(MIN_HOLE_MM <= hole[2] <= MAX_HOLE_MM for hole in board["holes"])
    vias = [hole for hole in board["holes"] if hole[2] == min(h[2] for h in board["holes"])]
    for x, y, drill, _ in vias:
        land = next(size for lx, ly, size in board["lands"] if abs(lx - x) + abs(ly - y) < 1e-3)
        assert (land - drill) / 2 >= MIN_RING_MM
    # Of each part to fit, the house's place is the middle of its pasted pads: the files have one
    # origin.
    circuit = board_circuit(board_values(design))
    places = list(
        csv.DictReader(io.StringIO(placement_file(circuit, placement, for_house=True).decode()))
    )
    for row in places:
        x, y = (float(row[axis].removesuffix("mm")) for axis in ("Mid X", "Mid Y"))
        pads = [pad for pad in placement.parts[row["Designator"]].pads if not pad.drill]
        if len(pads) == 2:
            near = sorted(board["paste"], key=lambda p: (p[0] - x) ** 2 + (p[1] - y) ** 2)[:2]
            assert (near[0][0] + near[1][0]) / 2 == pytest.approx(x, abs=2e-3), row["Designator"]
            assert (near[0][1] + near[1][1]) / 2 == pytest.approx(y, abs=2e-3), row["Designator"]
    fitted = sum(
        sum(not pad.drill for pad in placement.parts[row["Designator"]].pads) for row in places
    )
    assert len(board["paste"]) == fitted, (
        "every pad of a fitted part has paste, and nothing else has"
    )
    bom = csv.DictReader(io.StringIO(assembly_bom_file(circuit).decode()))
    assert {name for row in bom for name in row["Designator"].split(",")} == {
        row["Designator"] for row in places
    }
