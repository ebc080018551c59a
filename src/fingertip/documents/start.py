"""First screen of a page in plain words: what a finger or a set is, what it takes, and the next three steps.

Every figure is that of the sheets: it comes from the report, from the data of a set, or from the function that the
board's README asks.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from fingertip.board.analysis.board_values import board_values
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.fabrication.bom import estimate_cost, purchased_components
from fingertip.design import Design
from fingertip.documents.template import render_page


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
