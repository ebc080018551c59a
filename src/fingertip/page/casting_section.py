"""Casting guide of a page with the pictures of its steps, dimensioned sheets, and where all figures come from."""

from __future__ import annotations

from fingertip.catalogues.output_files import ACCEPTANCE, SHEET, STEPS_FOLDER
from fingertip.design import Design
from fingertip.design.files import list_parameters
from fingertip.page.html import Markup, element, embed, figure, join, note, table
from fingertip.page.markdown import list_steps, render, split_sections
from fingertip.page.parameters_and_checks import link_parameters
from fingertip.page.sources import COMMANDS, Sources

_OPEN = ("What to buy", "Quantities", "Warnings")
"""Sections that nobody should miss; others are folded up."""


def render_casting(sources: Sources) -> Markup:
    """Render the casting sheet, its procedure as steps with pictures."""
    sections = split_sections(sources.files[SHEET].decode())
    pictures = {
        name: embed(data, "image/png")
        for name, data in sources.files.items()
        if name.startswith(f"{STEPS_FOLDER}/") and name.endswith(".png")
    }
    parts = [render(sections.pop("").partition("\n")[2])]
    for heading, text in sections.items():
        if heading == "Procedure":
            parts.append(element("h3", "Step by step"))
            if STEPS_FOLDER in sources.remarks:
                parts.append(note(sources.remarks[STEPS_FOLDER]))
            parts.append(list_steps(text, pictures))
        elif heading in _OPEN:
            parts += [element("h3", heading), render(text)]
        else:
            parts.append(element("details", element("summary", heading), render(text)))
    if page := sources.text(ACCEPTANCE):
        title = "Tests of sensor and finished finger, with what each failure means"
        parts.append(element("details", element("summary", title), render(page.partition("\n")[2])))
    return join(parts)


def render_drawing(sources: Sources) -> Markup:
    """Render the dimensioned sheets, or say how to make them."""
    sheets = []
    for name, data in sources.files.items():
        if name.startswith("drawing_") and name.endswith(".svg"):
            part = name.removeprefix("drawing_").removesuffix(".svg").replace("_", " ")
            title = f"drawing of the {part}"
            picture = element("img", src=embed(data, "image/svg+xml"), alt=f"Dimensioned {title}", decoding="async")
            sheets.append(figure(picture, f"{part}, from {name}", title, "wide paper"))
    if sheets:
        return join(sheets)
    return note(
        "There is no drawing of these parts yet: in the folder of this page, ", element("code", COMMANDS["drawing"]),
        " makes a sheet with all dimensions and tolerances for each printed part, and ",
        element("code", COMMANDS["page"]), " then shows them here.",
    )  # fmt: skip


def render_basis(design: Design) -> Markup:
    """Render where each kind of figure comes from, and which parameters nobody verified."""
    curve, printer = design.force_curve, design.printer
    is_weighed = curve.curve == "calibrated"
    is_calibrated = printer.offset_mm != 0.0 or printer.scale_percent != 100.0
    sensor = design.force_curve.describe()
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
         f"{sensor[0].upper()}{sensor[1:]}."),
        ("Trial and detection", "simulated", "Friction, vibration, sensor, board and converter are models; a real "
         "finger will differ. Record a trial of your own, and read it with fingertip detect."),
    ]  # fmt: skip
    unverified = [parameter.path for parameter in list_parameters() if "(unverified)" in parameter.description]
    said = ("Parameters for which no document was found: ", link_parameters(unverified), ".")
    doubtful = element("p", *said) if unverified else ""
    return join((table(("figures", "are", "which means"), rows, "where the figures come from"), doubtful))
