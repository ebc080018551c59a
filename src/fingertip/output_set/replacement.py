"""Replacement of files in a folder: all of them or none, even if the process is killed.

The new files are put in place in a single step: a folder with them is made beside the old one, with hard links to all
that stays, and both folders then swap their names. Whoever is killed in between leaves the old files or the new ones.
Where folders cannot be swapped (another file system, Windows, the current folder of this process), the files are
renamed one after the other, and the next command that writes to the folder or checks it completes what was begun.
"""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import shutil
import sys
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path

from fingertip.output_set.content import Content, write_content

_COMMIT = ".fingertip-commit"
"""Folder, within the output folder, of files that are renamed one after the other."""
_PLAN, _COMPLETE = "plan.json", "complete.json"
"""Name of the list of renames before and after all files were written."""
_STAGING_SUFFIX = ".fingertip"


def replace_files(
    folder: Path, files: Mapping[str, Content], removed: Collection[str] = (), *, in_place: bool = False
) -> None:
    """Write some files of a folder and remove others. The caller holds the lock of the folder's parent.

    Parameters
    ----------
    folder
        Absolute path; the folder may be missing, its parent not.
    files
        Name -> content of each file, the manifest last.
    removed
        Names of the files to remove.
    in_place
        Whether the folder must not be swapped.
    """
    if in_place or not _swap_in(folder, files, removed):
        _rename_in(folder, files, removed)


def find_unfinished(folder: Path) -> Iterator[Path]:
    """Find the folders that `recover` has to complete: this one, and those within it."""
    if _staging(folder).is_dir() or next(folder.glob(".fingertip-*"), None):
        yield folder
    for path in sorted(folder.rglob(f".?*{_STAGING_SUFFIX}")):
        yield path.with_name(path.name[1:].removesuffix(_STAGING_SUFFIX))
    for path in sorted(folder.rglob(_COMMIT)):
        if path.parent != folder:
            yield path.parent


def recover(folder: Path) -> None:
    """Complete or undo what a command that was killed has left in or beside a folder."""
    staging = _staging(folder)
    if staging.is_dir():
        staging.chmod(0o700)  # it may have the mode of a folder that was made read-only
    if staging.is_dir() and not folder.exists():
        shutil.rmtree(staging)  # of a set that was never put in place
    if staging.is_dir():
        # After a swap the subfolders may still be in the old folder. Before one there are none in it.
        for path in staging.iterdir():
            if path.is_dir() and not path.is_symlink():
                os.rename(path, _free_name(folder / path.name))
        shutil.rmtree(staging)
    commit = folder / _COMMIT
    if (commit / _COMPLETE).is_file():
        _finish_renames(folder)
    elif commit.is_dir():
        shutil.rmtree(commit)
    if folder.is_dir():
        for path in folder.glob(".fingertip-????????"):  # temporary folders of version 0.1
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path, ignore_errors=True)


def try_to_write(folder: Path, path: Path) -> None:
    """Write a file below a folder and remove it again. The caller holds the lock of the folder's parent.

    What a command that was killed has left of it, `recover` removes as it does unfinished renames.

    Raises
    ------
    OSError
        If that is not possible.
    """
    recover(folder)
    with contextlib.ExitStack() as undo:
        made = folder / _COMMIT
        for name in (*path.parent.parts, ""):
            made.mkdir()
            undo.callback(made.rmdir)
            made /= name
        undo.callback((made / path.name).unlink, missing_ok=True)
        (made / path.name).write_bytes(b"?")


def _staging(folder: Path) -> Path:
    """Folder beside an output folder in which a new set is made. A hidden name: it exists for a moment only."""
    return folder.parent / f".{folder.name}{_STAGING_SUFFIX}"


def _free_name(path: Path) -> Path:
    while path.exists():
        path = path.with_name(path.name + ".recovered")
    return path


def _swap_in(folder: Path, files: Mapping[str, Content], removed: Collection[str]) -> bool:
    """Put files in place by swapping folders; False if that is not possible here, and nothing has changed then."""
    if _is_current(folder):
        return False
    staging = _staging(folder)
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
        with contextlib.suppress(OSError):
            recover(folder)
        raise


def _is_current(folder: Path) -> bool:
    """Return whether this process, and the shell that started it, stand in a folder; they would stay in the old one."""
    try:
        current = Path.cwd()
    except OSError:
        return False
    return folder == current or folder in current.parents


def _link(source: str, target: Path) -> None:
    try:
        os.link(source, target, follow_symlinks=False)
    except OSError:  # a file system without hard links
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
        plan = {"files": list(files), "removed": list(removed)}
        (commit / _PLAN).write_text(json.dumps(plan), "utf-8")
    except BaseException:
        shutil.rmtree(commit, ignore_errors=True)
        raise
    os.rename(commit / _PLAN, commit / _COMPLETE)
    _finish_renames(folder)


def _finish_renames(folder: Path) -> None:
    """Carry out a complete plan, or the rest of it. The manifest comes last."""
    commit = folder / _COMMIT
    plan = json.loads((commit / _COMPLETE).read_bytes())
    for name in plan["removed"]:
        (folder / name).unlink(missing_ok=True)
    for name in plan["files"]:
        if (commit / f"new-{name}").exists():
            os.replace(commit / f"new-{name}", folder / name)
    shutil.rmtree(commit)
