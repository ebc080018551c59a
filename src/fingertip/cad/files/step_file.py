"""Named and coloured STEP files whose bytes depend on the parts alone."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

import cadquery as cq
from OCP.IFSelect import IFSelect_RetDone
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool

from fingertip.errors import GeometryError, Issue

Coloured = tuple[str, cq.Solid, tuple[float, float, float]]
"""Name, solid, colour."""

_TIMESTAMP = re.compile(r"'\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d'")
_NO_DATE = "'1970-01-01T00:00:00'"
_PRESENTATION = re.compile(r"^#\d+ = MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION", re.MULTILINE)
_STYLED = re.compile(r"STYLED_ITEM\('color',\(#\d+\),#(\d+)\)")
_DEFINED = re.compile(r"^#(\d+) = ", re.MULTILINE)
_REFERENCE = re.compile(r"#(\d+)")


def write_part(path: Path, part: Coloured) -> None:
    """Write one named, coloured solid (AP214, mm).

    Raises
    ------
    GeometryError
        If the kernel cannot write it.
    """
    name, solid, colour = part
    document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
    label = XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).AddShape(solid.wrapped, False)
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
    colours = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    colours.SetColor(label, cq.Color(*colour).wrapped, XCAFDoc_ColorType.XCAFDoc_ColorGen)
    writer = STEPCAFControl_Writer()
    if not writer.Transfer(document) or writer.Write(str(path)) != IFSelect_RetDone:
        raise GeometryError(Issue("STEP", f"the B-rep kernel could not write {name}."))
    _settle(path)


def write_assembly(path: Path, title: str, parts: Iterable[Coloured]) -> None:
    """Write several named, coloured solids as one assembly (AP214, mm) called `title`."""
    assembly = cq.Assembly(name=title)
    for name, solid, colour in parts:
        assembly.add(solid, name=name, color=cq.Color(*colour))
    assembly.export(str(path), "STEP")
    _settle(path)


def _settle(path: Path) -> None:
    """Take out of a written file what differs from run to run: the date, and the order of the colours."""
    text = path.read_text(encoding="utf-8")
    path.write_text(_order_colours(_TIMESTAMP.sub(_NO_DATE, text, count=1)), encoding="utf-8")


def _order_colours(text: str) -> str:
    """Sort the colour blocks at the file's end by the solid they colour.

    The kernel walks them in the order of memory addresses. Blocks are moved and their entities numbered anew; nothing
    before them refers into them.
    """
    starts = [match.start() for match in _PRESENTATION.finditer(text)]
    if len(starts) < 2:
        return text
    end = text.index("ENDSEC;", starts[-1])
    blocks = [text[a:b] for a, b in zip(starts, [*starts[1:], end], strict=True)]
    blocks.sort(key=_coloured_entity)
    old = [number for block in blocks for number in _DEFINED.findall(block)]
    new = dict(zip(old, sorted(old, key=int), strict=True))
    tail = _REFERENCE.sub(lambda m: f"#{new.get(m[1], m[1])}", "".join(blocks))
    return text[: starts[0]] + tail + text[end:]


def _coloured_entity(block: str) -> int:
    styled = _STYLED.search(block)
    assert styled is not None, "a colour block without a styled item"
    return int(styled[1])
