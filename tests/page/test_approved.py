"""A page of small files, and drawings of small KiCad files, compared whole with approved ones.

A long line of a plot stands there as the number, the ends and the means of its coordinates, data as their length.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip.board.kicad.sexpr import read_expression
from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import Mesh
from fingertip.cad.shapes.parts import parts_by_name
from fingertip.design import Design
from fingertip.page import parameters_and_checks, render
from fingertip.page.board_section import render_board
from fingertip.page.casting_section import render_basis, render_casting, render_drawing
from fingertip.page.layout_svg import render_back, render_copper, render_placement
from fingertip.page.parameters_and_checks import render_checks, render_verdict
from fingertip.page.render import render_page
from fingertip.page.schematic_svg import render_schematic
from fingertip.page.sources import Sources
from fingertip.page.trial_section import render_trial
from tests.approved import check_approved
from tests.conftest import design_file
from tests.page.conftest import DRAWING
from tests.slip.recordings import burst
from tests.view.describe import sum_up

APPROVED = Path(__file__).parent / "approved"


def list_lines(markup: str) -> list[str]:
    """Elements of a page on lines of their own, without styles, scripts and the digits of data."""
    plain = re.sub(r"(<style>|<script[^>]*>).*?(</style>|</script>)", r"\1\2", markup, flags=re.DOTALL)
    plain = re.sub(r"'sha256-[^']*'", "'sha256'", plain)
    plain = re.sub(r";base64,([A-Za-z0-9+/=]*)", lambda found: f"; {len(found[1])} characters", plain)
    plain = re.sub(r'd="(M[^"]{200,})"', lambda found: f'd="{sum_up_path(found[1])}"', plain)
    return plain.replace("><", ">\n<").splitlines()


def sum_up_path(path: str) -> str:
    x, y = np.array([[float(word) for word in pair.split()] for pair in re.split("[ML]", path.strip("Z"))[1:]]).T
    return f"x {sum_up(x)} y {sum_up(y)}"


# Pictures of the board

SCHEMATIC = """(kicad_sch
  (lib_symbols
    (symbol "part" (pin_numbers (hide yes)) (pin_names)
      (symbol "part_0_1"
        (polyline (pts (xy -2 0) (xy 2 1) (xy 2 -1)) (fill (type outline)))
        (polyline (pts (xy -1 2) (xy 1 2)) (fill (type none)))
        (rectangle (start -1 -2) (end 2 3))
        (circle (center 0.5 0.25) (radius 0.75))
        (arc (start 0 0) (mid 1 0.4) (end 2 0)))
      (symbol "part_1_1" (pin line (at -5 1 0) (length 2.5) (name "IN") (number "1")))
      (symbol "part_2_1" (pin line (at 0 6 270) (length 2) (name "V+") (number "8"))))
    (symbol "plain" (pin_numbers) (pin_names (hide yes))
      (symbol "plain_1_1"
        (pin line (at -5 1 0) (length 2.5) (name "A") (number "1"))
        (pin line (at 1 -4 90) (length 1.5) (name "B") (number "2"))
        (pin line (at 0 0 0) (length 0) (name "~") (number "3")))))
  (wire (pts (xy 10 10) (xy 30 10)))
  (junction (at 20 10))
  (symbol (lib_id "part") (at 40 20 0) (unit 1)
    (property "Reference" "U1" (at 40 15 0) (effects (font (size 1.27 1.27)) (justify left)))
    (property "Value" "AD623" (at 40 25 0) (effects (font (size 1 1)) (justify right bottom)))
    (property "Footprint" "SO8" (at 0 0 0) (effects (font (size 9 9)))))
  (symbol (lib_id "part") (at 60 20 90) (mirror x) (unit 2)
    (property "Reference" "#PWR1" (at 70 15 0) (effects (font (size 1.27 1.27))))
    (property "Value" "hidden" (at 70 25 0) (effects (font (size 1 1)) (hide yes))))
  (symbol (lib_id "plain") (at 80 20 270) (mirror y)
    (property "Reference" "R1" (at 80 15 90) (effects (font (size 1.27 1.27)))))
  (symbol (lib_id "plain") (at 90 40 180)
    (property "Value" "1k" (at 90 45 90) (effects (font (size 1.27 1.27)) (justify left bottom))))
  (label "NET" (at 12 10 0) (effects (font (size 1.5 1.5)) (justify left bottom)))
  (label "BACK" (at 28 10 180) (effects (font (size 1.5 1.5)) (justify left bottom)))
  (label "UP" (at 15 10 90) (effects (font (size 1.5 1.5)) (justify left)))
  (text "a note" (at 50 50 0) (effects (font (size 2 2)))))"""
BOARD = """(kicad_pcb
  (gr_line (start 0 0) (end 20 0) (layer "Edge.Cuts"))
  (gr_line (start 22 12) (end 22 2) (layer "Edge.Cuts"))
  (gr_arc (start 20 0) (mid 21.414 0.586) (end 22 2) (layer "Edge.Cuts"))
  (gr_line (start 0 0) (end 0 12) (layer "Edge.Cuts"))
  (gr_arc (start 0 12) (mid 11 12) (end 22 12) (layer "Edge.Cuts"))
  (gr_line (start 5 5) (end 6 6) (layer "F.Fab"))
  (gr_text "front" (at 4 2 90) (layer "F.SilkS") (effects (font (size 1 1)) (justify right)))
  (gr_text "R1 4.7k" (at 9 9 0) (layer "B.SilkS") (effects (font (size 0.8 0.8)) (justify left mirror)))
  (gr_text "values" (at 9 7 90) (layer "B.SilkS") (effects (font (size 0.8 0.8))))
  (footprint "R" (layer "F.Cu") (at 8 5 90)
    (property "Reference" "R1" (at 0 -1.5 90) (layer "F.SilkS") (effects (font (size 0.9 0.9)) (justify left)))
    (fp_line (start -1 -0.5) (end 1 -0.5) (layer "F.SilkS"))
    (fp_rect (start -2 -1) (end 2 1.5) (layer "F.SilkS"))
    (fp_line (start -3 -3) (end 3 3) (layer "F.Fab"))
    (pad "1" smd roundrect (at -1 0 90) (size 0.8 1.2) (roundrect_rratio 0.25) (layers "F.Cu") (net 1 "A"))
    (pad "2" smd rect (at 1 0.25 135) (size 0.8 1.2) (layers "F.Cu") (net 2 "GND")))
  (footprint "J" (layer "F.Cu") (at 16 6)
    (property "Reference" "J1" (at 0 -3 0) (layer "F.Fab") (effects (font (size 1 1))))
    (pad "1" thru_hole rect (at 0 -1) (size 1.7 1.7) (drill 1) (layers "*.Cu") (net 1 "A"))
    (pad "2" thru_hole circle (at 0.2 1.5) (size 1.6 1.6) (drill 0.9) (layers "*.Cu") (net 2 "GND")))
  (footprint "H" (layer "F.Cu") (at 3 9)
    (property "Reference" "H1" (at 0 -3 0) (layer "F.SilkS") (effects (font (size 1 1)) (hide yes)))
    (pad "" np_thru_hole circle (at 0 0) (size 3 3) (drill 3)))
  (footprint "logo" (layer "F.Cu") (at 1 1))
  (segment (start 8 5) (end 8 7) (width 0.3) (layer "F.Cu") (net 1))
  (segment (start 8 7) (end 9 8) (width 0.4) (layer "B.Cu") (net 1))
  (via (at 8 7) (size 0.8) (drill 0.4) (net 1))
  (zone (net 2) (filled_polygon (layer "B.Cu") (pts (xy 1 1) (xy 19 1) (xy 10 9)))
    (filled_polygon (layer "F.Cu") (pts (xy 2 1) (xy 12 1) (xy 9 8)))))"""


def test_pictures_of_the_board_are_the_approved_ones() -> None:
    board = read_expression(BOARD)
    pictures = {
        "schematic": render_schematic(read_expression(SCHEMATIC), "schematic"),
        "placement": render_placement(board, "placement"),
        "copper": render_copper(board, "copper"),
        "back": render_back(board, "back"),
    }
    for name, picture in pictures.items():
        check_approved(APPROVED / f"{name}.svg", list_lines(picture))


# Page

BOM = """Quantity,References,Value,Footprint,Rating,Manufacturer,MPN,LCSC,Note
2,R1 R2,10k,0603,,Yageo,RC0603,C98220,
1,U1,AD623,MSOP-8,,Analog Devices,AD623ARMZ,C1,"<see> note"
"""
GATE = [
    {"name": "noise", "subject": "A1", "value": 1.23456, "unit": "mV", "limit": 2.0, "bound": "at most",
     "passed": True},
    {"name": "gain", "subject": "U1", "value": 90.0, "unit": "", "limit": 100.0, "bound": "at least", "passed": False,
     "remedy": "set board.passband_gain=100."},
]  # fmt: skip
SHEET = """# Casting sheet
What it is.
## What to buy
- wire
## Hardware
| a | b |
| --- | --- |
| 1 | 2 |
## Procedure
1. Print it.

   ![step 1](steps/01-print.png)

2. Cast **it**.

   ![step 2](steps/02-cast.png)
"""


def make_check(name: str, value: float, limit: float, relation: str = "at most", **more: Any) -> dict[str, Any]:
    return {"name": name, "value": value, "limit": limit, "unit": "mm", "relation": relation, "passed": True, **more}


def make_report(**strength: Any) -> dict[str, Any]:
    checks = [
        make_check("bone.safety_factor.grip_fdm", 1.25, 1.0, "at least", unit=""),
        make_check("mold.fill_time", 30.0, 31.0, unit="s"),
        make_check("mold.triangles", 30.0, 31.0, "exactly", unit=""),
        make_check("skin.min_thickness_misaligned", 2.0, 1.9, "at least"),
        *(make_check(f"bone.wall.pin_{i}", 0.1 * i, 2.0 + i) for i in range(12)),
    ]
    return {"checks": checks, "strength": {"material": "surgical_guide", "grip_safety_factor": 3.456,
            "shock_safety_factor": 2.0, "weakest": {"place": "cross-section", "z_mm": -12.34}, **strength}}  # fmt: skip


def make_sources(name: str = "fsr400", remarks: dict[str, str] | None = None, **changed: bytes | None) -> Sources:
    """Files of a design: each part a corner of a box of its own size, and the smallest of all others."""
    design = Design.load(design_file(name))
    triangles = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    files = {
        f"{part}.stl": stl.to_bytes(
            Mesh(np.vstack([np.zeros(3), np.diag([10.0 + i, 20.0, 30.0 + 2 * i])]), triangles), part
        )
        for i, part in enumerate(parts_by_name(design))
    }
    time_s, voltage_v = burst()
    trace = "\n".join(
        [
            "time_s,voltage_v,slip",
            *(f"{t:.4f},{v:.6f},{int(0.5 <= t < 0.7)}" for t, v in zip(time_s, voltage_v, strict=True)),
        ]
    )
    files |= {
        "casting.md": SHEET.encode(), "steps/01-print.png": b"PNG", "acceptance.md": b"# Acceptance\n\nTest it.\n",
        "drawing_bone.svg": DRAWING, "board/slip_filter.kicad_pcb": BOARD.encode(),
        "board/slip_filter.kicad_sch": SCHEMATIC.encode(), "board/bom.csv": BOM.encode(),
        "board/values.json": json.dumps({"gate": GATE}).encode(),
        "board/README.md": b"# Board\n## Connectors\nJ1 is the sensor.\n## Other\nNo.\n",
        "board/bringup.md": b"# Bring-up\nMeasure.\n", "signal/trace.csv": trace.encode(),
        "signal/detection.json": b'{"detector": "digital", "motion_s": 0.485}',
    }  # fmt: skip
    kept = {key: data for key, data in (files | changed).items() if data is not None}
    return Sources(design, make_report(), kept, remarks or {})


def test_page_is_the_approved_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the parameters of one table in place of all."""
    monkeypatch.setattr(render, "render_parameters", lambda design: parameters_and_checks.link_parameters(["a.b_c"]))
    sources = make_sources()
    page = render_page(sources)
    assert page == render_page(sources)
    check_approved(APPROVED / "page.html", list_lines(page.decode()), abs_=0.11)


CHECKS: dict[str, dict[str, Any]] = {
    "weak": make_report(),
    "strong": make_report(grip_safety_factor=9.0, shock_safety_factor=9.0),
    "failed": {"checks": [make_check("mold.fill_time", 99.0, 31.0, passed=False), *make_report()["checks"]]},
    "warned": {
        "checks": [
            make_check("sensor.pocket_clearance", 1.0, 2.0, warning="it rattles <much>"),
            *make_report()["checks"],
        ]
    },
}


def test_sections_of_other_folders_are_the_approved_ones() -> None:
    """Nothing but what must be there, old sets, checks that fail or warn, and where the figures of designs are from."""
    bare = make_sources(**dict.fromkeys((*(key for key in make_sources().files if "/" in key), "acceptance.md"), None))
    old = make_sources(
        remarks={"board": "no <board>", "signal": "no signal", "steps": "no steps"}, **{"drawing_bone.svg": None}
    )
    weighed = Design(
        force_curve={"curve": "calibrated", "min_force_n": 0.5, "max_force_n": 3}, printer={"scale_percent": 100.4}
    )
    sections = {
        "bare board": render_board(bare), "bare casting": render_casting(bare), "bare trial": render_trial(bare),
        "old board": render_board(old).partition("<h3")[0], "old casting": render_casting(old),
        "old trial": render_trial(old), "no drawing": render_drawing(old), "weighed": render_basis(weighed),
    }  # fmt: skip
    for name, report in CHECKS.items():
        sections |= {name: render_verdict(report), f"checks, {name}": render_checks(report, "basis")}
    lines = [line for name, markup in sections.items() for line in (f"== {name}", *list_lines(markup))]
    check_approved(APPROVED / "sections.html", lines, abs_=0.11)
