"""STEP file (AP214) of coloured boxes [mm], written as text: a board's models need no B-rep kernel.

Each box is a faceted boundary representation: six planes, each bounded by a loop of four corners.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

from fingertip.board.kicad.sexpr import number

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
    """Numbered entities of a STEP file."""

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
    """Add the product and return the shape that stands for it."""
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
    """Add the units, millimetre and radian, and the context that refers to them."""
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
    """Add a box and return its solid."""
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
