"""The article's figures beside ours under its protocol, as rows and as text."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingertip.documents.template import WIDTH, lay_out_page, render_text
from fingertip.lab.report.results import ONSETS, format_ms
from fingertip.slip.traces.truth import ENCODER_HZ, encoder_delay_band_s
from tools.article.previous_works import PLATE_FACTORS, PreviousWorks
from tools.article.protocol import DEVICES, MOVED_M, ProtocolStudy

TEMPLATE = Path(__file__).with_name("protocol.md")
PROTOCOL_COLUMNS = tuple(device for device in DEVICES if device != "fft")
"""Devices that have a column in the table of the article's protocol."""


@dataclass(frozen=True)
class ProtocolRow:
    """One figure of the article, ours beside it."""

    figure: str
    article: str
    ours: dict[str, str]
    """Device -> value; a device that the figure does not apply to is left out."""
    differs: str


def list_protocol_rows(study: ProtocolStudy, previous: PreviousWorks) -> list[ProtocolRow]:
    """List the article's figures (sections IV.A, IV.B and V) beside ours."""
    data: dict[str, Any] = {
        "columns": PROTOCOL_COLUMNS,
        "devices": [study.find(name) for name in PROTOCOL_COLUMNS],
        "later": [
            (moved_m, [study.find(name, moved_m) for name in PROTOCOL_COLUMNS])
            for moved_m in MOVED_M[1:]
        ],
        "fft": study.find("fft"),
        "plates": [(factor, previous.means_s(factor)) for factor in PLATE_FACTORS],
        "plain_fft": previous.plain_fft,
        "boards": list(study.manipulations.values()),
        "motion_ms": ONSETS["motion_ms"],
        "encoders_ms": [
            1000 * delay_s for delay_s in encoder_delay_band_s(ONSETS["motion_ms"] / 1000)
        ],
        "ms": lambda seconds: format_ms(seconds, "none found"),
    }
    rows = []
    page = lay_out_page(render_text(TEMPLATE.read_text(encoding="utf-8"), **data))
    table = [line[1:-1].split("|") for line in page.splitlines() if line.startswith("|")]
    head, _, *lines = ([cell.strip() for cell in line] for line in table)

    for row in (dict(zip(head, line, strict=True)) for line in lines):
        ours = {name: row[name] for name in PROTOCOL_COLUMNS if row[name]}
        rows.append(ProtocolRow(row["figure"], row["article"], ours, row["differs"]))

    return rows


def protocol_as_lines(study: ProtocolStudy, previous: PreviousWorks) -> list[str]:
    """Format the table as text; what differs stands below each row."""
    head = "".join(f"{name:>18}" for name in PROTOCOL_COLUMNS)
    lines = [
        "",
        "the article's own protocol beside its figures. Zero: first reading of encoders at "
        f"{ENCODER_HZ:g} Hz that shows the",
        "robot's motion. Window and converter: those of the design article. Threshold: what the "
        "noise of each board's",
        "output allows. Nothing was tuned to the article's figures:",
        f"{'':34} {'article':>29}{head}",
    ]

    for row in list_protocol_rows(study, previous):
        cells = "".join(f"{row.ours.get(name, ''):>18}" for name in PROTOCOL_COLUMNS)
        lines.append(f"{row.figure:34} {row.article:>29}{cells}".rstrip())
        lines += textwrap.wrap(row.differs, WIDTH, initial_indent="    ", subsequent_indent="    ")

    return lines
