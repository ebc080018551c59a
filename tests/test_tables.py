"""Tables of data are read as strictly as code would be."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import pytest

from fingertip.foundation.tables import load_table, read_rows


@dataclass(frozen=True)
class Row:
    name: str
    kind: Literal["a", "b"]
    mass_kg: float
    range_v: tuple[float, float]
    words: tuple[str, ...]
    is_new: bool
    hardness: float | None
    count: int = 3


CELLS = {
    "name": "x",
    "kind": "a",
    "mass_kg": "1.5k",
    "range_v": "3 4m",
    "words": "one two",
    "is_new": "no",
    "hardness": "30",
}


def test_cells_are_read_by_the_types_of_the_fields() -> None:
    assert load_table(Row, [CELLS]) == (
        Row("x", "a", 1500.0, (3.0, 0.004), ("one", "two"), False, 30.0),
    )
    (row,) = load_table(Row, [CELLS | {"words": ["one two"], "hardness": "", "count": "5"}])
    assert (row.words, row.hardness, row.count) == (("one two",), None, 5)


@pytest.mark.parametrize(
    "wrong",
    [
        {"kind": "c"},
        {"mass_kg": ""},
        {"mass_kg": "1.5x"},
        {"range_v": "3"},
        {"range_v": "3 4 5"},
        {"is_new": "no?"},
        {"name": 5},
        {"mass_kg": 5},
        {"hardness": "30 to 40"},
        {"count": "1.5"},
        {"weight": "5"},
    ],
    ids=str,
)
def test_a_cell_that_does_not_fit_is_refused(wrong: dict[str, object]) -> None:
    with pytest.raises((LookupError, TypeError, ValueError)):
        load_table(Row, [CELLS | wrong])


def test_a_missing_column_is_refused() -> None:
    with pytest.raises(TypeError, match="missing 1 required"):
        load_table(Row, [{column: cell for column, cell in CELLS.items() if column != "name"}])


def test_rows_have_the_cells_of_the_header_and_comments_are_left_out(tmp_path: Path) -> None:
    file = tmp_path / "table.csv"
    file.write_text('# a comment\na,b\n1,"2, 3"\n# another\n4,\n', encoding="utf-8")
    assert list(read_rows(file)) == [{"a": "1", "b": "2, 3"}, {"a": "4", "b": ""}]
    for line in ("1", "1,2,3"):
        file.write_text(f"a,b\n{line}\n", encoding="utf-8")
        with pytest.raises(
            ValueError, match=r"table\.csv: the row .* has more or fewer cells than the header"
        ):
            list(read_rows(file))
