"""Scene of the 3D view: the meshes of the exported files and of the bought items, and where they go when taken apart.

The meshes of parts are those of the STL files, vertex by vertex: coordinates stay binary32 numbers, triangles stay as
they are, and nothing is decimated.
"""

from __future__ import annotations

import base64
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.shapes.parts import PARTS, hardware, parts_by_name, print_scale
from fingertip.design import Design
from fingertip.design.geometry.solids import Solid

Offset = tuple[float, float, float]

_TOLERANCE_MM = 0.02
"""Tolerance of the meshes of bought items, which are in no file."""
_GAP_MM = 6.0
"""Distance between items that were taken apart."""
_MAX_SHORT_INDEX = 2**16


@dataclass(frozen=True)
class Item:
    """Part or bought item in its place in the closed mold."""

    name: str
    label: str
    """Name for people; equal items share it."""
    mesh: Mesh
    """Mesh as in the file."""
    scale: float
    """Factor of the file's lengths over the part's: that of the printer's compensation."""
    colour: tuple[float, float, float]
    is_bought: bool
    opened: Offset
    """Offset in the open mold [mm]."""
    apart: Offset
    """Further offset when everything is taken apart [mm]."""


def list_items(design: Design, files: Mapping[str, bytes]) -> tuple[Item, ...]:
    """List what the 3D view of exported files shows."""
    parts = parts_by_name(design)
    meshes = {name: stl.from_bytes(files[f"{name}.stl"]) for name in parts}
    scales = {name: print_scale(design, part) for name, part in parts.items()}
    return place_items(design, meshes, scales, MeshEvaluator(_TOLERANCE_MM).mesh)


def place_items(
    design: Design, meshes: Mapping[str, Mesh], scales: Mapping[str, float], make_mesh: Callable[[Solid], Mesh]
) -> tuple[Item, ...]:
    """Place the parts of a design and what is bought for them."""
    offsets = _find_offsets({name: np.ptp(mesh.vertices, axis=0) for name, mesh in meshes.items()})
    items = [
        Item(name, label_item(name), mesh, scales[name], PARTS[name].colour, False, *offsets.get(name, _STAY))
        for name, mesh in meshes.items()
    ]
    for bought in hardware(design, tuple(meshes)):
        opened, apart = offsets.get(re.sub(r"_\d+$", "", bought.name), _STAY)
        mesh = make_mesh(bought.solid)
        items.append(Item(bought.name, label_item(bought.name), mesh, 1.0, bought.colour, True, opened, apart))
    return tuple(items)


def label_item(name: str) -> str:
    """Return the name of an item for people: numbered items in the plural, without their number."""
    words = re.sub(r"_\d+$", "s", name)
    return words.replace("_", " ")


_STAY: tuple[Offset, Offset] = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def _find_offsets(sizes: Mapping[str, Any]) -> dict[str, tuple[Offset, Offset]]:
    """Find the offsets of each kind of item [mm]: y points dorsally, z to the tip.

    Opening moves the halves of the mold with their bolts and nuts. Taking apart then pulls the skin off the bone
    towards the tip, and the screws out of what they hold.
    """
    thickness = float(sizes["bone"][1])
    up = round(thickness + _GAP_MM, 3)
    pull = round(float(sizes["skin"][2]) + _GAP_MM, 3)
    beyond = round(float(sizes["bone"][2]) + _GAP_MM, 3)
    out = round(float(sizes["mold_dorsal"][1]) + _GAP_MM, 3)
    return {
        "mold_dorsal": ((0.0, up, 0.0), (0.0, up / 2, 0.0)),
        "mold_palmar": ((0.0, -up, 0.0), (0.0, -up / 2, 0.0)),
        "mold_bolt": ((0.0, up, 0.0), (0.0, up / 2 + out, 0.0)),
        "mold_nut": ((0.0, -up, 0.0), (0.0, -up / 2 - out / 2, 0.0)),
        "chaplet_screw": ((0.0, up, 0.0), (0.0, up / 2 + out, 0.0)),
        "skin": ((0.0, 0.0, 0.0), (0.0, 0.0, pull / 2)),
        "bone": ((0.0, 0.0, 0.0), (0.0, 0.0, -pull / 2)),
        "core": ((0.0, 0.0, 0.0), (0.0, 0.0, -pull / 2 - beyond)),
        "lid": ((0.0, 0.0, 0.0), (0.0, _GAP_MM, -pull / 2)),
        "joint_pin": ((0.0, 0.0, 0.0), (pull / 2, 0.0, -pull / 2)),
        "sensor": ((0.0, 0.0, 0.0), (0.0, -_GAP_MM, -pull / 2)),
    }


def scene_data(items: tuple[Item, ...]) -> list[dict[str, Any]]:
    """Describe the items as plain data, with coordinates and indices as little-endian numbers in base64."""
    return [
        {
            "name": item.name,
            "label": item.label,
            "bought": item.is_bought,
            "colour": [round(part, 3) for part in item.colour],
            "scale": item.scale,
            "opened": [*item.opened],
            "apart": [*item.apart],
            "vertices": _encode(item.mesh.vertices, "<f4"),
            "triangles": _encode(item.mesh.triangles, _index_type(item.mesh)),
            "wide": _index_type(item.mesh) == "<u4",
        }
        for item in items
    ]


def _index_type(mesh: Mesh) -> str:
    return "<u2" if len(mesh.vertices) <= _MAX_SHORT_INDEX else "<u4"


def _encode(numbers: Any, kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(numbers, dtype=kind).tobytes()).decode("ascii")
