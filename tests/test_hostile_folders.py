"""Folders as others leave them: links, pipes and damaged files in the place of ours, and files that
are theirs.

A folder with every set of a design stands beside the files of a victim, which are the same files,
so that a link to them looks right to whoever follows it. A command that names the folder ends with
a documented exit code and changes nothing beside it.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from fingertip.board.fabrication.fabrication_files import provenance_record
from fingertip.catalogues.output_files import (
    PART_FILES,
    PRINTS,
    PROVENANCE,
    REPORT,
    SHEET,
    SIGNAL,
    STEPS,
)
from fingertip.design import Design
from fingertip.foundation.errors import OutputError
from fingertip.foundation.folder_swap import recover
from fingertip.foundation.output_set import MANIFEST, SetWriter, hash_parameters, read_manifest
from fingertip.models.parts import parts_by_name
from fingertip.slip.traces.truth import Origin, read_origin
from fingertip.tasks import manifest_comparison
from fingertip.tasks.board_files import board_files, write_board
from fingertip.tasks.firmware_files import firmware_files, write_firmware
from fingertip.tasks.manifest_comparison import verify_sets
from tests.conftest import run_fingertip, run_python

pytestmark = pytest.mark.skipif(
    not hasattr(os, "mkfifo"), reason="links and pipes are made, NOT TESTED HERE"
)

TOP = "out/fsr400"
COMMIT = ".fingertip-commit"
TRACE = "time_s,voltage_v\n" + "".join(
    f"{i / 1000:.3f},{1 + i % 7 / 100:.2f}\n" for i in range(600)
)


@dataclass(frozen=True)
class Command:
    """A command, and the folder that it names."""

    words: str
    folder: str
    codes: tuple[int, ...] = (0, 1, 2)
    """Exit codes that it may have if one of the files there is another's."""
    linked: tuple[str, ...] = ()
    """Folders below it that may be links, which is refused."""


BOARD = f"{TOP}/board"
FIRMWARE = f"{TOP}/firmware"
COMMANDS = {
    "check": Command(f"check {TOP}", TOP, (1, 2), ("print", "board", "board/fab", "firmware")),
    "board --check": Command(f"board fsr400 --check --out {BOARD}", BOARD, linked=("fab", "3d")),
    "firmware --check": Command(
        f"firmware fsr400 --check --out {FIRMWARE}", FIRMWARE, linked=("src",)
    ),
    "page": Command(f"page fsr400 --out {TOP}", TOP, (2,), ("print", "steps")),
    "detect": Command(f"detect {TOP}/signal/trace.csv", f"{TOP}/signal"),
    "board": Command(
        f"board fsr400 --out {BOARD}", BOARD, linked=("3d", "3d/Resistor_SMD.3dshapes")
    ),
    "board --force": Command(f"board fsr400 --set board.cutoff_hz=60 --force --out {BOARD}", BOARD),
    "firmware": Command(f"firmware fsr400 --out {FIRMWARE}", FIRMWARE, (2,), ("src", "examples")),
    "make": Command("make fsr400 --formats stl", TOP, linked=("print", "board", "signal")),
}


def make_huge(path: Path) -> None:
    path.touch()
    os.truncate(path, 2**41)


KINDS: dict[str, Callable[[Path, Path], object]] = {
    "link": lambda path, victim: path.symlink_to(victim),
    "link to nothing": lambda path, victim: path.symlink_to(victim.with_name("planted")),
    "pipe": lambda path, victim: os.mkfifo(path),
    "folder": lambda path, victim: path.mkdir(),
    "huge": lambda path, victim: make_huge(path),
    "junk": lambda path, victim: path.write_bytes(b'{"\xff\0'),
}
"""What takes the place of a file, given its path and that of the same file of the victim."""


@dataclass(frozen=True)
class World:
    """Folder with the files of a victim and those of `out`, which another has left."""

    path: Path
    master: Path

    def renew(self) -> None:
        shutil.rmtree(self.path / "out", ignore_errors=True)
        shutil.copytree(self.master, self.path / "out", copy_function=os.link)

    def find_faults(self, command: Command, codes: tuple[int, ...], place: str) -> list[str]:
        """Run a command and return what is wrong with that."""
        before = self.look()
        done = run_fingertip(*command.words.split(), PWD=str(self.path))
        wrong = done.returncode not in codes
        faults = (
            [f"exit code {done.returncode}: {done.stdout[-300:]}{done.stderr[-300:]}"]
            if wrong
            else []
        )
        faults += [] if self.look() == before else ["changed the files of others"]
        return [f"{place}: {fault}" for fault in faults]

    def look(self) -> dict[Path, tuple[int, ...]]:
        """Kind, size and times of everything beside `out`."""
        stats = {path: path.lstat() for path in (self.path / "victim").rglob("*")}
        return {
            path: (s.st_mode, s.st_size, s.st_mtime_ns, s.st_ctime_ns) for path, s in stats.items()
        }


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> World:
    """The folder of a design with all its sets, some of them
    small fakes, and the victim's copy of it.
    """
    base = tmp_path_factory.mktemp("hostile")
    design = Design()
    top = base / "master" / "fsr400"
    parts = {f"{name}.stl": name.encode() for name in parts_by_name(design)} | {
        REPORT: b"{}",
        SHEET: b"# Casting\n",
    }
    PART_FILES.writer(design, top).write(parts)
    PRINTS.writer(design, top / "print", top=top).write({"bone.stl": b"bone"})
    STEPS.writer(design, top / "steps", top=top).write({"1.png": b"picture"})
    SIGNAL.writer(design, top / "signal").write(
        {"trace.csv": TRACE.encode(), "detection.json": b'{"motion_s": 0.3}'}
    )
    write_board(design, top / "board")
    fab = {"slip_filter_gerbers.zip": b"gerbers"}
    fab[PROVENANCE] = provenance_record(board_files(design), fab)
    parameters = hash_parameters(design.model_dump(mode="json"))
    SetWriter(top / "board/fab", "fabrication", design.name, parameters).write(fab)
    write_firmware(design, top / "firmware")
    shutil.copytree(base / "master", base / "world" / "victim")
    return World(base / "world", base / "master")


cached_board_files = cache(board_files)
cached_firmware_files = cache(firmware_files)


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compute contents that follow from the same design once."""
    monkeypatch.setattr(
        "fingertip.tasks.board_files.board_files", lambda design: dict(cached_board_files(design))
    )
    monkeypatch.setattr("fingertip.tasks.firmware_files.firmware_files", cached_firmware_files)


def remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    path.unlink(missing_ok=True)


@pytest.mark.parametrize("name", [name for name in COMMANDS if name != "make"])
def test_what_stands_in_the_place_of_a_file_leads_nowhere(world: World, name: str) -> None:
    """The manifest of the set and one of its files."""
    command = COMMANDS[name]
    faults = []
    inner = Path(command.folder).relative_to("out")
    own = sorted(
        path.name
        for path in (world.master / inner).iterdir()
        if path.is_file() and path.name[0] != "."
    )
    for file in (next(one for one in own if one != MANIFEST), MANIFEST):
        for kind, put in KINDS.items():
            world.renew()
            path = world.path / command.folder / file
            path.unlink()
            put(path, world.path / "victim" / inner / file)
            faults += world.find_faults(command, command.codes, f"{file} as {kind}")
    assert faults == []


@pytest.mark.parametrize(
    ("name", "place"),
    [(name, place) for name, command in COMMANDS.items() for place in command.linked],
)
def test_a_folder_that_is_a_link_is_refused(world: World, name: str, place: str) -> None:
    """What stands behind a link is not compared: a changed file there must not pass as written."""
    world.renew()
    command = COMMANDS[name]
    path = world.path / command.folder / place
    remove(path)
    path.symlink_to(world.path / "victim" / Path(command.folder).relative_to("out") / place)
    assert world.find_faults(command, (1,) if "check" in name else (2,), place) == []


def test_what_is_as_written_passes_and_a_hidden_folder_is_not_looked_into(world: World) -> None:
    world.renew()
    (world.path / TOP / ".cache").mkdir()
    (world.path / TOP / ".cache" / MANIFEST).write_text("{}")
    for name in ("check", "board --check", "firmware --check", "detect", "board"):
        assert world.find_faults(COMMANDS[name], (0,), name) == []


# Names and plans


def make_plan(commit: Path, data: Any) -> None:
    commit.mkdir(parents=True)
    (commit / "complete.json").write_bytes(
        data if isinstance(data, bytes) else json.dumps(data).encode()
    )


@pytest.mark.parametrize("plan", [b"", b"\xff", b"[]", b"{}", b'{"files": 1, "removed": []}'])
def test_a_damaged_plan_is_refused_and_stays(tmp_path: Path, plan: bytes) -> None:
    make_plan(tmp_path / COMMIT, plan)
    with pytest.raises(
        OutputError, match=r"damaged complete\.json.* remove this folder, then write the set again"
    ):
        recover(tmp_path)
    assert (tmp_path / COMMIT / "complete.json").read_bytes() == plan


def test_a_manifest_that_names_anything_but_files_of_its_folder_is_none_of_ours(
    tmp_path: Path,
) -> None:
    SetWriter(tmp_path, "board", "finger", "a").write({"bom.csv": b"1"})
    own = json.loads((tmp_path / MANIFEST).read_text())
    changes: list[dict[str, Any]] = [
        {"files": {name: "0" * 64}}
        for name in ("../t", "/t", "a\\b", "C:t", "", "a\0b", "nul.txt", "t.", "x" * 300)
    ]
    changes += (
        {"files": files}
        for files in ({"a": "0" * 64, "A": "0" * 64}, {"a": 5}, {"a": "../"}, [], None)
    )
    changes += ({key: value} for key in ("kind", "design", "parameters") for value in (None, [], 5))
    assert read_manifest(tmp_path) is not None
    for change in changes:
        (tmp_path / MANIFEST).write_text(json.dumps(own | change))
        assert read_manifest(tmp_path) is None, change


def test_a_plan_leaves_alone_what_was_changed_since(tmp_path: Path) -> None:
    """A file of one's own is neither removed nor overwritten by
    the plan of a command that was killed.
    """
    (tmp_path / "mine.txt").write_text("mine")
    (tmp_path / "link").symlink_to("mine.txt")
    for name, states in {
        "mine.txt": ("nothing", hashlib.sha256(b"theirs").hexdigest()),
        "link": ("no file",),
    }.items():
        for before in states:
            for data in (
                {"files": {name: before}, "removed": {}},
                {"files": {}, "removed": {name: before}},
            ):
                make_plan(tmp_path / COMMIT, data)
                (tmp_path / COMMIT / f"new-{name}").write_text("theirs")
                recover(tmp_path)
                assert sorted(path.name for path in tmp_path.iterdir()) == ["link", "mine.txt"]
                assert (tmp_path / "mine.txt").read_text() == "mine"
                assert (tmp_path / "link").is_symlink()


def test_names_that_a_set_may_not_have_are_refused_before_they_are_written(tmp_path: Path) -> None:
    writer = SetWriter(tmp_path, "board", "finger", "a")
    writer.write({"bom.csv": b"1"})
    for name in ("BOM.csv", "a:b.csv", "con", ".fingertip-x", "\ud800", "x" * 241):
        with pytest.raises(
            OutputError,
            match="has a name that not every system can store there; choose another one",
        ):
            writer.write({name: b"2"})
    assert verify_sets(tmp_path) == (1, [])


def test_large_and_deep_folders_are_looked_at_up_to_a_limit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for depth in range(1, 7):
        SetWriter(tmp_path.joinpath(*"abcdef"[:depth]), "set", "", "").write({"a.csv": b"1"})
    assert verify_sets(tmp_path) == (5, [])
    (tmp_path / "a" / MANIFEST).write_text("{}")
    text = "was not written by fingertip, or was changed since; the set is not compared."
    assert verify_sets(tmp_path) == (4, [f"{tmp_path / 'a' / MANIFEST}: {text}"])
    monkeypatch.setattr(manifest_comparison, "_MAX_ENTRIES", 5)
    done = run_fingertip("check", "/")
    assert done.returncode == 2
    assert (
        "/: holds more than 5 files and folders; name a folder that a command wrote." in done.stderr
    )
    assert run_fingertip("check", tmp_path).returncode == 2


# What the files state


@pytest.mark.parametrize(
    "report", [b"{}", b"[]", b"[" * 100_000, b"\xff", b"9" * 5000, b" " * 1_200_000]
)
def test_page_of_files_that_state_nonsense_or_too_much_is_a_sentence(
    tmp_path: Path, report: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    parts = {f"{name}.stl": bytes(84) for name in parts_by_name(Design())}  # without triangles
    # Each file is below the limit, both together are not.
    half = len(report) // 2 if len(report) > 1_000_000 else 0
    PART_FILES.writer(Design(), tmp_path).write(
        {**parts, REPORT: report[half:], SHEET: report[:half]}
    )
    monkeypatch.setenv("FINGERTIP_MAX_OUTPUT_MB", "1")
    done = run_fingertip("page", "fsr400", "--out", tmp_path)
    assert done.returncode == 2
    if half:
        assert (
            "holds files that are too large together to be shown; raise FINGERTIP_MAX_OUTPUT_MB."
            in done.stderr
        )
    else:
        assert "holds files that cannot be shown (" in done.stderr
        assert (
            "`fingertip make` makes others. If it made these, this is a fault of fingertip"
            in done.stderr
        )


@pytest.mark.parametrize("netlist", [b"", b"(" * 100_000, b"(a (components (comp)) (nets))"])
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
    assert "slip_filter.net: states no circuit; " in run_fingertip("board", "--out", folder).stderr


def test_detection_that_states_no_motion(tmp_path: Path) -> None:
    for text in (
        "",
        "[]",
        "[" * 100_000,
        '{"motion_s": "x"}',
        '{"motion_s": 1e999}',
        '{"motion_s": {}}',
    ):
        SIGNAL.writer(Design(), tmp_path).write(
            {"trace.csv": TRACE.encode(), "detection.json": text.encode()}
        )
        assert read_origin(tmp_path / "trace.csv") == Origin(is_simulated=True)


@pytest.mark.full
@pytest.mark.parametrize(
    "words",
    [
        "build fsr400 --out o",
        "drawing fsr400 --out o",
        "sweep sweep.toml --out o --jobs 2",
        "simulate --plot o.png",
    ],
)
def test_commands_run_nothing_of_the_current_folder(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory, words: str
) -> None:
    """Modules, and settings of libraries, that nobody asked for, stand there."""
    for name in ("json", "pickle", "multiprocessing", "cadquery", "OCP", "numpy"):
        (tmp_path / f"{name}.py").write_text(
            f"open('{name} was run', 'w')\nraise SystemExit('a stranger')\n"
        )
    for name in ("matplotlibrc", ".numba_config.yaml", "ezdxf.ini", "XSTEP.us", "SHAPE.us"):
        (tmp_path / name).write_bytes(b"\xff not what a library expects")
    (tmp_path / "sweep.toml").write_text(
        'outputs = ["cutoff_3db_hz"]\n[axes]\nboard.cutoff_hz = [60.0, 75.0]\n'
    )
    program = tmp_path_factory.mktemp("elsewhere") / "program.py"
    program.write_text(
        "from fingertip.__main__ import main\nif __name__ == '__main__':\n    main()\n"
    )
    done = run_python(str(program), *words.split(), PWD=str(tmp_path))
    assert (done.returncode, list(tmp_path.glob("* was run"))) == (0, []), done.stderr
