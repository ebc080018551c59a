"""Page on the fit coupon: how to print and measure it, which fits to try by hand, and what each failure means."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fingertip.cad.printing.orientations import print_orientations
from fingertip.cad.printing.print_files import LAYER_MM, RESIN_LAYER_MM
from fingertip.cad.shapes.coupon import list_heights
from fingertip.cad.shapes.coupon_layout import LETTERS, WALLS_MM, has_key, lay_out, text_unit_mm
from fingertip.cad.shapes.engraving import STROKE_WIDTH
from fingertip.calibration.readings import MIN_LENGTHS, MIN_READINGS, list_lengths
from fingertip.catalogues.output_files import PLAN
from fingertip.catalogues.threads import select_thread
from fingertip.design import Design

COUPON_LAYER_MM = 0.2
"""Height of the layers for which the coupon is made [mm]."""
COUPON_MINUTES = 20
"""Time within which both pieces print in such layers, as PrusaSlicer estimates it for each bundled design [min]."""


def render_instructions(design: Design, readings_file: str) -> str:
    """Render the page as Markdown."""
    outer, inner, walls = (
        sum(length.kind == kind for length in list_lengths(design)) for kind in ("outer", "inner", "wall")
    )
    (width, depth), scale = lay_out(design).size, design.printer.scale_percent
    sections = [
        f"# Fit coupon of {design.name}",
        f"Two pieces: a frame, {width:.1f} x {depth:.1f} mm, and a loose slice of the bone's base"
        f"{' with a key on it' if has_key(design) else ''}. Their fits are cut like those of the real parts.",
        "## Print",
        "Print `coupon` and `coupon_slice` as they lie, without supports and without a brim, on the printer, from the "
        "material and with the settings of the real parts, their layers too: `coupon` like the mold, `coupon_slice` "
        f"like the bone. At {LAYER_MM:g} mm, or {RESIN_LAYER_MM:g} mm for resin, they take longer than the "
        f"{COUPON_MINUTES} minutes estimated for layers of {COUPON_LAYER_MM:g} mm. The files hold the design at "
        f"{scale:g} % (printer.scale_percent): let the slicer scale nothing. Wash and cure resin as the real parts, "
        "and let the pieces cool before you measure. Keep the pieces: the silicone's cure is tested on them.",
        "The table [printer] describes one machine. If bone and mold come from two, print both pieces on each, "
        "calibrate a copy of the design for each, and build each part from its own: "
        f"`fingertip build bone.toml --parts {','.join(_list_inserts(design))}` and "
        "`fingertip build mold.toml --parts mold_palmar,mold_dorsal`. Try the slice of the one in the frame of the "
        "other.",
        "## Measure",
        f"Take calipers that read 0.01 mm, and set them to zero. Measure the {outer} outer and {inner} inner lengths "
        f"of `{readings_file}`, each {MIN_READINGS} to 5 times, and turn the piece between readings. Put the jaws on "
        "the upper half of an edge, above the first layers, which are often squeezed out. Measure the "
        f"{walls} thin walls too, from {min(WALLS_MM):g} to {max(WALLS_MM):g} mm, and leave those empty that did not "
        f"print whole. At least {MIN_LENGTHS} outer and {MIN_LENGTHS} inner lengths are needed. Then run:",
        "```console\n$ fingertip calibrate printer DESIGN.toml my_readings.toml --out calibrated.toml\n```",
        f"![Plan view of both pieces, with the numbers of the lengths and the heights]({PLAN})",
        "The numbers are those of the lengths. All lengths lie in the plane of the bed, along x or y, as the file is "
        "printed; none is in Z.",
        _table(
            ("place", "length", "along", "nominal [mm]", "where"),
            [
                (str(i), f"`{each.name}`", each.axis, f"{each.nominal_mm:.2f}", each.where)
                for i, each in enumerate(list_lengths(design), 1)
            ],
        ),
        "Heights, along Z, are marked Z1, Z2 and so on in the picture. Layers round "
        "them, and the calibration does not use them. One that is off by more than a layer says that the "
        "printer's Z axis or its first layer is set wrong.",
        _table(
            ("place", "height along Z", "nominal [mm]"),
            [
                (f"Z{i}", each.feature, f"{each.height_mm * scale / 100.0:.2f}")
                for i, each in enumerate(list_heights(design), 1)
            ],
        ),
        "## Try by hand",
        "\n".join(f"- {line}" for line in _list_fits(design)),
        "Print the coupon once more from the calibrated design before you print the real parts, and try the same fits.",
    ]
    return "\n\n".join(sections) + "\n"


def _list_inserts(design: Design) -> list[str]:
    """List the printed parts that are no half of the mold."""
    return [name for name in print_orientations(design) if not name.startswith("mold_")]


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    return "\n".join("| " + " | ".join(row) + " |" for row in (head, ["---"] * len(head), *rows))


def _list_fits(design: Design) -> Iterator[str]:
    """Yield the fits to try, and what it means if one fails."""
    layout, sensor, mold = lay_out(design), design.sensor, design.mold
    thread = select_thread(mold.bolt_diameter_mm)
    if has_key(design):
        yield (
            "Loose piece in its recess, key up: it drops in and does not rattle. If it jams, the gap is too small "
            "(mold.fit_clearance_mm); if it rattles, the bone will lie off in the mold."
        )
        yield (
            "Key in the round socket: the piece lies flat on the block. If it stands off, the socket is too narrow "
            "(mold.key_clearance_mm) or its floor is not clean."
        )
    else:
        yield "Loose piece in its recess: it drops in and does not rattle (mold.fit_clearance_mm)."
    gap = sensor.clearance_mm - design.printer.offset_mm / 2
    yield (
        f"Sensor in its pocket: head and tail lie flat, with a gap of about {gap:.2f} mm all round. If the film "
        "bulges, the pocket is too narrow (sensor.clearance_mm). Push it out through the hole."
    )
    yield (
        f"{thread.label} nut in the hexagonal trap: it goes in under the thumb and does not turn. If it needs a hammer "
        "or turns, change mold.nut_width_mm."
    )
    yield f"{thread.label} bolt in the hole below: it passes without cutting a thread (mold.bolt_diameter_mm)."
    if layout.luer:
        yield (
            "Nozzle of the syringe in the tallest block: it sits after a quarter turn, without wobbling. If it "
            "wobbles or touches the table, the cone is out of size: calibrate the scale, and ream it."
        )
    if layout.text:
        yield (
            f"Letters {LETTERS}: their strokes, {STROKE_WIDTH * text_unit_mm(design):.2f} mm wide, are open. If they "
            "have closed, choose taller letters (mold.engraving_height_mm) or none (mold.engraving_depth_mm=0)."
        )
    yield (
        "Thin walls: the thinnest that stands, without gaps, is the least that the printer makes (printer.min_wall_mm)."
    )
