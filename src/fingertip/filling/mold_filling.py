"""Filling of a design's mold, predicted for its silicone, with its gate, its ducts and its vents."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

from fingertip.design import Design
from fingertip.filling.gate import follow_design_front, list_ducts, pressure_pa
from fingertip.filling.predict import AirPocket, FillingPrediction, predict_filling
from fingertip.filling.vents import is_at_collar, list_openings, vent_cavity

MAX_AIR_MM3 = 1.0


@lru_cache(maxsize=32)
def predict_mold_filling(design: Design) -> FillingPrediction:
    """Predict the filling of a design's mold, with its vents; air at the collar's edge counts as vented."""
    silicone, (vents, gaps) = design.silicone.material, vent_cavity(design)
    prediction = predict_filling(
        follow_design_front(design), [*list_openings(vents), *gaps], list_ducts(design),
        viscosity_pa_s=silicone.viscosity_pa_s.high, pressure_pa=pressure_pa(design, silicone),
    )  # fmt: skip
    trapped = tuple(pocket for pocket in prediction.air_pockets if not is_at_collar(pocket.point_mm))
    return replace(prediction, air_pockets=trapped)


def largest_pocket(prediction: FillingPrediction) -> AirPocket | None:
    return max(prediction.air_pockets, key=lambda pocket: pocket.volume_mm3, default=None)


def injected_cm3(prediction: FillingPrediction) -> float:
    """Volume of silicone that the syringe must hold [cm3]: of the cavity, and of all ducts to it."""
    return (prediction.volume_mm3 + prediction.ducts_mm3) / 1000.0
