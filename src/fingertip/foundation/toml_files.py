"""TOML files: reading them with every problem reported as an issue, and identifying their kind by their names.

This is the one place that decides what a TOML file is. A design, a scene, a manipulation and a sweep share the suffix
.toml, so that only the names at the top level of a file tell them apart.
"""

from __future__ import annotations

import difflib
import re
import tomllib
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingertip.foundation.errors import MAX_VALUE_LENGTH, InputFileError, Issue, TomlFileError, shorten
from fingertip.foundation.input_files import TOML_LIMIT, read_input

MAX_DEPTH = 12
"""Maximum depth of tables and lists in a file. A sweep of scenes needs five."""
_TOO_DEEP = f"nests tables and lists more than {MAX_DEPTH} deep; write them side by side"
_NUMBER_REMEDY = "write whole numbers of at most 18 digits, and larger ones with an exponent, such as 1e30"


@dataclass(frozen=True)
class FileKind:
    """A kind of TOML file."""

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


DESIGN = FileKind(
    "design",
    frozenset(
        {
            "name", "sensor", "custom_sensor", "bone", "hand", "skin", "silicone", "mold", "printer", "strength",
            "force_curve", "board", "detector",
        }
    ),
    "fsr400",
    "`fingertip build` takes a design file, and so does design = in a sweep file",
)  # fmt: skip
SCENE = FileKind(
    "scene",
    frozenset(
        {
            "scene", "outputs", "contact", "hold", "slide", "load_change", "tap", "motor", "drift", "cable", "noise",
            "sensing", "converter",
        }
    ),
    "hard_tap",
    "`fingertip simulate` takes a scene file as its first argument",
)  # fmt: skip
MANIPULATION = FileKind(
    "manipulation",
    frozenset(
        {
            "scene",
            "outputs",
            "object",
            "grasp",
            "knock",
            "hand",
            "drift",
            "cable",
            "noise",
            "sensing",
            "converter",
        }
    ),
    "real_manipulation",
    "`fingertip simulate` takes a manipulation file as its first argument",
)
SWEEP = FileKind(
    "sweep",
    frozenset(
        {
            "name", "outputs", "sampling", "points", "seed", "tolerance_mm", "time_limit_s", "trials", "first_seed",
            "detector", "print_density_g_cm3", "minimise", "maximise", "axes", "design", "scene",
        }
    ),
    "board",
    "`fingertip sweep` takes a sweep file",
)  # fmt: skip
KINDS = (SWEEP, MANIPULATION, SCENE, DESIGN)
"""All kinds. A name that several kinds share counts for the last of them that has it, unless another name decides."""


class UnusableTomlError(Exception):
    """A text is valid TOML, but holds what no file of this program needs. The text completes a sentence."""


def parse_toml(text: str) -> dict[str, Any]:
    """Parse TOML whose values and tables are nested little, and whose whole numbers have 64 bits, as TOML 1.0 asks.

    Raises TOMLDecodeError or UnusableTomlError.
    """
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except RecursionError:
        raise UnusableTomlError(_TOO_DEEP) from None
    except ValueError:  # Python converts no whole number of thousands of digits
        raise UnusableTomlError(f"holds a number that is too long; {_NUMBER_REMEDY}") from None
    check_values(tables)
    return tables


def check_values(tables: Mapping[str, Any]) -> None:
    """Check that tables are nested little, and that their whole numbers have 64 bits. Raises UnusableTomlError."""
    level: list[Any] = [tables]
    for _ in range(MAX_DEPTH):
        for value in level:
            if isinstance(value, int) and not -(2**63) <= value < 2**63:
                digits = f"{value:.4g}" if abs(value) < 10**300 else "a number of over 300 digits"
                raise UnusableTomlError(f"holds {digits}, which is too large; {_NUMBER_REMEDY}")
        nested = (value.values() if isinstance(value, dict) else value for value in level)
        level = [inner for values in nested if isinstance(values, Collection) and not isinstance(values, str)
                 for inner in values]  # fmt: skip
        if not level:
            return
    raise UnusableTomlError(_TOO_DEEP)


def read_toml(path: Path, kind: FileKind | None = None) -> dict[str, Any]:
    """Read a TOML file in UTF-8, with or without a byte order mark. Raises TomlFileError."""
    try:
        text = read_input(path, TOML_LIMIT, kind.describe() if kind else "a TOML file").decode("utf-8-sig")
        text = text.replace("\r\n", "\n").replace("\r", "\n")  # the line breaks of any system
        tables = parse_toml(text)
    except InputFileError as error:
        raise TomlFileError(error.issues) from None
    except UnicodeDecodeError:
        raise TomlFileError(Issue(str(path), "is not UTF-8 text; save it as a TOML file in UTF-8.")) from None
    except tomllib.TOMLDecodeError as error:
        raise TomlFileError(Issue(str(path), _describe_syntax_error(error, text))) from None
    except UnusableTomlError as error:
        raise TomlFileError(Issue(str(path), f"{error}.")) from None
    if kind is not None:
        _require_kind(path, tables, kind)
    return tables


def identify_kind(path: Path) -> FileKind | None:
    """Identify the kind of a file by its names; None if the file cannot be read or none of its names is known.

    Raises TomlFileError.
    """
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


def _describe_syntax_error(error: tomllib.TOMLDecodeError, text: str) -> str:
    """Describe a syntax error by the line on which the parser stopped."""
    reason = str(error)
    found = re.search(r"\(at line (\d+), column \d+\)", reason)
    lines = text.splitlines()
    number = int(found[1]) if found else len(lines)
    line = lines[number - 1].strip() if 0 < number <= len(lines) else ""
    where = f"line {number}, `{shorten(line, MAX_VALUE_LENGTH)}`," if line else f"line {number}"
    if "Cannot overwrite a value" in reason:
        tables = [part.strip().strip("[]") for part in lines[:number] if part.strip().startswith("[")]
        name = ".".join([*tables[-1:], line.partition("=")[0].strip()])
        return f"{where} sets {shorten(name, MAX_VALUE_LENGTH)} a second time; delete one of the two lines."
    if "Cannot declare" in reason or "Cannot mutate immutable" in reason:
        return f"{where} begins a table that the file already has; move its parameters to the first one."
    if re.search(r"=\s*[-+]?\d+,\d+\s*(#.*)?$|=\s*\[[^]#]*\d,0\d", line):
        return f"{where} is not valid TOML; write the number with a decimal point, not with a comma."
    if re.search(r"=\s*[-+]?[\d.]+\s*[A-Za-z%]", line):
        return f"{where} is not valid TOML; write the number without a unit."
    problem = re.sub(r"\s*\(at .*\)$", "", reason)
    if "Illegal character '\\n'" in problem:
        problem = "a text has no closing quote"
    return f"{where} is not valid TOML ({problem}); write a table as [skin], and a parameter as width_mm = 18."


def _require_kind(path: Path, tables: Mapping[str, Any], expected: FileKind) -> None:
    """Refuse a file of which no name belongs to the expected kind alone, but some name to another kind."""
    found = _find_kinds(tables)
    if not found or expected in found:
        return
    kind = next(iter(found))
    if expected.names.issuperset(tables):
        return  # All names are shared with the expected kind.
    message = f"is {kind.describe()}, not {expected.describe()}; give one such as {expected.example} ({kind.use})."
    raise TomlFileError(Issue(str(path), message))


def _find_kinds(tables: Mapping[str, Any]) -> dict[FileKind, set[str]]:
    """Find the kinds that names at the top level of a file belong to, with these names.

    Names of one kind alone decide. Names that are shared count only if no other name decides for a kind that has them.
    A sweep file may hold names of all kinds.
    """
    names = set(tables)
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
