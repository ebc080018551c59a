"""Atlas of the parameters as one HTML file: each with a picture of what it changes, or with what it decides instead."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from fingertip.cad.shapes.reads import shapes_of_parameters
from fingertip.design import Design
from fingertip.design.files import Parameter, format_value
from fingertip.foundation.files import open_atomic
from fingertip.page.html import Markup, code, element, embed, read_asset, render_document
from fingertip.page.parameters_and_checks import describe_effect, describe_table, group_parameters
from fingertip.pictures.parameter_changes import AtlasPicture, draw_atlas

_LEGEND = (
    "Each picture shows the part that a parameter changes most, made with another value of it. Orange is nearer to you "
    "than before, blue is farther away, and pale blue is gone; a ring marks a small change. The other parameters stay."
)


def write_atlas(design: Design, path: str | Path, progress: Callable[[str], None] = lambda message: None) -> int:
    """Write the atlas of the parameters: each with a picture of what it changes. Returns the number of pictures.

    Raises OutputError.
    """
    with open_atomic(Path(path), "--html") as file:  # a path that cannot be written is refused before the work
        pictures = {picture.path: picture for picture in draw_atlas(design, progress)}
        file.write(render_atlas(design, pictures))
    return len(pictures)


def render_atlas(design: Design, pictures: Mapping[str, AtlasPicture]) -> bytes:
    tables, moved = group_parameters(), shapes_of_parameters(design)
    links = (element("li", element("a", name or "design", href=f"#t-{name}")) for name in tables)
    sections = []
    for name, entries in tables.items():
        parts = [element("h2", name or "design", id=f"t-{name}")]
        if said := describe_table(design, name):
            parts.append(element("p", said))
        listed = (_render_entry(design, one, pictures.get(one.path), moved) for one in entries)
        parts.append(element("ul", *listed, class_="atlas"))
        sections.append(element("section", *parts, aria_labelledby=f"t-{name}"))
    body = (
        element("a", "Skip to the parameters", href="#content", class_="skip"),
        element(
            "header", element("h1", f"Parameters of {design.name}"), element("p", _LEGEND, class_="lead"),
        ),
        element("nav", element("ul", *links), aria_label="tables"),
        element("main", *sections, id="content"),
    )  # fmt: skip
    return render_document(f"{design.name}: parameters", body, read_asset("page.css") + read_asset("atlas.css"), ())


def _render_entry(
    design: Design, one: Parameter, picture: AtlasPicture | None, moved: Mapping[str, tuple[str, ...]]
) -> Markup:
    value = design.value(one.path)
    shown = [element("span", f"{format_value(value)} {one.unit}".rstrip(), class_="num")]
    if value != one.default:
        shown.append(element("small", f" default {format_value(one.default)}"))
    if one.bounds:
        shown.append(element("small", f" {one.bounds}"))
    shows = element("p", describe_effect(one.path, moved.get(one.path, ()), linked=False))
    if picture:
        image = element("img", src=embed(picture.png, "image/png"), alt=f"{picture.path}: {picture.caption}")
        shows = element("figure", image, element("figcaption", picture.caption))
    return element(
        "li",
        element("h3", code(one.path), class_="code", id=f"p-{one.path}"),
        element("p", *shown),
        element("p", one.description),
        shows,
    )
