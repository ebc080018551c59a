"""Frame, title block, table of the sizes to check, and notes of a sheet (ISO 5457, ISO 7200)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from fingertip import __version__
from fingertip.design.geometry.sizes import GENERAL, PartDrawing, general
from fingertip.pictures.drawing.dimensioning import TEXT_MM
from fingertip.pictures.drawing.primitives import (
    Polyline,
    Primitive,
    Ring,
    Styles,
    Text,
    line,
    rectangle,
    text_width,
)

_ROW_MM = 5.2
_LINE_MM = 3.9
_PAD_MM = 1.5
_BLOCK_WIDTH_MM = 130.0
_BLOCK_ROW_MM = 9.0
_TITLE_MM = 3.5


@dataclass(frozen=True)
class Paper:
    """Size of a sheet in landscape [mm]."""

    width: float
    height: float
    left: ClassVar = 20.0
    bottom: ClassVar = 10.0
    """Left and lower edge of the frame: the border is wider where the sheet is filed."""

    @property
    def right(self) -> float:
        return self.width - 10.0

    @property
    def top(self) -> float:
        return self.height - 10.0


@dataclass(frozen=True)
class Heading:
    """Content of the title block that the part alone does not give."""

    design: str
    scale: str
    sheet: int
    sheets: int


def draw_frame(
    paper: Paper, part: PartDrawing, heading: Heading
) -> tuple[tuple[Primitive, ...], float]:
    """Draw frame, title block, table and notes; returns the height above which nothing is."""
    block, block_top = _title_block(paper, part, heading)
    # On narrow paper the table stands above the title block.
    beside = paper.right - paper.left - _BLOCK_WIDTH_MM >= 180.0
    right = paper.right - _BLOCK_WIDTH_MM if beside else paper.right
    bottom = paper.bottom if beside else block_top
    table, table_top = _table(part, paper.left, right, bottom)
    notes_left = paper.right - _BLOCK_WIDTH_MM + _PAD_MM if beside else paper.left + _PAD_MM
    base = block_top if beside else paper.bottom
    begin = base + _PAD_MM + 1.0
    notes = [
        Text(note, (notes_left, begin + i * 4.5), TEXT_MM)
        for i, note in enumerate(reversed(part.notes))
    ]
    top = max(block_top + (4.5 * len(notes) + 2.0 if beside else 0.0), table_top)

    return (
        rectangle(
            paper.left,
            bottom=paper.bottom,
            right=paper.right,
            top=paper.top,
            style=Styles.FRAME,
        ),
        *block,
        *table,
        *notes,
    ), top


def _title_block(
    paper: Paper, part: PartDrawing, heading: Heading
) -> tuple[list[Primitive], float]:
    left = paper.right - _BLOCK_WIDTH_MM
    right = paper.right
    bottom = paper.bottom
    first = left + 50.0
    second = left + 102.0
    *rows, top = (bottom + i * _BLOCK_ROW_MM for i in range(5))
    primitives: list[Primitive] = [
        rectangle(
            left,
            bottom=bottom,
            right=right,
            top=top,
            style=Styles.EDGE,
        )
    ]
    primitives += [line((left, y), (right, y), Styles.GRID) for y in rows[1:]]
    primitives += [line((x, rows[0]), (x, rows[2]), Styles.GRID) for x in (first, second)]
    primitives += [
        line((second, rows[2]), (second, top), Styles.GRID),
        line((first, rows[3]), (first, top), Styles.GRID),
    ]
    cells = (
        (left, rows[3], "part", part.title),
        (first, rows[3], "design", heading.design),
        (left, rows[2], "material", part.material),
        (left, rows[1], "general tolerances", GENERAL),
        (first, rows[1], "unit", "mm"),
        (second, rows[1], "scale", heading.scale),
        (left, rows[0], "made with", f"fingertip {__version__}"),
        (first, rows[0], "file", f"drawing_{part.part}.svg"),
        (second, rows[0], "sheet", f"{heading.sheet} of {heading.sheets}"),
    )
    ends = {left: first, first: second, second: right}

    for x, y, label, content in cells:
        height = _TITLE_MM if label in ("part", "scale", "sheet") else TEXT_MM
        room = (second if label == "material" else ends[x]) - x - 2 * _PAD_MM
        primitives.append(Text(label, (x + _PAD_MM, y + _BLOCK_ROW_MM - 2.9), 1.8))
        primitives.append(Text(_shorten(content, height, room), (x + _PAD_MM, y + 1.5), height))

    primitives += _projection_symbol((second + right) / 2, rows[2] + _BLOCK_ROW_MM)
    return primitives, top


def _projection_symbol(x: float, y: float) -> list[Primitive]:
    """Draw the symbol of first-angle projection: a truncated cone and its view from the left."""
    large = 4.2
    small = 2.1
    length = 8.4
    cone_x = x - 9.0
    circle_x = x + 6.0
    cone = (
        (cone_x, y - small),
        (cone_x + length, y - large),
        (cone_x + length, y + large),
        (cone_x, y + small),
    )

    return [
        Polyline((*cone, cone[0]), Styles.EDGE),
        Ring((circle_x, y), large, Styles.EDGE),
        Ring((circle_x, y), small, Styles.EDGE),
        line((cone_x - 1.5, y), (cone_x + length + 1.5, y), Styles.CENTRE),
        line((circle_x - large - 1.5, y), (circle_x + large + 1.5, y), Styles.CENTRE),
        line((circle_x, y - large - 1.5), (circle_x, y + large + 1.5), Styles.CENTRE),
    ]


def _table(
    part: PartDrawing, left: float, right: float, bottom: float
) -> tuple[list[Primitive], float]:
    columns = [left, left + 9.0, left + 9.0 + 58.0, left + 88.0, left + 110.0]
    primitives: list[Primitive] = []
    y = bottom

    for number, size in reversed([*enumerate(part.checked, 1)]):
        tolerance = (size.tolerance or general(size.printed)).text()
        name = _wrap(size.name, columns[2] - columns[1] - 2 * _PAD_MM)
        action = _wrap(size.action, right - columns[4] - 2 * _PAD_MM)
        y += _ROW_MM + _LINE_MM * (max(len(name), len(action)) - 1)
        first = y - 3.8
        primitives.append(
            Text(str(number), ((columns[0] + columns[1]) / 2, first), TEXT_MM, "middle")
        )
        cells = (name, [size.text().removesuffix(f" {tolerance}")], [tolerance], action)

        for x, rows in zip(columns[1:], cells, strict=True):
            primitives += [
                Text(text, (x + _PAD_MM, first - k * _LINE_MM), TEXT_MM)
                for k, text in enumerate(rows)
            ]

        primitives.append(line((left, y), (right, y), Styles.GRID))

    top = y + _ROW_MM
    titles = (
        "check",
        "size, measured with calipers",
        "print reads",
        "tolerance",
        "if it is out of tolerance",
    )
    primitives += [
        Text(title, (x + 0.8, y + 1.4), 2.0) for x, title in zip(columns, titles, strict=True)
    ]
    primitives += [line((x, bottom), (x, top), Styles.GRID) for x in columns[1:]]

    return [
        rectangle(
            left,
            bottom=bottom,
            right=right,
            top=top,
            style=Styles.EDGE,
        ),
        *primitives,
    ], top


def _wrap(text: str, width: float) -> list[str]:
    lines = [""]
    for word in text.split():
        longer = f"{lines[-1]} {word}".strip()
        if text_width(longer, TEXT_MM) <= width or not lines[-1]:
            lines[-1] = longer
        else:
            lines.append(word)

    return lines


def _shorten(text: str, height: float, width: float) -> str:
    if text_width(text, height) <= width:
        return text

    while text and text_width(f"{text}...", height) > width:
        text = text[:-1]

    return f"{text}..."
