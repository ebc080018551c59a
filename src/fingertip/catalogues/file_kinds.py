"""Kinds of TOML files (design, set, scene, manipulation, surface, sweep), and the bundled ones by
bare name.

This is the one place that decides what a TOML file is. The kinds share the suffix .toml, so that
only the names at the top level of a file tell them apart. A bare name is a single word without
suffix and slash, such as fsr400. An existing file of the same name comes first; a folder does not,
and ./fsr400 names it.
"""

from __future__ import annotations

import difflib
import os
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingertip.foundation.errors import Issue, TomlFileError, join_words
from fingertip.foundation.tables import read_rows, read_toml


@dataclass(frozen=True)
class FileKind:
    name: str
    names: frozenset[str]
    """Names that may stand at the top level of the file.
    A test compares them with the models of the files.
    """
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
    """Read a file, unless none of its names belongs to the expected kind alone, but some name to
    another kind.
    """
    tables = read_toml(path, kind.describe(), below)
    kinds = _find_kinds(tables)

    if kinds and kind not in kinds and not kind.names.issuperset(tables):
        actual = next(iter(kinds))
        message = (
            f"is {actual.describe()}, not {kind.describe()}; give one such as {kind.example} "
            f"({actual.use})."
        )
        if (actual, kind) == (SET, DESIGN):
            remedy = "give that of one finger, or the set to `fingertip make` or `check`"
            message = f"{message.partition(';')[0]}; {remedy}."

        raise TomlFileError(Issue(str(path), message))

    return tables


def identify_kind(path: Path) -> FileKind | None:
    """Identify the kind of a file by its names; None if it cannot be read or no name is known.

    Raises TomlFileError.
    """
    try:
        tables = read_toml(path)
    except TomlFileError:
        return None

    kinds = _find_kinds(tables)
    if len(kinds) > 1:
        parts = " and ".join(f"{min(names)} of a {kind.name}" for kind, names in kinds.items())
        remedy = "and give the design with --design" if DESIGN in kinds else "one for each"
        raise TomlFileError(Issue(str(path), f"holds {parts}; write them in two files {remedy}."))

    return next(iter(kinds), None)


def split_changes(
    changes: Iterable[str], kinds: Collection[FileKind]
) -> tuple[list[str], list[str]]:
    """Split changes, such as "tap.force_n=5", into those of a file of some kinds and those of the
    design beside it.

    The name before the first dot decides. A name that only files of other kinds have counts as the
    file's, whose error then lists the file's names. Any other unknown name counts as the most
    similar known one, so that the error can suggest it.
    """
    own: list[str] = []
    of_design: list[str] = []
    foreign = frozenset().union(*(kind.names for kind in KINDS)) - DESIGN.names
    own_names = foreign.union(*(kind.names for kind in kinds))
    known = sorted(own_names | DESIGN.names)

    for change in changes:
        name = change.partition("=")[0].partition(".")[0].strip()
        similar = (
            [name] if name in known else difflib.get_close_matches(name, known, n=1, cutoff=0.65)
        )
        (own if own_names.intersection(similar) else of_design).append(change)

    return own, of_design


def _find_kinds(tables: Mapping[str, Any]) -> dict[FileKind, set[str]]:
    """Find the kinds that names at the top level of a file belong to, with these names.

    Names of one kind alone decide. Names that are shared count only if no other name decides for a
    kind that has them. A sweep file may hold names of all kinds.
    """
    names = set(tables)
    if names == SURFACE.names:  # a scene may have such a table too, beside others
        return {SURFACE: names}

    own_names: dict[FileKind, set[str]] = {}
    for kind in KINDS:
        shared = frozenset().union(
            *(other_kind.names for other_kind in KINDS if other_kind is not kind)
        )
        own = names & (kind.names - shared)
        if own:
            own_names[kind] = own

    if SWEEP in own_names:
        return {SWEEP: own_names[SWEEP]}

    for kind in reversed(KINDS):
        explained = frozenset().union(*(other_kind.names for other_kind in own_names))
        left = (names & kind.names) - explained
        if left:
            own_names[kind] = own_names.get(kind, set()) | left

    return {kind: own_names[kind] for kind in KINDS if kind in own_names}


# The wheel holds `params/` within the package. In a checkout it stands at the top level, beside
# `src/`.
_IN_WHEEL = Path(__file__).parents[1] / "params"
_IN_CHECKOUT = Path(__file__).parents[3] / "params"
PARAMS = _IN_WHEEL if _IN_WHEEL.is_dir() else _IN_CHECKOUT
PRESETS = (
    "adult_finger",
    "adult_thumb",
    "youth_finger",
    "youth_thumb",
    "child_finger",
    "child_thumb",
)
"""Bundled designs of anatomical size, each with a clevis."""
_FOLDERS = ("", "scenes", "sets", "surfaces", "sweeps")
_BARE_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_-]*")
_MAX_SUGGESTIONS = 3


def list_bundled_files(*kinds: FileKind) -> dict[str, Path]:
    """List the bundled files of some kinds, or of all kinds, by bare name.

    No two files have the same name.
    """
    files = {
        path.stem: path for folder in _FOLDERS for path in sorted((PARAMS / folder).glob("*.toml"))
    }
    return {name: path for name, path in files.items() if not kinds or identify_kind(path) in kinds}


def is_bundled_name(name: str | Path, *kinds: FileKind) -> bool:
    """Tell whether a bare name is that of a bundled file of some kinds."""
    path = list_bundled_files().get(str(name))
    return path is not None and identify_kind(path) in kinds


def parse_source(typed: str, *kinds: FileKind) -> Path:
    """Parse a word that a user typed for a file of some kinds: its path, or the bare name of a
    bundled one.

    A path such as ./fsr400 or fsr400/ becomes absolute if it would be a bundled name without its
    slash, which a `Path` does not keep.
    """
    path = Path(typed)
    return path.absolute() if typed != str(path) and is_bundled_name(path, *kinds) else path


def find_file(source: str | Path, *kinds: FileKind, folder: Path | None = None) -> Path:
    """Find a file that is given by path or by bare name. Raises TomlFileError."""
    name = str(source)
    path = (folder or Path()) / source
    if not _BARE_NAME.fullmatch(name):
        return path

    bundled = list_bundled_files().get(name)
    expected = join_words((kind.describe() for kind in kinds), "or")
    # False for a name that is too long to be one, where Path.exists raises.
    if os.path.exists(path) and not (bundled and path.is_dir()):
        return path

    kind = identify_kind(bundled) if bundled else None
    if bundled and kind in kinds:
        return bundled

    known = list(list_bundled_files(*kinds))
    if kind is None:
        raise TomlFileError(Issue(name, _describe_unknown(name, path, kinds, known)))

    remedy = f"known names: {', '.join(known)} ({kind.use})"
    raise TomlFileError(Issue(name, f"is {kind.describe()}, not {expected}; {remedy}."))


def _describe_unknown(
    name: str, path: Path, kinds: Sequence[FileKind], known: Sequence[str]
) -> str:
    """Describe a bare name that nothing has, with close names, or else with all of them."""
    close = difflib.get_close_matches(name, known, n=_MAX_SUGGESTIONS)
    similar = [name_of_file for name_of_file in known if name_of_file in close]
    if os.path.isfile(path.with_name(f"{name}.toml")):
        similar.insert(0, f"{name}.toml")

    remedy = (
        f"known names: {', '.join(known)}; or give the path of a file."
        if known
        else "give the path of a file."
    )
    if similar:
        remedy = f"did you mean {join_words(similar, 'or')}?"

    expected = join_words((kind.name for kind in kinds), "or")
    return f"is neither a file nor the name of a bundled {expected}; {remedy}"
