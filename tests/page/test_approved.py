"""A page of small files, and drawings of small KiCad files, compared whole with approved ones.

A long line of a plot stands there as the number, the ends and the means of its coordinates, data as their length.
"""

from __future__ import annotations

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

APPROVED, INPUTS = Path(__file__).parent / "approved", Path(__file__).parent / "inputs"


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


def test_pictures_of_the_board_are_the_approved_ones() -> None:
    board, sheet = (read_expression((INPUTS / f"slip_filter.kicad_{end}").read_text()) for end in ("pcb", "sch"))
    pictures = {
        "schematic": render_schematic(sheet, "schematic"),
        "placement": render_placement(board, "placement"),
        "copper": render_copper(board, "copper"),
        "back": render_back(board, "back"),
    }
    for name, picture in pictures.items():
        check_approved(APPROVED / f"{name}.svg", list_lines(picture))


def make_check(name: str, value: float, limit: float, relation: str = "at most", **more: Any) -> dict[str, Any]:
    return {"name": name, "value": value, "limit": limit, "unit": "mm", "relation": relation, "passed": True, **more}


def make_report(**strength: Any) -> dict[str, Any]:
    checks = [
        make_check("bone.safety_factor.grip_fdm", 1.25, 1.0, "at least", unit=""),
        make_check("mold.fill_time", 30.0, 31.0, unit="s"),
        make_check("mold.triangles", 30.0, 31.0, "exactly", unit=""),
        make_check("skin.min_thickness_misaligned", 2.0, 1.9, "at least"),
        *(make_check(f"bone.wall.pin_{i}", 0.1 * i, 2.0 + i) for i in range(8)),
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
    samples = (f"{t:.4f},{v:.6f},{int(0.5 <= t < 0.7)}" for t, v in zip(time_s, voltage_v, strict=True))
    trace = "\n".join(["time_s,voltage_v,slip", *samples])
    files |= {f"board/{path.name}": path.read_bytes() for path in INPUTS.iterdir() if path.name != "casting.md"}
    files |= {
        "casting.md": (INPUTS / "casting.md").read_bytes(), "acceptance.md": b"# Acceptance\n\nTest it.\n",
        "steps/01-print.png": b"PNG", "drawing_bone.svg": DRAWING, "signal/trace.csv": trace.encode(),
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
