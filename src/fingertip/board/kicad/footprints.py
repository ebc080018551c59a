"""Footprints [mm]: pads as in KiCad's libraries, outlines drawn here.

A test compares the pads with the libraries of KiCad 9. The y axis points down, as on KiCad's boards.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from fingertip.board.parts import symbols

Point = tuple[float, float]
Box = tuple[float, float, float, float]
"""Left, top, right and bottom edge [mm]."""

PIN_1_DOT_MM = 0.5
"""Diameter of the dot beside pin 1."""
SILK_LINE_MM = 0.15
"""Width of the silkscreen lines: the usual minimum of board houses."""
TEXT_HEIGHT_MM = 1.0
"""Height of a printed capital letter: the usual minimum of board houses. Its line is as wide as `SILK_LINE_MM`."""
SILK_CLEARANCE_MM = 0.15
"""Least distance of silkscreen from pads: the usual minimum of board houses."""
_SILK_TO_PAD_MM = SILK_CLEARANCE_MM + SILK_LINE_MM / 2 + 0.025
"""Distance of the end of a silkscreen line from the pad beside it."""


@dataclass(frozen=True)
class Pad:
    """Pad of a footprint."""

    number: str
    x: float
    y: float
    width: float
    height: float
    shape: str = "roundrect"
    """KiCad's pad shape: roundrect, rect, oval or circle."""
    drill: float = 0.0
    """Diameter of the hole; 0 for a surface-mount pad on the front."""
    is_plated: bool = True
    corner_ratio: float | None = None
    """Corner radius of a rounded pad relative to its shorter side, where it is not that of its footprint."""
    mask_margin: float = 0.0
    """Distance by which the opening of the solder mask surpasses the pad."""


@dataclass(frozen=True)
class Footprint:
    """Footprint of a component: pads, outlines and silkscreen."""

    pads: tuple[Pad, ...]
    courtyard: Box
    """Area to keep free of other components."""
    body: Box
    """Outline of the component itself."""
    silkscreen: tuple[tuple[Point, Point], ...] = ()
    """Silkscreen lines, by both ends."""
    has_paste: bool = True
    pin_1_dot: Point | None = None
    """Centre of the silkscreen dot beside pin 1."""


def _chip(x: float, width: float, height: float, courtyard: Point, body: Point, silkscreen_y: float) -> Footprint:
    """Chip resistor or capacitor: two pads at -x and x, with silkscreen lines between them where there is room."""
    half_width, half_height = body
    gap = x - width / 2 - _SILK_TO_PAD_MM
    lines = tuple(((-gap, y), (gap, y)) for y in (-silkscreen_y, silkscreen_y)) if gap > 0.15 else ()
    return Footprint(
        (Pad("1", -x, 0.0, width, height), Pad("2", x, 0.0, width, height)),
        (-courtyard[0], -courtyard[1], courtyard[0], courtyard[1]),
        (-half_width, -half_height, half_width, half_height),
        lines,
    )


def _dual_row(x: float, pitch: float, width: float, height: float, courtyard: Point, body: Point) -> Footprint:
    """Package with four pins on either side, numbered anticlockwise."""
    rows = [pitch * (i - 1.5) for i in range(4)]
    left = [Pad(str(i), -x, y, width, height) for i, y in enumerate(rows, start=1)]
    right = [Pad(str(9 - i), x, y, width, height) for i, y in enumerate(rows, start=1)]
    half_width, half_height = body
    # Lines along both ends, and a dot beside pin 1, clear of its pad.
    edge = half_height + 0.11
    lines = (((-half_width, -edge), (half_width, -edge)), ((-half_width, edge), (half_width, edge)))
    dot = (-half_width - 0.2 - PIN_1_DOT_MM, rows[0] - height / 2 - 0.15 - PIN_1_DOT_MM / 2)
    return Footprint(
        (*left, *right),
        (-courtyard[0], -courtyard[1], courtyard[0], courtyard[1]),
        (-half_width, -half_height, half_width, half_height),
        lines,
        pin_1_dot=dot,
    )


def _header(pins: int) -> Footprint:
    """Pin header of one row with a pitch of 2.54 mm; pin 1 is square."""
    end = 2.54 * (pins - 1)
    pads = [Pad(str(i + 1), 0.0, 2.54 * i, 1.7, 1.7, "rect" if i == 0 else "circle", drill=1.0) for i in range(pins)]
    body = (-1.27, -1.27, 1.27, end + 1.27)
    corners = ((-1.33, 1.27), (-1.33, end + 1.33), (1.33, end + 1.33), (1.33, 1.27), (-1.33, 1.27))
    lines = (*pairwise(corners), ((-1.33, 0.0), (-1.33, -1.33)), ((-1.33, -1.33), (0.0, -1.33)))
    return Footprint(tuple(pads), (-1.77, -1.77, 1.77, end + 1.77), body, lines, has_paste=False)


_SMALL_CORNER_RATIO = 0.208333


def _jst_sh(pins: int) -> Footprint:
    """Connector JST SH for surface mounting, with its opening at the side of +y."""
    half, mount = (pins - 1) / 2, (pins - 1) / 2 + 1.3
    contacts = [Pad(str(i + 1), i - half, -2.0, 0.6, 1.55) for i in range(pins)]
    tabs = [Pad("MP", x, 1.875, 1.2, 1.8, corner_ratio=_SMALL_CORNER_RATIO) for x in (-mount, mount)]
    width = half + 1.5
    edge = width + 0.11
    # Outlines of the body where there are no pads.
    lines = (
        ((-edge, 0.7), (-edge, -1.785)), ((-edge, -1.785), (-half - 0.56, -1.785)),
        ((edge, 0.7), (edge, -1.785)), ((edge, -1.785), (half + 0.56, -1.785)),
        ((-mount + 0.86, 2.685), (mount - 0.86, 2.685)),
    )  # fmt: skip
    courtyard = (-width - 0.9, -3.28, width + 0.9, 3.28)
    dot = (-half - 0.3 - 0.2 - PIN_1_DOT_MM, -2.4)
    return Footprint((*contacts, *tabs), courtyard, (-width, -1.675, width, 2.575), lines, pin_1_dot=dot)


FIDUCIAL = "Fiducial:Fiducial_1mm_Mask2mm"
"""Footprint of a fiducial mark, which is on the board but not in the circuit."""
FIDUCIAL_CLEARANCE_MM = 0.6
"""Clearance of copper from a fiducial mark: its mask opening and KiCad's margin beside that."""

FOOTPRINTS: dict[str, Footprint] = {
    symbols.R_0603: _chip(0.825, 0.8, 0.95, (1.48, 0.73), (0.8, 0.4125), 0.52),
    symbols.C_0603: _chip(0.775, 0.9, 0.95, (1.48, 0.73), (0.8, 0.4), 0.51),
    symbols.C_0805: _chip(0.95, 1.0, 1.45, (1.7, 0.98), (1.0, 0.625), 0.735),
    symbols.C_1206: _chip(1.475, 1.15, 1.8, (2.3, 1.15), (1.6, 0.8), 0.91),
    symbols.SOD_123: Footprint(
        (Pad("1", -1.65, 0.0, 0.9, 1.2), Pad("2", 1.65, 0.0, 0.9, 1.2)),
        (-2.35, -1.15, 2.35, 1.15), (-1.4, -0.9, 1.4, 0.9),
        # The line on the left marks the cathode.
        (((-2.35, -1.0), (-2.35, 1.0)), ((-2.35, -1.0), (1.65, -1.0)), ((-2.35, 1.0), (1.65, 1.0))),
    ),
    symbols.SOT_23: Footprint(
        (Pad("1", -0.9375, -0.95, 1.475, 0.6), Pad("2", -0.9375, 0.95, 1.475, 0.6),
         Pad("3", 0.9375, 0.0, 1.475, 0.6)),
        (-1.93, -1.7, 1.93, 1.7), (-0.65, -1.45, 0.65, 1.45),
        (((-0.65, -1.56), (0.65, -1.56)), ((-0.65, 1.56), (0.65, 1.56))),
    ),
    symbols.SOT_23_5: Footprint(
        (Pad("1", -1.1375, -0.95, 1.325, 0.6), Pad("2", -1.1375, 0.0, 1.325, 0.6), Pad("3", -1.1375, 0.95, 1.325, 0.6),
         Pad("4", 1.1375, 0.95, 1.325, 0.6), Pad("5", 1.1375, -0.95, 1.325, 0.6)),
        (-2.05, -1.7, 2.05, 1.7), (-0.8, -1.45, 0.8, 1.45),
        (((-0.8, -1.56), (0.8, -1.56)), ((-0.8, 1.56), (0.8, 1.56))), pin_1_dot=(-1.4, -1.65),
    ),
    symbols.TC33X: Footprint(
        (Pad("1", -1.8, -1.0, 1.2, 1.2, "rect"), Pad("2", 1.45, 0.0, 1.5, 1.6, "rect"),
         Pad("3", -1.8, 1.0, 1.2, 1.2, "rect")),
        (-2.65, -1.85, 2.45, 1.85), (-1.5, -1.5, 1.5, 1.5),
        (((-0.95, -1.61), (1.61, -1.61)), ((-0.95, 1.61), (1.61, 1.61))),
    ),
    symbols.SOIC_8: _dual_row(2.475, 1.27, 1.95, 0.6, (3.7, 2.7), (1.95, 2.45)),
    symbols.MSOP_8: _dual_row(2.1125, 0.65, 1.625, 0.4, (3.18, 1.75), (1.5, 1.5)),
    symbols.HEADER_2: _header(2),
    symbols.HEADER_3: _header(3),
    symbols.HEADER_4: _header(4),
    symbols.HEADER_5: _header(5),
    symbols.JST_SH_2: _jst_sh(2),
    symbols.JST_SH_10: _jst_sh(10),
    symbols.JST_PH_2: Footprint(
        (Pad("1", 0.0, 0.0, 1.2, 1.75, drill=0.75, corner_ratio=_SMALL_CORNER_RATIO),
         Pad("2", 2.0, 0.0, 1.2, 1.75, "oval", drill=0.75)),
        (-2.45, -1.85, 4.45, 6.75), (-1.95, -1.35, 3.95, 6.25),
        tuple(pairwise(((-0.86, -1.46), (-2.06, -1.46), (-2.06, 6.36), (4.06, 6.36), (4.06, -1.46), (2.86, -1.46)))),
        has_paste=False, pin_1_dot=(-1.35, -1.0),
    ),
    symbols.TEST_PAD: Footprint(
        (Pad("1", 0.0, 0.0, 1.0, 1.0, "circle"),), (-1.0, -1.0, 1.0, 1.0), (-0.5, -0.5, 0.5, 0.5), (), has_paste=False
    ),
    FIDUCIAL: Footprint(
        (Pad("", 0.0, 0.0, 1.0, 1.0, "circle", mask_margin=0.5),),
        (-1.25, -1.25, 1.25, 1.25), (-1.0, -1.0, 1.0, 1.0), (), has_paste=False,
    ),
    symbols.M2_HOLE: Footprint(
        (Pad("", 0.0, 0.0, 2.2, 2.2, "circle", drill=2.2, is_plated=False),),
        (-2.45, -2.45, 2.45, 2.45), (-1.1, -1.1, 1.1, 1.1), (), has_paste=False,
    ),
}  # fmt: skip
"""Footprints by KiCad identifier, "library:name"."""

DEFAULT_CORNER_RATIO = 0.25
CORNER_RATIOS = {symbols.C_1206: 0.217391}
"""Corner radius of rounded pads relative to their shorter side, where it is not `DEFAULT_CORNER_RATIO`."""


def pad_corner_ratio(footprint: str, pad: Pad) -> float:
    """Corner radius of a rounded pad relative to its shorter side, by the footprint's KiCad identifier."""
    return CORNER_RATIOS.get(footprint, DEFAULT_CORNER_RATIO) if pad.corner_ratio is None else pad.corner_ratio
