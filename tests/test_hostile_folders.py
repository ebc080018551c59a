"""Folders from a stranger: whatever stands in one, no command reads, writes or removes a file outside it.

A folder with every set of a design stands beside the files of a victim, which are the same files, so that a link to
them looks right to whoever follows it. In each case something hostile takes the place of one file or folder, and a
command names the folder. The files of the victim then have the times of before (a file that was read has a newer time
of access), nothing outside was opened, and the command has ended with a documented exit code.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import os
import shutil
import sqlite3
import stat
import struct
import sys
import urllib.parse
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import typer

from fingertip.board.fabrication.fabrication_files import provenance_record
from fingertip.cad.shapes.parts import parts_by_name
from fingertip.catalogues.output_files import FAB_FOLDER, PART_FILES, PRINTS, PROVENANCE, REPORT, SHEET, SIGNAL, STEPS
from fingertip.cli import app
from fingertip.cli.options import read_design
from fingertip.design import Design
from fingertip.foundation import files as output_files
from fingertip.foundation.errors import OutputError
from fingertip.foundation.files import write_file
from fingertip.foundation.folder_swap import recover
from fingertip.foundation.output_set import MANIFEST, SetWriter, hash_parameters, read_manifest
from fingertip.slip.traces.truth import Origin, read_origin
from fingertip.tasks import verification
from fingertip.tasks.board import board_files, plan_board, write_board
from fingertip.tasks.firmware import firmware_files, write_firmware
from fingertip.tasks.verification import verify_sets
from tests.conftest import run_fingertip, run_python
from tools.fuzz import in_process, originals
from tools.fuzz.cases import Case
from tools.fuzz.outcome import find_faults

pytestmark = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="links and pipes are made, NOT TESTED HERE")

TOP = "out/fsr400"
COMMIT = ".fingertip-commit"
TRACE = "time_s,voltage_v\n" + "".join(f"{i / 1000:.3f},{1 + i % 7 / 100:.2f}\n" for i in range(600))


@dataclass(frozen=True)
class Command:
    """A command, and the folder that it names."""

    words: tuple[str, ...]
    folder: str
    sets: tuple[str, ...] = ("",)
    """Folders below it whose files it reads or replaces."""
    writes: bool = False
    codes: tuple[int, ...] = (0, 1, 2)
    """Exit codes that it may have if one of these files is hostile."""


BOARD = f"{TOP}/board"
COMMANDS = {
    "check": Command(
        ("check", TOP),
        TOP,
        ("", "print", "steps", "board", "board/fab", "board/3d", "signal", "firmware", "firmware/src"),
        codes=(1, 2),
    ),
    "board --check": Command(("board", "fsr400", "--check", "--out", BOARD), BOARD, ("", "fab", "3d")),
    "firmware --check": Command(
        ("firmware", "fsr400", "--check", "--out", f"{TOP}/firmware"), f"{TOP}/firmware", ("", "src")
    ),
    "page": Command(("page", "fsr400", "--out", TOP), TOP, ("", "steps", "board", "signal"), True, (2,)),
    "detect": Command(("detect", f"{TOP}/signal/trace.csv"), f"{TOP}/signal"),
    "board": Command(("board", "fsr400", "--out", BOARD), BOARD, ("", "fab", "3d"), True),
    "board --force": Command(
        ("board", "fsr400", "--set", "board.cutoff_hz=60", "--force", "--out", BOARD), BOARD, writes=True
    ),
    "firmware": Command(("firmware", "fsr400", "--out", f"{TOP}/firmware"), f"{TOP}/firmware", ("", "src"), True, (2,)),
}
REFUSED = {
    "build": (("build", "fsr400", "--formats", "stl", "--out", TOP), (".", "print")),
    "make": (("make", "fsr400", "--formats", "stl"), (".", "board", "signal")),
    "drawing": (("drawing", "fsr400"), (".",)),
    "picture": (("picture", "fsr400"), (".",)),
    "acceptance": (("acceptance", "fsr400"), (".",)),
    "simulate": (("simulate",), ("signal",)),
    "validate": (("validate", "fsr400", "--out", f"{TOP}/new"), ("new",)),
    "sheet": (("sheet", "fsr400"), (".",)),
}
"""Commands that work for long, and folders in which they find a damaged plan before they begin."""


def make_device(path: Path) -> None:
    if os.geteuid() == 0:
        os.mknod(path, stat.S_IFCHR | 0o666, os.makedev(1, 5))  # /dev/zero
    else:
        path.symlink_to("/dev/zero")


def make_huge(path: Path) -> None:
    path.touch()
    os.truncate(path, 2**41)


KINDS: dict[str, Callable[[Path, Path], object]] = {
    "link": lambda path, victim: path.symlink_to(victim),
    "link to nothing": lambda path, victim: path.symlink_to(victim.with_name("planted")),
    "link to itself": lambda path, victim: path.symlink_to(path),
    "link to a folder": lambda path, victim: path.symlink_to(victim.parent),
    "pipe": lambda path, victim: os.mkfifo(path),
    "device": lambda path, victim: make_device(path),
    "folder": lambda path, victim: path.mkdir(),
    "huge": lambda path, victim: make_huge(path),
    "junk": lambda path, victim: path.write_bytes(b'{"\xff\0'),
    "deep": lambda path, victim: path.write_bytes(b"[" * 100_000),
}
"""What takes the place of a file, given its path and that of the same file of the victim."""


cached_board_files, cached_firmware_files = cache(board_files), cache(firmware_files)
COMMAND_LINE = typer.main.get_command(app)


@cache
def cached_read(file: Path | None, changes: tuple[str, ...]) -> tuple[Design, bool]:
    return read_design(file, changes)


# The machinery: a world with a victim, and a guard that sees what is opened


class Guard:
    """Watcher of what this process opens or changes, by audit events."""

    def __init__(self) -> None:
        self.world: Path | None = None
        self.allowed: tuple[str, ...] = ()
        self.found: list[str] = []
        sys.addaudithook(self._hear)

    def _hear(self, event: str, arguments: tuple[Any, ...]) -> None:
        if self.world is None or not event.startswith(("open", "os.", "shutil.", "sqlite3.connect")):
            return
        world, self.world = self.world, None  # what this function does itself is no finding
        try:
            for place in arguments[1:2] if event == "os.symlink" else arguments[:2]:
                if isinstance(place, str | bytes | os.PathLike):
                    self._judge(event, os.fsdecode(place), world)
        finally:
            self.world = world

    def _judge(self, event: str, text: str, world: Path) -> None:
        if event == "sqlite3.connect":
            text = urllib.parse.unquote(text.removeprefix("file:").partition("?")[0])
        path = os.path.join(world, text)
        if "\0" in text or not ("/" in text or os.path.lexists(path)):
            return  # a name relative to an open folder
        if event in ("open", "os.listdir", "os.scandir", "os.chmod", "os.truncate", "os.utime", "sqlite3.connect"):
            path = os.path.realpath(path)
        else:  # the link itself, not its target
            path = os.path.join(os.path.realpath(os.path.dirname(path)), os.path.basename(path))
        inside = any(path == place or path.startswith(place + os.sep) for place in self.allowed)
        above = os.path.isdir(path) and any(place.startswith(path + os.sep) for place in self.allowed)
        if path.startswith(f"{world}{os.sep}") and not inside and not above:
            self.found.append(f"{event} {path.removeprefix(str(world))}")
        is_odd = os.path.exists(path) and not os.path.isfile(path) and not os.path.isdir(path)
        if event == "open" and text != os.devnull and is_odd:
            self.found.append(f"{event} {text}, a pipe or device")


GUARD = Guard()


@dataclass(frozen=True)
class World:
    """Folder with the files of a victim and the folder that a stranger sent."""

    path: Path
    master: Path

    @property
    def victim(self) -> Path:
        return self.path / "victim"

    def renew(self) -> None:
        """Put the stranger's folder there anew."""
        shutil.rmtree(self.path / "out", ignore_errors=True)
        shutil.copytree(self.master, self.path / "out", copy_function=os.link)

    def look(self, folder: Path, *, without: bool) -> dict[str, tuple[int, ...]]:
        """Kind, mode, size and times of everything; without a folder and what a command makes beside it, or with it."""
        top, found = str(folder), dict[str, tuple[int, ...]]()
        left_out = (top, str(folder.with_name(f".{folder.name}.fingertip"))) if without else ()
        for place, folders, files in os.walk(self.path):
            folders[:] = [name for name in folders if os.path.join(place, name) not in left_out]
            for name in (*folders, *files):
                path = os.path.join(place, name)
                status = os.lstat(path)
                times = [status.st_mtime_ns, status.st_ctime_ns, status.st_atime_ns]
                # Files in the folder may be read. A folder that is read here has a new time of access too, and one in
                # which something was made for a moment a new time.
                kept = 2 if path.startswith(top + os.sep) else 3
                found[path] = (status.st_mode, status.st_ino, status.st_size, *times[: kept * (name in files)])
        return found

    def run(self, command: Command, codes: tuple[int, ...] = (), label: object = "") -> list[str]:
        """Run a command that names a folder, and return what is wrong with that, after a label."""
        top = self.path / command.folder
        before = self.look(top, without=command.writes)
        GUARD.allowed = (str(top), str(top.with_name(f".{top.name}.fingertip")))
        GUARD.found, GUARD.world = [], self.path
        case = Case("hostile", command.words, may_fail=True, limit_s=5.0)
        try:
            outcome = in_process.run(case, self.path)
        finally:
            GUARD.world = None
        faults = [fault for fault in find_faults(case, outcome, self.path) if not fault.startswith("memory")]
        faults += GUARD.found
        after = self.look(top, without=command.writes)
        faults += [f"changed {name}" for name in before.keys() | after.keys() if before.get(name) != after.get(name)]
        if outcome.code not in (codes or command.codes) and not faults:
            faults.append(f"exit code {outcome.code}: {outcome.stdout[-300:]}{outcome.stderr[-300:]}")
        return [f"{label}: {fault}" for fault in faults]


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> World:
    """The folder of a design with all its sets, some of them small fakes, and the victim's copy of it."""
    base, design = tmp_path_factory.mktemp("hostile"), Design()
    top = base / "master" / "fsr400"
    parts = {f"{name}.stl": name.encode() for name in parts_by_name(design)} | {REPORT: b"{}", SHEET: b"# Casting\n"}
    PART_FILES.writer(design, top).write(parts)
    PRINTS.writer(design, top / "print", top=top).write({"bone.stl": b"bone"})
    STEPS.writer(design, top / "steps", top=top).write({"1.png": b"picture"})
    SIGNAL.writer(design, top / "signal").write({"trace.csv": TRACE.encode(), "detection.json": b'{"motion_s": 0.3}'})
    write_board(design, top / "board")
    fab = {"slip_filter_gerbers.zip": b"gerbers"}
    fab[PROVENANCE] = provenance_record(board_files(design), fab)
    parameters = hash_parameters(design.model_dump(mode="json"))
    SetWriter(top / "board/fab", "fabrication", design.name, parameters).write(fab)
    write_firmware(design, top / "firmware")
    sweep = base / "master" / "sweep"
    sweep.mkdir()
    (sweep / "sweep.sqlite").write_bytes(originals.sweep_database())
    shutil.copytree(base / "master", base / "world" / "victim", copy_function=shutil.copy)
    for path in (base / "world").rglob("*"):
        os.utime(path, (1, 2))  # read before it was written, so that reading it gives it a new time of access
    return World(base / "world", base / "master")


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Short limits of time, and contents that follow from the same design computed once."""
    monkeypatch.setattr(in_process, "WAIT_LIMIT_S", 10.0)
    monkeypatch.setattr("fingertip.tasks.board.board_files", lambda design: dict(cached_board_files(design)))
    monkeypatch.setattr("fingertip.cli.app", COMMAND_LINE)
    monkeypatch.setattr("fingertip.cli.options.read_design", cached_read)
    monkeypatch.setattr("fingertip.tasks.firmware.firmware_files", cached_firmware_files)


def put(path: Path, kind: str, victim: Path) -> None:
    """Let something hostile take the place of a file or folder."""
    remove(path)
    KINDS[kind](path, victim)


def remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        path.chmod(0o700)
        shutil.rmtree(path)
    path.unlink(missing_ok=True)


@pytest.mark.full
def test_what_is_as_written_passes(world: World) -> None:
    world.renew()
    for name, command in COMMANDS.items():
        codes = (2,) if name == "page" else (0,)  # its parts are no STL files
        assert world.run(command, codes) == [], name


def list_files(world: World, command: Command) -> Iterator[str]:
    """Paths of the files that a command reads or replaces, below `out`."""
    for place in command.sets:
        folder = world.master / Path(command.folder).relative_to("out") / place
        for path in sorted(folder.rglob("*") if place == "3d" else folder.iterdir()):
            file = path.relative_to(world.master).as_posix()
            if (
                path.is_file() and path.name != ".gitattributes" and f"out/{file}" not in command.words
            ):  # a file that is named may be a link
                yield file


def find_faults_with(world: World, command: Command, cases: Iterable[tuple[str, str]]) -> list[str]:
    """Run a command with something hostile in the place of one file after the other."""
    faults = []
    world.renew()
    for file, kind in cases:
        path = world.path / "out" / file
        put(path, kind, world.victim / file)
        faults += world.run(command, label=f"{file} as {kind}")
        if command.writes:
            world.renew()
        else:
            remove(path)
            os.link(world.master / file, path)
    return faults[:10]


@pytest.mark.parametrize("name", COMMANDS)
def test_hostile_files(world: World, name: str) -> None:
    """The files of the set and some of those below it as a link, and one with its manifest as everything."""
    sets: dict[str, list[str]] = {}
    for file in list_files(world, COMMANDS[name]):
        sets.setdefault(file.rpartition("/")[0], []).append(file)
    some = [file for folder, found in sets.items() for file in (found[0], f"{folder}/{MANIFEST}")]
    links = (file for file in (*next(iter(sets.values())), *some))
    cases = {(file, kind): None for kind in KINDS for file in some[:2]} | {(file, "link"): None for file in links}
    assert find_faults_with(world, COMMANDS[name], cases) == []


# Names


NAMES = (
    "../victim/t", "/victim/t", "a/../../victim/t", "a\\b", "C:t", "..", ".", "", "a\0b", "nul.txt", "COM1", "t.", "t ",
    "x" * 300, "\ud800", ".fingertip-commit", ".FINGERTIP-commit", "\x1b[31m",
)  # fmt: skip
"""Names that a plan or a manifest may state, and that are of no file in its folder."""


def make_plan(commit: Path, data: Any) -> None:
    commit.mkdir(parents=True)
    (commit / "complete.json").write_bytes(data if isinstance(data, bytes) else json.dumps(data).encode())


def test_a_plan_or_a_manifest_that_names_anything_but_files_of_its_folder_is_refused(tmp_path: Path) -> None:
    """Nothing of such a plan is carried out, and no command compares or removes what such a manifest names."""
    plans: list[Any] = [*({"files": {name: "nothing"}, "removed": {}} for name in NAMES)]
    plans += ({"files": {}, "removed": {name: "nothing"}} for name in NAMES)
    plans += (
        {"files": {"bom.csv": ""}, "removed": {"BOM.csv": ""}}, {"files": {"\xe9": ""}, "removed": {"e\u0301": ""}},
        {"files": {"src": ""}, "removed": {}}, {"files": ["bom.csv"], "removed": []}, b"", b"x", b"\xff", b"[]", b"{}",
        b"[" * 100_000, b'{"files": 1, "removed": []}', b"9" * 5000,
    )  # fmt: skip
    (tmp_path / "src").mkdir()
    for plan in plans:
        make_plan(tmp_path / COMMIT, plan)
        with pytest.raises((OutputError, OSError), match=r"complete|name too long"):
            recover(tmp_path)
        shutil.rmtree(tmp_path / COMMIT)
    SetWriter(tmp_path, "board", "finger", "a").write({"bom.csv": b"1"})
    own = json.loads((tmp_path / MANIFEST).read_bytes())
    changes: list[dict[str, Any]] = [{"files": {name: hashlib.sha256(b"t").hexdigest()}} for name in NAMES]
    changes += ({"files": files} for files in ({"a": "0" * 64, "A": "0" * 64}, {"a": 5}, {"a": "../"}, [], None))
    changes += ({key: value} for key in ("kind", "design", "parameters") for value in (None, [], 5))
    assert read_manifest(tmp_path) is not None
    for change in changes:
        (tmp_path / MANIFEST).write_text(json.dumps(own | change))
        assert read_manifest(tmp_path) is None, change


def test_a_plan_leaves_alone_what_it_cannot_know(tmp_path: Path) -> None:
    """A file of one's own is neither removed nor overwritten by a plan that a stranger has left in a folder."""
    (tmp_path / "mine.txt").write_text("mine")
    digest = hashlib.sha256(b"theirs").hexdigest()
    for before in ("nothing", digest, ""):
        for data in ({"files": {"mine.txt": before}, "removed": {}}, {"files": {}, "removed": {"mine.txt": before}}):
            make_plan(tmp_path / COMMIT, data)
            (tmp_path / COMMIT / "new-mine.txt").write_text("theirs")
            recover(tmp_path)
            assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
            assert (tmp_path / "mine.txt").read_text() == "mine"
    (tmp_path / "link").symlink_to("mine.txt")
    for data in ({"files": {"link": "no file"}, "removed": {}}, {"files": {}, "removed": {"link": "no file"}}):
        make_plan(tmp_path / COMMIT, data)
        (tmp_path / COMMIT / "new-link").write_text("theirs")
        recover(tmp_path)
        assert (tmp_path / "link").is_symlink()
    make_plan(tmp_path / COMMIT, {"files": {"mine.txt": "nothing"}, "removed": {}})
    (tmp_path / COMMIT / "new-mine.txt").mkdir()
    with pytest.raises(OutputError, match=r"damaged complete\.json"):
        recover(tmp_path)


def test_a_board_of_make_does_not_follow_a_link_that_took_its_folders_place(tmp_path: Path) -> None:
    top, victim = tmp_path / "made", tmp_path / "victim"
    victim.mkdir()
    plan = plan_board(Design.load("fsr400"), top / "board", top=top)
    plan.write(print)
    remove(top / "board")
    (top / "board").symlink_to(victim)
    with pytest.raises(OutputError, match="is a link"):
        plan.write(print)
    assert not any(victim.iterdir())


def test_names_that_a_set_may_not_have_are_refused_before_they_are_written(tmp_path: Path) -> None:
    writer = SetWriter(tmp_path, "board", "finger", "a")
    writer.write({"bom.csv": b"1"})
    for name in ("BOM.csv", "a:b.csv", "con", ".fingertip-x", "\ud800", "x" * 241):
        with pytest.raises(OutputError, match="has a name that not every system can store there; choose another one"):
            writer.write({name: b"2"})
    assert verify_sets(tmp_path) == (1, [])


def test_provenance_names_files_of_its_folder_only(world: World) -> None:
    world.renew()
    record = world.path / BOARD / FAB_FOLDER / PROVENANCE
    text = record.read_text()
    faults = []
    for name in (str(world.victim / "sweep/sweep.sqlite"), "./../../../../victim/sweep/sweep.sqlite"):
        record.unlink()
        record.write_text(f"{text}{'0' * 64}  {name}\n")
        faults += world.run(COMMANDS["board --check"], (1,), name)
    assert faults == []


# Links in the place of folders, and what a killed command seems to have left


def link_out(path: Path, target: Path) -> None:
    remove(path)
    path.symlink_to(target)


@pytest.mark.parametrize(
    ("name", "places"),
    [
        ("check", ("print", "steps", "board", "signal", "board/fab", "board/3d", "firmware")),
        ("page", ("print", "steps", "board", "signal")),
        ("board --check", ("fab", "3d", "3d/Resistor_SMD.3dshapes")),
        ("board", ("fab", "3d", "3d/Resistor_SMD.3dshapes")),
        ("firmware", ("src", "examples", "examples/slip_pin")),
        ("firmware --check", ("src", "examples", "examples/slip_pin")),
    ],
)
def test_folders_that_are_links(world: World, name: str, places: tuple[str, ...]) -> None:
    command, faults = COMMANDS[name], []
    codes = {"page": (2,), "firmware": (2,)}.get(name, (0, 2) if command.writes else (1,))
    for place in places:
        world.renew()
        path = world.path / command.folder / place
        link_out(path, world.victim / Path(command.folder).relative_to("out") / place)
        codes = (2,) if name == "board" and place != "fab" else codes
        faults += world.run(command, codes, place)
    assert faults == []


@pytest.mark.parametrize("name", REFUSED)
def test_commands_that_work_for_long_refuse_a_damaged_plan_or_a_link_before_they_begin(world: World, name: str) -> None:
    words, places = REFUSED[name]
    plan = {"files": {}, "removed": {"../../victim/fsr400/report.json": ""}}
    linked, faults = ("print", "board", "signal") if name == "make" else (), []
    for place, is_linked in (*((place, False) for place in places), *((place, True) for place in linked)):
        world.renew()
        if is_linked:
            link_out(world.path / TOP / place, world.victim / "fsr400" / place)
        else:
            make_plan(world.path / TOP / place / COMMIT, plan)
        faults += world.run(Command(words, TOP, writes=True), (2,), f"{place}, {is_linked=}")
    assert faults == []


def leave_hostile(world: World) -> Iterator[tuple[str, Callable[[Path], object]]]:
    """Ways to fill the places of what a killed command leaves, given the output folder."""
    victim = world.victim / "fsr400"

    def stage(folder: Path) -> Path:
        path = folder.with_name(f".{folder.name}.fingertip")
        path.mkdir()
        return path

    yield "staging link", lambda f: f.with_name(f".{f.name}.fingertip").symlink_to(victim)
    yield "staging of a link", lambda f: (link_out(f / "src", victim / "firmware/src"), stage(f / "src"))
    yield "staging pipe", lambda f: os.mkfifo(f.with_name(f".{f.name}.fingertip"))
    yield "link in staging", lambda f: (stage(f) / "print").symlink_to(victim / "print")
    yield "plan in staging", lambda f: make_plan(stage(f) / COMMIT, {"files": {}, "removed": {"mine.txt": ""}})
    yield "closed staging", lambda f: stage(f).chmod(0)
    yield "commit link", lambda f: (f / COMMIT).symlink_to(victim)
    yield "commit file", lambda f: (f / COMMIT).write_bytes(b"")
    yield "version 0.1 link", lambda f: (f / ".fingertip-abcdefgh").symlink_to(victim)
    yield "trial link", lambda f: (f / ".fingertip-trial").symlink_to(victim)
    yield "trial folder", lambda f: link_in(f / ".fingertip-trial", victim)
    yield "version 0.1 folder", lambda f: link_in(f / ".fingertip-abcdefgh", victim)
    yield "plan link", lambda f: link_in(f / COMMIT, victim / REPORT, "complete.json")
    yield "plan pipe", lambda f: ((f / COMMIT).mkdir(), os.mkfifo(f / COMMIT / "complete.json"))


def link_in(folder: Path, target: Path, name: str = "link") -> None:
    folder.mkdir()
    (folder / name).symlink_to(target)


def test_a_link_to_a_folder_is_a_difference_and_hidden_folders_are_not_looked_into(world: World) -> None:
    """What stands behind a link is not compared: a changed file there must not pass as written."""
    for name in ("src", "photos", ".git", ".hidden.fingertip", ".fingertip-commit"):
        world.renew()
        (world.path / TOP / name).symlink_to(world.victim)
        assert world.run(COMMANDS["check"], (1,)) == [], name
    world.renew()
    (world.path / TOP / ".cache").mkdir()
    (world.path / TOP / ".cache" / MANIFEST).write_text("{}")
    assert world.run(COMMANDS["check"], (0,)) == []


def test_large_and_deep_folders_are_looked_at_up_to_a_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for depth in range(1, 7):
        SetWriter(tmp_path.joinpath(*"abcdef"[:depth]), "set", "", "").write({"a.csv": b"1"})
    assert verify_sets(tmp_path) == (5, [])
    (tmp_path / "a" / MANIFEST).write_text("{}")
    text = "was not written by fingertip, or was changed since; the set is not compared."
    assert verify_sets(tmp_path) == (4, [f"{tmp_path / 'a' / MANIFEST}: {text}"])
    monkeypatch.setattr(verification, "_MAX_ENTRIES", 5)
    done = run_fingertip("check", "/")
    assert done.returncode == 2
    assert "/: holds more than 5 files and folders; name a folder that a command wrote." in done.stderr
    assert run_fingertip("check", tmp_path).returncode == 2


@pytest.mark.parametrize("name", [pytest.param("check", marks=pytest.mark.full), "firmware"])
def test_hostile_leftovers(world: World, name: str) -> None:
    faults, command = [], COMMANDS[name]
    for label, leave in leave_hostile(world):
        world.renew()
        folder = world.path / command.folder
        (folder / "mine.txt").touch()
        leave(folder)
        faults += world.run(command, (0, 1, 2), label)
        if not (folder / "mine.txt").is_file():
            faults.append(f"{label}: removed a file")
        remove(folder.with_name(f".{folder.name}.fingertip"))
    assert faults == []


def test_unfinished_files_in_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file is written beside its place under a name that a stranger may have taken, and leftovers are removed."""
    victim, path = tmp_path / "victim", tmp_path / "dl" / "a.csv"
    victim.write_bytes(b"precious")
    path.parent.mkdir()
    monkeypatch.setattr(output_files, "_numbers", itertools.count())
    for process in (os.getpid(), 2**22 + 1, "\xb2", "9" * 200, "", "-1", "x"):
        (path.parent / f".fingertip-{process}-0").symlink_to(victim)
    write_file(path, b"new")
    assert victim.read_bytes() == b"precious"
    assert path.read_bytes() == b"new"
    assert not path.is_symlink()


# What the files state


@pytest.mark.parametrize("report", [b"{}", b"[]", b"[" * 100_000, b"\xff", b"9" * 5000, b" " * 1_200_000])
def test_page_of_files_that_state_nonsense_or_too_much_is_a_sentence(
    tmp_path: Path, report: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    parts = {f"{name}.stl": bytes(84) for name in parts_by_name(Design())}  # without triangles
    half = len(report) // 2 if len(report) > 1_000_000 else 0  # each file is below the limit, both together are not
    PART_FILES.writer(Design(), tmp_path).write({**parts, REPORT: report[half:], SHEET: report[:half]})
    monkeypatch.setenv("FINGERTIP_MAX_OUTPUT_MB", "1")
    done = run_fingertip("page", "fsr400", "--out", tmp_path)
    assert done.returncode == 2
    if half:
        assert "holds files that are too large together to be shown; raise FINGERTIP_MAX_OUTPUT_MB." in done.stderr
    else:
        assert "holds files that cannot be shown (" in done.stderr
        assert "`fingertip make` makes others. If it made these, this is a fault of fingertip" in done.stderr


@pytest.mark.parametrize("netlist", [b"", b"()", b"(" * 100_000, b"(a (components (comp)) (nets))", b"\xff"])
def test_board_whose_netlist_states_no_circuit_is_refused(world: World, netlist: bytes) -> None:
    world.renew()
    folder = world.path / BOARD
    for name, data in (("slip_filter.net", netlist), ("slip_filter.kicad_pcb", b"(kicad_pcb)")):
        (folder / name).unlink()
        (folder / name).write_bytes(data)
    manifest = json.loads((folder / MANIFEST).read_bytes())
    manifest["files"]["slip_filter.net"] = hashlib.sha256(netlist).hexdigest()
    (folder / MANIFEST).unlink()
    (folder / MANIFEST).write_text(json.dumps(manifest))
    assert world.run(COMMANDS["board"], (2,)) == []
    assert "slip_filter.net: states no circuit; " in run_fingertip("board", "--out", folder).stderr


def test_detection_that_states_no_motion(tmp_path: Path) -> None:
    for text in ("", "[]", "[" * 100_000, '{"motion_s": "x"}', '{"motion_s": 1e999}', '{"motion_s": {}}'):
        SIGNAL.writer(Design(), tmp_path).write({"trace.csv": TRACE.encode(), "detection.json": text.encode()})
        assert read_origin(tmp_path / "trace.csv") == Origin(is_simulated=True)


# Databases of sweeps


SWEEP = 'outputs = ["cutoff_3db_hz"]\n[axes]\nboard.cutoff_hz = [60.0, 67.0, 75.0]\n'


def name_super_journal(folder: Path, victim: Path) -> None:
    """Leave a transaction half-done whose journal names another file, which SQLite removes when it undoes that."""
    path = folder / "sweep.sqlite"
    with sqlite3.connect(path, isolation_level=None) as connection:
        connection.executescript("PRAGMA cache_size = 1; BEGIN IMMEDIATE; UPDATE rows SET reason = hex(zeroblob(9000))")
        database, journal = path.read_bytes(), path.with_name("sweep.sqlite-journal").read_bytes()
        connection.execute("ROLLBACK")
    connection.close()
    name = os.fsencode(victim)
    record = struct.pack(">I", 2**30 // 4096 + 1) + name + struct.pack(">II", len(name), sum(name))
    path.unlink()
    path.write_bytes(database)
    path.with_name("sweep.sqlite-journal").write_bytes(journal + record + bytes.fromhex("d9d505f920a163d7"))


DATABASES: dict[str, Callable[[Path, Path], object]] = {
    **{
        f"{kind} as sweep.sqlite{ending}": lambda folder, victim, kind=kind, ending=ending: put(
            folder / f"sweep.sqlite{ending}", kind, victim
        )
        for kind in ("link", "link to nothing", "pipe", "device", "folder")
        for ending in ("", "-journal", "-wal", "-shm")
    },
    "journal that names another file": name_super_journal,
}


@pytest.mark.full
@pytest.mark.parametrize("words", [("--show",), ("../sweep.toml", "--resume"), ("../sweep.toml",)])
def test_databases_of_sweeps(world: World, words: tuple[str, ...]) -> None:
    (world.path.parent / "sweep.toml").write_text(SWEEP)
    command, faults = Command(("sweep", *words, "--out", "out/sweep"), "out/sweep", writes=True, codes=(2,)), []
    for label, damage in DATABASES.items():
        world.renew()
        damage(world.path / "out/sweep", world.victim / "sweep/sweep.sqlite")
        faults += world.run(command, label=label)
    assert faults == []


@pytest.mark.full
@pytest.mark.parametrize(
    "words",
    ["build fsr400 --out o", "drawing fsr400 --out o", "sweep sweep.toml --out o --jobs 2", "simulate --plot o.png"],
)
def test_commands_run_nothing_of_the_current_folder(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory, words: str
) -> None:
    """Modules, and settings of libraries, that nobody asked for, stand there."""
    for name in ("json", "pickle", "multiprocessing", "cadquery", "OCP", "numpy"):
        (tmp_path / f"{name}.py").write_text(f"open('{name} was run', 'w')\nraise SystemExit('a stranger')\n")
    for name in ("matplotlibrc", ".numba_config.yaml", "ezdxf.ini", "XSTEP.us", "SHAPE.us"):
        (tmp_path / name).write_bytes(b"\xff not what a library expects")
    (tmp_path / "sweep.toml").write_text(SWEEP)
    program = tmp_path_factory.mktemp("elsewhere") / "program.py"
    program.write_text("from fingertip.__main__ import main\nif __name__ == '__main__':\n    main()\n")
    done = run_python(str(program), *words.split(), PWD=str(tmp_path))
    assert (done.returncode, list(tmp_path.glob("* was run"))) == (0, []), done.stderr
