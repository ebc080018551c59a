"""Sets of output files: written whole or not at all, and protected from being overwritten.

A set is what one command writes to a folder. Its manifest, `manifest.json`, lists the files with their hashes. A new
set takes the place of the old one in a single step: it is made beside the folder, with hard links to all that is not
part of it, and both folders then swap their names. Whoever is killed in between leaves the old set or the new one.
Where folders cannot be swapped (another file system, Windows, the current folder of this process), the files are
renamed one after the other, and the next command that writes to the folder or checks it completes what was begun.

A file that the manifest does not name, or that was changed since, is somebody's own. It is never overwritten or
removed unless that is asked for.
"""

from __future__ import annotations

import contextlib
import ctypes
import errno
import hashlib
import json
import os
import shutil
import sys
import time
from collections.abc import Collection, Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from fingertip._version import __version__
from fingertip.errors import Issue, OutputError

MANIFEST = "manifest.json"
_COMMIT = ".fingertip-commit"
"""Folder, within the output folder, of files that are renamed one after the other."""
_PLAN, _COMPLETE = "plan.json", "complete.json"
"""Name of the list of renames before and after all files were written."""
_LOCK_S = 60.0
"""Time for which a command waits for another one that writes to the same place."""


@dataclass(frozen=True)
class Manifest:
    """Files of a set, and what they were made from."""

    fingertip: str
    """Version that wrote the set."""
    kind: str
    """Kind of set, such as "parts" or "board"."""
    design: str
    """Name of the design."""
    parameters: str
    """Hash of the parameters that the files depend on."""
    files: Mapping[str, str]
    """Name of each file -> SHA-256 hash."""

    def to_bytes(self) -> bytes:
        """Content of the file."""
        return (json.dumps(asdict(self) | {"files": dict(sorted(self.files.items()))}, indent=2) + "\n").encode()


@dataclass(frozen=True)
class SetWriter:
    """Writer of one set: its place, what it is made from, and how it treats other files there."""

    folder: Path
    kind: str
    design: str
    parameters: str
    adopted: Collection[str] = ()
    """Files of an earlier version without manifest that count as this program's own."""
    force: bool = False
    """True if files that are somebody's own may be overwritten."""
    in_place: bool = False
    """True if the folder must not be swapped, because a file in it is open."""

    def check(self, names: Collection[str]) -> None:
        """Refuse to write these names if one is somebody's own or a folder, before work starts.

        Raises
        ------
        OutputError
            With all such names.
        """
        with _output_errors(self.folder):
            issues = [
                Issue(str(self.folder / name), "is a folder; move it away, or choose another folder with --out.")
                for name in names
                if (self.folder / name).is_dir()
            ]
            if not self.force:
                issues += (
                    Issue(
                        str(self.folder / name),
                        "was not written by fingertip, or was changed since; move it away, choose another folder with "
                        "--out, or add --force to overwrite it.",
                    )
                    for name in sorted(self._foreign(names))
                )
        if issues:
            raise OutputError(issues)

    def write(self, contents: Mapping[str, bytes]) -> tuple[str, ...]:
        """Write the set: the folder holds either the old set or the new one at any moment.

        Files of the old set stay if they were made from the same parameters. Otherwise those that nobody changed are
        removed.

        Returns
        -------
        tuple
            Names of the files that were removed.

        Raises
        ------
        OutputError
            If the folder or a file cannot be written, or a file is somebody's own. Nothing has changed then.
        """
        folder = self.folder.resolve()
        created = [path for path in (folder, *folder.parents) if not path.exists()]
        try:
            with _output_errors(self.folder):
                folder.parent.mkdir(parents=True, exist_ok=True)
                with _lock(folder.parent):
                    recover(folder)
                    self.check((*contents, MANIFEST))
                    return self._write(folder, contents)
        except BaseException:
            for path in created:
                with contextlib.suppress(OSError):
                    path.rmdir()
            raise

    def add(self, contents: Mapping[str, bytes]) -> None:
        """Write some files of a set to a folder that holds no set, or one of the same parameters.

        Raises
        ------
        OutputError
            As `write` does, and if the folder holds a set of other parameters.
        """
        manifest = read_manifest(self.folder)
        if manifest and (manifest.kind, manifest.parameters) != (self.kind, self.parameters):
            message = (
                f"holds the {manifest.kind} of another design, or of other parameters of {manifest.design!r}; build "
                "this design there first, or name a file with --out."
            )
            raise OutputError(Issue(str(self.folder), message))
        self.write(contents)

    def _write(self, folder: Path, contents: Mapping[str, bytes]) -> tuple[str, ...]:
        old = read_manifest(folder)
        known = dict(old.files) if old else dict.fromkeys(self.adopted, "")
        same = old is not None and (old.kind, old.parameters) == (self.kind, self.parameters)
        others = [name for name in known if name not in contents and (folder / name).is_file()]
        removed = () if same else tuple(sorted(set(others) - self._foreign(others)))
        kept = {name: known[name] for name in others} if same else {}
        hashes = {name: hashlib.sha256(data).hexdigest() for name, data in contents.items()}
        manifest = Manifest(__version__, self.kind, self.design, self.parameters, kept | hashes)
        files = {**contents, MANIFEST: manifest.to_bytes()}
        if self.in_place or not _swap_in(folder, files, removed):
            _rename_in(folder, files, removed)
        return removed

    def _foreign(self, names: Collection[str]) -> set[str]:
        """Names of existing files that are somebody's own."""
        manifest, foreign = read_manifest(self.folder), set()
        for name in names:
            path = self.folder / name
            if name == MANIFEST and manifest is None and path.exists():
                foreign.add(name)
            elif path.is_file() and name != MANIFEST:
                listed = manifest.files.get(name) if manifest else None
                is_own = _hash(path) == listed if manifest else name in self.adopted
                if not is_own:
                    foreign.add(name)
        return foreign


def hash_parameters(data: object) -> str:
    """Hash plain data, such as the parameters that a set was made from."""
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()


def read_manifest(folder: Path) -> Manifest | None:
    """Read the manifest of a folder; None if it has none, or one that is not of this program."""
    try:
        data = json.loads((folder / MANIFEST).read_bytes())
        return Manifest(**{name: data[name] for name in ("fingertip", "kind", "design", "parameters", "files")})
    except (OSError, ValueError, KeyError, TypeError):
        return None


def verify_sets(folder: Path) -> tuple[int, list[str]]:
    """Compare the sets in a folder and its subfolders with their manifests.

    Returns
    -------
    count
        Number of files that manifests list.
    differences
        Description of each file that is missing or was changed; empty if there is none.

    Raises
    ------
    OutputError
        If there is no manifest.
    """
    recover(folder.resolve())
    manifests = {path.parent: read_manifest(path.parent) for path in sorted(folder.rglob(MANIFEST))}
    found = {place: manifest for place, manifest in manifests.items() if manifest}
    if not found:
        message = f"has no {MANIFEST} of fingertip; name a design file, or a folder that a command wrote."
        raise OutputError(Issue(str(folder), message))
    differences = []
    for place, manifest in found.items():
        for name, digest in manifest.files.items():
            path = place / name
            if not path.is_file():
                differences.append(f"{path}: is missing.")
            elif _hash(path) != digest:
                differences.append(f"{path}: was changed after it was written.")
    return sum(len(manifest.files) for manifest in found.values()), differences


def recover(folder: Path) -> None:
    """Complete or undo what a command that was killed has left in or beside a folder."""
    staging = _staging(folder)
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
            shutil.rmtree(path, ignore_errors=True)


def _staging(folder: Path) -> Path:
    """Folder beside an output folder in which a new set is made. A hidden name: it exists for a moment only."""
    return folder.with_name(f".{folder.name}.fingertip")


def _free_name(path: Path) -> Path:
    while path.exists():
        path = path.with_name(path.name + ".recovered")
    return path


def _swap_in(folder: Path, files: Mapping[str, bytes], removed: Collection[str]) -> bool:
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
            (staging / name).write_bytes(data)
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


def _rename_in(folder: Path, files: Mapping[str, bytes], removed: Collection[str]) -> None:
    """Put files in place one after the other, after a plan that `recover` can complete."""
    commit = folder / _COMMIT
    commit.mkdir(parents=True)
    try:
        for name, data in files.items():
            (commit / f"new-{name}").write_bytes(data)
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


@contextlib.contextmanager
def _lock(folder: Path) -> Iterator[None]:
    """Hold a lock on a folder while a set in it is replaced. The lock ends with the process, however it ends."""
    try:
        import fcntl
    except ImportError:  # Windows: sets are not locked there
        yield
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        deadline = time.monotonic() + _LOCK_S
        while True:
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except OSError as error:
                if error.errno not in (errno.EWOULDBLOCK, errno.EACCES):
                    break  # a file system without locks
                if time.monotonic() > deadline:
                    message = f"another command has been writing here for {_LOCK_S:g} s; wait for it and try again."
                    raise OutputError(Issue(str(folder), message)) from error
                time.sleep(0.02)
        yield
    finally:
        os.close(handle)


@contextlib.contextmanager
def _output_errors(folder: Path) -> Iterator[None]:
    """Turn errors of the operating system into an OutputError with a remedy."""
    try:
        yield
    except OSError as error:
        reason = error.strerror or str(error)
        message = f"cannot be written ({reason}); choose another folder with --out."
        raise OutputError(Issue(str(folder), message)) from error


def _hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
