"""A page of small files, and drawings of small KiCad files, compared whole with approved ones.

A long line of a plot stands there as the number, the ends and the means of its coordinates, data as
their length.
"""

from __future__ import annotations

import base64
import difflib
import json
import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from fingertip.board.kicad.sexpr import read_expression
from fingertip.design import Design
from fingertip.design.design_file import list_parameters
from fingertip.page.board_section import render_board
from fingertip.page.layout_svg import render_back, render_copper, render_placement
from fingertip.page.markdown_sheets import render_basis, render_casting, render_drawing
from fingertip.page.model_section import list_items, scene_json
from fingertip.page.parameters_and_checks import render_checks, render_parameters, render_verdict
from fingertip.page.schematic_svg import render_schematic
from fingertip.page.trial_section import render_trial
from tests.approved import check_figures
from tests.conftest import design_file
from tests.figures import sum_up
from tests.page.conftest import INPUTS, Page, make_check, make_report, make_sources

APPROVED = Path(__file__).parent / "approved"


BREAKS = "head|meta|title|style|body|header|nav|main|section|figure|h[123]|p|li|table|tr|details|fieldset|label|svg class"  # noqa: E501


def list_lines(markup: str) -> list[str]:
    """Blocks of a page on lines of their own, plots and data summed
    up, without styles, scripts and line breaks.
    """
    plain = re.sub(
        r"(<style>|<script[^>]*>).*?(</style>|</script>)", r"\1\2", markup, flags=re.DOTALL
    )
    plain = re.sub(r"sha256-[A-Za-z0-9+/=]*", "sha256", plain)
    plain = re.sub(
        r";base64,([A-Za-z0-9+/=]*)", lambda found: f"; {len(found[1])} characters", plain
    )
    plain = re.sub(
        r'<svg [^>]*class="plot".*?</svg>',
        lambda found: describe_plot(found[0]),
        plain,
        flags=re.DOTALL,
    )
    return re.sub(rf"(?<!^)(?<!\n)(?=<({BREAKS})\b)", "\n", plain.replace("<wbr>", "")).splitlines()


PLACES = ("x", "y", "x1", "y1", "x2", "y2", "cx", "cy", "r", "width", "height", "d", "fill-opacity")


def describe_plot(markup: str) -> str:
    """Elements of a plot that look alike on one line: all texts, and the sum of places
    and sizes.
    """
    texts: dict[str, list[str]] = {}
    places: dict[str, dict[str, list[float]]] = {}
    for element in ElementTree.fromstring(markup).iter():
        look = " ".join(
            [
                element.tag,
                *(f"{key}={value}" for key, value in element.items() if key not in PLACES),
            ]
        )
        texts.setdefault(look, []).extend(
            [element.text] if element.text and element.text.strip() else []
        )
        found = places.setdefault(look, {})
        for key, value in element.items():
            numbers = (
                [float(number) for number in re.findall(r"-?[\d.]+", value)]
                if key in PLACES
                else []
            )
            for name, part in (
                (("x", numbers[::2]), ("y", numbers[1::2])) if key == "d" else ((key, numbers),)
            ):
                found.setdefault(name, []).extend(part)
    lines = []
    for look, found in places.items():
        summed = ", ".join(f"{key} {sum_up(values)}" for key, values in found.items() if values)
        lines.append(f"{look}: {' | '.join(texts[look])} {summed}")
    return "\n" + "\n".join(lines) + "\n"


def draw_board() -> dict[str, str]:
    board, sheet = (
        read_expression((INPUTS / f"slip_filter.kicad_{end}").read_text()) for end in ("pcb", "sch")
    )
    return {
        "schematic": render_schematic(sheet, "schematic"),
        "placement": render_placement(board, "placement"),
        "copper": render_copper(board, "copper"),
        "back": render_back(board, "back"),
    }


def test_pictures_of_the_board_are_the_approved_ones() -> None:
    for name, picture in draw_board().items():
        check_figures(
            APPROVED / f"{name}.svg",
            picture.replace("><", ">\n<").replace("\n</", "</").splitlines(),
        )


def describe_item(item: dict[str, Any]) -> str:
    vertices = np.frombuffer(base64.b64decode(item["vertices"]), "<f4").reshape(-1, 3)
    ends = (*vertices.min(axis=0), *vertices.max(axis=0))
    kind = (
        f"{'bought' if item['bought'] else 'part'} {sum_up(item['colour'])} {item['scale']:g} "
        f"{item['wide']}"
    )
    moved = f"opened {sum_up(item['opened'])} apart {sum_up(item['apart'])}"
    return f"{item['name']}, {item['label']}: {kind} {moved} within {sum_up(ends)}"


def test_page_is_the_approved_one(page: Page, monkeypatch: pytest.MonkeyPatch) -> None:
    """The table of parameters, pictures of the board, and the meshes
    of three designs stand in files of their own.
    """
    start, end = (page.source.index(mark) for mark in ("<p>Press the name", '<h2 id="pad">'))
    source = page.source[:start] + page.source[end:]
    for picture in draw_board().values():
        inside = picture[picture.index("</title>") :]
        assert source.count(inside) == 1
        source = source.replace(inside, "</title></svg>")
    check_figures(APPROVED / "page.html", list_lines(source), abs_=0.11)
    others = (("child_finger", ("printer.scale_percent=100.4",)), ("adult_thumb", ()))
    scenes = [page.scene]
    for name, changes in others:
        sources = make_sources(name, changes=changes)
        scenes.append(json.loads(scene_json(list_items(sources.design, sources.files))))
    check_figures(
        APPROVED / "scene.txt",
        (describe_item(item) for scene in scenes for item in scene),
        abs_=0.05,
    )


def test_effects_of_parameters_are_the_approved_ones() -> None:
    """Values, changes and what each parameter moves; a description
    stands where the parameter is declared.
    """
    markup = render_parameters(Design.load(design_file("adult_finger")))
    text = Page(markup).text
    assert all(
        f"{one.path}{one.description}" in text and one.bounds in text for one in list_parameters()
    )
    rows = re.findall(r'<tr><td data-label="parameter">.*?</tr>', markup, re.DOTALL)
    assert len(rows) == len([*list_parameters()])
    check_figures(APPROVED / "parameters.txt", map(describe_parameter, rows))


def describe_parameter(row: str) -> str:
    """Path, value, default, and the parts that are named and highlighted."""
    path, value = (re.search(f'{name}([^<"]*)', row) for name in ('id="p-', 'class="num">'))
    assert path
    assert value
    moves = re.findall('data-moves="([^"]*)"', row)
    shapes, *default = re.findall("<small>(.*?)</small>", row)
    assert not moves or shapes == f"Shapes {moves[0].replace(' ', ', ').replace('_', ' ')}."
    return ", ".join((f"{path[1]}: {value[1]}", *default, shapes))


FAILED = make_check("mold.palmar_error", 0.3, 0.2, passed=False)
CHECKS = {"passed": make_report().checks, "failed": (FAILED, *make_report().checks)}


def test_sections_of_other_folders_are_the_approved_ones() -> None:
    """Nothing but what must be there, old sets, checks that fail, and where the figures of designs
    are from.

    Of checks and figures those lines that differ from the page's.
    """
    bare = make_sources(
        replaced=dict.fromkeys(
            key for key in make_sources().files if "/" in key or key == "acceptance.md"
        )
    )
    missing = {"board": "no <board>", "signal": "no signal", "steps": "no steps"}
    old = make_sources(remarks=missing, replaced={"drawing_bone.svg": None})
    weighed = Design(
        force_curve={"curve": "calibrated", "min_force_n": 0.5, "max_force_n": 3},
        printer={"scale_percent": 100.4},
    )
    sections = {
        "bare board": render_board(bare),
        "bare casting": render_casting(bare),
        "bare trial": render_trial(bare),
        "old board": render_board(old),
        "old casting": render_casting(old),
        "old trial": render_trial(old),
        "no drawing": render_drawing(old),
    }
    lines = [
        line for name, markup in sections.items() for line in (f"== {name}", *list_lines(markup))
    ]
    basis = render_basis(Design.load("fsr400"), ())
    passed = render_checks(CHECKS["passed"], "basis")
    lines += ("== weighed", *list_changes(basis, render_basis(weighed, ())))
    for name, checks in CHECKS.items():
        changes = list_changes(passed, render_checks(checks, "basis"))
        lines += (f"== {name}", *list_lines(render_verdict(checks)), *changes)
    check_figures(APPROVED / "sections.html", lines, abs_=0.11)


def list_changes(old: str, new: str) -> list[str]:
    return [line for line in difflib.ndiff(list_lines(old), list_lines(new)) if line[0] in "+-"]
