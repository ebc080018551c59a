"""Expressions that all of a schematic's items are made of: fields, looks of words, lines."""

from __future__ import annotations

from fingertip.board.kicad.sexpr import Expression, number, quoted

TEXT_MM = 1.27


def property_(
    name: str, words: str, x: float, y: float, hidden: bool = False, angle: str = "0", justify: str = ""
) -> Expression:
    """A field of a symbol at a point [mm]."""
    at = ("at", number(x), number(y), angle)
    return ("property", quoted(name), quoted(words), at, effects(justify, hidden=hidden))


def effects(justify: str = "", size: float = TEXT_MM, hidden: bool = False) -> Expression:
    """How words look."""
    font: Expression = ("font", ("size", number(size), number(size)))
    sides: tuple[Expression, ...] = (("justify", *justify.split()),) if justify else ()
    return ("effects", font, *sides, *((("hide", "yes"),) if hidden else ()))


def stroke(width: float) -> Expression:
    """A line of this width [mm]."""
    return ("stroke", ("width", number(width)), ("type", "default"))


def fill(kind: str) -> Expression:
    """What fills an outline."""
    return ("fill", ("type", kind))
