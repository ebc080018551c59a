"""The processes that make STEP files: two of them, and whatever goes wrong in either is told in one sentence."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from fingertip.cad.files.step import StepJob, StepRequest
from fingertip.cad.solids import Box, Solid, difference
from fingertip.errors import GeometryError

GREY = (0.5, 0.5, 0.5)
BOX = Box((0.0, 0.0, 0.0), (1.0, 2.0, 3.0))
NOTHING = difference(BOX, Box((-1.0, -1.0, -1.0), (4.0, 4.0, 4.0)))


class Deadly:
    """Ends the process that evaluates it, as a crash of the kernel does."""

    def __hash__(self) -> int:
        os._exit(9)


def files(*solids: Solid) -> dict[str, bytes]:
    job = StepJob("test", tuple((f"part{i}", solid, GREY) for i, solid in enumerate(solids)))
    with StepRequest(job) as request:
        return request.result().contents


def test_both_halves_of_the_parts_are_there() -> None:
    names = [*(f"part{i}" for i in range(3)), "assembly"]
    assert sorted(files(BOX, BOX, BOX)) == sorted(f"{name}.step" for name in names)


def test_a_single_part_is_made_too() -> None:
    assert sorted(files(BOX)) == ["assembly.step", "part0.step"]


@pytest.mark.parametrize("place", [0, 1])
def test_a_refused_solid_is_told_from_either_process(place: int) -> None:
    solids: list[Solid] = [BOX, BOX]
    solids[place] = NOTHING
    with pytest.raises(GeometryError, match="one valid solid was expected"):
        files(*solids)


@pytest.mark.parametrize("place", [0, 1])
def test_a_crash_is_told_from_either_process(place: int) -> None:
    solids: list[Solid] = [BOX, BOX]
    solids[place] = Deadly()  # type: ignore[call-overload]
    with pytest.raises(GeometryError, match="ended without an answer"):
        files(*solids)


def test_no_process_outlives_a_request() -> None:
    job = StepJob("test", (("a", BOX, GREY), ("b", BOX, GREY)))
    with StepRequest(job) as request:
        group = request._process.pid
        time.sleep(0.5)
    deadline = time.monotonic() + 5.0
    while living(group) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert living(group) == []


def living(group: int) -> list[str]:
    """Processes of a group, from /proc; zombies wait for their parent and do nothing."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        if int(fields[2]) == group and fields[0] != "Z":
            found.append(str(stat))
    return found
