"""First screen of a page in plain words: what a finger or a set is, what it takes, and the next three steps.

Every figure is that of the sheets: it comes from the report, from the data of a set, or from the function that the
board's README asks.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from typing import Any

from fingertip.board.analysis.board_values import board_values
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.fabrication.bom import estimate_cost, purchased_components
from fingertip.design import Design
from fingertip.documents.template import render_page

_HARDER = {"bone.safety_factor.shock": "Keep harder knocks off.", "bone.safety_factor.grip": "Do not grip that hard."}
"""Check that warns of a force -> what a user must know besides."""


def render_start(
    design: Design,
    report: Mapping[str, Any],
    size_mm: Sequence[float],
    files: Collection[str],
    steps: int,
    verdict: str,
) -> str:
    """Render the first screen of a design; `files` are the paths that it may name, `steps` the number to cast."""
    told = [f"{one['name']}: {one['warning']}" for one in report["checks"] if one["passed"] and one.get("warning")]
    return render_page(
        "start.md",
        design=design,
        size_mm=[f"{size:.0f}" for size in size_mm],
        casting=report.get("casting"),
        warnings=_tell_warnings(told),
        loads=_find_loads(design, report["checks"]),
        files=files,
        steps=steps,
        verdict=verdict,
        **_board_data(design),
    )


def render_set_start(data: Mapping[str, Any], board_design: Design | None) -> str:
    """Render the first screen of a set, with the board of all its fingers if there is one."""
    board = _board_data(board_design) if board_design else {"cost_usd": None, "components": 0}
    warnings = [(form["design"], told) for form in data["forms"] for told in _tell_warnings(form["warnings"])]
    return render_page("finger_set/start.md", **data, waits=_count_waits(data["calendar"]), warnings=warnings, **board)


def render_basis_table(design: Design) -> str:
    """Render where each kind of figure of a page comes from, as a table."""
    printer, curve = design.printer, design.force_curve
    is_calibrated = printer.offset_mm != 0.0 or printer.scale_percent != 100.0
    is_weighed, sensor = curve.curve == "calibrated", curve.describe()
    return render_page("basis.md", printer=printer, is_calibrated=is_calibrated, is_weighed=is_weighed, sensor=sensor)


def _find_loads(design: Design, checks: Sequence[Mapping[str, Any]]) -> dict[str, int]:
    """Find the loads at which the bone has the safety factors that its checks want [N]; none if it was not checked."""
    return {
        (load := check["name"].rpartition(".")[2]): int(
            design.value(f"strength.{load}_force_n") * check["value"] / check["limit"]
        )
        for check in checks
        if check["name"] in _HARDER and "limit" in check
    }


def _board_data(design: Design) -> dict[str, Any]:
    if not design.board.has_filter:
        return {"cost_usd": None, "components": 0}
    circuit = board_circuit(board_values(design), design.board.channels)
    return {"cost_usd": estimate_cost(circuit), "components": len(purchased_components(circuit))}


def _count_waits(plan: Sequence[Mapping[str, Any]]) -> dict[str, int]:
    """Count the waits of a plan, the most frequent first."""
    return dict(Counter(stage["wait"] for stage in plan if stage["wait"]).most_common())


def _tell_warnings(warnings: Sequence[str]) -> list[str]:
    """Tell what checks warn of and what helps, without names of checks and loads, and places on the bone."""
    found = [warning.partition(", below strength.")[0].rstrip(".").partition(": ") for warning in warnings]
    return [f"{said[0].upper()}{said[1:]}. {_HARDER.get(name, '')}".rstrip() for name, _, said in found]
