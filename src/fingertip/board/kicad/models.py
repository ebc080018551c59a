"""3D models of the packages: boxes with the outline and the height of each part, as STEP files.

They stand in for the models of KiCad's own libraries, which take gigabytes and are often not installed. The files have
the folders and the names of KiCad's, so that one variable of the project selects the ones or the others.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

from fingertip.board.kicad.footprints import FOOTPRINTS, Footprint, Pad
from fingertip.board.kicad.sexpr import number
from fingertip.board.parts import symbols

# STEP file (AP214) of coloured boxes [mm], written as text: a board's models need no B-rep kernel.
#
# Each box is a faceted boundary representation: six planes, each bounded by a loop of four corners.


Corner = tuple[float, float, float]
Colour = tuple[float, float, float]
"""Red, green and blue from 0 to 1."""


@dataclass(frozen=True)
class Block:
    """Coloured box, by two opposite corners."""

    low: Corner
    high: Corner
    colour: Colour


_FACES = (
    ((-1, 0, 0), (0, 1, 3, 2)), ((1, 0, 0), (4, 6, 7, 5)),
    ((0, -1, 0), (0, 4, 5, 1)), ((0, 1, 0), (2, 3, 7, 6)),
    ((0, 0, -1), (0, 2, 6, 4)), ((0, 0, 1), (1, 5, 7, 3)),
)  # fmt: skip
"""Outward normal of each face and its corners, anticlockwise seen from outside. Corner 4 i + 2 j + k lies at the high
end of x, y and z where i, j and k are 1."""


class _Entities:
    def __init__(self) -> None:
        self.lines: list[str] = []

    def add(self, text: str) -> str:
        """Add an entity and return its name."""
        name = f"#{len(self.lines) + 1}"
        self.lines.append(f"{name}={text};")
        return name


def step_file(name: str, blocks: Sequence[Block]) -> bytes:
    """Content of the file. The same blocks give the same bytes: there is no date."""
    entities = _Entities()
    product_shape, context = _add_product(entities, name), _add_context(entities)
    origin = _add_placement(entities, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    solids = [_add_block(entities, block) for block in blocks]
    shape = entities.add(f"FACETED_BREP_SHAPE_REPRESENTATION('{name}',{_list(origin, *solids)},{context})")
    entities.add(f"SHAPE_DEFINITION_REPRESENTATION({product_shape},{shape})")
    styles = list(_add_colours(entities, blocks, solids))
    entities.add(f"MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',{_list(*styles)},{context})")
    lines = [
        "ISO-10303-21;", "HEADER;", "FILE_DESCRIPTION((''),'2;1');",
        f"FILE_NAME('{name}.step','',(''),(''),'fingertip','','');",
        "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));", "ENDSEC;", "DATA;",
        *entities.lines, "ENDSEC;", "END-ISO-10303-21;",
    ]  # fmt: skip
    return ("\n".join(lines) + "\n").encode("ascii")


def _add_product(entities: _Entities, name: str) -> str:
    add = entities.add
    application = add("APPLICATION_CONTEXT('automotive design')")
    add(f"APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,{application})")
    product_context = add(f"PRODUCT_CONTEXT('',{application},'mechanical')")
    item = add(f"PRODUCT('{name}','{name}','',({product_context}))")
    add(f"PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,({item}))")
    formation = add(f"PRODUCT_DEFINITION_FORMATION('','',{item})")
    design = add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')")
    definition = add(f"PRODUCT_DEFINITION('design','',{formation},{design})")
    return add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")


def _add_context(entities: _Entities) -> str:
    add = entities.add
    length = add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
    angle = add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
    solid_angle = add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
    accuracy = add(f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-05),{length},'distance_accuracy_value','')")
    return add(
        f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({accuracy}))"
        f"GLOBAL_UNIT_ASSIGNED_CONTEXT({_list(length, angle, solid_angle)})REPRESENTATION_CONTEXT('',''))"
    )


def _add_block(entities: _Entities, block: Block) -> str:
    ends = zip(block.low, block.high, strict=True)
    corners: list[Corner] = [(x, y, z) for x, y, z in product(*ends)]
    points = [_add_point(entities, corner) for corner in corners]
    faces = []
    for normal, order in _FACES:
        loop = entities.add(f"POLY_LOOP('',{_list(*(points[i] for i in order))})")
        bound = entities.add(f"FACE_OUTER_BOUND('',{loop},.T.)")
        plane = entities.add(f"PLANE('',{_add_placement(entities, corners[order[0]], normal)})")
        faces.append(entities.add(f"FACE_SURFACE('',({bound}),{plane},.T.)"))
    shell = entities.add(f"CLOSED_SHELL('',{_list(*faces)})")
    return entities.add(f"FACETED_BREP('',{shell})")


def _add_point(entities: _Entities, corner: Corner) -> str:
    return entities.add(f"CARTESIAN_POINT('',{_list(*map(_real, corner))})")


def _add_placement(entities: _Entities, point: Corner, axis: Sequence[float]) -> str:
    """Add a placement with this z axis. Its x axis is the x or the y axis of the file."""
    across = (0.0, 1.0, 0.0) if axis[0] else (1.0, 0.0, 0.0)
    z, x = (entities.add(f"DIRECTION('',{_list(*map(_real, direction))})") for direction in (axis, across))
    return entities.add(f"AXIS2_PLACEMENT_3D('',{_add_point(entities, point)},{z},{x})")


def _add_colours(entities: _Entities, blocks: Iterable[Block], solids: Iterable[str]) -> Iterator[str]:
    """Add the colour of each box and yield the styled items; boxes of one colour share it."""
    styles: dict[Colour, str] = {}
    for block, solid in zip(blocks, solids, strict=True):
        if block.colour not in styles:
            colour = entities.add(f"COLOUR_RGB('',{','.join(map(_real, block.colour))})")
            fill_colour = entities.add(f"FILL_AREA_STYLE_COLOUR('',{colour})")
            fill = entities.add(f"FILL_AREA_STYLE('',({fill_colour}))")
            area = entities.add(f"SURFACE_STYLE_FILL_AREA({fill})")
            side = entities.add(f"SURFACE_SIDE_STYLE('',({area}))")
            usage = entities.add(f"SURFACE_STYLE_USAGE(.BOTH.,{side})")
            styles[block.colour] = entities.add(f"PRESENTATION_STYLE_ASSIGNMENT(({usage}))")
        yield entities.add(f"STYLED_ITEM('',({styles[block.colour]}),{solid})")


def _list(*items: str) -> str:
    return f"({','.join(items)})"


def _real(value: float) -> str:
    """Format a real number, which needs a decimal point."""
    text = number(value)
    return text if "." in text else f"{text}."


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
