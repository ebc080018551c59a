"""Page of a design as one HTML file: every style, script, mesh and picture is within it, and it asks no network."""

from __future__ import annotations

from fingertip.foundation.version import __version__
from fingertip.page.board_section import render_board
from fingertip.page.casting_section import render_basis, render_casting, render_drawing
from fingertip.page.html import Markup, element, read_asset, read_viewer_library, render_document
from fingertip.page.model_section import Item, list_items, render_model, render_no_view, scene_json
from fingertip.page.pad_section import render_pad
from fingertip.page.parameters_and_checks import render_checks, render_parameters, render_verdict
from fingertip.page.sources import Sources
from fingertip.page.trial_section import render_trial
from fingertip.slip.detectors.registry import DETECTORS, ENVELOPE_MEAN

ARTICLE_DOI = "10.1109/TMRB.2021.3060032"
_LEAD = "A sensorised prosthetic fingertip: printed bone and mold, silicone skin, filter board, slip detector."
_ENVELOPE_DETECTORS = " and ".join(name for name, kind in DETECTORS.items() if kind.quantity == ENVELOPE_MEAN)
_SECTIONS = (
    ("model", "Model"), ("checks", "Checks"), ("parameters", "Parameters"), ("pad", "Pad"),
    ("casting", "Casting guide"), ("drawing", "Drawing"), ("board", "Board"), ("response", "Response"),
    ("trial", "Trial"), ("basis", "Basis"),
)  # fmt: skip


def render_page(sources: Sources) -> bytes:
    """Render the page of a design. The same files give the same bytes."""
    name, items = sources.design.name, list_items(sources.design, sources.files)
    links = (element("li", element("a", label, href=f"#{section}")) for section, label in _SECTIONS)
    body = (
        element("a", "Skip to the content", href="#content", class_="skip"),
        _render_header(sources),
        element("nav", element("ul", *links), aria_label="sections"),
        element("main", *_render_sections(sources, items), id="content"),
        _render_footer(),
        element("script", scene_json(items), type="application/json", id="scene"),
    )
    scripts = (read_viewer_library(), read_asset("viewer.js"), read_asset("board.js"))
    return render_document(f"{name}: fingertip", body, read_asset("page.css"), scripts, data_design=name)


def _render_sections(sources: Sources, items: tuple[Item, ...]) -> list[Markup]:
    design = sources.design
    model = element("div", element("h2", "Model", id="model"), render_no_view(), render_model(items), class_="model")
    checks = element("div", element("h2", "Checks", id="checks"), render_checks(sources.report), class_="checks")
    parameters = element("div", element("h2", "Parameters", id="parameters"), render_parameters(design))
    beside = element("section", element("div", model, element("div", checks, parameters), class_="beside"))
    parts = [beside]
    for name, title, content in (
        ("pad", "What the sensor feels", render_pad(design)),
        ("casting", "Casting guide", render_casting(sources)),
        ("drawing", "Dimensioned drawing", render_drawing(sources)),
        ("board", "Board", render_board(sources)),
        ("trial", "Trial and detection", render_trial(sources)),
        ("basis", "What is simulated and what is measured", render_basis(design)),
    ):
        parts.append(element("section", element("h2", title, id=name), content, aria_labelledby=name))
    return parts


def _render_header(sources: Sources) -> Markup:
    design, report = sources.design, sources.report
    skin, strength = design.skin, report.get("strength")
    facts = [
        ("sensor", design.dimensions.sensor.label),
        ("skin", f"{skin.width_mm:g} mm wide, {skin.length_mm:g} mm long"),
        ("made by", "overmolding" if design.mold.method == "overmold" else "a sleeve, pulled over"),
        ("board", f"{design.board.variant}, {design.board.supply_v:g} V"),
        (
            f"threshold of {_ENVELOPE_DETECTORS}",
            f"{1000 * design.detector.threshold_v:g} mV, {ENVELOPE_MEAN}; that of fast stands with the trial",
        ),
    ]
    if strength:
        said = f"{strength['grip_safety_factor']:.1f} in {strength['material'].replace('_', ' ')}"
        facts.append(("bone's safety factor at the grip force", said))
    terms = (element("div", element("dt", term), element("dd", value)) for term, value in facts)
    return element(
        "header",
        element("h1", f"Fingertip {design.name}"),
        element("p", _LEAD, class_="lead"),
        render_verdict(report),
        element("dl", *terms, class_="facts"),
    )  # fmt: skip


def _render_footer() -> Markup:
    return element(
        "footer",
        element(
            "p", "After R. A. Romeo, C. Lauretti, C. Gentile, E. Guglielmelli, L. Zollo: Method for Automatic Slippage "
            "Detection With Tactile Sensors Embedded in Prosthetic Hands. IEEE Transactions on Medical Robotics and "
            "Bionics 3(2), 485-497, 2021. ", element("a", f"doi:{ARTICLE_DOI}", href=f"https://doi.org/{ARTICLE_DOI}"),
        ),
        element(
            "p", f"Made by fingertip {__version__}. The 3D view uses three.js, under the MIT License that stands in "
            "this file. This page needs no network.",
        ),
    )  # fmt: skip
