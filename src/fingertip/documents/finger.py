"""Documents of one finger: casting sheet with its steps, first screen of its page, and where its figures come from.

The templates hold no figure. Every figure is that of the casting sheet, of the report, or of the function that the
board's README asks.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fingertip.board.analysis.board_values import board_values
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.fabrication.bom import estimate_cost, purchased_components
from fingertip.casting.sheet import CastingSheet
from fingertip.design import Design
from fingertip.documents.template import render, render_page

_REFERENCE = re.compile(r"\[([^\]]+)\]\(#(\w+)\)")
"""Words of a step, and the key of the thing that they name."""


@dataclass(frozen=True)
class Step:
    picture: str
    """Name of the scene in `fingertip.pictures.steps` that shows the step."""
    text: str
    uses: tuple[str, ...]
    """Keys of the things that it names."""


def list_steps(sheet: CastingSheet) -> list[Step]:
    """List the steps. Raises KeyError if one names a thing that is not in the list to buy."""
    known = {thing.key: thing for thing in sheet.things}
    _, *pages = render("steps.md", **vars(sheet)).split("## ")
    steps = []
    for name, _, text in (page.partition("\n") for page in pages):
        uses = dict.fromkeys(known[key].key for _, key in _REFERENCE.findall(text))
        steps.append(Step(name, " ".join(_REFERENCE.sub(r"\1", text).split()), tuple(uses)))
    return steps


def render_sheet(sheet: CastingSheet, pictures: Sequence[str] = ()) -> str:
    return render_page("casting.md", **vars(sheet), steps=list_steps(sheet), pictures=pictures)


def render_start(
    design: Design,
    report: Mapping[str, Any],
    size_mm: Sequence[float],
    files: Collection[str],
    steps: int,
    verdict: str,
) -> str:
    """Render the first screen of a design; `files` are the paths that it may name, `steps` the number to cast."""
    return render_page(
        "start.md",
        design=design,
        size_mm=[f"{size:.0f}" for size in size_mm],
        casting=report.get("casting"),
        loads=(report.get("strength") or {}).get("loads"),
        files=files,
        steps=steps,
        verdict=verdict,
        **_board_data(design),
    )


def render_set_start(data: Mapping[str, Any], board_design: Design | None) -> str:
    """Render the first screen of a set, with the board of all its fingers if there is one."""
    board = _board_data(board_design) if board_design else {"cost_usd": None, "components": 0}
    return render_page("set_start.md", **data, **board)


def render_basis_table(design: Design) -> str:
    """Render where each kind of figure of a page comes from, as a table."""
    printer, curve = design.printer, design.force_curve
    is_calibrated = printer.offset_mm != 0.0 or printer.scale_percent != 100.0
    is_weighed, sensor = curve.curve == "calibrated", curve.describe()
    return render_page("basis.md", printer=printer, is_calibrated=is_calibrated, is_weighed=is_weighed, sensor=sensor)


def _board_data(design: Design) -> dict[str, Any]:
    if not design.board.has_filter:
        return {"cost_usd": None, "components": 0}
    circuit = board_circuit(board_values(design), design.board.channels)
    return {"cost_usd": estimate_cost(circuit), "components": len(purchased_components(circuit))}
