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
from fingertip.files import write_file

MANIFEST = "manifest.json"
_COMMIT = ".fingertip-commit"
"""Folder, within the output folder, of files that are renamed one after the other."""
_PLAN, _COMPLETE = "plan.json", "complete.json"
"""Name of the list of renames before and after all files were written."""
_OF_ONE_DESIGN = ("parts", "board", "fabrication", "signal")
"""Kinds of sets in the folder of a design, which belong together if they were made from the same parameters."""
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
        """Refuse to write these names if the folder cannot take them, before work starts.

        Parameters
        ----------
        names
            Names of the files; with their contents, files that are equal already do not count.

        Raises
        ------
        OutputError
            If the folder is a file, may not be written or holds a set of another kind, or if a name is that of a
            folder or of a file that is somebody's own.
        """
        try:
            self._refuse(names)
        except OutputError:
            parent = self.folder.resolve().parent
            if not parent.is_dir():
                raise
            # Another command may just have swapped the folder between two looks at it.
            with _output_errors(self.folder), _lock(parent):
                self._refuse(names)

    def _refuse(self, names: Collection[str]) -> None:
        with _output_errors(self.folder):
            if issues := list(self._find_issues(names)):
                raise OutputError(issues)

    def _find_issues(self, names: Collection[str]) -> Iterator[Issue]:
        place = next((path for path in (self.folder, *self.folder.parents) if path.exists()), self.folder)
        if not place.is_dir():
            yield Issue(str(place), "is a file; choose another folder with --out.")
            return
        if not os.access(place, os.W_OK):
            yield Issue(str(place), "may not be written; change its mode, or choose another folder with --out.")
        manifest = read_manifest(self.folder)
        if manifest and manifest.kind != self.kind:
            message = f"holds the {manifest.kind} of {manifest.design!r}; choose another folder with --out, such as"
            yield Issue(str(self.folder), f"{message} {self.folder / self.kind}.")
            return
        yield from (
            Issue(str(self.folder / name), "is a folder; move it away, or choose another folder with --out.")
            for name in names
            if (self.folder / name).is_dir()
        )
        foreign = [] if self.force else sorted(self._foreign(names))
        remedy = "move it away, choose another place with --out, or add --force to overwrite it."
        if len(foreign) > 1 and manifest is None:
            yield Issue(
                str(self.folder),
                f"has no {MANIFEST} that says who wrote {', '.join(foreign)}; move them away, choose another place "
                "with --out, or add --force to overwrite them.",
            )
        else:
            for name in foreign:
                yield Issue(str(self.folder / name), f"was not written by fingertip, or was changed since; {remedy}")

    def write(self, contents: Mapping[str, bytes], obsolete: Collection[str] = ()) -> tuple[str, ...]:
        """Write the set: the folder holds either the old set or the new one at any moment.

        Files of the old set stay if they were made from the same parameters. Otherwise those that nobody changed are
        removed.

        Parameters
        ----------
        contents
            Name -> content of each file.
        obsolete
            Files of the old set that are to be removed in any case, unless somebody changed them.

        Returns
        -------
        tuple
            Names of the files that were removed.

        Raises
        ------
        OutputError
            As `check` does, or if a file cannot be written. Nothing has changed then.
        """
        self.check(())
        folder = self.folder.resolve()
        created = [path for path in (folder, *folder.parents) if not path.exists()]
        try:
            with _output_errors(self.folder):
                folder.parent.mkdir(parents=True, exist_ok=True)
                with _lock(folder.parent):
                    recover(folder)
                    self._refuse({**contents, MANIFEST: b""})
                    return self._write(folder, contents, obsolete)
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

    def _write(self, folder: Path, contents: Mapping[str, bytes], obsolete: Collection[str]) -> tuple[str, ...]:
        old = read_manifest(folder)
        known = dict(old.files) if old else dict.fromkeys(self.adopted, "")
        same = old is not None and (old.kind, old.parameters) == (self.kind, self.parameters)
        others = [name for name in known if name not in contents and (folder / name).is_file()]
        unwanted = set(others) & set(obsolete) if same else set(others)
        removed = tuple(sorted(unwanted - self._foreign(unwanted)))
        kept = {name: known[name] for name in others if name not in removed} if same else {}
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
            if name == MANIFEST:
                is_own = manifest is not None or not path.exists()
            elif not path.is_file() or (isinstance(names, Mapping) and path.read_bytes() == names[name]):
                is_own = True
            else:
                is_own = _hash(path) == manifest.files.get(name) if manifest else name in self.adopted
            if not is_own:
                foreign.add(name)
        return foreign


def add_to_set(path: Path, data: bytes, option: str = "--out") -> None:
    """Write one file; where its folder holds a set, the file becomes a part of it.

    Raises
    ------
    OutputError
        If the file cannot be written, or the set's folder holds a file of this name that is somebody's own.
    """
    manifest = read_manifest(path.parent)
    if manifest is None or path.is_dir():
        write_file(path, data, option)
    else:
        SetWriter(path.parent, manifest.kind, manifest.design, manifest.parameters).write({path.name: data})


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
    with _output_errors(folder):
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
    top = found.get(folder)
    for place, manifest in found.items():
        if top and manifest.kind in _OF_ONE_DESIGN and manifest.parameters != top.parameters:
            differences.append(f"{place}: was made from other parameters than {folder}; make both again.")
    return sum(len(manifest.files) for manifest in found.values()), differences


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
