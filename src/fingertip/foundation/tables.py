"""Tables of data beside the code, in CSV or TOML, read as dataclasses.

The columns of a table are the fields of a dataclass; a field with a default may be left out. A number may end in a
prefix such as k, a flag is yes or no, words are separated by spaces or stand in a list of TOML, and nothing is None.
A field whose class has a method `parse` is read by it. Lines of a CSV file that begin with # are comments.
"""

from __future__ import annotations

import csv
import types
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Literal, TypeVar, get_args, get_origin, get_type_hints

_EXPONENTS = {"M": 6, "k": 3, "m": -3, "u": -6, "n": -9, "p": -12}

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
                raise ValueError(f"{path.name}: the row {row} has more or fewer cells than the header")
            yield row


def load_table(kind: type[Row], rows: Iterable[Mapping[str, Any]]) -> tuple[Row, ...]:
    """Load rows, each by column. Raises LookupError, TypeError or ValueError where one does not fit."""
    hints = get_type_hints(kind)
    return tuple(kind(**{column: _read(hints.get(column), value) for column, value in row.items()}) for row in rows)


def _read(wanted: Any, value: Any) -> Any:
    """Read a cell as the type of its field. What is no text or list was read before."""
    if get_origin(wanted) is types.UnionType:
        if value == "":
            return None
        wanted = get_args(wanted)[0]
    if get_origin(wanted) is tuple and isinstance(value, str | list):
        items, kinds = value.split() if isinstance(value, str) else value, get_args(wanted)
        kinds = kinds[:1] * len(items) if kinds[-1] is ... else kinds
        return tuple(_read(*pair) for pair in zip(kinds, items, strict=True))
    if get_origin(wanted) is Literal and value not in get_args(wanted):
        raise ValueError(f"{value!r} is none of {get_args(wanted)}")
    if hasattr(wanted, "parse"):
        return wanted.parse(value)
    return _READERS[wanted](value) if wanted in _READERS else value


_READERS: Mapping[Any, Callable[[str], Any]] = {
    str: str.__str__,
    float: parse_value,
    int: int,
    bool: {"yes": True, "no": False}.__getitem__,
}
