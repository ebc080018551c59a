"""Command `python -m tools.fuzz.interrupt`: interrupt commands at random moments, and look at what they leave.

    python -m tools.fuzz.interrupt --cases 500 --seed 0 --out found

A batch is a folder with the files of an earlier run, or an empty one, in which one command is interrupted a few times
and then runs to its end. After each interruption, every file is that of the earlier run or that of the whole new one,
the files of each manifest are those it lists, the rows of a sweep are those of a whole sweep, and no process is left.
After the last run the folder equals that of a run without interruptions, and no temporary file is left. A part of the
batches starts fresh processes; the others fork this one, so that their time is spent in the work. The cases of a seed
are the same each time, but for the speed of the machine. Exit code 1: there is a fault.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import json
import random
import re
import shutil
import signal
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from fingertip.foundation.output_set import MANIFEST
from tools.fuzz.commands import COMMANDS, Command, write_inputs
from tools.fuzz.interruptible import SIGNALS, Interruption, Place, Run, load_modules

BATCH = 4
"""Interruptions before a run to the end."""
FRESH_SHARE = 0.2
"""Share of the batches that start fresh processes."""
EMPTY_SHARE = 0.25
"""Share of the batches that begin with an empty folder."""
LIMIT_S = 600.0
"""Time within which a command ends, on a machine with other work."""
END_LIMIT_S = 60.0
"""Time within which an interrupted command, and each process that it started, ends."""

Tree = dict[str, str]
"""Path of each file below a folder, and the hash of its content."""


@dataclass
class Reference:
    """Files and rows of a command without interruptions."""

    prior: Path | None
    """Folder with the files of the earlier run."""
    old: Tree
    new: Tree
    rows: list[str]
    code: int
    seconds: dict[bool, float]
    """Duration of a run, of a fresh process and of a fork [s]."""


@dataclass
class Tally:
    """Counts and faults of all cases."""

    ends: Counter[tuple[str, str, str]] = field(default_factory=Counter)
    """Number of cases by command, signal and how they ended."""
    faults: list[dict[str, object]] = field(default_factory=list)

    def add(self, command: Command, seed: int, kind: str, detail: object) -> None:
        """Add a fault."""
        fault = {"command": command.name, "seed": seed, "kind": kind, "detail": str(detail)[-2000:]}
        self.faults.append(fault)
        print(f"FAULT {json.dumps(fault)[:700]}", flush=True)


def read_tree(folder: Path) -> Tree:
    """Read the hashes of all files."""
    found: Tree = {}
    for path in sorted(folder.rglob("*")):
        if path.is_file() or path.is_symlink():
            found[path.relative_to(folder).as_posix()] = hashlib.sha256(path.read_bytes()).hexdigest()
    return found


def read_rows(folder: Path) -> list[str]:
    """Read the rows of a sweep as texts, in which NaN equals itself."""
    from fingertip.sweep.database import SweepDatabase

    if not SweepDatabase.exists(folder):
        return []
    with SweepDatabase.open(folder) as database:
        return [repr(row) for row in database.rows()]


def prepare(command: Command, top: Path) -> Reference:
    """Run a command without interruptions, before and after a change of its design."""
    folder = top
    seconds: dict[bool, float] = {}
    prior, old = None, {}
    place = Place(folder / "reference")
    if command.old:
        (place.work / "out").mkdir()
        _expect_end(command.old, place.run(command.old, None, fresh=True, limit_s=LIMIT_S))
        prior, old = folder / "prior", read_tree(place.work)
        shutil.copytree(place.work, prior)
    (place.work / "out").mkdir(exist_ok=True)
    modules = folder / "modules.txt"
    done = place.run(command.new, None, fresh=False, limit_s=LIMIT_S, modules=modules)
    _expect_end(command.new, done)
    new, rows = read_tree(place.work), read_rows(place.work / "out/boards") if command.is_sweep else []
    load_modules(modules)
    for fresh in (False, True):  # with all modules loaded, as in the cases
        with contextlib.suppress(OSError):
            (place.work / "out/tip.toml").unlink()
        shutil.rmtree(place.work / "out/boards", ignore_errors=True)
        again = place.run(command.new, None, fresh=fresh, limit_s=LIMIT_S)
        _expect_end(command.new, again)
        seconds[fresh] = again.seconds
    assert done.code is not None
    print(f"{command.name}: {seconds[False]:.1f} s, {seconds[True]:.1f} s from its start; {len(new)} files", flush=True)
    return Reference(prior, old, new, rows, done.code, seconds)


def _expect_end(words: tuple[str, ...], done: Run) -> None:
    if done.code not in (0, 1):
        raise SystemExit(f"{' '.join(words)}: exit code {done.code}: {done.stderr[-2000:]}")


def run_batch(command: Command, reference: Reference, top: Path, seed: int, count: int, tally: Tally) -> None:
    """Interrupt a command a few times in one folder, and then let it end."""
    rng = random.Random(f"{command.name} {seed}")
    fresh, empty = rng.random() < FRESH_SHARE, rng.random() < EMPTY_SHARE
    place = Place(top / f"{command.name}-{seed}")
    if reference.prior and (not empty or command.name == "page"):
        shutil.copytree(reference.prior, place.work, dirs_exist_ok=True)
    (place.work / "out").mkdir(exist_ok=True)
    before = len(tally.faults)
    for _ in range(count):
        number = rng.choice(SIGNALS)
        moment = Interruption(number, rng.uniform(0.0, 1.05) * reference.seconds[fresh])
        words = command.next if command.next and (place.work / "out/boards").exists() else command.new
        _make_way(command, reference, place)
        done = place.run(words, moment, fresh=fresh, limit_s=LIMIT_S)
        end = _judge_end(command, reference, seed, number, done, tally)
        tally.ends[command.name, number.name, end] += 1
        _look(command, reference, place, seed, tally)
    _make_way(command, reference, place)
    words = command.next if command.next and (place.work / "out/boards").exists() else command.new
    done = place.run(words, None, fresh=fresh, limit_s=LIMIT_S)
    if done.code != reference.code:
        tally.add(command, seed, "next run", f"exit code {done.code}: {done.stderr}")
    _compare_end(command, reference, place, seed, tally)
    if len(tally.faults) == before:
        shutil.rmtree(place.top, ignore_errors=True)


def _make_way(command: Command, reference: Reference, place: Place) -> None:
    """Remove a complete file that the command would not overwrite."""
    if command.keeps_file:
        for path in (place.work / "out").glob("[!.]*"):
            path.unlink()


def _judge_end(
    command: Command, reference: Reference, seed: int, number: signal.Signals, done: Run, tally: Tally
) -> str:
    """Judge exit code and messages of an interrupted run, and name its end."""
    if done.code is None:
        tally.add(command, seed, "hang", f"{number.name}: no end")
        return "hang"
    is_start = done.code == -number and not re.search(r"__main__\.py.*, in main", done.stderr)
    if "Traceback" in done.stderr or "Fatal Python error" in done.stderr or "Exception ignored" in done.stderr:
        if is_start:  # within the start of Python, before the first function of this program runs
            return "at the start"
        tally.add(command, seed, "traceback", f"{number.name}, exit code {done.code}: {done.stderr}")
        return "traceback"
    if done.code == reference.code:
        return "finished"
    if done.code == (-number if number == signal.SIGKILL else 128 + number):
        return "interrupted"
    if done.code == -number and not done.stderr.strip():
        return "at the start"  # or at the end, when nothing is left to undo
    if done.code == -number and done.stdout:
        return "at the end"
    tally.add(command, seed, "exit code", f"{number.name}: {done.code}: {done.stderr}")
    return f"exit code {done.code}"


def _look(command: Command, reference: Reference, place: Place, seed: int, tally: Tally) -> None:
    """Look at the files right after an interruption."""
    if left := place.wait_for_processes(END_LIMIT_S):
        names = [Path(f"/proc/{pid}/cmdline").read_bytes() for pid in left]
        tally.add(command, seed, "process left", names)
    if command.is_sweep:
        rows = read_rows(place.work / "out/boards")
        if len(set(rows)) != len(rows) or not set(rows) <= set(reference.rows):
            tally.add(command, seed, "rows", f"{len(rows)} rows, {len(set(rows) - set(reference.rows))} of them wrong")
        return
    mixed = []
    for folder in {path.parent for path in place.work.rglob("*")}:
        hidden = any(part.startswith(".") for part in folder.relative_to(place.work).parts)
        if hidden or (folder / ".fingertip-commit").exists():
            continue  # unfinished: the next run removes or completes it
        tree = {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir() if path.is_file()}
        name = folder.relative_to(place.work).as_posix()
        for file, digest in tree.items():
            at = f"{name}/{file}" if name != "." else file
            is_judged = not file.startswith(".") and file != MANIFEST
            if is_judged and digest not in (reference.old.get(at), reference.new.get(at)):
                mixed.append(at)
        # `make` adds acceptance sheet and page to parts of the same run: a manifest may list a part of the files.
        with contextlib.suppress(OSError):
            listed = json.loads((folder / MANIFEST).read_bytes())["files"]
            mixed += [f"{name}/{file}" for file, digest in listed.items() if tree.get(file) != digest]
            if not any(
                all(run.get(f"{name}/{file}") == digest for file, digest in listed.items())
                for run in (reference.old, reference.new)
            ):
                mixed.append(f"{name}/{MANIFEST}")
    if mixed:
        tally.add(command, seed, "mixed set", sorted(set(mixed)))


def _compare_end(command: Command, reference: Reference, place: Place, seed: int, tally: Tally) -> None:
    """Compare the folder after the last run with that of a run without interruptions."""
    if left := place.wait_for_processes(END_LIMIT_S):
        tally.add(command, seed, "process left", left)
    if command.is_sweep:
        rows = read_rows(place.work / "out/boards")
        if rows != reference.rows:
            missing = len(set(reference.rows) - set(rows))
            tally.add(command, seed, "rows", f"{len(rows)} rows, {missing} of {len(reference.rows)} lost")
    tree, wanted = read_tree(place.work), reference.new
    if command.is_sweep:  # the pages of a database depend on when its rows arrived
        tree, wanted = dict.fromkeys(tree, ""), dict.fromkeys(wanted, "")
    if tree != wanted:
        other = {name for name in tree.keys() | wanted.keys() if tree.get(name) != wanted.get(name)}
        tally.add(command, seed, "litter", sorted(other))
    if left_files := sorted(path.name for path in place.temporary.iterdir()):
        tally.add(command, seed, "temporary files", left_files)


def print_summary(tally: Tally) -> None:
    """Print how the cases ended, and the faults with their seeds."""
    ends = ("interrupted", "finished", "at the start", "at the end")
    print(f"{'command':12}{'signal':9}" + "".join(f"{end:>14}" for end in ends) + f"{'other':>8}")
    for command in COMMANDS:
        for number in SIGNALS:
            counts = {end: n for (c, s, end), n in tally.ends.items() if (c, s) == (command.name, number.name)}
            other = sum(counts.values()) - sum(counts.get(end, 0) for end in ends)
            if counts:
                row = "".join(f"{counts.get(end, 0):14d}" for end in ends)
                print(f"{command.name:12}{number.name:9}{row}{other:8d}")
    kinds = Counter(str(fault["kind"]) for fault in tally.faults)
    print(f"{tally.ends.total()} interruptions, {len(tally.faults)} faults")
    for kind, count in sorted(kinds.items()):
        seeds = sorted({f"{fault['command']} {fault['seed']}" for fault in tally.faults if fault["kind"] == kind})
        print(f"{count:6d}  {kind}: {', '.join(seeds)[:300]}")


def run_cases(
    cases: int, seed: int, names: list[str], folder: Path, tally: Tally, *, time_limit_s: float = float("inf")
) -> None:
    """Run a number of cases of some commands, shared out among them, within a folder."""
    begun = time.monotonic()
    folder.mkdir(parents=True, exist_ok=True)
    write_inputs(folder / "inputs")
    chosen = [command for command in COMMANDS if command.name in names]
    shares = sum(command.share for command in chosen)
    # Commands that take long come last, so that a run that is cut short has most of its cases.
    for command in sorted(chosen, key=lambda one: -one.share):
        # The inputs stand beside the folder in which a command works.
        top = folder / f"of-{command.name}"
        top.mkdir()
        wanted = max(1, round(cases * command.share / shares))
        reference: Reference | None = None
        for batch, first in enumerate(range(0, wanted, BATCH)):
            if time.monotonic() - begun > time_limit_s:
                print(f"{command.name}: stopped at the time limit after {first} of {wanted} cases", flush=True)
                break
            reference = reference or prepare(command, top)
            run_batch(command, reference, top, seed * 10_000 + batch, min(BATCH, wanted - first), tally)
        if reference:
            print(f"{command.name}: ended after {time.monotonic() - begun:.0f} s", flush=True)


def main() -> int:
    """Run the command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("--cases", type=int, default=500)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--commands", default=",".join(command.name for command in COMMANDS))
    parser.add_argument("--time-limit-s", type=float, default=float("inf"), help="begin no batch after this time")
    parser.add_argument("--out", type=Path, help="folder in which the cases with a fault are kept")
    options = parser.parse_args()
    tally = Tally()
    with contextlib.ExitStack() as stack:
        folder = options.out or Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="fingertip-interrupt-")))
        run_cases(
            options.cases, options.seed, options.commands.split(","), folder.resolve(), tally,
            time_limit_s=options.time_limit_s,
        )  # fmt: skip
    print_summary(tally)
    if options.out:
        (options.out / "faults.json").write_text(json.dumps(tally.faults, indent=1) + "\n", encoding="utf-8")
    return 1 if tally.faults else 0


if __name__ == "__main__":
    raise SystemExit(main())
