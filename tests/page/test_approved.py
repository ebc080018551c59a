"""A page of small files, and drawings of small KiCad files, compared whole with approved ones.

A long line of a plot stands there as the number, the ends and the means of its coordinates, data as their length.
"""

from __future__ import annotations

import base64
import difflib
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip.board.kicad.sexpr import read_expression
from fingertip.design import Design
from fingertip.design.files import list_parameters
from fingertip.page.board_section import render_board
from fingertip.page.casting_section import render_basis, render_casting, render_drawing
from fingertip.page.layout_svg import render_back, render_copper, render_placement
from fingertip.page.model_section import list_items, scene_json
from fingertip.page.parameters_and_checks import render_checks, render_parameters, render_verdict
from fingertip.page.schematic_svg import render_schematic
from fingertip.page.trial_section import render_trial
from tests.approved import check_figures
from tests.conftest import design_file
from tests.figures import sum_up
from tests.page.conftest import INPUTS, Page, make_check, make_report, make_sources

APPROVED = Path(__file__).parent / "approved"


def list_lines(markup: str) -> list[str]:
    """Elements of a page on lines of their own, without styles, scripts and the digits of data."""
    plain = re.sub(r"(<style>|<script[^>]*>).*?(</style>|</script>)", r"\1\2", markup, flags=re.DOTALL)
    plain = re.sub(r"sha256-[A-Za-z0-9+/=]*", "sha256", plain)
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
        check_figures(APPROVED / f"{name}.svg", list_lines(picture))


def describe_item(item: dict[str, Any]) -> str:
    vertices = np.frombuffer(base64.b64decode(item["vertices"]), "<f4").reshape(-1, 3)
    ends = (*vertices.min(axis=0), *vertices.max(axis=0))
    kind = f"{'bought' if item['bought'] else 'part'} {sum_up(item['colour'])} {item['scale']:g} {item['wide']}"
    moved = f"opened {sum_up(item['opened'])} apart {sum_up(item['apart'])}"
    return f"{item['name']}, {item['label']}: {kind} {moved} within {sum_up(ends)}"


def test_page_is_the_approved_one(page: Page, monkeypatch: pytest.MonkeyPatch) -> None:
    """The table of parameters and the meshes stand in files of their own, the meshes for two designs more."""
    start, end = (page.source.index(mark) for mark in ("<p>Press the name", '<h2 id="pad">'))
    check_figures(APPROVED / "page.html", list_lines(page.source[:start] + page.source[end:]), abs_=0.11)
    others = (("child_finger", ("printer.scale_percent=100.4",)), ("adult_thumb", ()))
    scenes = [page.scene]
    for name, changes in others:
        sources = make_sources(name, changes=changes)
        scenes.append(json.loads(scene_json(list_items(sources.design, sources.files))))
    check_figures(APPROVED / "scene.txt", (describe_item(item) for scene in scenes for item in scene), abs_=0.05)


def test_effects_of_parameters_are_the_approved_ones() -> None:
    """Values, changes and what each parameter moves; a description stands where the parameter is declared."""
    design = Design.load(design_file("adult_finger"))
    drawn = list_lines(render_parameters(design))
    text = Page(render_parameters(design)).text
    assert all(f"{one.path}{one.description}" in text and one.bounds in text for one in list_parameters())
    wanted = ("<summary", "<button", "<small", '<span class="code"', '<span class="num"')
    check_figures(APPROVED / "parameters.html", (line for line in drawn if line.startswith(wanted)))


FAILED = make_check("mold.palmar_error", 0.3, 0.2, passed=False)
WARNED = make_check("sensor.pocket_clearance", 1.0, 2.0, warning="it rattles <much>")
CHECKS: dict[str, dict[str, Any]] = {
    "passed": make_report(),
    "failed": {"checks": [FAILED, *make_report()["checks"]]},
    "warned": {"checks": [WARNED, *make_report()["checks"]]},
}


def test_sections_of_other_folders_are_the_approved_ones() -> None:
    """Nothing but what must be there, old sets, checks that fail or warn, and where the figures of designs are from."""
    bare = make_sources(
        replaced=dict.fromkeys(key for key in make_sources().files if "/" in key or key == "acceptance.md")
    )
    missing = {"board": "no <board>", "signal": "no signal", "steps": "no steps"}
    old = make_sources(remarks=missing, replaced={"drawing_bone.svg": None})
    weighed = Design(
        force_curve={"curve": "calibrated", "min_force_n": 0.5, "max_force_n": 3}, printer={"scale_percent": 100.4}
    )
    sections = {
        "bare board": render_board(bare), "bare casting": render_casting(bare), "bare trial": render_trial(bare),
        "old board": render_board(old), "old casting": render_casting(old),
        "old trial": render_trial(old), "no drawing": render_drawing(old), "weighed": render_basis(weighed),
    }  # fmt: skip
    lines = [line for name, markup in sections.items() for line in (f"== {name}", *list_lines(markup))]
    passed = list_lines(render_checks(CHECKS["passed"], "basis"))
    for name, report in CHECKS.items():
        found = list_lines(render_checks(report, "basis"))
        changes = [line for line in difflib.ndiff(passed, found) if line[0] in "+-"] if name != "passed" else found
        lines += (f"== {name}", *list_lines(render_verdict(report)), *changes)
    check_figures(APPROVED / "sections.html", lines, abs_=0.11)
