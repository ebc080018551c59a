"""Casting guide of a page: the casting sheet with the pictures of its steps, and the tests of the finished finger."""

from __future__ import annotations

import base64

from fingertip.cad.report import SHEET, STEPS_FOLDER
from fingertip.design import Design
from fingertip.design.files import list_parameters
from fingertip.page.html import Markup, code, element, figure, join, table
from fingertip.page.markdown import list_steps, render, split_sections
from fingertip.page.sources import COMMANDS, Sources

_ACCEPTANCE = "acceptance.md"
_PROCEDURE = "Procedure"
_OPEN = ("What to buy", "Quantities", "Warnings")
"""Sections that nobody should miss; others are folded up."""


def render_casting(sources: Sources) -> Markup:
    """Render the casting sheet, its procedure as steps with pictures."""
    sections = split_sections(sources.files[SHEET].decode())
    pictures = embed_pictures(sources)
    parts = [render(sections.pop("").partition("\n")[2])]
    for heading, text in sections.items():
        if heading == _PROCEDURE:
            parts.append(element("h3", "Step by step"))
            if STEPS_FOLDER in sources.remarks:
                parts.append(element("p", sources.remarks[STEPS_FOLDER], class_="note"))
            parts.append(list_steps(text, pictures))
        elif heading in _OPEN:
            parts += [element("h3", heading), render(text)]
        else:
            parts.append(element("details", element("summary", heading), render(text)))
    if page := sources.text(_ACCEPTANCE):
        title = "Tests of sensor and finished finger, with what each failure means"
        parts.append(element("details", element("summary", title), render(page.partition("\n")[2])))
    return join(parts)


def embed_pictures(sources: Sources) -> dict[str, str]:
    """Turn the pictures of the steps into addresses that hold their data, by their path in the sheet."""
    return {
        name: f"data:image/png;base64,{base64.b64encode(data).decode('ascii')}"
        for name, data in sources.files.items()
        if name.startswith(f"{STEPS_FOLDER}/") and name.endswith(".png")
    }


def render_drawing(sources: Sources) -> Markup:
    """Render the dimensioned sheets, or say how to make them."""
    sheets = {
        name: data for name, data in sources.files.items() if name.startswith("drawing_") and name.endswith(".svg")
    }
    if not sheets:
        return element(
            "p", "There is no drawing of these parts yet: in the folder of this page, ",
            element("code", COMMANDS["drawing"]),
            " makes a sheet with all dimensions and tolerances for each printed part, and ",
            element("code", COMMANDS["page"]), " then shows them here.", class_="note",
        )  # fmt: skip
    return join(_render_sheet(name, data) for name, data in sheets.items())


def _render_sheet(name: str, data: bytes) -> Markup:
    part = name.removeprefix("drawing_").removesuffix(".svg").replace("_", " ")
    source = f"data:image/svg+xml;base64,{base64.b64encode(data).decode('ascii')}"
    picture = element("img", src=source, alt=f"Dimensioned drawing of the {part}", decoding="async")
    return figure(picture, f"{part}, from {name}", f"drawing of the {part}", "wide paper")


# Basis of a page's figures: what was computed, what was simulated, and what was measured.


_MARK = "(unverified)"


def render_basis(design: Design) -> Markup:
    """Render where each kind of figure comes from, and which parameters nobody verified."""
    curve, printer = design.force_curve, design.printer
    is_weighed = curve.curve == "calibrated"
    is_calibrated = printer.offset_mm != 0.0 or printer.scale_percent != 100.0
    said = design.force_curve.describe()
    rows = [
        ("Parts and checks", "computed", "Measured on the files themselves, read back. Nobody has printed and cast "
         "these files yet."),
        ("Printer", "set in the design" if is_calibrated else "assumed",
         f"Scale {printer.scale_percent:g} %, surfaces {printer.offset_mm:g} mm out. "
         + ("" if is_calibrated else "Print the fit coupon (fingertip coupon) to measure yours.")),
        ("Filling and casting", "simulated", "A Newtonian silicone in a thin gap. Mix ratio, pot life and viscosity "
         "are ranges of the kind; the container of yours is right."),
        ("Strength of the bone", "computed", "Beam sections with stress concentrations, and the strength of the print "
         "material that the report names."),
        ("Board", "computed", "From the circuit, with typical figures of the amplifiers. Nobody has built this board "
         "yet."),
        ("Sensor", "measured" if is_weighed else "data sheet",
         f"{said[0].upper()}{said[1:]}."),
        ("Trial and detection", "simulated", "Friction, vibration, sensor, board and converter are models; a real "
         "finger will differ. Record a trial of your own, and read it with fingertip detect."),
    ]  # fmt: skip
    unverified = [parameter for parameter in list_parameters() if _MARK in parameter.description]
    names: list[str] = []
    for parameter in unverified:
        names += [", "] if names else []
        names.append(element("a", code(parameter.path), href=f"#p-{parameter.path}", class_="code"))
    doubtful = element("p", "Parameters for which no document was found: ", *names, ".") if names else ""
    return join((table(("figures", "are", "which means"), rows, "where the figures come from"), doubtful))
