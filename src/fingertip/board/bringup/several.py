"""Bring-up of a board of several fingers: the readings of one finger for each, and what they tell together.

A fault of a part that all fingers share shows at all of them, and one of a finger's own part at no other. So a finger
whose readings pass clears the shared parts, and where all fail alike the shared parts alone are suspected.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from fingertip.board.bringup import readings
from fingertip.board.bringup.bench import HOST, Fault
from fingertip.board.bringup.plan import SUPPLY_MA, SUPPLY_OHM, BringUp, find_failed
from fingertip.board.circuits.channels import SHARED_PARTS, name_part
from fingertip.design.parameters.declaration import suggest_name
from fingertip.foundation.errors import BoardError, Issue
from fingertip.foundation.tables import read_toml

COMMON_READINGS = (SUPPLY_OHM, SUPPLY_MA)
"""Readings that are taken once, and not for each finger."""
WHOLE_BOARD = "board"
_PART = re.compile(r"\b(?:RV|TP|[CDJQRU])\d{1,2}(?=[ab]?\b)")


def write_template(plan: BringUp, fingers: Sequence[str], name: str) -> str:
    """Write the file of readings, each still without a value: a table for each finger."""
    own = [readings.format_entry(key, limits) for key, limits in plan.all.items() if key not in COMMON_READINGS]
    lines = [*readings.list_head(plan, name), *(readings.format_entry(key, plan.all[key]) for key in COMMON_READINGS)]
    for channel, finger in enumerate(fingers, start=1):
        lines += ["", f"[{finger}]  # finger {channel}: TP1 is TP{channel}01", *own]
    return "\n".join(lines) + "\n"


def read_fingers(path: Path, plan: BringUp, fingers: Sequence[str]) -> dict[str, readings.Readings]:
    """Read a file of readings by finger; one that was not measured is left out. Raises TomlFileError or BoardError."""
    content = read_toml(path)
    tables = {name: value for name, value in content.items() if isinstance(value, dict)}
    common = {name: value for name, value in content.items() if name not in tables}
    if issues := list(_find_issues(common, tables, plan, fingers, path)):
        raise BoardError(issues)
    tone = {readings.TONE: common[readings.TONE]} if readings.TONE in common else {}
    found = {WHOLE_BOARD: readings.select_readings(common, plan)}
    found |= {finger: readings.select_readings({**tone, **tables.get(finger, {})}, plan) for finger in fingers}
    return {finger: taken for finger, taken in found.items() if taken.values}


def _find_issues(
    common: Mapping[str, Any], tables: Mapping[str, Any], plan: BringUp, fingers: Sequence[str], path: Path
) -> Iterator[Issue]:
    for name in (name for name in tables if name not in fingers):
        yield Issue(f"[{name}]", f"is no finger of this board; {suggest_name(name, list(fingers))}")
    expected = (readings.IDENTITY, readings.TONE, *COMMON_READINGS)
    stated = {name: value for name, value in common.items() if name in expected}
    for name in (name for name in common if name not in stated):
        yield Issue(name, f"stands ahead of the tables; write it below one of [{'], ['.join(fingers)}].")
    yield from readings.find_reading_issues(stated, plan, path, needs_reading=False)
    for finger in fingers:
        own = {readings.IDENTITY: plan.identity, **tables.get(finger, {})}
        for issue in readings.find_reading_issues(own, plan, path, needs_reading=False):
            yield Issue(f"{finger}.{issue.field}", issue.message)
    if not any(readings.take_values(table, plan) for table in (common, *tables.values())):
        yield Issue(str(path), "holds no reading; write at least one in place of nan.")


def assess_fingers(plan: BringUp, measured: Mapping[str, readings.Readings], fingers: Sequence[str]) -> dict[str, Any]:
    """Compare the readings of all fingers with their limits and name the likely faults, as plain data."""
    levels = {
        finger: {name: v for name, v in taken.values.items() if name in plan.levels}
        for finger, taken in measured.items()
    }
    failed_at = {finger: set(find_failed(plan.levels, taken)) for finger, taken in levels.items()}
    failing = [finger for finger, names in failed_at.items() if names]
    # A finger clears the shared parts of what fails elsewhere if it passes in the same readings.
    cleared = {
        finger
        for finger in failing
        if any(failed_at[finger] <= levels[other].keys() and not failed_at[other] for other in levels)
    }
    found = {
        finger: readings.assess_readings(plan, taken, _choose(finger in cleared)) for finger, taken in measured.items()
    }
    names = [{sentence.split(" ")[0] for sentence in found[finger]["likely"]} for finger in failing]
    if not cleared and len(failing) > 1 and not any(map(SHARED_PARTS.isdisjoint, names)):
        found |= {finger: readings.assess_readings(plan, measured[finger], _is_shared) for finger in failing}
    named = {WHOLE_BOARD: found[WHOLE_BOARD]} if WHOLE_BOARD in found else {}
    named |= {finger: _rename(found[finger], k) for k, finger in enumerate(fingers, start=1) if finger in found}
    for finger, each in named.items():
        each["missing"] = [name for name in each["missing"] if (name in COMMON_READINGS) == (finger == WHOLE_BOARD)]
    failed = [finger for finger, each in named.items() if not each["passed"]]
    verdict = (
        f"{', '.join(failed)}: readings fail." if failed else f"All readings of {', '.join(named)} are within limits."
    )
    return {"passed": not failed, "verdict": verdict, "fingers": named}


def format_fingers(data: Mapping[str, Any]) -> str:
    """Format an assessment as text, the verdict first."""
    parts = [f"{finger}: {readings.format_assessment(each)}" for finger, each in data["fingers"].items()]
    return "\n\n".join((data["verdict"], *parts))


def _is_shared(fault: Fault) -> bool:
    return SHARED_PARTS.issuperset(fault.reference.split(" and "))


def _choose(is_cleared: bool) -> Callable[[Fault], bool]:
    """Faults to consider: those of shared parts unless another finger clears them."""
    return lambda fault: not is_cleared or SHARED_PARTS.isdisjoint(fault.reference.split(" and "))


def _rename(data: Any, channel: int) -> Any:
    """Name the parts in sentences as the board of several fingers does."""
    if isinstance(data, dict):
        return {key: _rename(value, channel) for key, value in data.items()}
    if isinstance(data, list):
        return [_rename(value, channel) for value in data]
    if not isinstance(data, str):
        return data
    return _PART.sub(
        lambda match: match[0] if match[0] in (*SHARED_PARTS, HOST) else name_part(match[0], channel), data
    )
