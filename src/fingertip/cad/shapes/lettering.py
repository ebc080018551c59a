"""Which lines are engraved into a mold's half, and how large: what could not be read is left out."""

from __future__ import annotations

from collections.abc import Iterator

from fingertip.cad.shapes import strokes
from fingertip.design import Design
from fingertip.design.mold_layout import MoldLayout

STROKE = 0.8
"""Width of the letters' strokes, in units of their grid."""
MIN_STROKE_MM = 0.4
"""Narrower strokes close up in printing; the least height of letters has this one. An assumption."""
_FOOT = 2.0  # of a line, from the middle between the two, in units of the grid
_BESIDE_MM = 0.5  # between letters and nut traps
_OF_LENGTH = 0.8  # of the block, for the longest line


def lines(design: Design, m: MoldLayout, half: str) -> Iterator[tuple[str, float, float]]:
    """Each line that is engraved: its text, the grid's unit and its foot's distance from the middle [mm]."""
    for text, foot in ((design.name, _FOOT), (half, -_FOOT - strokes.HEIGHT)):
        unit = _unit(design, m, text)
        if design.mold.engraving_depth_mm and STROKE * unit >= MIN_STROKE_MM - 1e-9:
            yield text, unit, unit * foot


def left_out(design: Design, m: MoldLayout) -> list[str]:
    """Lines that would be engraved if there were room for them."""
    if not design.mold.engraving_depth_mm:
        return []
    engraved = {text for half in ("palmar", "dorsal") for text, _, _ in lines(design, m, half)}
    return [text for text in (design.name, "palmar", "dorsal") if text not in engraved]


def _unit(design: Design, m: MoldLayout, text: str) -> float:
    """The grid's unit [mm]: letters as high as asked for, if the block is long enough, and wide enough between nuts."""
    across = m.bolts[-1][0] - m.nut_circumradius - _BESIDE_MM
    return min(
        design.mold.engraving_height_mm / strokes.HEIGHT,
        _OF_LENGTH * (m.distal_z - m.proximal_z) / strokes.text_width(text),
        across / (_FOOT + strokes.HEIGHT + STROKE / 2),
    )
