"""Page of the studio: the 3D view of the page of a design, the form beside it, and the checks below."""

from __future__ import annotations

from fingertip.design import Design
from fingertip.design.export import json_schema
from fingertip.page.document import read_asset, read_viewer_library, render_document
from fingertip.page.html import Markup, element
from fingertip.page.model_section import render_model, render_no_view, scene_json
from fingertip.page.moves import shapes_of_parameters
from fingertip.studio.answers import FILE_TOLERANCE_MM, VIEW_TOLERANCE_MM, make_items
from fingertip.studio.downloads import DOWNLOADS
from fingertip.studio.form import make_form
from fingertip.studio.form_section import render_form

_LEAD = "Move a slider: the parts and their checks follow. Nothing is written until you download a file."
_ORIGIN = (
    f"The parts are meshes within {VIEW_TOLERANCE_MM:g} mm of the exact surface, coarser than those of the files "
    f"({FILE_TOLERANCE_MM:g} mm); sensor, bolts and nuts are plain bodies without threads."
)


def render_studio(design: Design, token: str) -> bytes:
    """Render the page.

    Parameters
    ----------
    design
        Design that the form begins with.
    token
        Secret that the page sends with each request.
    """
    items = make_items(design)
    form = render_form(make_form(json_schema()), design, shapes_of_parameters(design))
    model = element(
        "div", element("h2", "Model", id="model"), render_no_view(),
        render_model(items, _ORIGIN, saves_files=False), class_="model",
    )  # fmt: skip
    beside = element("div", model, element("div", element("h2", "Parameters", id="parameters"), form), class_="beside")
    body = (
        element("a", "Skip to the parameters", href="#form", class_="skip"),
        element("header", element("h1", f"Studio: {design.name}"), element("p", _LEAD, class_="lead")),
        _render_bar(),
        element("main", element("section", beside), _render_checks(), id="content"),
        element("footer", element("p", "Served to this machine alone. Ctrl-C in the terminal ends it.")),
        element("script", scene_json(items), type="application/json", id="scene"),
    )
    style = read_asset("page.css") + read_asset("studio.css", __package__)
    scripts = (read_viewer_library(), read_asset("viewer.js"), read_asset("studio.js", __package__))
    return render_document(
        f"{design.name}: fingertip studio", body, style, scripts, "'self'", data_design=design.name, data_token=token
    )


def render_locked() -> bytes:
    """Render what somebody sees who has not the address with its token."""
    text = "This is a fingertip studio. Open it with the address that its terminal shows: it ends in a token."
    body = (element("main", element("section", element("h1", "Studio"), element("p", text))),)
    return render_document("fingertip studio", body, read_asset("page.css"), ())


def render_way_in(url: str) -> str:
    """Render a page that leads to another one at once, without telling it where from."""
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>fingertip studio</title>'
        '<meta name="referrer" content="no-referrer">'
        f'<meta http-equiv="refresh" content="0; url={url}"></head>'
        f'<body><p><a href="{url}">Open the studio</a></p></body></html>\n'
    )


def _render_bar() -> Markup:
    """Render what stays in sight: verdict, time of the last change, downloads."""
    buttons = (element("button", label, type="button", data_download=name) for name, (label, _) in DOWNLOADS.items())
    return element(
        "section",
        element("div", element("p", "checking", class_="verdict"), id="verdict", role="status"),
        element("p", "", id="change-time", class_="hint"),
        element("div", element("span", "download"), *buttons, class_="row", role="group", aria_label="download"),
        class_="bar", aria_label="verdict and downloads",
    )  # fmt: skip


def _render_checks() -> Markup:
    return element(
        "section",
        element("h2", "Checks", id="checks-title"),
        element(
            "div", element("button", "make the files and check all", type="button", id="check-all"),
            element("span", "as fingertip check does, in some seconds", class_="hint"), class_="row",
        ),
        element("div", "", id="checks"), aria_labelledby="checks-title",
    )  # fmt: skip
