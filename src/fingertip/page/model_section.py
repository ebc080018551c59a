"""3D view of a page: canvas, controls and the scene's data. `assets/viewer.js` brings it to life."""

from __future__ import annotations

import json
from collections.abc import Sequence

from fingertip.page.html import Markup, element, join
from fingertip.page.scene import Item, scene_data

_PRESETS = (
    ("finger", "Finger"), ("closed", "Mold closed"), ("opened", "Mold open"), ("apart", "All apart"),
)  # fmt: skip
_VIEWS = (("slanted", "slanted"), ("dorsal", "back"), ("palmar", "palm"), ("side", "side"), ("tip", "tip"))
_AXES = (("x", "lengthwise"), ("y", "in the parting plane"), ("z", "across"))
_HELP = (
    "3D view of the parts. Arrow keys turn it, plus and minus zoom, 0 brings it back. The buttons below show the same "
    "parts closed, open and apart."
)


_EXPORTED = (
    "The parts are the meshes of the STL files, with every triangle; sensor, bolts and nuts are plain bodies without "
    "threads."
)


def render_model(items: Sequence[Item], origin: str = _EXPORTED, *, saves_files: bool = True) -> Markup:
    """Render the 3D view with its controls."""
    return element(
        "div",
        element("canvas", id="canvas", tabindex="0", role="application", aria_label=_HELP),
        element("p", "", id="view-status", class_="status", role="status"),
        element("div", *_rows(items, saves_files), class_="controls"),
        element(
            "p", f"Drag to turn, wheel or two fingers to zoom, right button or two fingers to shift. {origin}",
            class_="status controls",
        ),
        id="view",
    )  # fmt: skip


def render_no_view() -> Markup:
    """Render what stands in place of the 3D view where a browser has none."""
    text = "This browser shows no 3D view (WebGL). The pictures of the casting steps below show the same parts."
    return element("p", text, id="no-view", class_="note", hidden=True)


def scene_json(items: Sequence[Item]) -> Markup:
    """Encode the scene so that nothing in it can end the script element that holds it."""
    text = json.dumps(scene_data(tuple(items)), separators=(",", ":"), sort_keys=True)
    return Markup(text.replace("<", "\\u003c"))


def render_boxes(items: Sequence[Item]) -> Markup:
    """Render a box for each kind of item, which shows or hides it."""
    labels = list(dict.fromkeys(item.label for item in items))
    return join(_box(i, label, next(item for item in items if item.label == label)) for i, label in enumerate(labels))


def _rows(items: Sequence[Item], saves_files: bool) -> list[Markup]:
    presets = [
        element("button", label, type="button", data_preset=name, aria_pressed="true" if name == "opened" else "false")
        for name, label in _PRESETS
    ]
    views = [
        element("button", label, type="button", data_from=name, aria_label=f"seen from: {label}")
        for name, label in _VIEWS
    ]
    stl = [
        element("button", f"{item.name}.stl", type="button", data_stl=item.name)
        for item in items
        if saves_files and not item.is_bought
    ]
    return [
        element("div", *presets, class_="row", role="group", aria_label="state of the mold"),
        element(
            "div", element("label", "take apart", for_="apart"),
            element("input", type="range", id="apart", min=0, max=100, value=50),
            element("output", "", id="apart-value", for_="apart"), class_="row",
        ),
        element(
            "div", element("label", element("input", type="checkbox", id="cut"), " section"),
            element(
                "select", *(element("option", label, value=axis) for axis, label in _AXES), id="cut-axis",
                aria_label="direction of the section", disabled=True,
            ),
            element(
                "input", type="range", id="cut-place", min=0, max=100, step="0.5", value=50, disabled=True,
                aria_label="place of the section",
            ),
            element("output", "", id="cut-value", for_="cut-place"), class_="row",
        ),
        element("fieldset", element("legend", "show"), element("div", render_boxes(items), class_="row", id="boxes")),
        element("div", element("span", "seen from"), *views, class_="row", role="group", aria_label="direction"),
        element(
            "div", element("label", element("input", type="checkbox", id="clear"), " see through skin and mold"),
            class_="row",
        ),
        element(
            "div", element("span", "save"), element("button", "picture", type="button", id="save-picture"), *stl,
            class_="row", role="group", aria_label="save",
        ),
    ]  # fmt: skip


def _box(number: int, label: str, item: Item) -> Markup:
    red, green, blue = (round(255 * part) for part in item.colour)
    swatch = element(
        "svg", element("rect", width=10, height=10, fill=f"rgb({red},{green},{blue})"), class_="swatch",
        viewBox="0 0 10 10", aria_hidden="true",
    )  # fmt: skip
    return element("label", element("input", type="checkbox", id=f"show-{number}", checked=True), swatch, label)
