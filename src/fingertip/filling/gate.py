"""Gate of a design's mold, the ducts from syringe or funnel to it, and the grid of the cavity behind it."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from fingertip.catalogues.hardware import LUER_DEPTH_MM, LUER_MOUTH_MM, LUER_TAPER, NOZZLE_DEPTH_MM, NOZZLE_LENGTH_MM
from fingertip.catalogues.silicones import Silicone
from fingertip.design import Design
from fingertip.filling.ducts_and_mouths import Duct, conical_duct, rectangular_duct, round_duct
from fingertip.filling.predict import Course, Opening, follow_front, head_pressure_pa, syringe_pressure_pa
from fingertip.filling.surface_links import SkinGrid, build_skin_grid
from fingertip.foundation.numerics import Array


@lru_cache(maxsize=32)
def follow_design_front(design: Design) -> Course:
    return follow_front(build_grid(design), gate_opening(design))


def gate_opening(design: Design) -> Opening:
    layout, dims = design.mold_layout, design.dimensions
    inlet = layout.inlet
    if inlet is None:
        z = design.skin.length_mm * dims.shrinkage
        return Opening((layout.gate_x, 0.0, z), design.mold.gate_diameter_mm)
    side = dims.outer.half_width_at(inlet.depth / 2, inlet.gate_z)
    return Opening((side, inlet.depth / 2, inlet.gate_z), 2 * math.sqrt(inlet.width * inlet.depth / math.pi))


def list_ducts(design: Design) -> tuple[Duct, ...]:
    layout, mold = design.mold_layout, design.mold
    inlet = layout.inlet
    if inlet is None:
        above = layout.distal_z - mold.funnel_depth_mm - design.skin.length_mm * design.dimensions.shrinkage
        mouth, throat = mold.funnel_diameter_mm, mold.gate_diameter_mm
        funnel = conical_duct(mouth, throat, mold.funnel_depth_mm) if mouth > throat else None
        gate = round_duct(throat, max(above, throat))
        return (funnel, gate) if funnel else (gate,)
    # The nozzle, what it leaves of its cone, the sprue, and both legs of the runner.
    at_nozzle = LUER_MOUTH_MM - LUER_TAPER * NOZZLE_DEPTH_MM
    at_end = LUER_MOUTH_MM - LUER_TAPER * LUER_DEPTH_MM
    side = gate_opening(design).point_mm[0]
    return (
        round_duct(mold.nozzle_bore_mm, NOZZLE_LENGTH_MM),
        conical_duct(at_nozzle, at_end, LUER_DEPTH_MM - NOZZLE_DEPTH_MM),
        round_duct(at_end, layout.dorsal_height - LUER_DEPTH_MM),
        rectangular_duct(inlet.width, inlet.depth, inlet.z - inlet.gate_z + inlet.x - side),
    )


def pressure_pa(design: Design, silicone: Silicone) -> float:
    """Compute the pressure under the thumb, or the head of a full funnel above the gate."""
    inlet = design.mold_layout.inlet
    if inlet:
        return syringe_pressure_pa(design.mold.thumb_force_n, inlet.syringe.bore_mm)
    height = design.mold_layout.distal_z - design.skin.length_mm * design.dimensions.shrinkage
    return head_pressure_pa(silicone.density_g_cm3.low, height)


def build_grid(design: Design) -> SkinGrid:
    chaplet = design.dimensions.chaplet
    if chaplet is None:
        return build_skin_grid(design)
    scale = design.dimensions.shrinkage if design.mold.method == "sleeve" else 1.0

    def is_closed(points: Array) -> NDArray[np.bool_]:
        distance = np.hypot(points[..., 0], points[..., 2] - scale * chaplet.z)
        return np.asarray((points[..., 1] > 0.0) & (distance < scale * chaplet.radius))

    return build_skin_grid(design, is_closed=is_closed)
