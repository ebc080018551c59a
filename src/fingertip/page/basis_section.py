"""Basis of a page's figures: what was computed, what was simulated, and what was measured."""

from __future__ import annotations

from fingertip.design import Design
from fingertip.design.export import list_parameters
from fingertip.design.force_curve import describe_force_curve
from fingertip.page.html import Markup, code, element, join, table

_MARK = "(unverified)"


def render_basis(design: Design) -> Markup:
    """Render where each kind of figure comes from, and which parameters nobody verified."""
    curve, printer = design.force_curve, design.printer
    is_weighed = curve.curve == "calibrated"
    is_calibrated = printer.offset_mm != 0.0 or printer.scale_percent != 100.0
    said = describe_force_curve(design)
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
