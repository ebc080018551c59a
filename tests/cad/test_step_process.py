"""STEP process and its forked process: files, errors and crashes of either one, and the end of both."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from fingertip.cad.files.step_process import StepJob, StepProcess
from fingertip.design.geometry.solids import Box, Solid, difference
from fingertip.foundation.errors import GeometryError

GREY = (0.5, 0.5, 0.5)
BOX = Box((0.0, 0.0, 0.0), (1.0, 2.0, 3.0))
EMPTY = difference(BOX, Box((-1.0, -1.0, -1.0), (4.0, 4.0, 4.0)))


class CrashingSolid:
    """Object that ends the process which evaluates it, as a crash of the kernel does."""

    def __hash__(self) -> int:
        os._exit(9)


def make_step_files(*solids: Solid) -> dict[str, bytes]:
    job = StepJob("test", tuple((f"part{i}", solid, GREY) for i, solid in enumerate(solids)))
    with StepProcess(job) as process:
        return process.result().contents


def test_files_of_both_processes_are_returned() -> None:
    names = [*(f"part{i}" for i in range(3)), "assembly"]
    assert sorted(make_step_files(BOX, BOX, BOX)) == sorted(f"{name}.step" for name in names)


@pytest.mark.full
def test_job_with_a_single_part() -> None:
    assert sorted(make_step_files(BOX)) == ["assembly.step", "part0.step"]


@pytest.mark.full
@pytest.mark.parametrize("position", [0, 1])
def test_invalid_solid_is_reported_by_either_process(position: int) -> None:
    solids: list[Solid] = [BOX, BOX]
    solids[position] = EMPTY
    with pytest.raises(GeometryError, match="one valid solid was expected"):
        make_step_files(*solids)


@pytest.mark.full
@pytest.mark.parametrize("position", [0, 1])
def test_crash_is_reported_in_either_process(position: int) -> None:
    solids: list[Solid] = [BOX, BOX]
    solids[position] = CrashingSolid()  # type: ignore[call-overload]
    with pytest.raises(GeometryError, match="the B-rep kernel crashed"):
        make_step_files(*solids)


def test_no_process_outlives_the_context_manager() -> None:
    job = StepJob("test", (("a", BOX, GREY), ("b", BOX, GREY)))
    with StepProcess(job) as process:
        group = process._process.pid
        time.sleep(0.5)
    deadline = time.monotonic() + 5.0
    while running_processes(group) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert running_processes(group) == []


def running_processes(group: int) -> list[str]:
    """List the processes of a group from /proc, without zombies."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        if int(fields[2]) == group and fields[0] != "Z":
            found.append(str(stat))
    return found
