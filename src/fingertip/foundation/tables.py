"""Tables from files: CSV and TOML beside the code as dataclasses, and TOML of a user with every
problem an issue.

The columns of a table are the fields of a dataclass; a field with a default may be left out. A
number may end in a prefix such as k, a flag is yes or no, words are separated by spaces or stand in
a list of TOML, and an empty cell is None. Lines of a CSV file that begin with # are comments.
"""

from __future__ import annotations

import csv
import re
import tomllib
import types
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Literal, TypeVar, get_args, get_origin, get_type_hints

from fingertip.foundation.errors import (
    MAX_VALUE_LENGTH,
    InputFileError,
    Issue,
    TomlFileError,
    shorten,
)
from fingertip.foundation.input_files import TOML_LIMIT, read_input

_EXPONENTS = {
    "M": 6,
    "k": 3,
    "m": -3,
    "u": -6,
    "n": -9,
    "p": -12,
}

Row = TypeVar("Row")


def parse_value(text: str) -> float:
    """Parse a value [its unit], correctly rounded: "100n" is the float nearest to 1e-7."""
    exponent = _EXPONENTS.get(text[-1])
    return float(text) if exponent is None else float(f"{text[:-1]}e{exponent}")


def read_rows(path: Path) -> Iterator[dict[str, str]]:
    """Read the rows of a CSV file, each by column."""
    with path.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            if None in row or None in row.values():
                raise ValueError(
                    f"{path.name}: the row {row} has more or fewer cells than the header"
                )

            yield row


def load_table(kind: type[Row], rows: Iterable[Mapping[str, Any]]) -> tuple[Row, ...]:
    """Load rows, each by column.

    Raises LookupError, TypeError or ValueError where one does not fit.
    """
    hints = get_type_hints(kind)
    return tuple(
        kind(**{column: _read(hints.get(column), value) for column, value in row.items()})
        for row in rows
    )


def _read(kind: Any, value: Any) -> Any:
    """Read a cell as the type of its field. Values that are neither text nor list stay."""
    if get_origin(kind) is types.UnionType:
        if value == "":
            return None

        kind = get_args(kind)[0]

    if get_origin(kind) is tuple and isinstance(value, str | list):
        items = value.split() if isinstance(value, str) else value
        kinds = get_args(kind)
        kinds = kinds[:1] * len(items) if kinds[-1] is ... else kinds
        return tuple(_read(*pair) for pair in zip(kinds, items, strict=True))

    if get_origin(kind) is Literal and value not in get_args(kind):
        raise ValueError(f"{value!r} is none of {get_args(kind)}")

    return _READERS[kind](value) if kind in _READERS else value


_READERS: Mapping[Any, Callable[[str], Any]] = {
    str: str.__str__,
    float: parse_value,
    int: int,
    bool: {"yes": True, "no": False}.__getitem__,
}

MAX_DEPTH = 12
"""Maximum depth of tables and lists in a file. A sweep of scenes needs five."""
_TOO_DEEP = f"nests tables and lists more than {MAX_DEPTH} deep; write them side by side"
_NUMBER_REMEDY = (
    "write whole numbers of at most 18 digits, and larger ones with an exponent, such as 1e30"
)


class UnusableTomlError(Exception):
    """A text is valid TOML, but holds what no file of this program needs.

    The text completes a sentence.
    """


def parse_toml(text: str) -> dict[str, Any]:
    """Parse TOML of few levels and numbers of 64 bits (TOML 1.0).

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
    """Check that tables are nested little, and that their whole numbers have 64 bits.

    Raises UnusableTomlError.
    """
    level: list[Any] = [tables]
    for _ in range(MAX_DEPTH):
        for value in level:
            if isinstance(value, int) and not -(2**63) <= value < 2**63:
                digits = f"{value:.4g}" if abs(value) < 10**300 else "a number of over 300 digits"
                raise UnusableTomlError(f"holds {digits}, which is too large; {_NUMBER_REMEDY}")

        next_level: list[Any] = []
        for value in level:
            values = value.values() if isinstance(value, dict) else value
            if isinstance(values, Collection) and not isinstance(values, str):
                next_level += values

        level = next_level
        if not level:
            return

    raise UnusableTomlError(_TOO_DEEP)


def read_toml(path: Path, wanted: str = "a TOML file", below: Path | None = None) -> dict[str, Any]:
    """Read a TOML file in UTF-8, with or without a byte order mark, as `read_input` does.

    Raises TomlFileError.
    """
    try:
        text = read_input(path, TOML_LIMIT, wanted, below=below).decode("utf-8-sig")
        text = text.replace("\r\n", "\n").replace("\r", "\n")  # the line breaks of any system
        return parse_toml(text)
    except InputFileError as error:
        raise TomlFileError(error.issues) from None
    except UnicodeDecodeError:
        raise TomlFileError(
            Issue(str(path), "is not UTF-8 text; save it as a TOML file in UTF-8.")
        ) from None
    except tomllib.TOMLDecodeError as error:
        raise TomlFileError(Issue(str(path), _describe_syntax_error(error, text))) from None
    except UnusableTomlError as error:
        raise TomlFileError(Issue(str(path), f"{error}.")) from None


_POSITION = re.compile(r"\s*\(at (?:line (\d+), column \d+|end of document)\)$")
"""End of a message of tomllib, whose errors have `msg` and `lineno` from Python 3.14 on only."""


def _describe_syntax_error(error: tomllib.TOMLDecodeError, text: str) -> str:
    """Describe a syntax error by the line on which the parser stopped."""
    problem = str(error)
    found = _POSITION.search(str(error))
    lines = text.splitlines()
    number = int(found[1] or len(lines)) if found else len(lines)
    line = lines[number - 1].strip() if 0 < number <= len(lines) else ""
    where = f"line {number}, `{shorten(line, MAX_VALUE_LENGTH)}`," if line else f"line {number}"

    if "Cannot overwrite a value" in problem:
        tables = [
            part.strip().strip("[]") for part in lines[:number] if part.strip().startswith("[")
        ]
        name = ".".join([*tables[-1:], line.partition("=")[0].strip()])
        return (
            f"{where} sets {shorten(name, MAX_VALUE_LENGTH)} a second time; delete one of the "
            "two lines."
        )

    if "Cannot declare" in problem or "Cannot mutate immutable" in problem:
        return (
            f"{where} begins a table that the file already has; move its parameters to the "
            "first one."
        )
    if re.search(r"=\s*[-+]?\d+,\d+\s*(#.*)?$|=\s*\[[^]#]*\d,0\d", line):
        return (
            f"{where} is not valid TOML; write the number with a decimal point, not with a comma."
        )
    if re.search(r"=\s*[-+]?[\d.]+\s*[A-Za-z%]", line):
        return f"{where} is not valid TOML; write the number without a unit."

    problem = _POSITION.sub("", problem)
    if "Illegal character '\\n'" in problem:
        problem = "a text has no closing quote"

    return (
        f"{where} is not valid TOML ({problem}); write a table as [skin], and a parameter as "
        "width_mm = 18."
    )
