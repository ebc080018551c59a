"""Kinds of TOML files: design, set of fingers, scene, manipulation, surface and sweep.

This is the one place that decides what a TOML file is. The kinds share the suffix .toml, so that only the names at
the top level of a file tell them apart.
"""

from __future__ import annotations

import difflib
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingertip.foundation.errors import Issue, TomlFileError
from fingertip.foundation.tables import read_rows, read_toml


@dataclass(frozen=True)
class FileKind:
    name: str
    names: frozenset[str]
    """Names that may stand at the top level of the file. A test compares them with the models of the files."""
    example: str
    """Name of a bundled file of this kind."""
    use: str
    """Command that takes a file of this kind, for somebody who gave it in place of another one."""

    def describe(self) -> str:
        """Return the kind with its article, such as "a design file"."""
        return f"a {self.name} file"


KINDS = tuple(
    FileKind(row["name"], frozenset(row["names"].split()), row["example"], row["use"])
    for row in read_rows(Path(__file__).with_name("file_kinds.csv"))
)
SWEEP, SET, SURFACE, MANIPULATION, SCENE, DESIGN = KINDS


def read_file(path: Path, kind: FileKind, below: Path | None = None) -> dict[str, Any]:
    """Read a file, unless none of its names belongs to the expected kind alone, but some name to another kind."""
    tables = read_toml(path, kind.describe(), below)
    found = _find_kinds(tables)
    if found and kind not in found and not kind.names.issuperset(tables):
        other = next(iter(found))
        message = f"is {other.describe()}, not {kind.describe()}; give one such as {kind.example} ({other.use})."
        if (other, kind) == (SET, DESIGN):
            remedy = "give that of one finger, or the set to `fingertip make` or `check`"
            message = f"{message.partition(';')[0]}; {remedy}."
        raise TomlFileError(Issue(str(path), message))
    return tables


def identify_kind(path: Path) -> FileKind | None:
    """Identify the kind of a file by its names; None if it cannot be read or no name is known. Raises TomlFileError."""
    try:
        tables = read_toml(path)
    except TomlFileError:
        return None
    found = _find_kinds(tables)
    if len(found) > 1:
        parts = " and ".join(f"{min(names)} of a {kind.name}" for kind, names in found.items())
        remedy = "and give the design with --design" if DESIGN in found else "one for each"
        raise TomlFileError(Issue(str(path), f"holds {parts}; write them in two files {remedy}."))
    return next(iter(found), None)


def split_changes(changes: Iterable[str], kinds: Collection[FileKind]) -> tuple[list[str], list[str]]:
    """Split changes, such as "tap.force_n=5", into those of a file of some kinds and those of the design beside it.

    The name before the first dot decides. A name that only files of other kinds have counts as the file's, whose error
    then lists the file's names. Any other unknown name counts as the most similar known one, so that the error can
    suggest it.
    """
    own: list[str] = []
    others: list[str] = []
    foreign = frozenset().union(*(kind.names for kind in KINDS)) - DESIGN.names
    own_names = foreign.union(*(kind.names for kind in kinds))
    known = sorted(own_names | DESIGN.names)
    for change in changes:
        name = change.partition("=")[0].partition(".")[0].strip()
        similar = [name] if name in known else difflib.get_close_matches(name, known, n=1, cutoff=0.65)
        (own if own_names.intersection(similar) else others).append(change)
    return own, others


def _find_kinds(tables: Mapping[str, Any]) -> dict[FileKind, set[str]]:
    """Find the kinds that names at the top level of a file belong to, with these names.

    Names of one kind alone decide. Names that are shared count only if no other name decides for a kind that has them.
    A sweep file may hold names of all kinds.
    """
    names = set(tables)
    if names == SURFACE.names:  # a scene may have such a table too, beside others
        return {SURFACE: names}
    found: dict[FileKind, set[str]] = {}
    for kind in KINDS:
        shared = frozenset().union(*(other.names for other in KINDS if other is not kind))
        if own := names & (kind.names - shared):
            found[kind] = own
    if SWEEP in found:
        return {SWEEP: found[SWEEP]}
    for kind in reversed(KINDS):
        explained = frozenset().union(*(other.names for other in found))
        if left := (names & kind.names) - explained:
            found[kind] = found.get(kind, set()) | left
    return {kind: found[kind] for kind in KINDS if kind in found}
