"""Table of the article's figures beside those under its own protocol, with what differs and why."""

from __future__ import annotations

import textwrap
from dataclasses import asdict, dataclass
from typing import Any

from fingertip.documents.template import WIDTH, render_rows
from fingertip.lab.report.numbers import ONSETS, format_ms, to_data
from fingertip.lab.studies.article import DEVICES, MOVED_M, ProtocolStudy
from fingertip.slip.traces.origin import ENCODER_HZ, encoder_delay_band_s

COLUMNS = tuple(device for device in DEVICES if device != "fft")
"""Devices that have a column."""


@dataclass(frozen=True)
class ProtocolRow:
    """One figure of the article, ours beside it."""

    figure: str
    article: str
    ours: dict[str, str]
    """Device -> value; a device that the figure does not apply to is left out."""
    differs: str
    """Difference between the two, and its reason."""


def list_rows(study: ProtocolStudy) -> list[ProtocolRow]:
    """List the article's figures (sections IV.A, IV.B and V) beside ours."""
    data = {
        "columns": COLUMNS,
        "devices": [study.find(name) for name in COLUMNS],
        "later": [(moved_m, [study.find(name, moved_m) for name in COLUMNS]) for moved_m in MOVED_M[1:]],
        "fft": study.find("fft"),
        "boards": list(study.manipulations.values()),
        "motion_ms": ONSETS["motion_ms"],
        "encoders_ms": [1000 * delay_s for delay_s in encoder_delay_band_s(ONSETS["motion_ms"] / 1000)],
        "ms": lambda seconds: format_ms(seconds, "none found"),
    }
    return [
        ProtocolRow(row["figure"], row["article"], {name: row[name] for name in COLUMNS if row[name]}, row["differs"])
        for row in render_rows("validation/protocol.md", data)
    ]


def as_lines(study: ProtocolStudy) -> list[str]:
    """Format the table as text; what differs stands below each row."""
    head = "".join(f"{name:>18}" for name in COLUMNS)
    lines = [
        "",
        "the article's own protocol beside its figures. Zero: first reading of encoders at "
        f"{ENCODER_HZ:g} Hz that shows the",
        "robot's motion. Window and converter: those of the design article. Threshold: what the noise of each board's",
        "output allows. Nothing was tuned to the article's figures:",
        f"{'':34} {'article':>29}{head}",
    ]
    for row in list_rows(study):
        cells = "".join(f"{row.ours.get(name, ''):>18}" for name in COLUMNS)
        lines.append(f"{row.figure:34} {row.article:>29}{cells}".rstrip())
        lines += textwrap.wrap(row.differs, WIDTH, initial_indent="    ", subsequent_indent="    ")
    return lines


def as_data(study: ProtocolStudy) -> dict[str, Any]:
    """Return the table and the numbers behind it for JSON; what is not known is null."""
    return {
        "encoder_hz": ENCODER_HZ,
        "rows": [asdict(row) for row in list_rows(study)],
        "results": list(map(to_data, study.results)),
    }
