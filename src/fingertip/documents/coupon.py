"""Page on the fit coupon: how to print and measure it, which fits to try by hand, and what each failure means."""

from __future__ import annotations

from fingertip.cad.printing.orientations import print_orientations
from fingertip.cad.printing.settings import LAYER_MM, RESIN_LAYER_MM
from fingertip.cad.shapes.coupon import list_heights
from fingertip.cad.shapes.coupon_layout import LETTERS, WALLS_MM, has_key, lay_out, text_unit_mm
from fingertip.cad.shapes.engraving import STROKE_WIDTH
from fingertip.calibration.readings import MIN_LENGTHS, MIN_READINGS, list_lengths
from fingertip.catalogues.hardware import select_thread
from fingertip.catalogues.output_files import PLAN
from fingertip.design import Design
from fingertip.documents.template import render_page

COUPON_LAYER_MM = 0.2
"""Height of the layers for which the coupon is made [mm]."""
COUPON_MINUTES = 20
"""Time within which both pieces print in such layers, as PrusaSlicer estimates it for each bundled design [min]."""


def render_instructions(design: Design, readings_file: str) -> str:
    layout, lengths = lay_out(design), list_lengths(design)
    width_mm, depth_mm = layout.size
    return render_page(
        "coupon.md",
        design=design.name,
        width_mm=width_mm,
        depth_mm=depth_mm,
        has_key=has_key(design),
        has_luer=bool(layout.luer),
        has_text=bool(layout.text),
        layer_mm=LAYER_MM,
        resin_layer_mm=RESIN_LAYER_MM,
        coupon_layer_mm=COUPON_LAYER_MM,
        minutes=COUPON_MINUTES,
        scale_percent=design.printer.scale_percent,
        inserts=[part for part in print_orientations(design) if not part.startswith("mold_")],
        readings_file=readings_file,
        min_readings=MIN_READINGS,
        min_lengths=MIN_LENGTHS,
        walls_mm=WALLS_MM,
        plan=PLAN,
        lengths=lengths,
        count={kind: sum(length.kind == kind for length in lengths) for kind in ("outer", "inner", "wall")},
        heights=list_heights(design),
        crimp_mm=design.sensor.crimp_height_mm if design.dimensions.tail_passes_collar else None,
        is_folded=design.dimensions.fold is not None,
        sensor_gap_mm=design.sensor.clearance_mm - design.printer.offset_mm / 2,
        thread=select_thread(design.mold.bolt_diameter_mm).label,
        letters=LETTERS,
        stroke_mm=STROKE_WIDTH * text_unit_mm(design),
    )
