"""Checks of the filling: time, force on the syringe, trapped air, and loads on bone and mold."""

from __future__ import annotations

import math
from collections.abc import Iterator

from fingertip.cad.verification.check import Check
from fingertip.design import Design
from fingertip.design.silicone import select_silicone
from fingertip.design.threads import select_thread
from fingertip.filling.mold_filling import MAX_AIR_MM3, injected_cm3, largest_pocket, predict_mold_filling
from fingertip.filling.predict import FillingPrediction
from fingertip.print_materials import PRINT_MATERIALS
from fingertip.silicones import Silicone

PUSH_S = 60.0
"""Time for which a thumb can push [s]. An assumption."""
_PRELOAD_N_PER_MM = 100.0
"""Preload of a bolt tightened by hand in a printed mold, per millimetre of its diameter [N/mm]. An assumption."""
_MIN_BEARING_FACTOR = 2.0
"""Least strength of the bone over the pressure of the chaplet's screw on its thread."""
_GRAVITY_M_S2 = 9.81


def check_filling(design: Design) -> Iterator[Check]:
    """Check the filling of a mold with the silicone of its design."""
    prediction, silicone = predict_mold_filling(design), select_silicone(design)
    allowed_s = silicone.filling_limit_s
    syringe = design.mold_layout.inlet.syringe if design.mold_layout.inlet else None
    yield Check("mold.fill_time", prediction.fill_s, allowed_s, "s")
    if syringe:
        force = prediction.force_for_time_n(PUSH_S, syringe.bore_mm)
        yield Check("mold.syringe_force", force, design.mold.thumb_force_n, "N")
        yield Check("mold.syringe_volume", injected_cm3(prediction), syringe.volume_ml, "cm3")
        pocket = largest_pocket(prediction)
        yield Check("mold.air_trapped", pocket.volume_mm3 if pocket else 0.0, MAX_AIR_MM3, "mm3")
    else:
        yield Check("mold.air_rise_time", air_rise_s(design, silicone), allowed_s - prediction.fill_s, "s")
    if design.dimensions.chaplet:
        yield Check("mold.bone_load", _bearing_factor(design, prediction), _MIN_BEARING_FACTOR, "", "at least")
    bolts = len(design.mold_layout.bolts) * _PRELOAD_N_PER_MM * select_thread(design.mold.bolt_diameter_mm).diameter_mm
    yield Check("mold.opening_force", prediction.static_opening_force_n, bolts, "N")


def air_rise_s(design: Design, silicone: Silicone) -> float:
    """Time in which air rises from the collar to the tip through silicone that is poured on it [s].

    Air that is wider than the gap rises in it at rho g h^2 / (12 mu), as silicone flows down through the same gap
    (G. I. Taylor and P. G. Saffman, Q. J. Mech. Appl. Math. 12 (1959) 265).
    """
    skin = design.skin
    gap_m = 1e-3 * min(skin.thickness_side_mm, skin.thickness_dorsal_mm)
    density = 1e3 * silicone.density_g_cm3.low
    speed = density * _GRAVITY_M_S2 * gap_m**2 / (12.0 * silicone.viscosity_pa_s.high)
    return 1e-3 * skin.length_mm / speed


def _bearing_factor(design: Design, prediction: FillingPrediction) -> float:
    """Strength of the bone over the pressure on the chaplet's thread, which holds the bone in the filled mold.

    The largest load acts if the vents are closed and the thumb goes on pushing: then the inlet's pressure pushes the
    bone out of the cavity.
    """
    chaplet = design.dimensions.chaplet
    assert chaplet
    load = math.hypot(prediction.static_axial_force_n, prediction.side_force_n)
    pressure = load / (chaplet.thread.diameter_mm * chaplet.engaged)
    return PRINT_MATERIALS[design.strength.print_material].across_mpa / pressure
