"""3D view of a page: canvas, controls, meshes, and how everything comes apart.

The meshes of parts are those of the STL files, vertex by vertex: coordinates stay binary32 numbers,
triangles stay as they are, and nothing is decimated. `assets/viewer.js` brings the view to life.
"""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.models.hardware import hardware
from fingertip.models.parts import PARTS, parts_by_name, print_scale
from fingertip.models.solids import Solid
from fingertip.page.html import Markup, button, element, join

Offset = tuple[float, float, float]

_IN_FINGER = ("bone", "skin")
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
    parts = {name: part for name, part in parts_by_name(design).items() if not part.is_tool}
    meshes = {name: stl.from_bytes(files[f"{name}.stl"]) for name in parts}
    scales = {name: print_scale(design, part) for name, part in parts.items()}

    return place_items(design, meshes, scales, MeshEvaluator(_TOLERANCE_MM).mesh)


def place_items(
    design: Design,
    meshes: Mapping[str, Mesh],
    scales: Mapping[str, float],
    make_mesh: Callable[[Solid], Mesh],
) -> tuple[Item, ...]:
    offsets = _find_offsets({name: np.ptp(mesh.vertices, axis=0) for name, mesh in meshes.items()})
    items = [
        Item(
            name,
            label_item(name),
            mesh,
            scales[name],
            PARTS[name].colour,
            False,
            *offsets.get(name, _STAY),
        )
        for name, mesh in meshes.items()
    ]
    for bought in hardware(design, tuple(meshes)):
        opened, apart = offsets.get(re.sub(r"_\d+$", "", bought.name), _STAY)
        mesh = make_mesh(bought.solid)
        items.append(
            Item(
                name=bought.name,
                label=label_item(bought.name),
                mesh=mesh,
                scale=1.0,
                colour=bought.colour,
                is_bought=True,
                opened=opened,
                apart=apart,
            )
        )

    return tuple(items)


def measure_finger(items: tuple[Item, ...]) -> list[float]:
    """Measure the finished finger: across, thickness and length [mm]."""
    corners = [item.mesh.vertices / item.scale for item in items if item.name in _IN_FINGER]
    size: list[float] = np.ptp(np.concatenate(corners), axis=0).tolist()
    return size


def label_item(name: str) -> str:
    """Return the name of an item for people: numbered items in the plural, without their number."""
    return re.sub(r"_\d+$", "s", name).replace("_", " ")


_STAY: tuple[Offset, Offset] = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def _find_offsets(sizes: Mapping[str, Array]) -> dict[str, tuple[Offset, Offset]]:
    """Find the offsets of each kind of item [mm]: y points dorsally, z to the tip.

    Opening moves the halves of the mold. Taking apart then pulls the skin off the bone towards the
    tip.
    """
    lengths_mm = sizes["bone"][1], sizes["skin"][2], sizes["bone"][2]
    up, pull, beyond = (round(float(length) + _GAP_MM, 3) for length in lengths_mm)
    return {
        "mold_dorsal": ((0.0, up, 0.0), (0.0, up / 2, 0.0)),
        "mold_palmar": ((0.0, -up, 0.0), (0.0, -up / 2, 0.0)),
        "skin": ((0.0, 0.0, 0.0), (0.0, 0.0, pull / 2)),
        "bone": ((0.0, 0.0, 0.0), (0.0, 0.0, -pull / 2)),
        "core": ((0.0, 0.0, 0.0), (0.0, 0.0, -pull / 2 - beyond)),
        "holder": ((0.0, 0.0, 0.0), (0.0, 0.0, -pull / 2 - beyond)),
        "plug": ((0.0, 0.0, 0.0), (0.0, -2 * _GAP_MM, -pull / 2)),
        "joint_pin": ((0.0, 0.0, 0.0), (pull / 2, 0.0, -pull / 2)),
        "sensor": ((0.0, 0.0, 0.0), (0.0, -_GAP_MM, -pull / 2)),
    }


def scene_data(items: tuple[Item, ...]) -> list[dict[str, Any]]:
    """Describe the items as data, with little-endian numbers in base64."""
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


_PRESETS = (
    ("finger", "Finger"),
    ("closed", "Mold closed"),
    ("opened", "Mold open"),
    ("apart", "All apart"),
)
_VIEWS = (
    ("slanted", "slanted"),
    ("dorsal", "back"),
    ("palmar", "palm"),
    ("side", "side"),
    ("tip", "tip"),
)
_AXES = (("x", "lengthwise"), ("y", "in the parting plane"), ("z", "across"))
_HELP = (
    "3D view of the parts. Arrow keys turn it, plus and minus zoom, 0 brings it back. The buttons "
    "below show the same "
    "parts closed, open and apart."
)
_EXPORTED = (
    "The parts are the meshes of the STL files, with every triangle; sensor, bolts and nuts are "
    "plain bodies without "
    "threads."
)

_USE = (
    "Drag to turn, wheel or two fingers to zoom, right button or two fingers to shift. On a touch "
    "screen, tap the view "
    "first: until then a swipe up or down scrolls the page."
)


def render_model(
    items: Sequence[Item], origin: str = _EXPORTED, *, preset: str = "finger"
) -> Markup:
    """Render the 3D view, which shows a state of the mold or the finger first.

    Only exported parts can be saved.
    """
    is_exported = origin == _EXPORTED
    rows = _rows(items, preset, saves_files=is_exported)
    return element(
        "div",
        element(
            "div",
            element(
                "canvas",
                id="canvas",
                tabindex="0",
                role="application",
                aria_label=_HELP,
            ),
            element("p", "", id="view-status", class_="status", role="status"),
            rows[0],
        ),
        element(
            "details",
            element("summary", "Parts, sections, directions and saving"),
            *rows[1:],
            element("p", f"{_USE} {origin}", class_="status"),
            class_="controls roomy",
            open=is_exported,
        ),
        id="view",
    )


def render_no_view() -> Markup:
    """Render what stands in place of the 3D view where a browser has none."""
    text = (
        "This browser shows no 3D view (WebGL). The pictures of the casting steps show the "
        "same parts."
    )
    return element("p", text, id="no-view", class_="note", hidden=True)


def scene_json(items: Sequence[Item]) -> Markup:
    """Encode the scene so that nothing in it can end the script element that holds it."""
    text = json.dumps(scene_data(tuple(items)), separators=(",", ":"), sort_keys=True)
    return Markup(text.replace("<", "\\u003c"))


def render_boxes(items: Sequence[Item]) -> Markup:
    """Render a box for each kind of item, which shows or hides it."""
    labels = list(dict.fromkeys(item.label for item in items))
    return join(
        _box(i, label, next(item for item in items if item.label == label))
        for i, label in enumerate(labels)
    )


def _rows(items: Sequence[Item], preset: str, *, saves_files: bool) -> list[Markup]:
    presets = [
        button(label, data_preset=name, aria_pressed="true" if name == preset else "false")
        for name, label in _PRESETS
    ]
    views = [
        button(label, data_from=name, aria_label=f"seen from: {label}") for name, label in _VIEWS
    ]
    stl = [
        button(f"{item.name}.stl", data_stl=item.name)
        for item in items
        if saves_files and not item.is_bought
    ]
    return [
        element("div", *presets, class_="row controls", role="group", aria_label="what is shown"),
        element(
            "div",
            element("label", "take apart", for_="apart"),
            element(
                "input",
                type="range",
                id="apart",
                min=0,
                max=100,
                value=0,
            ),
            element("output", "", id="apart-value", for_="apart"),
            class_="row",
        ),
        element(
            "div",
            element("label", element("input", type="checkbox", id="cut"), " section"),
            element(
                "select",
                *(element("option", label, value=axis) for axis, label in _AXES),
                id="cut-axis",
                aria_label="direction of the section",
                disabled=True,
            ),
            element(
                "input",
                type="range",
                id="cut-place",
                min=0,
                max=100,
                step="0.5",
                value=50,
                disabled=True,
                aria_label="place of the section",
            ),
            element("output", "", id="cut-value", for_="cut-place"),
            class_="row",
        ),
        element(
            "fieldset",
            element("legend", "show"),
            element("div", render_boxes(items), class_="row", id="boxes"),
        ),
        element(
            "div",
            element("span", "seen from"),
            *views,
            class_="row",
            role="group",
            aria_label="direction",
        ),
        element(
            "div",
            element(
                "label", element("input", type="checkbox", id="clear"), " see through skin and mold"
            ),
            class_="row",
        ),
        element(
            "div",
            element("span", "save"),
            button("picture", id="save-picture"),
            *stl,
            class_="row",
            role="group",
            aria_label="save",
        ),
    ]


def _box(number: int, label: str, item: Item) -> Markup:
    red, green, blue = (round(255 * part) for part in item.colour)
    swatch = element(
        "svg",
        element("rect", width=10, height=10, fill=f"rgb({red},{green},{blue})"),
        class_="swatch",
        viewBox="0 0 10 10",
        aria_hidden="true",
    )
    return element(
        "label", element("input", type="checkbox", id=f"show-{number}", checked=True), swatch, label
    )
