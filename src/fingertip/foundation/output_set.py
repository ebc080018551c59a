"""Sets of output files: written whole or not at all, and protected from being overwritten.

A set is what one command writes to a folder. Its manifest, `manifest.json`, lists the files with
their hashes.

A file that the manifest does not name, or that was changed since, is somebody's own. It is never
overwritten or removed unless that is asked for.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import struct
import zipfile
import zlib
from collections.abc import Collection, Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from fingertip import __version__
from fingertip.foundation import folder_swap, input_files
from fingertip.foundation.errors import InputFileError, Issue, OutputError, raise_issues
from fingertip.foundation.files import ZIP_DATE, encode_json, write_file
from fingertip.foundation.folder_swap import (
    Content,
    hash_content,
    is_folder,
    lock,
    output_errors,
    recover,
)

_NAME = "trial"


def find_place_issues(folder: Path, remedy: str, name: str = _NAME) -> Iterator[Issue]:
    """Find out whether a file can be written to a folder, and leave nothing behind.

    A mode says little: root may write everywhere, but to `/proc` or a disk that is mounted
    read-only nobody can.
    """
    target = Path(os.path.realpath(folder))
    try:
        place = _find_existing(target)
        # Another command may be about to swap this folder, and would take what is made here for
        # somebody's files.
        with lock(place.parent):
            folder_swap.try_to_write(place, target.relative_to(place) / name)
    except PermissionError:
        yield Issue(
            str(_find_existing(folder)), f"may not be written; change its mode, or {remedy}."
        )
    except OSError as error:
        path = folder if name == _NAME else folder / name
        yield Issue(str(path), f"cannot be written ({error.strerror or error}); {remedy}.")


def _find_existing(folder: Path) -> Path:
    return next((path for path in (folder, *folder.parents) if os.path.lexists(path)), folder)


@dataclass(frozen=True)
class Revision:
    """Content of an edited file before and after.

    The manifest keeps the hash of the file without edits.
    """

    before: bytes
    after: bytes


Revisions = Mapping[str, Revision]
_NONE: Revisions = {}


@dataclass(frozen=True)
class SetWriter:
    """Writer of one set: its place, what it is made from, and how it treats other files there."""

    folder: Path
    kind: str
    design: str
    parameters: str
    force: bool = False
    """True if files that are somebody's own may be overwritten."""
    in_place: bool = False
    """True if the folder must not be swapped, because a file in it is open."""
    top: Path | None = None
    """Folder that the user has named, if this one is below it: no link in between is followed."""
    program: str = ""
    """Digest of the program that makes the files.
    Empty to keep the one that the manifest records, if any.
    """

    def check(self, names: Collection[str], revisions: Revisions = _NONE) -> None:
        """Refuse to write these names if the folder cannot take them, before work starts.

        Raises OutputError.
        """
        names = {**names, MANIFEST: b""} if isinstance(names, Mapping) else {*names, MANIFEST}
        link = input_files.find_link(self.top or self.folder, self.folder)
        if link is None:
            finish_interrupted(self.folder)

        try:
            self._refuse(names, revisions)
        except OutputError:
            parent = Path(os.path.realpath(self.folder)).parent
            if link or not parent.is_dir():
                raise

            # Another command may just have swapped the folder between two looks at it.
            with output_errors(self.folder), lock(parent):
                self._refuse(names, revisions)

        raise_issues(
            OutputError, find_place_issues(self.folder, "choose another folder with --out")
        )

    def _refuse(self, names: Collection[str], revisions: Revisions) -> None:
        with output_errors(self.folder):
            raise_issues(OutputError, self._find_issues(names, revisions))

    def _find_issues(self, names: Collection[str], revisions: Revisions) -> Iterator[Issue]:
        link = input_files.find_link(self.top or self.folder, self.folder)
        if link:
            yield Issue(
                str(link),
                "is a link, which may lead to the files of others; remove it, or name its target.",
            )
            return

        place = next(
            (path for path in (self.folder, *self.folder.parents) if path.exists()), self.folder
        )
        if not place.is_dir():
            yield Issue(str(place), "is a file; choose another folder with --out.")
            return

        manifest = read_manifest(self.folder, self.top)
        if manifest and manifest.kind != self.kind:
            message = (
                f"holds the {manifest.kind} of {manifest.design!r}; choose another folder "
                "with --out, such as"
            )
            yield Issue(str(self.folder), f"{message} {self.folder / self.kind}.")
            return

        yield from (
            Issue(
                str(self.folder / name),
                "is a folder; move it away, or choose another folder with --out.",
            )
            for name in names
            if is_folder(self.folder / name)
        )
        known = manifest.files if manifest else {}
        yield from (
            Issue(
                str(self.folder / str(name)),
                "has a name that not every system can store there; choose another one.",
            )
            for name in input_files.find_unsafe_names(dict.fromkeys([*known, *names]))
        )
        foreign = [] if self.force else sorted(self._foreign(names) - set(revisions))

        for name, revision in revisions.items():
            path = self.folder / name
            if not has_hash(path, hash_content(revision.before)):
                yield Issue(str(path), "was changed while this command was running; run it again.")

        remedy = "move it away, choose another place with --out, or add --force to overwrite it."
        if len(foreign) > 1 and manifest is None:
            yield Issue(
                str(self.folder),
                f"has no {MANIFEST} that says who wrote {', '.join(foreign)}; move them away, "
                "choose another place "
                "with --out, or add --force to overwrite them.",
            )
        else:
            for name in foreign:
                yield Issue(
                    str(self.folder / name),
                    f"was not written by fingertip, or was changed since; {remedy}",
                )

    def write(
        self,
        contents: Mapping[str, Content],
        obsolete: Collection[str] = (),
        revisions: Revisions = _NONE,
    ) -> tuple[str, ...]:
        """Write the set: the folder holds either the old set or the new one at any moment.

        Files of the old set stay if they were made from the same parameters. Otherwise those that
        nobody changed are removed.

        Raises OutputError.
        """
        self.check(())
        folder = Path(os.path.realpath(self.folder))
        created = [path for path in (folder, *folder.parents) if not path.exists()]

        try:
            with output_errors(self.folder):
                folder.parent.mkdir(parents=True, exist_ok=True)
                with lock(folder.parent):
                    recover(folder)
                    self._refuse({**contents, MANIFEST: b""}, revisions)
                    return self._write(folder, contents, obsolete, revisions)
        except BaseException:
            for path in created:
                with contextlib.suppress(OSError):
                    path.rmdir()

            raise

    def add(self, contents: Mapping[str, Content]) -> None:
        """Write files of a set to a folder without a set, or with one of the same parameters.

        Raises OutputError.
        """
        self.check_addition(contents)
        self.write(contents)

    def check_addition(self, names: Collection[str]) -> None:
        """Refuse to add these names to a folder, before work starts. Raises OutputError."""
        self.check(names)
        manifest = read_manifest(self.folder, self.top)

        if manifest and (manifest.kind, manifest.parameters) != (self.kind, self.parameters):
            message = (
                f"holds the {manifest.kind} of another design, or of other parameters of "
                f"{manifest.design!r}; build "
                "this design there first, or name a file with --out."
            )
            raise OutputError(Issue(str(self.folder), message))

    def _write(
        self,
        folder: Path,
        contents: Mapping[str, Content],
        obsolete: Collection[str],
        revisions: Revisions,
    ) -> tuple[str, ...]:
        old = read_manifest(folder)
        known = dict(old.files) if old else {}
        same = old is not None and (old.kind, old.parameters) == (self.kind, self.parameters)
        not_written = [name for name in known if name not in contents and (folder / name).is_file()]
        unwanted = set(not_written) & set(obsolete) if same else set(not_written)
        removed = tuple(sorted(unwanted - self._foreign(unwanted)))
        staying = {name: known[name] for name in not_written if name not in removed} if same else {}
        hashes = {name: hash_content(data) for name, data in contents.items()}
        program = self.program or (old.program if old and same else "")
        manifest = Manifest(
            fingertip=__version__,
            kind=self.kind,
            design=self.design,
            parameters=self.parameters,
            files=staying | hashes,
            program=program,
        )
        files = {**contents, **{name: revision.after for name, revision in revisions.items()}}
        # A file that keeps its content stays as it is, with its date.
        files = {
            name: data
            for name, data in files.items()
            if name not in revisions or data != revisions[name].before
        }
        files[MANIFEST] = manifest.to_bytes()
        folder_swap.replace_files(folder, files, removed, self.in_place)

        return removed

    def _foreign(self, names: Collection[str]) -> set[str]:
        manifest = read_manifest(self.folder, self.top)
        foreign = set()
        for name in names:
            path = self.folder / name
            if not os.path.lexists(path) or is_folder(path):
                continue

            equal = hash_content(names[name]) if isinstance(names, Mapping) else None
            written = manifest.files.get(name) if manifest else None
            is_own = manifest is not None if name == MANIFEST else has_hash(path, equal, written)
            if not is_own:
                foreign.add(name)

        return foreign


def check_set(path: Path) -> None:
    """Refuse to write one file if `add_to_set` would refuse it for the set in its folder, before
    work starts.
    """
    manifest = read_manifest(path.parent)
    if manifest:
        SetWriter(path.parent, manifest.kind, manifest.design, manifest.parameters).check(
            [path.name]
        )


def finish_interrupted(folder: Path) -> None:
    """Complete or undo what a killed command has left in or beside an output folder.

    Raises OutputError.
    """
    folder = Path(os.path.realpath(folder))
    with output_errors(folder):
        if any(folder_swap.find_unfinished(folder)):
            with lock(folder.parent):
                recover(folder)


def add_to_set(path: Path, data: bytes, option: str = "--out") -> None:
    """Write one file; where its folder holds a set, the file becomes a part of it.

    Raises OutputError.
    """
    manifest = read_manifest(path.parent)
    if manifest is None or path.is_dir():
        write_file(path, data, option)
    else:
        SetWriter(path.parent, manifest.kind, manifest.design, manifest.parameters).write(
            {path.name: data}
        )


# Manifest of a set of files: what they are, and what they were made from.

MANIFEST = "manifest.json"
_SHA256 = re.compile("[0-9a-f]{64}")
_DAMAGED_ZIP = (
    zipfile.BadZipFile,
    zlib.error,
    struct.error,
    EOFError,
    KeyError,
    RuntimeError,
    ValueError,
)
"""Errors of reading an archive that is damaged, encrypted or packed in a way that Python does not
know.
"""


@dataclass(frozen=True)
class Manifest:
    fingertip: str
    """Version that wrote the set."""
    kind: str
    """Kind of set, such as "parts" or "board"."""
    design: str
    parameters: str
    """Hash of the parameters that the files depend on."""
    files: Mapping[str, str]
    """Name of each file -> SHA-256 hash."""
    program: str = ""
    """Digest of the program that made the files; empty where it is not recorded."""

    def to_bytes(self) -> bytes:
        """Encode the manifest as JSON, without a program that is not recorded."""
        data = asdict(self) | {"files": dict(sorted(self.files.items()))}
        if not self.program:
            del data["program"]

        return encode_json(data)


def read_manifest(folder: Path, below: Path | None = None) -> Manifest | None:
    """Read the manifest of a folder; None if it has none, or one that is not of this program.

    A set is the files of one folder: a manifest that names a file elsewhere is not of this program.
    `below` is the folder that the user has named, if that is another one above.
    """
    try:
        data = input_files.read_input(
            folder / MANIFEST, input_files.PARSED_LIMIT, below=below or folder
        )
    except InputFileError:
        return None

    return parse_manifest(data)


def parse_manifest(text: bytes) -> Manifest | None:
    """Parse the text of a manifest; None if it is not of this program."""
    try:
        data = json.loads(text)
        manifest = Manifest(
            **{name: data[name] for name in ("fingertip", "kind", "design", "parameters", "files")},
            program=data.get("program", ""),
        )
        texts = (
            manifest.fingertip,
            manifest.kind,
            manifest.design,
            manifest.parameters,
            manifest.program,
        )
        is_own = all(isinstance(text, str) for text in texts) and not input_files.find_unsafe_names(
            manifest.files
        )
        is_own &= all(_SHA256.fullmatch(digest) for digest in manifest.files.values())
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return None

    return manifest if is_own else None


def is_packed_set(path: Path) -> bool:
    """Tell whether a file is an archive of a set's folder as `write_zip` makes it: one folder, and
    no dates.
    """
    if path.is_symlink():
        return False

    try:
        with (
            input_files.open_input(path, input_files.RECORDING_LIMIT) as file,
            zipfile.ZipFile(file) as archive,
        ):
            members = archive.infolist()
            folders = {member.filename.partition("/")[0] for member in members}
            if len(folders) != 1 or any(member.date_time != ZIP_DATE for member in members):
                return False

            with archive.open(f"{folders.pop()}/{MANIFEST}") as manifest:
                text = manifest.read(input_files.PARSED_LIMIT.value)
    except (InputFileError, *_DAMAGED_ZIP):
        return False

    return parse_manifest(text) is not None


def hash_parameters(data: object) -> str:
    """Hash plain data, such as the parameters that a set was made from."""
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()


def hash_file(path: Path) -> str:
    with input_files.open_input(path, input_files.RECORDING_LIMIT, below=path.parent) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def has_hash(path: Path, *digests: str | None) -> bool:
    """Return whether a file is a regular one with one of these hashes, as it is or as git for
    Windows checks it out.
    """
    try:
        if hash_file(path) in digests:
            return True

        data = input_files.read_input(path, input_files.RECORDING_LIMIT, below=path.parent)
        return hash_content(fold_lines(data)) in digests
    except InputFileError:
        return False


def fold_lines(data: bytes) -> bytes:
    """Replace the line endings of Windows."""
    return data.replace(b"\r\n", b"\n")


def write_attributes(folder: Path) -> None:
    """Tell git, in a folder that is meant for a repository, to leave line endings as they are.

    A file that says so already stays.
    """
    path = folder / ".gitattributes"
    if not os.path.lexists(path):
        write_file(path, b"* -text\n")
