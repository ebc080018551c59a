"""Tables of the report in Markdown, aligned so that they are read as plain text too."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from tools.grain.counts import Counts, add_up, count_module
from tools.grain.snapshots import FOLDERS, PAGES, Snapshot

ABSENT = "-"
"""Cell of a figure that is not known, or of a folder without modules."""

ROWS: tuple[tuple[str, Callable[[Counts], str]], ...] = (
    ("modules", lambda counts: write_number(counts.modules)),
    ("lines of code", lambda counts: write_number(counts.code_lines)),
    ("tokens of code", lambda counts: write_number(counts.tokens)),
    ("tokens a line", lambda counts: divide(counts.tokens, counts.code_lines)),
    ("lines of a function, mean", lambda counts: divide(counts.function_lines, counts.functions)),
    ("in 1 000 lines of code:", lambda _: ""),
    ("packed assignments", lambda counts: per_thousand(counts.packed_assignments, counts)),
    ("- of three or more", lambda counts: per_thousand(counts.packed_of_three, counts)),
    ("walrus", lambda counts: per_thousand(counts.walruses, counts)),
    ("`fmt: skip`", lambda counts: per_thousand(counts.format_skips, counts)),
    (
        "6 positional arguments or more",
        lambda counts: per_thousand(counts.positional_calls, counts),
    ),
    (
        "conditional in a conditional",
        lambda counts: per_thousand(counts.nested_conditionals, counts),
    ),
)
"""Label of each row of the first table, and the figure of it."""


def write_code_table(snapshots: Sequence[Snapshot]) -> str:
    """Write the table of the code: each folder at each time."""
    heading = ["code"]
    counts = []
    for folder in FOLDERS:
        for snapshot in snapshots:
            heading.append(folder if snapshot is snapshots[0] else snapshot.name)
            counts.append(count_folder(snapshot, folder))

    rows = [[label, *(write(one) for one in counts)] for label, write in ROWS]
    return write_table([heading, *rows])


def write_text_table(snapshots: Sequence[Snapshot], test_seconds: Sequence[float | None]) -> str:
    """Write the table of words and of the tests' seconds at each time; None is not known."""
    rows = [["texts and tests", *(snapshot.name for snapshot in snapshots)]]
    for place in PAGES:
        words = [count_words(snapshot, place) for snapshot in snapshots]
        rows.append([f"words of {place}", *(write_number(count) for count in words)])
    if any(seconds is not None for seconds in test_seconds):
        rows.append(["seconds of the tests", *(write_seconds(one) for one in test_seconds)])
    return write_table(rows)


def count_folder(snapshot: Snapshot, folder: str) -> Counts:
    """Count the modules of a folder."""
    return add_up(count_module(text, path) for path, text in snapshot.select(folder).items())


def count_words(snapshot: Snapshot, place: str) -> int:
    """Count the words of pages: what stands between blanks."""
    return sum(len(text.split()) for text in snapshot.select(place).values())


def write_number(number: int) -> str:
    """Write a whole number in groups of three digits."""
    return f"{number:,}".replace(",", " ")


def write_seconds(seconds: float | None) -> str:
    """Write seconds, rounded to whole ones."""
    return ABSENT if seconds is None else write_number(round(seconds))


def divide(number: int, count: int) -> str:
    """Write a mean with one decimal."""
    return f"{number / count:.1f}" if count else ABSENT


def per_thousand(number: int, counts: Counts) -> str:
    """Write how many there are in 1 000 lines of code."""
    return divide(1000 * number, counts.code_lines)


def write_table(rows: Sequence[Sequence[str]]) -> str:
    """Write a table in Markdown, whose first row is the heading and whose columns are aligned."""
    widths = [max(len(cell) for cell in column) for column in zip(*rows, strict=True)]
    rule = ["-" * widths[0], *("-" * (width - 1) + ":" for width in widths[1:])]
    return "".join(write_line(row, widths) for row in (rows[0], rule, *rows[1:]))


def write_line(cells: Sequence[str], widths: Sequence[int]) -> str:
    """Write one line of a table: the first cell begins at the left, the others end at the right."""
    first = cells[0].ljust(widths[0])
    others = [cell.rjust(width) for cell, width in zip(cells[1:], widths[1:], strict=True)]
    return f"| {' | '.join([first, *others])} |\n"
