"""Assembly drawing of a board, five times its size, and its list of parts.

It shows where a part belongs, which value it has, and which way round it goes.
"""

from __future__ import annotations

from fingertip import __version__
from fingertip.board.kicad.placement import Placement
from fingertip.board.parts.circuit import Circuit
from fingertip.pictures.board_outlines import draw_part
from fingertip.pictures.board_part_list import draw_part_list
from fingertip.pictures.board_sheet import SCALE, BoardOnSheet
from fingertip.pictures.drawing.primitives import Primitive, Sheet, Style, Text

_A4_MM = (297.0, 210.0)
"""Width and height of the paper of small boards."""
_A3_MM = (420.0, 297.0)
"""Width and height of the paper of boards that do not fit A4."""
_MARGIN_MM = 12.0
"""Distance of everything from the edges of the paper."""
_HEADER_MM = 10.0
"""Height of title and note, above the board."""
_TITLE_MM = 3.5
"""Height of the title's capitals."""
_NOTE_MM = 2.0
"""Height of the note's capitals."""
_NOTE_ABOVE_MM = 2.5
"""Distance of the note from the board."""
_LIST_WIDTH_MM = 75.0
"""Width of the list of parts, with the gap beside it."""
_LIST_GAP_MM = 5.0
"""Distance of the list of parts from the board."""
_BOARD = Style("board", 0.5)
"""Line around the board."""


def draw_assembly(circuit: Circuit, placement: Placement, title: str) -> Sheet:
    """Draw the front of a board, with a list of what to place."""
    paper_width, paper_height = _choose_paper(placement)
    board = BoardOnSheet(left=_MARGIN_MM, top=paper_height - _MARGIN_MM - _HEADER_MM)
    edges = board.place((0.0, 0.0, placement.width, placement.height))
    title_y = paper_height - _MARGIN_MM - _TITLE_MM

    primitives: list[Primitive] = [
        Text(title, (edges.left, title_y), _TITLE_MM),
        Text(_describe_drawing(placement), (edges.left, edges.top + _NOTE_ABOVE_MM), _NOTE_MM),
        edges.outline(_BOARD),
    ]
    for part in circuit.components:
        if part.is_fitted:
            primitives += draw_part(part, placement.parts[part.reference], board)

    primitives += draw_part_list(circuit, edges.right + _LIST_GAP_MM, edges.top)
    return Sheet("assembly", paper_width, paper_height, tuple(primitives))


def _choose_paper(placement: Placement) -> tuple[float, float]:
    """Return width and height of the smallest paper for a board and its list [mm]."""
    needed_mm = SCALE * placement.width + _LIST_WIDTH_MM + _MARGIN_MM
    return _A4_MM if needed_mm < _A4_MM[0] else _A3_MM


def _describe_drawing(placement: Placement) -> str:
    """Write the note: scale, size of the board, and what bars and dots mean."""
    return (
        f"Front, {SCALE:g}:1, {placement.width:g} x {placement.height:g} mm; made with fingertip "
        f"{__version__}. "
        "Print at 100 %. Bar: cathode. Dot: pin 1. Parts with neither go in either way, or in one "
        "way only."
    )
