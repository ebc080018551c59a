"""Pieces of a page, each against what it must not do or what something else says."""

from __future__ import annotations

import itertools
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

from fingertip import Design
from fingertip.board.analysis.board_analysis import bode_table
from fingertip.board.analysis.board_values import board_values
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.kicad.project import read_archive
from fingertip.board.kicad.sexpr import read_expression
from fingertip.cad.kernel.mesh import Mesh
from fingertip.cad.parts import shapes_of_parameters
from fingertip.catalogues.output_files import SCHEMATIC
from fingertip.foundation.output_set import SetWriter
from fingertip.models.parts import parts_by_name
from fingertip.page import markdown_sheets
from fingertip.page.block_diagram_svg import ON_OFF, draw_block_diagram, list_blocks
from fingertip.page.board_section import draw_response
from fingertip.page.html import Markup, code, element, figure, table
from fingertip.page.layout_svg import list_pads, render_back
from fingertip.page.model_section import Item, scene_json
from fingertip.page.schematic_svg import find_way, first, list_bodies, numbers, points
from fingertip.page.sources import _read_current_set
from fingertip.page.svg import Axis, Frame, format_tick, number
from fingertip.page.trial_svg import reduce_line
from tests.conftest import ROOT
from tests.page.conftest import Page

EVIL = "<script>alert(1)</script>\"'&"


VARIANTS = {
    "article": ["board.variant=article", "board.supply_v=5", "detector.kind=analog"],
    "precision": ["detector.kind=digital"],
    "comparator": ["board.variant=comparator", "detector.kind=analog"],
    "divider": ["board.variant=divider"],
}


@pytest.mark.parametrize("changes", VARIANTS.values(), ids=VARIANTS)
def test_blocks_are_the_stages_of_the_circuit(changes: list[str]) -> None:
    design = Design.load("fsr400", changes=changes)
    blocks = list_blocks(design)
    assert blocks[-1].output == ON_OFF
    assert [block.is_software for block in blocks] == sorted(block.is_software for block in blocks)
    for block in blocks:
        longest = max(map(len, (block.title, *block.lines)))
        assert longest <= 25, f"{block} is wider than its frame"
        assert len(block.lines) <= 3

    if design.board.has_filter:
        values = board_values(design)
        nets = set(board_circuit(values).net_by_pin.values()) | {"current of D1"}
        part = values.by_reference
        assert nets.issuperset(block.output for block in blocks if not block.is_software)
        first, second = (block for block in blocks if "order" in block.title and block.lines[1:])
        pole_hz = 1 / (2 * math.pi * part["R1"] * part["C1"])
        section_hz = 1 / (2 * math.pi * math.sqrt(part["R2"] * part["R3"]) * part["C2"])
        assert first.lines[0].startswith(f"{pole_hz:.1f} Hz")
        assert second.lines[1].startswith(f"{section_hz:.1f} Hz")


def test_every_variant_has_a_block_diagram_of_its_own() -> None:
    titles = {
        name: tuple(block.title for block in list_blocks(Design.load("fsr400", changes=changes)))
        for name, changes in VARIANTS.items()
    }
    assert len(set(titles.values())) == len(VARIANTS)
    assert {name for name, found in titles.items() if "Wheatstone bridge" in found} == {"article"}
    assert "Comparator" in titles["comparator"]
    drawn = draw_block_diagram(Design.load("fsr400", changes=VARIANTS["comparator"]))
    # The software reads the envelope, and not the comparator before it: one arrow less.
    assert drawn.count('Z"') == len(titles["comparator"]) - 2


def test_text_is_never_markup() -> None:
    for built in (
        element("p", EVIL),
        element("p", element("b", EVIL), title=EVIL),
        element("p", code(EVIL)),
        table([EVIL], [[EVIL]], EVIL),
        figure(element("img", alt=EVIL), EVIL),
        markdown_sheets.render_markdown(
            f"# {EVIL}\n\n{EVIL}\n\n- {EVIL}\n\n| a |\n| --- |\n| {EVIL} |\n\n**{EVIL}** `{EVIL}`"
        ),
        markdown_sheets.render_steps(f"1. {EVIL}\n\n   ![{EVIL}](x.png)", {"x.png": EVIL}),
    ):
        page = Page(built)
        assert not page.faults, built
        assert "script" not in {tag for tag, _ in page.elements}
        assert not [
            key for _, attributes in page.elements for key in attributes if key == "alert(1)"
        ]
    # The same test would fail for text that is wrongly taken as markup.
    assert "script" in {tag for tag, _ in Page(element("p", Markup("<script></script>"))).elements}
    mesh = Mesh(np.eye(3), np.array([[0, 1, 2]]))
    text = scene_json([Item("</script>", EVIL, mesh, 1.0, (0, 0, 0), False, (0, 0, 0), (0, 0, 0))])
    assert "<" not in text
    assert json.loads(text)[0]["name"] == "</script>"
    assert "img" not in markdown_sheets.render_markdown("![x](http://example.org/x.png)"), (
        "a picture that nobody embedded is left out"
    )


def test_ticks_are_round_and_points_are_placed_by_their_axes() -> None:
    assert Axis(1.79, 1.96, "").ticks(8) == [1.8, 1.85, 1.9, 1.95]
    assert Axis(10, 1e5, "", True).ticks(8) == [10, 100, 1000, 10_000, 100_000]
    assert Axis(-20, 40, "").ticks(5) == [-20, 0, 20, 40]
    assert [format_tick(value) for value in (500, 2000, -20)] == ["500", "2 k", "-20"]
    frame = Frame(Axis(1, 100, "", True), Axis(0, 2, ""), 10, 20, 200, 100)
    assert frame.point(10, 1) == pytest.approx((110, 70))
    assert frame.point(1000, -1) == pytest.approx((210, 120))  # beyond the axes: on the border
    decades = Axis(3, 700, "", True)
    assert [decades.share(value) for value in (3, 700, math.sqrt(3 * 700))] == pytest.approx(
        [0, 1, 0.5]
    )
    assert decades.share(60) - decades.share(6) == pytest.approx(
        decades.share(300) - decades.share(30)
    ), "equal ratios"
    assert number(-0.04) == "0"


def test_bundled_board_is_drawn_as_large_as_in_its_file() -> None:
    """Holes have the diameters of their drills, and pads that were turned wrongly would reach into
    each other.
    """
    layout = read_expression((ROOT / "pcb" / "slip_filter.kicad_pcb").read_text())
    footprints = [*layout.children("footprint")]
    drills = [
        numbers(drill)[0]
        for f in footprints
        for pad in f.children("pad")
        for drill in pad.children("drill")
    ]
    holes = [
        2 * float(a["r"] or 0)
        for tag, a in Page(render_back(layout, "b")).elements
        if tag == "circle"
    ]
    assert holes == pytest.approx(drills, abs=1e-3)
    for footprint in footprints:
        for one, other in itertools.combinations([pad.box for pad in list_pads(footprint)], 2):
            assert max(one[0], other[0]) >= min(one[2], other[2]) or max(one[1], other[1]) >= min(
                one[3], other[3]
            )


def test_reduced_lines_keep_their_extremes() -> None:
    rng = np.random.default_rng(3)
    x = np.arange(50_000) / 2000
    y = rng.normal(size=50_000)
    reduced = reduce_line(x, y)
    assert len(reduced) < 1400
    assert (min(b for _, b in reduced), max(b for _, b in reduced)) == (y.min(), y.max())
    assert [a for a, _ in reduced] == sorted(a for a, _ in reduced)


def test_response_agrees_with_the_bode_table(design: Design) -> None:
    """The line on the page, read back from its pixels, is the gain that the network's equations
    give.
    """
    svg = Page(draw_response(design))
    lines = [a for tag, a in svg.elements if tag == "path" and a.get("stroke") == "var(--series-1)"]
    (data,) = (a["d"] or "" for a in lines)
    spots = [tuple(map(float, pair.split())) for pair in data[1:].split("L")]
    rows = [row.split(",") for row in bode_table(design).splitlines()[41:]]  # from 10 Hz on
    assert len(rows) == len(spots)
    labels = [
        (float(a["y"] or 0) - 4, word)
        for (tag, a), word in _texts(svg)
        if a.get("text-anchor") == "end"
    ]
    (y0, low), (y1, high) = ((y, float(word)) for y, word in (labels[0], labels[-1]))
    for (_, y), row in zip(spots, rows, strict=True):
        assert low + (y - y0) / (y1 - y0) * (high - low) == pytest.approx(float(row[5]), abs=0.03)
    # In the pass band the band is as wide as the range of gains in the caption, which has another
    # source.
    (data,) = (
        a["d"] or "" for tag, a in svg.elements if tag == "path" and a.get("fill") == "var(--band)"
    )
    ends = [float(pair.split()[1]) for pair in data[1:].rstrip("Z").split("L")]
    peak = min(range(len(spots)), key=lambda i: spots[i][1])
    width_db = (ends[-1 - peak] - ends[peak]) / (y0 - y1) * (high - low)
    stated = re.search(r"a gain of ([\d.]+) to ([\d.]+) ", svg.text)
    assert stated
    assert width_db == pytest.approx(20 * math.log10(float(stated[2]) / float(stated[1])), rel=0.2)


def _texts(page: Page) -> list[tuple[tuple[str, dict[str, str | None]], str]]:
    """Text elements with their words."""
    words_of = [word for word in page.words if word.strip()]
    elements = [entry for entry in page.elements if entry[0] in ("title", "text", "figcaption")]
    assert len(words_of) == len(elements)
    return [
        (entry, word) for entry, word in zip(elements, words_of, strict=True) if entry[0] == "text"
    ]


def test_pins_of_the_schematic_meet_its_wires() -> None:
    """A symbol that is turned or mirrored wrongly has pins beside its wires."""
    sheet = read_expression(read_archive("article")[SCHEMATIC].decode())
    library = {symbol.words[1]: symbol for symbol in first(sheet, "lib_symbols").children("symbol")}
    wires = [points(wire) for wire in sheet.children("wire")]
    pins = [
        find_way(symbol)(*numbers(first(pin, "at"))[:2])
        for symbol in sheet.children("symbol")
        for body in list_bodies(symbol, library[symbol.word("lib_id")])
        for pin in body.children("pin")
    ]
    assert len(pins) > 80

    def on_wire(x: float, y: float) -> bool:
        return any(
            min(x0, x1) - 1e-6 <= x <= max(x0, x1) + 1e-6
            and min(y0, y1) - 1e-6 <= y <= max(y0, y1) + 1e-6
            for (x0, y0), (x1, y1) in wires
        )

    marks = [
        numbers(first(mark, "at"))[:2]
        for mark in sheet.children("label", "global_label", "no_connect")
    ]
    alone = [
        (x, y)
        for x, y in pins
        if not on_wire(x, y) and all(math.dist((x, y), m) > 1e-6 for m in marks)
    ]
    assert [
        spot for spot in alone if sum(math.dist(spot, other) < 1e-6 for other in pins) < 2
    ] == []


CHANGED = (
    "skin.width_mm",
    "bone.channel_diameter_mm",
    "bone.collar_length_mm",
    "mold.wall_mm",
    "skin.bump_height_mm",
    "sensor.clearance_mm",
    "bone.post_width_mm",
    "bone.groove_depth_mm",
    "board.cutoff_hz",
    "mold.engraving_height_mm",
)


@pytest.mark.full
@pytest.mark.parametrize("path", CHANGED)
def test_whatever_a_parameter_changes_is_highlighted(path: str, design: Design) -> None:
    """Shapes that differ after a small change, against the parameters that they were recorded to
    read.
    """
    moved = set(shapes_of_parameters(design).get(path, ()))
    other = design.with_values({path: design.value(path) * 1.02})
    changed = {
        name
        for name, part in parts_by_name(design).items()
        if part.solid(other) != part.solid(design)
    }
    assert changed <= moved
    assert bool(changed) == (path.partition(".")[0] not in ("board", "detector"))


def test_a_set_is_shown_as_it_was_made_and_no_archive_of_it(tmp_path: Path) -> None:
    shown = {"README.md": b"# Board", "bom.csv": b"R1"}
    SetWriter(tmp_path / "board", "board", "finger", "now").write(shown | {"gerbers.zip": b"zip"})
    assert _read_current_set(tmp_path, "board", "now") == shown
    assert _read_current_set(tmp_path, "steps", "now") == "The files in steps/ are missing"
    assert (
        _read_current_set(tmp_path, "board", "then")
        == "The files in board/ were made from other parameters"
    )
    (tmp_path / "board" / "bom.csv").write_bytes(b"R2")
    assert (
        _read_current_set(tmp_path, "board", "now")
        == "The files in board/ were changed after they were written"
    )
