"""Page on the fit coupon: how to print and measure it, which fits to try by hand, and what each failure means."""

from __future__ import annotations

from fingertip.cad.printing import settings
from fingertip.cad.printing.orientations import print_orientations
from fingertip.cad.shapes import coupon_layout
from fingertip.cad.shapes.coupon import list_heights
from fingertip.cad.shapes.engraving import STROKE_WIDTH
from fingertip.calibration import readings
from fingertip.catalogues.hardware import select_thread
from fingertip.catalogues.output_files import PLAN
from fingertip.design import Design
from fingertip.documents.template import render_page

COUPON_LAYER_MM = 0.2
"""Height of the layers for which the coupon is made [mm]."""
COUPON_MINUTES = 20
"""Time within which both pieces print in such layers, as PrusaSlicer estimates it for each bundled design [min]."""


def render_instructions(design: Design, readings_file: str) -> str:
    lengths = readings.list_lengths(design)
    return render_page(
        "coupon.md",
        design=design,
        layouts=coupon_layout,
        layout=coupon_layout.lay_out(design),
        settings=settings,
        coupon_layer_mm=COUPON_LAYER_MM,
        minutes=COUPON_MINUTES,
        inserts=[part for part in print_orientations(design) if not part.startswith("mold_")],
        readings=readings,
        readings_file=readings_file,
        plan=PLAN,
        lengths=lengths,
        count={kind: sum(length.kind == kind for length in lengths) for kind in ("outer", "inner", "wall")},
        heights=[*list_heights(design)],
        thread=select_thread(design.mold.bolt_diameter_mm).label,
        stroke_mm=STROKE_WIDTH * coupon_layout.text_unit_mm(design),
    )
