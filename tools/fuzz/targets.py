"""Command `python -m tools.fuzz.targets`: damage what this program finds on disk, and see what it
makes of that.

    python -m tools.fuzz.targets --cases 400     the same cases each time, by Hypothesis

A target is a function of bytes: it puts them where the program meets a manifest, the plan of an
unfinished replacement, a sweep's database, a layout that somebody edited in KiCad, or a recording;
or takes them for odd arguments of a public function. It may raise the errors of the program and
nothing else, and it asserts what must hold then. Exit code 1: there is a fault, whose bytes are
printed.
"""

from __future__ import annotations

import argparse
import contextlib
import inspect
import os
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path

import numpy as np
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

import fingertip
from fingertip.board.kicad.netlist import CircuitRecord, read_netlist
from fingertip.design import Design
from fingertip.foundation.errors import FingertipError
from fingertip.foundation.output_set import SetWriter, read_manifest
from fingertip.slip.traces.read import read_trace
from fingertip.sweep.database import SweepDatabase
from fingertip.tasks.board_files import plan_board
from fingertip.tasks.edited_board import enter_texts, enter_values
from fingertip.tasks.manifest_comparison import verify_sets
from tools.fuzz import originals
from tools.fuzz.damage import damaged


@contextlib.contextmanager
def _place() -> Iterator[Path]:
    """Give a folder within one whose other file must stay as it is."""
    with tempfile.TemporaryDirectory() as top:
        folder = Path(top) / "set"
        other = Path(top) / "other.txt"
        folder.mkdir()
        other.write_bytes(b"somebody's own")
        yield folder
        assert other.read_bytes() == b"somebody's own"
        assert {path.name for path in Path(top).iterdir()} <= {"set", "other.txt"}


def _check_set(folder: Path) -> None:
    """Verify a set, write a new one in its place, and verify that."""
    (folder / "own.txt").write_bytes(b"somebody's own")
    with contextlib.suppress(FingertipError):
        verify_sets(folder)

    with contextlib.suppress(FingertipError):
        SetWriter(folder, "parts", "tip", "0" * 64).write({"a.txt": b"new"})
        assert (folder / "a.txt").read_bytes() == b"new"
        assert read_manifest(folder) is not None
        assert verify_sets(folder)[1] == []


def try_manifest(data: bytes) -> None:
    """Meet a manifest. What it does not own stays, in its folder and outside."""
    with _place() as folder:
        (folder / "manifest.json").write_bytes(data)
        (folder / "a.txt").write_bytes(b"old")
        _check_set(folder)


def try_plan(data: bytes) -> None:
    """Meet the plan of a replacement that was interrupted. Nothing outside the folder changes."""
    with _place() as folder:
        commit = folder / ".fingertip-commit"
        commit.mkdir()
        (commit / "complete.json").write_bytes(data)
        for name in ("new-a.txt", "new-manifest.json"):
            (commit / name).write_bytes(b"new")

        _check_set(folder)


def try_database(data: bytes) -> None:
    """Meet the database of a sweep. Its rows are those of its plan."""
    with tempfile.TemporaryDirectory() as top, contextlib.suppress(FingertipError):
        (Path(top) / "sweep.sqlite").write_bytes(data)
        with SweepDatabase.open(Path(top)) as database:
            count = len(database.find_missing_points())
            assert all(0 <= row.point < count for row in database.rows())
            assert database.table() is not None
            database.count_by_status()


@cache
def _boards() -> tuple[Mapping[str, bytes], Mapping[str, bytes], CircuitRecord, CircuitRecord]:
    """Files and circuits of two boards that differ in values."""
    plans = [
        plan_board(Design(board={"cutoff_hz": cutoff_hz}), Path("none")).files
        for cutoff_hz in (67.0, 80.0)
    ]
    records = [read_netlist(files["slip_filter.net"]) for files in plans]
    short = [
        {name: _shorten(data) for name, data in files.items() if "kicad_" in name}
        for files in plans
    ]

    return short[0], short[1], records[0], records[1]


def _shorten(data: bytes) -> bytes:
    """Keep the lists of R1, R2 and R3, which change, and a few
    others: a case takes as long as its file.
    """
    head, *lists = data.decode().removesuffix(")\n").split("\n  (")
    kept = [
        text
        for i, text in enumerate(lists)
        if i % 20 == 0 or any(f'"R{n}"' in text for n in (1, 2, 3))
    ]
    return "\n  (".join([head, *kept]).encode() + b")\n"


def _edit(data: bytes, name: str, kind: str) -> None:
    before, after, old, new = _boards()
    with contextlib.suppress(ValueError):  # a sentence says so
        edited, _, problems = enter_values(data, kind, old, new)
        if not problems:
            assert enter_values(edited, kind, new, new) == (edited, [], [])
        if kind == "footprint":
            enter_texts(edited, before[name], after[name])


def try_layout(data: bytes) -> None:
    """Meet a layout that somebody edited. Values that are entered are there, and can be read."""
    _edit(data, "slip_filter.kicad_pcb", "footprint")


_LIGHT = frozenset(
    {
        "Trace",
        "Trial",
        "CampaignPlan",
        "Readout",
        "calibrate_printer",
        "calibrate_sensor",
        "detect",
        "detect_file",
        "detect_stream",
        "read_trace",
        "read_weighings",
    }
)
"""Public names that may get a design: others would work for minutes."""
_ODD: tuple[object, ...] = (
    None,
    True,
    0,
    -1,
    1.5,
    float("nan"),
    float("inf"),
    10**400,
    "",
    "fsr400",
    "\0",
    b"x",
    Path("x"),
    [],
    [1.0, 2.0],
    [None],
    {},
    {"a": 1},
    {5: 5},
    (1,),
    ("a", "b"),
    object(),
    np.zeros(3),
    np.zeros((3, 5)),
    np.float64(2e3),
)


def try_call(data: bytes) -> None:
    """Call a public function with odd values: it works, or raises an
    error of its own that names an argument.
    """
    names = [
        name
        for name in fingertip.__all__
        if callable(getattr(fingertip, name)) and not name.endswith("Error")
    ]
    name, *rest = names[data[0] % len(names) if data else 0], *data[1:]
    parameters = list(inspect.signature(getattr(fingertip, name)).parameters.values())
    values = {
        each.name: _ODD[byte % len(_ODD)] for each, byte in zip(parameters, rest, strict=False)
    }
    values |= {
        each.name: Design() for each in parameters if each.name == "design" and name in _LIGHT
    }

    if all(each.name in values or each.default is not each.empty for each in parameters):
        with (
            tempfile.TemporaryDirectory() as top,
            contextlib.chdir(top),
            contextlib.suppress(FingertipError),
        ):
            getattr(fingertip, name)(**values)


def try_recording(data: bytes) -> None:
    """Meet a recording, whose first byte tells its kind. What is read is finite, and in order."""
    names = sorted(originals.recordings())
    with tempfile.TemporaryDirectory() as top, contextlib.suppress(FingertipError):
        path = Path(top) / names[data[0] % len(names) if data else 0]
        path.write_bytes(data[1:])
        trace = read_trace(path, rate_hz=None)
        assert np.isfinite(trace.voltage_v).all()


@cache
def list_examples(name: str) -> list[bytes]:
    """Valid bytes for a target."""
    recordings = [
        bytes([i]) + data for i, (_, data) in enumerate(sorted(originals.recordings().items()))
    ]
    plan = (
        b'{"files": {"a.txt": "nothing", "manifest.json": "nothing"}, "removed": {"b.txt": "no '
        b'file"}}'
    )
    examples: Mapping[str, list[bytes]] = {
        "manifest": [originals.board_folder()["manifest.json"]],
        "plan": [plan],
        "database": [originals.sweep_database()],
        "layout": [_boards()[0]["slip_filter.kicad_pcb"]],
        "call": [bytes([i, j, *range(j, j + 8)]) for i in range(60) for j in range(len(_ODD))],
        "recording": recordings,
    }

    return examples[name]


TARGETS: Mapping[str, Callable[[bytes], None]] = {
    "manifest": try_manifest,
    "plan": try_plan,
    "database": try_database,
    "layout": try_layout,
    "call": try_call,
    "recording": try_recording,
}


def run_hypothesis(name: str, count: int, first_seed: int) -> None:
    """Try a target with damaged and random bytes."""

    @seed(first_seed)
    @settings(
        max_examples=count,
        database=None,
        deadline=None,
        phases=(Phase.generate,),
        suppress_health_check=list(HealthCheck),
        print_blob=False,
    )
    @given(
        st.one_of(
            st.binary(max_size=60), *[st.sampled_from(list_examples(name)).flatmap(damaged)] * 9
        )
    )
    def try_data(data: bytes) -> None:
        TARGETS[name](data)

    try_data()


def run_each(run: Callable[[str], None], names: Iterable[str]) -> int:
    """Run something for each target, in a process of its own; return 1 if one of them fails."""
    codes = []
    for name in names:
        begun = time.monotonic()
        pid = os.fork()
        if not pid:
            code = 1
            try:
                run(name)
                code = 0
            except Exception:
                traceback.print_exc()
            finally:
                sys.stderr.flush()
                os._exit(code)

        codes.append(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]))
        print(
            f"{name}: {'FAULT' if codes[-1] else 'no fault'} after "
            f"{time.monotonic() - begun:.0f} s",
            flush=True,
        )

    return int(any(codes))


def main() -> int:
    """Run the command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("--targets", default=",".join(TARGETS))
    parser.add_argument("--cases", type=int, default=400, help="cases of each target")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()

    return run_each(
        lambda name: run_hypothesis(name, options.cases, options.seed), options.targets.split(",")
    )


if __name__ == "__main__":
    raise SystemExit(main())
