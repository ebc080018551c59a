"""Sets of files: whole or old whenever the writer is killed, and
never at the cost of somebody's own file.
"""

from __future__ import annotations

import errno
import hashlib
import itertools
import json
import os
import resource
import shutil
import signal
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from unittest.mock import Mock

import pytest

from fingertip.foundation import folder_swap
from fingertip.foundation.errors import OutputError
from fingertip.foundation.files import open_atomic, write_file
from fingertip.foundation.folder_swap import recover
from fingertip.foundation.output_set import MANIFEST, Revision, SetWriter, add_to_set, read_manifest
from fingertip.tasks.manifest_comparison import verify_sets

pytestmark = pytest.mark.skipif(
    not hasattr(os, "fork"), reason="processes are killed with signals, NOT TESTED HERE"
)

OLD = {"board.net": b"old netlist", "bom.csv": b"old parts", "old_only.txt": b"of the old set"}
NEW = {"board.net": b"new netlist", "bom.csv": b"new parts", "new_only.txt": b"of the new set"}
OPERATIONS = (
    "os.rename",
    "os.link",
    "os.mkdir",
    "os.remove",
    "os.rmdir",
    "os.symlink",
    "shutil.copyfile",
    "open",
)
"""Audit events of what changes a file system; a swap has none and is counted by hand."""


def writer(folder: Path, parameters: str, **options: bool) -> SetWriter:
    return SetWriter(folder, "board", "finger", parameters, **options)


def prepare(folder: Path) -> None:
    """Write the old set, a file and a link of somebody's own, and a subfolder with another set."""
    writer(folder, "old").write(OLD)
    (folder / "mine.txt").write_bytes(b"mine")
    (folder / "link").symlink_to("mine.txt")
    SetWriter(folder / "fab", "gerbers", "finger", "old").write({"gerbers.zip": b"gerbers"})


def files_in(folder: Path) -> dict[str, bytes]:
    """Content of the files in a folder, without the manifest and what is somebody's own."""
    paths = [
        path
        for path in folder.iterdir()
        if path.is_file() and path.name not in (MANIFEST, "mine.txt", "link")
    ]
    return {path.name: path.read_bytes() for path in paths}


def assert_whole(folder: Path) -> None:
    """The folder holds the old set or the new one, with its own manifest, and somebody's
    own file.
    """
    files = files_in(folder)
    manifest = read_manifest(folder)
    assert files in (OLD, NEW)
    assert manifest is not None
    assert manifest.parameters == ("old" if files == OLD else "new")
    assert dict(manifest.files) == {
        name: hashlib.sha256(data).hexdigest() for name, data in files.items()
    }
    assert (folder / "mine.txt").read_bytes() == b"mine"
    assert os.readlink(folder / "link") == "mine.txt"


def assert_no_litter(folder: Path) -> None:
    assert [path.name for path in folder.parent.iterdir() if path.name != folder.name] == []
    names = {path.name for path in folder.iterdir()}
    assert names == {*files_in(folder), MANIFEST, "mine.txt", "link", "fab"}
    assert verify_sets(folder) == (len(files_in(folder)) + 1, [])


def run_in_child(action: Callable[[], object], before: Callable[[str], None]) -> int:
    """Run an action in a child, with a call before each change of the file system; return its exit
    status.

    It is 2 for a refusal, and 1 for another error.
    """
    child = os.fork()
    if child == 0:

        def hook(event: str, arguments: tuple[object, ...]) -> None:
            if event in OPERATIONS and (
                event != "open" or int(str(arguments[2])) & (os.O_WRONLY | os.O_RDWR)
            ):
                before(event)

        swap = folder_swap._swap

        def counted_swap(first: Path, second: Path) -> bool:
            before("swap")
            swapped = swap(first, second)
            before("swap")
            return swapped

        folder_swap._swap = counted_swap
        sys.addaudithook(hook)
        status = 0
        try:
            action()
        except OutputError:
            status = 2
        except BaseException:
            status = 1
        os._exit(status)
    return os.waitpid(child, 0)[1]


def run_and_kill_before(operation: int, action: Callable[[], object]) -> bool:
    """Run an action in a child that kills itself before the n-th
    change of the file system; True if it got there.
    """
    left = itertools.count(operation, -1)
    status = run_in_child(action, lambda event: next(left) or os.kill(os.getpid(), signal.SIGKILL))
    assert status in (0, signal.SIGKILL), "the writer failed without being killed"
    return status == signal.SIGKILL


def kill_everywhere(folder: Path, action: Callable[[], object]) -> Iterator[int]:
    """Prepare a folder anew and kill the action before its first,
    second, ... change, until it ends by itself.
    """
    operation = 0
    while True:
        for path in sorted(folder.parent.rglob("*"), reverse=True):
            path.rmdir() if path.is_dir() and not path.is_symlink() else path.unlink()
        prepare(folder)
        killed = run_and_kill_before(operation, action)
        yield operation
        if not killed:
            return
        operation += 1


def tree_of(folder: Path) -> dict[str, bytes | None]:
    return {
        str(path): path.read_bytes() if path.is_file() else None
        for path in sorted(folder.rglob("*"))
    }


def assert_check_only_reports(folder: Path, unfinished: Path) -> None:
    """`check` changes nothing. It names what is left unfinished."""
    before = tree_of(folder.parent)
    differences = "\n".join(verify_sets(folder)[1])
    assert tree_of(folder.parent) == before
    text = (
        f"{unfinished}: was left by a command that was ended before it was done; the next "
        "command that writes there"
    )
    assert (text in differences) == unfinished.exists()


@pytest.mark.full
def test_writer_killed_at_any_change_leaves_the_old_set_or_the_new_one(tmp_path: Path) -> None:
    folder = tmp_path / "area" / "board"
    seen = set()
    steps = 0
    for _ in kill_everywhere(folder, lambda: writer(folder, "new").write(NEW)):
        steps += 1
        assert_whole(folder)  # at once, before anything else has run
        seen.add("old" if files_in(folder) == OLD else "new")
        staging = folder.with_name(".board.fingertip")
        assert_check_only_reports(folder, staging)
        writer(folder, "new").write(NEW)  # the next run
        assert files_in(folder) == NEW
        assert (folder / "fab" / "gerbers.zip").read_bytes() == b"gerbers"
        assert_no_litter(folder)
    assert seen == {"old", "new"}
    assert steps > 12


@pytest.mark.parametrize("in_place", [False, pytest.param(True, marks=pytest.mark.full)])
def test_a_disk_that_is_full_from_any_change_on_keeps_the_old_set(
    tmp_path: Path, in_place: bool
) -> None:
    """What takes room fails, and what gives room does not; the
    writer says so, and leaves nothing behind.
    """
    folder = tmp_path / "area" / "board"
    refused = 0
    prepare(folder)
    for operation in itertools.count():
        left = itertools.count(operation, -1)

        def fill(event: str, left: Iterator[int] = left) -> None:
            if (
                event in ("os.mkdir", "open", "os.link", "os.symlink", "shutil.copyfile")
                and next(left) <= 0
            ):
                raise OSError(errno.ENOSPC, "No space left on device")

        status = run_in_child(lambda: writer(folder, "new", in_place=in_place).write(NEW), fill)
        if status == 0:
            break
        assert os.waitstatus_to_exitcode(status) == 2, "a full disk is a sentence"
        assert_whole(folder)
        assert files_in(folder) == OLD
        assert_no_litter(folder)
        refused += 1
    assert refused >= 4
    assert files_in(folder) == NEW
    assert_no_litter(folder)


def test_check_waits_for_a_writer_and_leaves_its_work_alone(tmp_path: Path) -> None:
    folder = tmp_path / "area" / "board"
    prepare(folder)
    staging = folder.with_name(".board.fingertip")
    reader, ready = os.pipe()
    child = os.fork()
    if child == 0:
        with folder_swap.lock(folder.parent):
            staging.mkdir()
            os.write(ready, b".")
            time.sleep(0.3)
            status = 0 if staging.is_dir() else 1
            shutil.rmtree(staging, ignore_errors=True)
        os._exit(status)
    os.read(reader, 1)
    assert verify_sets(folder) == (4, [])
    assert os.waitpid(child, 0)[1] == 0


@pytest.mark.full
def test_killed_renames_in_place_are_completed_or_undone_by_the_next_command(
    tmp_path: Path,
) -> None:
    """Where folders cannot be swapped, the set is whole again after the next command."""
    folder = tmp_path / "area" / "board"
    seen = set()
    for _ in kill_everywhere(folder, lambda: writer(folder, "new", in_place=True).write(NEW)):
        assert_check_only_reports(folder, folder / ".fingertip-commit")
        writer(folder, "new").check([])
        assert_whole(folder)
        seen.add("old" if files_in(folder) == OLD else "new")
        assert_no_litter(folder)
    assert seen == {"old", "new"}


@pytest.mark.parametrize("error", [OSError, AttributeError, TypeError])
def test_folder_that_cannot_be_swapped_is_written_in_place(
    tmp_path: Path, error: type[Exception], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The system has no such function, or no C library that Python can load."""
    folder = tmp_path / "area" / "board"
    prepare(folder)
    inode = folder.stat().st_ino
    monkeypatch.setattr(folder_swap.ctypes, "CDLL", Mock(side_effect=error))
    assert writer(folder, "new").write(NEW) == ("old_only.txt",)
    assert folder.stat().st_ino == inode
    assert_whole(folder)
    assert_no_litter(folder)


def test_current_folder_and_a_link_are_not_swapped_away(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "area" / "board"
    link = tmp_path / "link"
    prepare(folder)
    link.symlink_to(folder)
    writer(link, "new").write(NEW)
    assert link.is_symlink()
    assert files_in(folder) == NEW
    monkeypatch.chdir(folder)
    writer(Path("."), "old").write(OLD)
    assert Path("board.net").read_bytes() == b"old netlist"
    assert_whole(folder)
    assert_no_litter(folder)
    recover(Path("/"))  # before each write below it; its own name is empty


@pytest.mark.full
def test_writers_at_the_same_time_wait_for_each_other(tmp_path: Path) -> None:
    folder = tmp_path / "area" / "board"
    prepare(folder)
    children = []
    for files, parameters in ((OLD, "old"), (NEW, "new")) * 2:
        child = os.fork()
        if child == 0:
            status = 0
            try:
                for _ in range(50):
                    writer(folder, parameters).write(files)
            except BaseException:
                status = 1
            os._exit(status)
        children.append(child)
    assert [os.waitpid(child, 0)[1] for child in children] == [0] * 4
    assert_whole(folder)
    assert_no_litter(folder)


# What is somebody's own


def test_changed_or_unknown_files_are_never_overwritten(tmp_path: Path) -> None:
    folder = tmp_path / "board"
    prepare(folder)
    (folder / "bom.csv").write_bytes(b"my own notes on the parts")
    (folder / "new_only.txt").write_bytes(b"my own")
    before = {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}
    for attempt in (
        lambda: writer(folder, "new").check(NEW),
        lambda: writer(folder, "new").write(NEW),
    ):
        with pytest.raises(OutputError) as caught:
            attempt()
        assert [Path(issue.field).name for issue in caught.value.issues] == [
            "bom.csv",
            "new_only.txt",
        ]
        assert all("add --force to overwrite it" in issue.message for issue in caught.value.issues)
        assert {
            path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()
        } == before
    assert writer(folder, "new", force=True).write(NEW) == ("old_only.txt",)
    assert files_in(folder) == NEW
    (folder / "new_only.txt").write_bytes(b"changed")
    assert writer(folder, "old").write(OLD) == ()
    assert files_in(folder) == OLD | {"new_only.txt": b"changed"}, (
        "what the other set does not have stays"
    )


def test_set_of_the_same_parameters_grows(tmp_path: Path) -> None:
    folder = tmp_path / "parts"
    writer(folder, "a").write({"bone.stl": b"1"})
    assert writer(folder, "a").write({"skin.stl": b"2"}) == ()
    manifest = read_manifest(folder)
    assert manifest is not None
    assert set(manifest.files) == {"bone.stl", "skin.stl"}
    writer(folder, "a").add({"casting.md": b"3"})
    with pytest.raises(
        OutputError, match="of other parameters of 'finger'; build this design there first"
    ):
        writer(folder, "b").add({"casting.md": b"4"})
    assert verify_sets(folder) == (3, [])


def test_folder_in_the_place_of_a_file_and_a_file_in_that_of_a_folder_are_refused(
    tmp_path: Path,
) -> None:
    folder = tmp_path / "board"
    prepare(folder)
    (folder / "new_only.txt").mkdir()
    with pytest.raises(OutputError, match=r"new_only\.txt: is a folder; move it away"):
        writer(folder, "new").write(NEW)
    assert files_in(folder) == OLD
    with pytest.raises(OutputError, match=r"bom\.csv: is a file; choose another folder with out"):
        writer(folder / "bom.csv" / "deeper" / "board", "new").write(NEW)
    assert [path.name for path in tmp_path.iterdir()] == ["board"]


def test_manifest_of_another_program_is_not_overwritten_but_refused_before_work(
    tmp_path: Path,
) -> None:
    (tmp_path / MANIFEST).write_text('{"name": "web app"}')
    for attempt in (
        lambda: writer(tmp_path, "new").check(NEW),
        lambda: writer(tmp_path, "new").write(NEW),
    ):
        with pytest.raises(OutputError, match=r"manifest\.json: was not written by fingertip"):
            attempt()
    assert json.loads((tmp_path / MANIFEST).read_text()) == {"name": "web app"}


def test_missing_and_changed_files_are_found(tmp_path: Path) -> None:
    folder = tmp_path / "board"
    prepare(folder)
    (folder / "bom.csv").unlink()
    (folder / "fab" / "gerbers.zip").write_bytes(b"other")
    count, differences = verify_sets(folder)
    assert count == 4
    assert sorted(differences) == [
        f"{folder / 'bom.csv'}: is missing.",
        f"{folder / 'fab' / 'gerbers.zip'}: was changed after it was written.",
    ]
    with pytest.raises(OutputError, match=r"has no manifest\.json of fingertip"):
        verify_sets(tmp_path / "area")


def test_set_of_another_kind_is_not_replaced(tmp_path: Path) -> None:
    writer(tmp_path, "old").write(OLD)
    parts = SetWriter(tmp_path, "parts", "finger", "old", force=True)
    for attempt in (lambda: parts.check(["bone.stl"]), lambda: parts.write({"bone.stl": b"1"})):
        with pytest.raises(
            OutputError,
            match=r"holds the board of 'finger'; choose another folder .* such as \S+parts",
        ):
            attempt()
    assert files_in(tmp_path) == OLD


def test_folder_without_manifest_takes_equal_files_and_explains_others(tmp_path: Path) -> None:
    writer(tmp_path, "old").write(OLD)
    (tmp_path / MANIFEST).unlink()
    writer(tmp_path, "old").write(OLD)  # nothing would change
    (tmp_path / MANIFEST).unlink()
    with pytest.raises(OutputError) as caught:
        writer(tmp_path, "new").write(NEW)
    assert str(caught.value) == (
        f"{tmp_path}: has no manifest.json that says who wrote board.net, bom.csv; move them "
        "away, choose another "
        "place with out, or add force=True to overwrite them."
    )


def test_single_file_in_a_set_becomes_a_part_of_it(tmp_path: Path) -> None:
    writer(tmp_path, "a").write({"trace.csv": b"1"})
    add_to_set(tmp_path / "slip.png", b"2")
    add_to_set(tmp_path / "slip.png", b"3")
    assert verify_sets(tmp_path) == (2, [])
    # What was made from an earlier file is removed.
    assert writer(tmp_path, "a").write({"trace.csv": b"3"}, obsolete=("slip.png",)) == ("slip.png",)
    assert verify_sets(tmp_path) == (1, [])
    add_to_set(tmp_path / "elsewhere" / "slip.png", b"4")
    assert not (tmp_path / "elsewhere" / MANIFEST).exists()


@pytest.mark.parametrize("mode", [0o555, 0o500])
def test_folder_that_may_not_be_written_is_refused_and_nothing_is_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, mode: int
) -> None:
    folder = tmp_path / "area" / "board"
    prepare(folder)
    folder.chmod(mode)
    mkdir = os.mkdir

    def refuse(path: Path, mode: int = 0o777) -> None:  # root may write everywhere
        if not os.stat(path.parent).st_mode & 0o200:
            raise PermissionError(errno.EACCES, "Permission denied", str(path))
        mkdir(path, mode)

    monkeypatch.setattr(os, "mkdir", refuse)
    with pytest.raises(OutputError, match="board: may not be written; change its mode"):
        writer(folder, "new").write(NEW)
    assert [path.name for path in folder.parent.iterdir()] == ["board"]
    folder.chmod(0o755)
    assert_whole(folder)
    assert files_in(folder) == OLD


@pytest.mark.parametrize("place", ["/proc/fingertip/board", "area/" + 300 * "b"])
def test_a_place_that_cannot_be_written_is_refused_before_work_whatever_its_mode(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, place: str
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(
        OutputError, match=r"cannot be written \((No such file|File name too long).*another folder"
    ):
        writer(Path(place), "new").check(NEW)
    writer(Path("area/board"), "new").check(NEW)
    assert list(tmp_path.iterdir()) == []


# Single files


def test_killed_writer_of_one_file_leaves_it_as_it_was_and_the_next_one_cleans_up(
    tmp_path: Path,
) -> None:
    path = tmp_path / "trace.csv"
    operation = 0
    killed = True
    while killed:
        path.write_bytes(b"old")
        killed = run_and_kill_before(operation, lambda: write_file(path, b"new"))
        assert path.read_bytes() in (b"old", b"new")
        write_file(tmp_path / "other.csv", b"other")
        assert sorted(p.name for p in tmp_path.iterdir()) == ["other.csv", "trace.csv"]
        operation += 1
    assert operation > 2


def write_in_pieces(path: Path, length: int, piece: int) -> None:
    with open_atomic(path) as file:
        for _ in range(length // piece):
            file.write(bytes(piece))


def test_a_file_names_errors_of_its_own_and_no_others(tmp_path: Path) -> None:
    path = tmp_path / "new" / "a.csv"
    with pytest.raises(FileNotFoundError, match="other"), open_atomic(path):
        (tmp_path / "other").read_bytes()
    for error in (ValueError("no file"), OSError("no name")):
        with pytest.raises(type(error), match=str(error)), open_atomic(path):
            raise error
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, before[1]))  # fails as a full disk does
    try:
        for size in (30_000, 5_000):  # within the block, and at its end
            with pytest.raises(OutputError, match=r"a\.csv: cannot be written \(File too large\)"):
                write_in_pieces(path, 30_000, size)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert list(tmp_path.iterdir()) == []


def test_unfinished_file_of_a_running_process_is_left_alone(tmp_path: Path) -> None:
    with open_atomic(tmp_path / "long.csv") as file:
        file.write(b"half")
        write_file(tmp_path / (251 * "s" + ".csv"), b"as long a name as disks permit")
        file.write(b" and half")
    assert (tmp_path / "long.csv").read_bytes() == b"half and half"


def test_revised_file_gets_its_own_content_and_stays_somebodys_own(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    writer(folder, "old").write(OLD)
    revisions = {"bom.csv": Revision(b"edited parts", b"edited new parts")}
    (folder / "bom.csv").write_bytes(b"edited again")
    with pytest.raises(
        OutputError, match=r"bom\.csv: was changed while this command was running; run it again"
    ):
        writer(folder, "new").write(NEW, revisions=revisions)
    assert files_in(folder) == OLD | {"bom.csv": b"edited again"}
    (folder / "bom.csv").write_bytes(b"edited parts")
    writer(folder, "new").check(NEW, revisions)
    writer(folder, "new").write(NEW, revisions=revisions)
    assert files_in(folder) == NEW | {"bom.csv": b"edited new parts"}
    assert read_manifest(folder).files["bom.csv"] == hashlib.sha256(NEW["bom.csv"]).hexdigest()
    with pytest.raises(
        OutputError, match=r"bom\.csv: was not written by fingertip, or was changed since"
    ):
        writer(folder, "old").write(OLD)
