"""Replacement of files in a folder: all of them or none, even if the process is killed.

The new files are put in place in a single step: a folder with them is made beside the old one, with
hard links to all that stays, and both folders then swap their names. A process that is killed in
between leaves the old files or the new ones. Where folders cannot be swapped (another file system,
Windows, the current folder of this process), the files are renamed one after the other, and the
next command that writes to the folder completes the renames.

Only folders are taken for leftovers of a killed command, no links. A plan of renames identifies the
file that it replaces: a file that was changed or added since stays.
"""

from __future__ import annotations

import contextlib
import ctypes
import hashlib
import json
import os
import shutil
import sys
import time
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path

from fingertip.foundation.errors import InputFileError, Issue, OutputError
from fingertip.foundation.files import lock_folder
from fingertip.foundation.input_files import PARSED_LIMIT, is_safe_name, read_input

# Content of a file that is to be written: its bytes, or the path of a finished file that is too
# large for memory.

Content = bytes | Path


def hash_content(content: Content) -> str:
    if isinstance(content, Path):
        with content.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()

    return hashlib.sha256(content).hexdigest()


def write_content(content: Content, path: Path) -> None:
    if isinstance(content, Path):
        shutil.copyfile(content, path)
    else:
        path.write_bytes(content)


_COMMIT = ".fingertip-commit"
"""Folder, within the output folder, of files that are renamed one after the other."""
_TRIAL = ".fingertip-trial"
"""Folder, within an output folder or one above it, of a file that is written as a trial."""
_PLAN = "plan.json"
_COMPLETE = "complete.json"
"""Name of the list of renames before and after all files were written."""
_STAGING_SUFFIX = ".fingertip"


def replace_files(
    folder: Path, files: Mapping[str, Content], removed: Collection[str], in_place: bool
) -> None:
    """Write some files of a folder and remove others.

    The caller holds the lock of the folder's parent.
    """
    if in_place or not _swap_in(folder, files, removed):
        _rename_in(folder, files, removed)


def find_unfinished(folder: Path) -> Iterator[Path]:
    """Find the folders that a killed command has left in and beside an output folder."""
    return filter(is_folder, (staging_folder(folder), folder / _COMMIT, folder / _TRIAL))


def find_output_folder(path: Path) -> Path | None:
    """Find the output folder of a killed command's leftover; None for any other folder."""
    if path.name == _COMMIT:
        return path.parent

    name = path.name[1:].removesuffix(_STAGING_SUFFIX)
    is_staging = path.name == f".{name}{_STAGING_SUFFIX}" and is_safe_name(name)
    return path.with_name(name) if is_staging else None


def recover(folder: Path) -> None:
    """Complete or undo the work of a command that was killed while it wrote to a folder.

    Raises OutputError.
    """
    staging = staging_folder(folder)
    if is_folder(staging):
        staging.chmod(0o700)  # it may have the mode of a folder that was made read-only
        # After a swap the subfolders may still be in the old folder. Before one it has none.
        if folder.exists():
            _bring_back_subfolders(staging, folder)

        shutil.rmtree(staging)

    if is_folder(folder / _COMMIT):
        _finish_renames(folder)

    for path in find_unfinished(folder):
        shutil.rmtree(path)


def _bring_back_subfolders(staging: Path, folder: Path) -> None:
    """Move the subfolders of an old folder to the new one, beside any of the same name."""
    for path in staging.iterdir():
        if is_folder(path) and not path.name.startswith(_COMMIT):
            target = folder / path.name
            while os.path.lexists(target):
                target = target.with_name(target.name + ".recovered")

            os.rename(path, target)


def try_to_write(folder: Path, path: Path) -> None:
    """Write a file below a folder, whose parent the caller has locked, and remove it again.

    Raises OSError.
    """
    place = folder / _TRIAL
    if is_folder(place):  # a command was killed here
        shutil.rmtree(place)

    with contextlib.ExitStack() as undo:
        for name in (*path.parent.parts, ""):
            place.mkdir()
            undo.callback(place.rmdir)
            place /= name

        undo.callback((place / path.name).unlink, missing_ok=True)
        (place / path.name).write_bytes(b"?")


def read_plan(commit: Path) -> tuple[dict[str, str], dict[str, str]]:
    """Read which files a complete plan of renames puts in place, and which it removes.

    Each name comes with the identity of the file that it had when the plan was made, as `_identify`
    returns it. Without a plan there are none. Raises OutputError.
    """
    if not os.path.lexists(commit / _COMPLETE):
        return {}, {}

    try:
        plan = json.loads(read_input(commit / _COMPLETE, PARSED_LIMIT, below=commit))
        return dict(plan["files"]), dict(plan["removed"])
    except (InputFileError, ValueError, KeyError, TypeError):
        remedy = "remove this folder, then write the set again"
        message = f"holds a damaged {_COMPLETE}, so that nothing can complete it; {remedy}."
        raise OutputError(Issue(str(commit), message)) from None


_ABSENT = "nothing"
_OTHER = "no file"


def _identify(path: Path) -> str:
    """Return the hash of a regular file; a mark if there is nothing; or else, as for a link, its
    number and time of change.
    """
    if not os.path.lexists(path):
        return _ABSENT
    if path.is_file() and not path.is_symlink():
        return hash_content(path)

    status = os.lstat(path)
    return f"{_OTHER}: {status.st_ino}, {status.st_ctime_ns}"


def is_folder(path: Path) -> bool:
    return path.is_dir() and not path.is_symlink()


def staging_folder(folder: Path) -> Path:
    """Return the hidden folder beside an output folder in which a new set is made."""
    return folder.parent / f".{folder.name}{_STAGING_SUFFIX}"


def _swap_in(folder: Path, files: Mapping[str, Content], removed: Collection[str]) -> bool:
    """Put files in place by swapping folders.

    Returns False if that is not possible here; nothing has changed then.
    """
    if _is_current(folder):
        return False

    staging = staging_folder(folder)
    try:
        staging.mkdir()
    except OSError:
        return False

    try:
        for name, data in files.items():
            write_content(data, staging / name)

        if not folder.exists():
            os.rename(staging, folder)
            return True

        shutil.copymode(folder, staging)
        subfolders = []
        for entry in os.scandir(folder):
            if entry.name in files or entry.name in removed:
                continue

            if entry.is_symlink():
                os.symlink(os.readlink(entry.path), staging / entry.name)
            elif entry.is_dir():
                subfolders.append(entry.name)
            else:
                _link(entry.path, staging / entry.name)

        if not _swap(staging, folder):
            shutil.rmtree(staging)
            return False

        staging.chmod(0o700)
        for name in subfolders:
            os.rename(staging / name, folder / name)

        shutil.rmtree(staging)
        return True
    except BaseException:
        with contextlib.suppress(OSError, OutputError):
            recover(folder)

        raise


def _is_current(folder: Path) -> bool:
    """Return whether a folder is or contains the current one, which would not follow a swap."""
    try:
        current = Path.cwd()
    except OSError:
        return False

    return folder == current or folder in current.parents


def _link(source: str, target: Path) -> None:
    try:
        os.link(source, target, follow_symlinks=False)
    except OSError:  # a file system without hard links
        if not os.path.isfile(source):  # a copy of a pipe or device may never end
            raise

        shutil.copy2(source, target, follow_symlinks=False)


def _swap(first: Path, second: Path) -> bool:
    """Swap the names of two folders in one step; False where the system cannot."""
    try:
        libc = ctypes.CDLL(None, use_errno=True)
        if sys.platform == "darwin":
            result = libc.renamex_np(os.fsencode(first), os.fsencode(second), 2)
        else:
            here = -100  # AT_FDCWD: relative to the current folder
            result = libc.renameat2(here, os.fsencode(first), here, os.fsencode(second), 2)
    except (OSError, AttributeError, TypeError):
        return False

    return bool(result == 0)


def _rename_in(folder: Path, files: Mapping[str, Content], removed: Collection[str]) -> None:
    """Put files in place one after the other, after a plan that `recover` can complete."""
    commit = folder / _COMMIT
    commit.mkdir(parents=True)

    try:
        for name, data in files.items():
            write_content(data, commit / f"new-{name}")

        plan = {
            "files": {name: _identify(folder / name) for name in files},
            "removed": {name: _identify(folder / name) for name in removed},
        }
        (commit / _PLAN).write_text(json.dumps(plan), "utf-8")
    except BaseException:
        shutil.rmtree(commit, ignore_errors=True)
        raise

    os.rename(commit / _PLAN, commit / _COMPLETE)
    _finish_renames(folder)


def _finish_renames(folder: Path) -> None:
    """Carry out a complete plan, or the rest of it. The manifest comes last."""
    commit = folder / _COMMIT
    files, removed = read_plan(commit)

    for name, before in removed.items():
        if before != _ABSENT and _identify(folder / name) == before:
            (folder / name).unlink()

    for name, before in files.items():
        if os.path.lexists(commit / f"new-{name}") and _identify(folder / name) == before:
            os.replace(commit / f"new-{name}", folder / name)

    shutil.rmtree(commit)


LOCK_S = 60.0
"""Time for which a command waits for another one that writes to the same place."""


@contextlib.contextmanager
def lock(folder: Path, *, shared: bool = False) -> Iterator[None]:
    """Hold a lock on a folder until the block, or the process, ends.

    Commands that only read a set share it. Raises OutputError after `LOCK_S`.
    """
    handle = None
    deadline = time.monotonic() + LOCK_S

    while True:
        try:
            # A folder that may not be listed cannot be locked either.
            with contextlib.suppress(PermissionError):
                handle = lock_folder(folder, shared=shared)

            break
        except BlockingIOError as error:
            if time.monotonic() > deadline:
                message = (
                    f"another command has been writing here for {LOCK_S:g} s; wait for it "
                    "and try again."
                )
                raise OutputError(Issue(str(folder), message)) from error

            time.sleep(0.02)

    try:
        yield
    finally:
        if handle is not None:
            os.close(handle)


@contextlib.contextmanager
def output_errors(folder: Path) -> Iterator[None]:
    """Turn errors of the operating system into an OutputError with a remedy."""
    try:
        yield
    except OSError as error:
        message = (
            f"cannot be written ({error.strerror or str(error)}); choose another folder with --out."
        )
        raise OutputError(Issue(str(folder), message)) from error
