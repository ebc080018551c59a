"""Board section of a page: layout, bill of materials, schematic, gate, notes, response."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from fingertip.board.analysis import tolerance
from fingertip.board.analysis.board_values import board_values
from fingertip.board.analysis.response import model_filter
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.network import build_network
from fingertip.board.fabrication.bom import PRICE
from fingertip.board.kicad.sexpr import read_expression
from fingertip.catalogues import output_files as outputs
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from fingertip.page.block_diagram_svg import draw_block_diagram
from fingertip.page.html import (
    Markup,
    element,
    embed,
    figure,
    fold,
    join,
    list_links,
    note,
    quantity,
    scrolling,
    table,
)
from fingertip.page.layout_svg import render_back, render_copper, render_placement
from fingertip.page.markdown_sheets import render_markdown, split_sections
from fingertip.page.schematic_svg import render_schematic
from fingertip.page.sources import COMMANDS, Sources
from fingertip.page.svg import Axis, Frame, figure_svg, legend, line

_COLUMNS = (
    "Quantity",
    "References",
    "Value",
    "Footprint",
    "Rating",
    "Manufacturer",
    "MPN",
    "LCSC",
    PRICE,
    "Note",
)
_FILES = (
    outputs.README,
    outputs.BOM,
    outputs.BRING_UP,
    outputs.WIRING,
    outputs.ASSEMBLY_DRAWING,
    outputs.PROJECT,
)
_BOM_CAPTION = (
    "bill of materials; board/bom.csv names the source of each number; prices are "
    "estimates of November 2026"
)
_NOTES = (
    "Before you apply power",
    "Channels",
    "Connectors",
    "Test points",
    "Before you order",
    "Order form",
)
"""Sections of the board's README that a page shows."""
_CHANNEL = "Channel of one finger, here of the first."
_PLACEMENT = (
    "Placement, seen from the front. Point at a contact to read its pin; a table below "
    "names the pins of connectors."
)
_COPPER = (
    "Copper, seen through the board from the front: front layer in orange, back layer in "
    "blue, pale where it is poured."
)
_BLOCKS = (
    "What each stage does, with its parts as the schematic names them. The last line of a block is "
    "the net that it drives; a block to which no arrow leads names the nets that it reads."
)
_BACK = (
    "Back, seen from the back: the printed list of values. Frames show where the parts are, "
    "all of them on the front."
)


def render_board(sources: Sources) -> Markup:
    if outputs.BOARD_FOLDER in sources.remarks:
        return note(sources.remarks[outputs.BOARD_FOLDER])

    names = (
        outputs.LAYOUT,
        outputs.SCHEMATIC,
        outputs.CHANNEL_SHEET,
        outputs.BOM,
        outputs.VALUES,
        outputs.README,
    )
    layout, schematic, channel, bom, values, readme, bring_up = (
        sources.text(f"{outputs.BOARD_FOLDER}/{name}") for name in (*names, outputs.BRING_UP)
    )
    links = sources.links
    sections = split_sections(readme or "")
    paths = [f"{outputs.BOARD_FOLDER}/{name}" for name in _FILES]
    linked = [path for path in paths if path in links]
    parts = []
    if linked:
        parts = [element("p", "Files of the board:"), list_links(linked, links, "files")]

    if sources.design.board.variant == "divider":
        return join((_draw_wiring(sources), *parts[1:]))

    folded = list[tuple[str, Markup]]()
    buy = fold("What to buy for the board", render_bom(bom), state="roomy") if bom else Markup("")
    if layout:
        board = read_expression(layout)
        placement = figure(
            render_placement(board, "Placement of the components"), _PLACEMENT, "placement"
        )
        if buy:  # both are seen at once
            placement = element(
                "div", element("div", placement), element("div", buy), class_="parts"
            )

        parts.append(placement)
        folded += [
            ("Back", figure(render_back(board, "Back of the board"), _BACK, "back")),
            ("Copper", figure(render_copper(board, "Copper of the board"), _COPPER, "copper")),
        ]
    else:
        parts.append(buy)

    if schematic:
        diagram = figure(draw_block_diagram(sources.design), _BLOCKS, "block diagram", "wide")
        folded.append(("Block diagram", diagram))

    sheets = (
        (schematic, "Schematic of the board", ""),
        (channel, "Schematic of a channel", _CHANNEL),
    )
    for sheet, title, caption in sheets:
        if sheet:
            drawing = render_schematic(read_expression(sheet), title)
            folded.append((title, figure(drawing, caption, title, "wide")))

    if values:
        parts.append(_render_gate(json.loads(values).get("gate", [])))

    folded += [
        (heading, render_markdown(sections[heading], links))
        for heading in _NOTES
        if heading in sections
    ]
    if bring_up:
        text = bring_up.partition("\n")[2]
        folded.append(("Bring-up with a multimeter", render_markdown(text, links)))

    wiring = _draw_wiring(sources)
    if wiring:
        folded.append(("How to connect it", wiring))

    parts += [fold(title, content) for title, content in folded]
    if not bring_up:
        command = element("code", COMMANDS[outputs.BOARD_FOLDER])
        parts.append(
            note("There is no bring-up sheet: in the folder of this page, ", command, " makes it.")
        )

    return join(parts)


def _draw_wiring(sources: Sources) -> Markup:
    wiring = sources.files.get(f"{outputs.BOARD_FOLDER}/{outputs.WIRING}")
    if wiring is None:
        return Markup("")

    board = "resistor" if sources.design.board.variant == "divider" else "board"
    image = element(
        "img", src=embed(wiring, "image/svg+xml"), alt=f"Wiring of sensor, {board} and controller"
    )
    return figure(image, "", "wiring", "paper")


def render_bom(text: str) -> Markup:
    """Render `bom.csv` as a table whose lines name their parts.

    `board.js` adds a check box for what is placed and a button that highlights the parts of a line
    on the pictures of the board. Without scripts it is a plain table.
    """
    rows = []
    for row in csv.DictReader(io.StringIO(text)):
        entry = {name: row.get(name) or "" for name in _COLUMNS}
        name = " ".join(filter(None, (entry["Manufacturer"], entry["MPN"])))
        lcsc = f"LCSC {entry['LCSC']}" if entry["LCSC"] else ""
        more = ", ".join(filter(None, (entry["Footprint"], lcsc, entry["Note"])))
        contents = (
            ("quantity", entry["Quantity"]),
            ("references", entry["References"]),
            ("value", join((entry["Value"], element("small", entry["Rating"])))),
            ("part", join((name, element("small", more)))),
            ("USD each", entry[PRICE]),
        )
        cells = (
            element("td", content, data_label=label, class_=label.split()[0])
            for label, content in contents
        )
        rows.append(
            element("tr", *cells, data_parts=entry["References"], data_value=entry["Value"])
        )

    head = (
        element("th", label, scope="col")
        for label in ("quantity", "references", "value", "part", "USD each")
    )
    whole = element(
        "table",
        element("caption", _BOM_CAPTION),
        element("thead", element("tr", *head)),
        element("tbody", *rows),
        class_="cards",
        id="bom",
    )
    # The script shows the line of controls; without it there is nothing to control.
    controls = element("div", class_="row", id="bom-controls", hidden=True)
    return join((controls, scrolling(whole, _BOM_CAPTION)))


def _render_gate(gate: list[Mapping[str, Any]]) -> Markup:
    if not gate:
        return Markup("")

    passed = sum(entry["passed"] for entry in gate)
    rows = []
    for entry in gate:
        verdict, kind = ("✓", "passed") if entry["passed"] else (f"✗ {entry['remedy']}", "failed")
        value = quantity(entry["value"], entry["unit"])
        limit = quantity(entry["limit"], entry["unit"], entry["bound"])
        rows.append(
            (entry["name"], entry["subject"], value, limit, element("span", verdict, class_=kind))
        )

    body = table(
        ("requirement", "of", "value", "must be", "met"), rows, "what makes the board work"
    )
    state = "open" if passed < len(gate) else ""
    return fold(f"Requirements of the board: {passed} of {len(gate)} met", body, state=state)


BOARDS = 1000
"""Number of boards that the band is drawn from."""
_SEED = 1
_LOW_HZ = 10.0
_HIGH_HZ = 1e5
_PER_DECADE = 40
_WIDTH = 760.0
_HEIGHT = 380.0


def draw_response(design: Design) -> Markup:
    """Draw the gain from the tactile voltage to the rectifier, as a figure with a caption."""
    circuit = board_circuit(board_values(design))
    network = build_network(circuit, find_gain_bandwidth_hz(design.board))
    board = tolerance.TolerancedFilter(model_filter(circuit), network.values)
    limits = tolerance.component_tolerances(circuit)
    spread = tolerance.monte_carlo(board, limits, BOARDS, _SEED)
    random_values = board.deviate(tolerance.draw_deviations(board, limits, BOARDS, _SEED))
    nominal_power = board.model.transfer(board.values).power_gain()
    random_power = board.model.transfer(random_values).power_gain()
    steps = round(_PER_DECADE * math.log10(_HIGH_HZ / _LOW_HZ))
    f_hz = [_LOW_HZ * 10.0 ** (i / _PER_DECADE) for i in range(steps + 1)]
    gains_db = []  # nominal, and the ends of the interval with 95 % of the boards

    for hz in f_hz:
        omega = math.tau * hz
        ends = np.quantile(np.asarray(random_power(omega)), tolerance.BAND_QUANTILES)
        powers = (nominal_power(omega), *ends)
        gains_db.append([10.0 * math.log10(float(power)) for power in powers])

    nominal, low, high = zip(*gains_db, strict=True)
    bottom = 10.0 * math.floor(min(low) / 10.0)
    top = 10.0 * math.ceil((max(high) + 3.0) / 10.0)
    frame = Frame(
        x=Axis(_LOW_HZ, _HIGH_HZ, "frequency [Hz]", True),
        y=Axis(bottom, top, "gain [dB]"),
        left=58.0,
        top=46.0,
        width=_WIDTH - 80.0,
        height=_HEIGHT - 100.0,
    )
    cutoff = spread["cutoff_hz"]
    gain = spread["passband_gain"]
    cutoff_line = frame.point(cutoff.nominal, bottom), frame.point(cutoff.nominal, top)
    svg = figure_svg(
        _WIDTH,
        _HEIGHT,
        f"Gain of the filter over frequency, with the band of {BOARDS} boards",
        frame.axes(),
        frame.band([*zip(f_hz, high, strict=True)], [*zip(f_hz, low, strict=True)], "var(--band)"),
        frame.line(zip(f_hz, nominal, strict=True), "var(--series-1)", 2),
        line(*cutoff_line, "var(--series-2)", 1.5, "4 3"),
        legend(
            210.0,
            22.0,
            (
                ("var(--series-1)", "", "nominal values"),
                ("var(--band)", "band", "95 % of boards"),
                ("var(--series-2)", "4 3", "-3 dB"),
            ),
        ),
    )
    caption = (
        f"Computed, not measured. Nominal -3 dB frequency {cutoff.nominal:.1f} Hz, passband gain "
        f"{gain.nominal:.1f}. "
        f"Of {BOARDS} boards with components anywhere within the tolerances that are bought, 95 % "
        "have "
        f"{cutoff.low_95:.1f} to {cutoff.high_95:.1f} Hz (each ±{cutoff.error_95:.1f}) and a gain "
        f"of {gain.low_95:.1f} to {gain.high_95:.1f} (±{gain.error_95:.1f}); ± is the 95 % "
        "interval of an end, from so many boards."
    )

    return figure(svg, caption, "response of the filter", "wide")
