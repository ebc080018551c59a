"""Atlas of the parameters as one HTML file: each parameter with its picture, or with what it decides instead."""

from __future__ import annotations

import base64
from collections.abc import Mapping

from fingertip.design import Design
from fingertip.design.export import Parameter, format_value
from fingertip.design.parameters import ParameterTable
from fingertip.page.atlas import AtlasPicture
from fingertip.page.document import read_asset, render_document
from fingertip.page.html import Markup, code, element
from fingertip.page.moves import shapes_of_parameters
from fingertip.page.parameters_section import describe_effect, group_parameters

_LEGEND = (
    "Each picture shows the part that a parameter changes most, made with another value of it. Orange is nearer to you "
    "than before, blue is farther away, and pale blue is gone; a ring marks a small change. The other parameters stay."
)


def render_atlas(design: Design, pictures: Mapping[str, AtlasPicture]) -> bytes:
    """Render the atlas.

    Parameters
    ----------
    design
        The fingertip.
    pictures
        Pictures by the names of their parameters.
    """
    tables, moved = group_parameters(), shapes_of_parameters(design)
    links = (element("li", element("a", name or "design", href=f"#t-{name}")) for name in tables)
    sections = (
        element(
            "section",
            element("h2", name or "design", id=f"t-{name}"),
            *_describe_table(design, name),
            element(
                "ul", *(_render_entry(design, one, pictures.get(one.path), moved) for one in entries), class_="atlas"
            ),
            aria_labelledby=f"t-{name}",
        )
        for name, entries in tables.items()
    )
    body = (
        element("a", "Skip to the parameters", href="#content", class_="skip"),
        element(
            "header", element("h1", f"Parameters of {design.name}"), element("p", _LEGEND, class_="lead"),
        ),
        element("nav", element("ul", *links), aria_label="tables"),
        element("main", *sections, id="content"),
    )  # fmt: skip
    style = read_asset("page.css") + read_asset("atlas.css")
    return render_document(f"{design.name}: parameters", body, style, ())


def _describe_table(design: Design, name: str) -> list[Markup]:
    table = getattr(design, name) if name else None
    said = " ".join((type(table).__doc__ or "").split()) if isinstance(table, ParameterTable) else ""
    return [element("p", said)] if said else []


def _render_entry(
    design: Design, one: Parameter, picture: AtlasPicture | None, moved: Mapping[str, tuple[str, ...]]
) -> Markup:
    value = design.value(one.path)
    shown = [element("span", f"{format_value(value)} {one.unit}".rstrip(), class_="num")]
    if value != one.default:
        shown.append(element("small", f" default {format_value(one.default)}"))
    if one.bounds:
        shown.append(element("small", f" {one.bounds}"))
    effect = describe_effect(one.path, moved.get(one.path, ()), linked=False)
    return element(
        "li",
        element("h3", code(one.path), class_="code", id=f"p-{one.path}"),
        element("p", *shown),
        element("p", one.description),
        _render_picture(picture) if picture else element("p", effect),
    )


def _render_picture(picture: AtlasPicture) -> Markup:
    source = f"data:image/png;base64,{base64.b64encode(picture.png).decode('ascii')}"
    image = element("img", src=source, alt=f"{picture.path}: {picture.caption}")
    return element("figure", image, element("figcaption", picture.caption))
