"""3D models of the packages: boxes with the outline and the height of each part, as STEP files.

They stand in for the models of KiCad's own libraries, which take gigabytes and are often not installed. The files have
the folders and the names of KiCad's, so that one variable of the project selects the ones or the others.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from fingertip.board.kicad import symbols
from fingertip.board.kicad.footprints import FOOTPRINTS, Footprint, Pad
from fingertip.board.kicad.step_boxes import Block, Colour, step_file

MODEL_FOLDER = "3d"
"""Folder of the models, beside the board."""
MODEL_VARIABLE = "PARTS_3D"
"""Text variable of the project that names the folder of the models."""
MODEL_FOLDER_OF_PROJECT = f"${{KIPRJMOD}}/{MODEL_FOLDER}"
"""Value of the variable that selects the models beside the board."""
MODEL_FOLDER_OF_KICAD = "${KICAD9_3DMODEL_DIR}"
"""Value of the variable that selects KiCad's own models."""

_BLACK: Colour = (0.12, 0.12, 0.13)
_TAN: Colour = (0.62, 0.5, 0.36)
_IVORY: Colour = (0.88, 0.85, 0.76)
_TIN: Colour = (0.78, 0.78, 0.8)
_GOLD: Colour = (0.85, 0.68, 0.3)
_WHITE: Colour = (0.95, 0.95, 0.95)

_FILLET_MM = 0.4
"""Length of a pad beyond the tip of a lead, for the solder."""
_LEAD_HEIGHT_MM = 0.25
_LEAD_RATIO = 0.7
"""Width of a lead relative to that of its pad."""
_MARK_MM, _MARK_HEIGHT_MM = 0.4, 0.02
_PIN_MM = 0.64
"""Side of a square pin."""


@dataclass(frozen=True)
class Chip:
    """Chip resistor or capacitor: a body between two terminals."""

    height: float
    terminal: float
    """Length of each terminal."""
    colour: Colour


@dataclass(frozen=True)
class Leaded:
    """Body with leads on its sides, or with pins below it."""

    height: float
    colour: Colour
    gap: float = 0.1
    """Height of the body's lower face above the board."""
    has_mark: bool = False
    """True if a mark on the body's top shows pin 1."""
    pin_below: float = 0.0
    """Length of the pins below the board's upper face."""
    pin_top: float = 0.0
    """Height of the pins' tops."""


_HEADER = Leaded(2.54, _BLACK, gap=0.0, pin_below=3.0, pin_top=8.54)
_SHAPES: dict[str, Chip | Leaded] = {
    symbols.R_0603: Chip(0.45, 0.3, _BLACK),
    symbols.C_0603: Chip(0.8, 0.35, _TAN),
    symbols.C_0805: Chip(1.25, 0.5, _TAN),
    symbols.C_1206: Chip(1.6, 0.5, _TAN),
    symbols.SOD_123: Leaded(1.15, _BLACK, has_mark=True),
    symbols.SOT_23: Leaded(1.1, _BLACK),
    symbols.SOT_23_5: Leaded(1.45, _BLACK, has_mark=True),
    symbols.TC33X: Leaded(1.2, _IVORY, gap=0.0),
    symbols.SOIC_8: Leaded(1.75, _BLACK, has_mark=True),
    symbols.MSOP_8: Leaded(1.1, _BLACK, has_mark=True),
    symbols.HEADER_2: _HEADER,
    symbols.HEADER_3: _HEADER,
    symbols.HEADER_4: _HEADER,
    symbols.HEADER_5: _HEADER,
    symbols.JST_SH_2: Leaded(2.95, _IVORY, gap=0.0),
    symbols.JST_SH_10: Leaded(2.95, _IVORY, gap=0.0),
    symbols.JST_PH_2: Leaded(4.8, _IVORY, gap=0.0, pin_below=3.4),
}
"""Shape of each package. Heights [mm] are the largest of the package's outline (JEDEC MS-012, MO-187, MO-178 and
TO-236), those of KiCad's models for chips, and those of the makers' catalogues for connectors and trimmer."""


def has_model(footprint: str) -> bool:
    """Return whether a footprint, by its KiCad identifier, has a model. Test points and holes have none."""
    return footprint in _SHAPES


def model_path(footprint: str) -> str:
    """Path of a footprint's model below the folder of the models, as in KiCad's libraries."""
    library, name = footprint.split(":")
    return f"{library}.3dshapes/{name}.step"


def model_files() -> dict[str, bytes]:
    """Content of the model of every package, by its path below the folder of the models."""
    return {
        model_path(footprint): step_file(footprint.split(":")[1], tuple(model_blocks(footprint)))
        for footprint in _SHAPES
    }


def model_blocks(footprint: str) -> Iterator[Block]:
    """Yield the boxes of a package's model [mm]. The y axis points up, as in KiCad's models."""
    match _SHAPES[footprint]:
        case Chip() as chip:
            yield from _chip_blocks(FOOTPRINTS[footprint], chip)
        case Leaded() as package:
            yield from _leaded_blocks(FOOTPRINTS[footprint], package)


def _chip_blocks(footprint: Footprint, chip: Chip) -> Iterator[Block]:
    left, top, right, bottom = footprint.body
    ends = (left, left + chip.terminal, right - chip.terminal, right)
    for start, end, colour in zip(ends, ends[1:], (_TIN, chip.colour, _TIN), strict=False):
        yield Block((start, -bottom, 0.0), (end, -top, chip.height), colour)


def _leaded_blocks(footprint: Footprint, package: Leaded) -> Iterator[Block]:
    left, top, right, bottom = footprint.body
    yield Block((left, -bottom, package.gap), (right, -top, package.height), package.colour)
    for pad in footprint.pads:
        if package.pin_below:
            x, y, half = pad.x, -pad.y, _PIN_MM / 2
            low, high = (x - half, y - half, -package.pin_below), (x + half, y + half, package.pin_top)
            yield Block(low, high, _GOLD)
        else:
            yield from _lead_block(footprint, pad)
    if package.has_mark:
        yield _mark(footprint, package)


def _lead_block(footprint: Footprint, pad: Pad) -> Iterator[Block]:
    """Yield the lead on a pad, from the body's side to its tip; none where the pad lies below the body."""
    left, top, right, bottom = footprint.body
    half_width, half_height = pad.width / 2, pad.height / 2
    x_tips = (pad.x - half_width + _FILLET_MM, pad.x + half_width - _FILLET_MM)
    y_tips = (pad.y - half_height + _FILLET_MM, pad.y + half_height - _FILLET_MM)
    across = _LEAD_RATIO * (half_height if max(left - x_tips[0], x_tips[1] - right) > 0.0 else half_width)
    sides = (
        (left - x_tips[0], (x_tips[0], left), (pad.y - across, pad.y + across)),
        (x_tips[1] - right, (right, x_tips[1]), (pad.y - across, pad.y + across)),
        (top - y_tips[0], (pad.x - across, pad.x + across), (y_tips[0], top)),
        (y_tips[1] - bottom, (pad.x - across, pad.x + across), (bottom, y_tips[1])),
    )
    length, (x0, x1), (y0, y1) = max(sides)
    if length > 1e-9:
        yield Block((x0, -y1, 0.0), (x1, -y0, _LEAD_HEIGHT_MM), _TIN)


def _mark(footprint: Footprint, package: Leaded) -> Block:
    """Mark on the top beside pin 1: a bar across a diode, a square in the corner of an amplifier."""
    left, top, _, bottom = footprint.body
    x, pin_y = left + _MARK_MM / 2, -footprint.pads[0].y
    is_diode = len(footprint.pads) == 2
    y0, y1 = (-bottom, -top) if is_diode else (pin_y - _MARK_MM / 2, pin_y + _MARK_MM / 2)
    return Block((x, y0, package.height), (x + _MARK_MM, y1, package.height + _MARK_HEIGHT_MM), _WHITE)
