"""Named and coloured STEP files whose bytes depend on the parts alone."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

from OCP.IFSelect import IFSelect_RetDone
from OCP.Quantity import Quantity_Color, Quantity_TOC_sRGB
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Builder, TopoDS_Compound, TopoDS_Shape
from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

from fingertip.foundation.errors import GeometryError, Issue

ColouredSolid = tuple[str, TopoDS_Shape, tuple[float, float, float]]
"""Name, solid and colour of a part."""

_TIMESTAMP = re.compile(r"'\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d'")
_FIXED_TIMESTAMP = "'1970-01-01T00:00:00'"
_COLOUR_BLOCK = re.compile(
    r"^#\d+ = MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION", re.MULTILINE
)
_STYLED_ITEM = re.compile(r"STYLED_ITEM\('color',\(#\d+\),#(\d+)\)")
_COLOUR = re.compile(r"^#(\d+) = COLOUR_RGB\([^;]*;\n", re.MULTILINE)
_ENTITY = re.compile(r"^#(\d+) = ", re.MULTILINE)
_REFERENCE = re.compile(r"#(\d+)")


def write_part(path: Path, part: ColouredSolid) -> None:
    """Write one named, coloured solid (AP214, mm). Raises GeometryError."""
    name, solid, colour = part
    document, shapes = _open_document()
    label = shapes.AddShape(solid, False)
    _describe(
        document,
        label=label,
        name=name,
        colour=colour,
        kind=XCAFDoc_ColorType.XCAFDoc_ColorGen,
    )
    _write(document, path, name)


def write_assembly(path: Path, title: str, parts: Iterable[ColouredSolid]) -> None:
    """Write several named, coloured solids as one assembly called `title` (AP214, mm).

    Raises GeometryError.
    """
    document, shapes = _open_document()
    top = shapes.NewShape()
    _set_name(top, title)

    for name, solid, colour in parts:
        label = shapes.NewShape()
        compound = TopoDS_Compound()
        TopoDS_Builder().MakeCompound(compound)
        TopoDS_Builder().Add(compound, solid)
        shapes.SetShape(label, compound)
        _describe(
            document,
            label=label,
            name=name,
            colour=colour,
            kind=XCAFDoc_ColorType.XCAFDoc_ColorSurf,
        )
        _set_name(shapes.AddComponent(top, label, TopLoc_Location()), name)

    shapes.UpdateAssemblies()
    _write(document, path, title)


def _open_document() -> tuple[TDocStd_Document, XCAFDoc_ShapeTool]:
    document = TDocStd_Document(TCollection_ExtendedString("BinXCAF"))
    return document, XCAFDoc_DocumentTool.ShapeTool_s(document.Main())


def _describe(
    document: TDocStd_Document,
    label: TDF_Label,
    name: str,
    colour: tuple[float, float, float],
    kind: XCAFDoc_ColorType,
) -> None:
    _set_name(label, name)
    shade = Quantity_Color(*colour, Quantity_TOC_sRGB)
    XCAFDoc_DocumentTool.ColorTool_s(document.Main()).SetColor(label, shade, kind)


def _set_name(label: TDF_Label, name: str) -> None:
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))


def _write(document: TDocStd_Document, path: Path, name: str) -> None:
    writer = STEPCAFControl_Writer()
    if not writer.Transfer(document) or writer.Write(str(path)) != IFSelect_RetDone:
        raise GeometryError(
            Issue("STEP", f"the B-rep kernel could not write {name}; use --formats stl,3mf.")
        )

    # The date, and the order of the colour blocks, differ from run to run.
    text = _TIMESTAMP.sub(_FIXED_TIMESTAMP, path.read_text(encoding="utf-8"), count=1)
    path.write_text(_sort_colour_blocks(text), encoding="utf-8")


def _sort_colour_blocks(text: str) -> str:
    """Sort the colour blocks at the end of the file by the number of the solid they colour.

    The kernel writes them in the order of memory addresses. Solids of one colour share its entity,
    which stands in the block that was written first; it moves to the first one after sorting. The
    blocks are moved and their entities renumbered; no entity before them refers to an entity inside
    them.
    """
    starts = [match.start() for match in _COLOUR_BLOCK.finditer(text)]
    if len(starts) < 2:
        return text

    end = text.index("ENDSEC;", starts[-1])
    blocks = [text[a:b] for a, b in zip(starts, [*starts[1:], end], strict=True)]
    blocks.sort(key=lambda block: int(_STYLED_ITEM.findall(block)[0]))
    colours = {match[1]: match[0] for block in blocks for match in _COLOUR.finditer(block)}

    for i, block in enumerate(blocks):
        own = _COLOUR.sub("", block)
        used = [number for number in _REFERENCE.findall(own) if number in colours]
        blocks[i] = own + "".join(colours.pop(number) for number in dict.fromkeys(used))

    old = [number for block in blocks for number in _ENTITY.findall(block)]
    new = dict(zip(old, sorted(old, key=int), strict=True))
    tail = _REFERENCE.sub(lambda m: f"#{new.get(m[1], m[1])}", "".join(blocks))
    return text[: starts[0]] + tail + text[end:]
