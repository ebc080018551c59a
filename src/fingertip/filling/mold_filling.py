"""Filling of a design's mold: its gate, its ducts, where its vents stand, and the prediction for its silicone.

Vents stand where air would be trapped: at each point that fills last in a part of the cavity. The gap between collar
and recess lets air out, but hardly any silicone: silicone is a million times as viscous. Air at the collar's edge
therefore needs no vent of its own.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fingertip.catalogues.hardware import LUER_DEPTH_MM, LUER_MOUTH_MM, LUER_TAPER, NOZZLE_DEPTH_MM, NOZZLE_LENGTH_MM
from fingertip.design import Design
from fingertip.filling.ducts_and_mouths import Duct, conical_duct, rectangular_duct, round_duct
from fingertip.filling.predict import Course, FillingPrediction, Opening, Point3, syringe_pressure_pa
from fingertip.filling.surface_links import SkinGrid, build_skin_grid
from fingertip.foundation.numerics import Array

MAX_AIR_MM3 = 1.0
_AT_COLLAR_MM = 0.6
"""Height above the collar up to which its gap vents the cavity [mm]."""
_MAX_ROUNDS = 4
"""Largest number of rounds in which vents are added."""
_MOVES = 20
"""Moves of a vent that is pushed away from others and from the chaplet by turns."""
_APART_DIAMETERS = 0.8
_POSE_STEP_MM = 0.01
"""Step of the slopes at a vent [mm]."""
_BESIDE_HEAD_MM = 0.1
"""Wall between a vent and the head of the chaplet's screw, beyond the least one [mm]."""
_CLEAR_DIAMETERS = 2.0
"""Least height above the collar's vented edge of a vent that is there to be looked at, in diameters."""
_GROOVE_WIDTHS = 2.0
"""Width of a vent in the parting plane, where pockets are long, over the diameter of others; it is half as deep."""
_POINT_DECIMALS = 6
"""Decimals of a vent's point [mm]. The last digits of the solution depend on the processor, and files must not."""
_STEEP = 1.5
"""Distance of a last point from the dorsal surface straight above it, in thicknesses of the skin, from which on a hole
from above would miss it."""


@lru_cache(maxsize=32)
def follow_design_front(design: Design) -> Course:
    return Course.follow(build_grid(design), gate_opening(design))


def gate_opening(design: Design) -> Opening:
    inlet = design.mold_layout.inlet
    side = design.dimensions.outer.half_width_at(inlet.depth / 2, inlet.gate_z)
    return Opening((side, inlet.depth / 2, inlet.gate_z), 2 * math.sqrt(inlet.width * inlet.depth / math.pi))


def list_ducts(design: Design) -> tuple[Duct, ...]:
    layout, mold = design.mold_layout, design.mold
    inlet = layout.inlet
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


def build_grid(design: Design) -> SkinGrid:
    chaplet = design.dimensions.chaplet
    if chaplet is None:
        return build_skin_grid(design)

    def is_closed(points: Array) -> NDArray[np.bool_]:
        distance = np.hypot(points[..., 0], points[..., 2] - chaplet.z)
        return np.asarray((points[..., 1] > 0.0) & (distance < chaplet.radius))

    return build_skin_grid(design, is_closed=is_closed)


@dataclass(frozen=True)
class Vent:
    kind: Literal["dorsal", "side"]
    """dorsal: along y through the dorsal half; side: a groove in the parting plane."""
    point_mm: Point3
    """Point of the cavity that it vents."""
    diameter_mm: float


def list_openings(vents: Iterable[Vent]) -> list[Opening]:
    return [Opening(vent.point_mm, vent.diameter_mm) for vent in vents]


def place_vents(design: Design) -> tuple[Vent, ...]:
    """Place one vent where air would be trapped without it, the largest air first, and one in any case."""
    return vent_cavity(design)[0]


@lru_cache(maxsize=32)
def vent_cavity(design: Design) -> tuple[tuple[Vent, ...], tuple[Opening, ...]]:
    """Place the vents, and find where the gap at the collar lets out air that they do not."""
    diameter = design.mold.vent_diameter_mm
    course, vents, gaps = follow_design_front(design), tuple[Vent, ...](), tuple[Opening, ...]()
    for _ in range(_MAX_ROUNDS):
        # An opening can leave another pocket behind, which had been part of the one that it empties.
        points = (course.place_of(air.node) for air in course.find_last_points([*list_openings(vents), *gaps])[1])
        before = len(vents) + len(gaps)
        for found in points:
            if is_at_collar(found):
                gaps += (Opening(found, diameter),)
            elif vent := _make_vent(design, found, vents):
                vents += (vent,)
        if len(vents) + len(gaps) == before:
            break
    if not vents:  # the gap at the collar lets out all air, but nobody sees there that the mold is full
        arrival, height = course.filling.arrival_mm3, course.grid.layer.points_mm[:, 2]
        is_clear = np.isfinite(arrival) & (height > _AT_COLLAR_MM + _CLEAR_DIAMETERS * diameter)
        sign = _make_vent(design, course.place_of(int(np.argmax(np.where(is_clear, arrival, 0.0)))), ())
        vents = (sign,) if sign else ()
    return vents, gaps


def _make_vent(design: Design, place: Point3, vents: tuple[Vent, ...]) -> Vent | None:
    """Make a vent at a place, or beside it where others and the chaplet need room; None if it is near enough to one."""
    diameter = design.mold.vent_diameter_mm
    point = _clear_of_chaplet(design, place)
    if any(math.dist(point, vent.point_mm) <= _APART_DIAMETERS * diameter for vent in vents):
        return None
    # A hole from the dorsal side where it meets the point, and else a groove in the parting plane
    (x, y, z), dims = point, design.dimensions
    above = dims.shrinkage * dims.outer.dorsal_height_at(x / dims.shrinkage, z / dims.shrinkage) - y
    is_dorsal = y > 0.0 and above <= _STEEP * design.skin.thickness_dorsal_mm
    if is_dorsal:
        # A wall must stay between two holes from above.
        spacing = diameter + design.printer.min_wall_mm + _BESIDE_HEAD_MM
        others = [vent.point_mm[::2] for vent in vents if vent.kind == "dorsal"]
        for _ in range(_MOVES):
            for x, z in others:
                point = _push_away(point, x, z, spacing)
            point = _clear_of_chaplet(design, point)
        if min((math.dist(point[::2], other) for other in others), default=math.inf) < spacing - _BESIDE_HEAD_MM / 2:
            return None
    x, y, z = (round(value, _POINT_DECIMALS) for value in point)
    return Vent("dorsal", (x, y, z), diameter) if is_dorsal else Vent("side", (x, y, z), _GROOVE_WIDTHS * diameter)


def _clear_of_chaplet(design: Design, point: Point3) -> Point3:
    """Move a point as far from the chaplet as a vent needs: it may cut the side of the boss, but not its screw."""
    chaplet = design.dimensions.chaplet
    if chaplet is None or point[1] < 0.0:
        return point
    needed = chaplet.head_radius + design.mold.vent_diameter_mm / 2 + design.printer.min_wall_mm + _BESIDE_HEAD_MM
    return _push_away(point, 0.0, chaplet.z, needed)


def _push_away(point: Point3, from_x: float, from_z: float, needed_mm: float) -> Point3:
    """Move a point away from an axis along y, to the distance that it needs at least; on the axis it stays."""
    x, y, z = point
    distance = math.hypot(x - from_x, z - from_z)
    if distance == 0.0 or distance >= needed_mm:
        return point
    away = needed_mm / distance
    return from_x + (x - from_x) * away, y, from_z + (z - from_z) * away


def is_at_collar(point: Point3) -> bool:
    """Tell whether a point is so near the collar that the gap there lets its air out."""
    return point[2] <= _AT_COLLAR_MM


def find_pose(design: Design) -> Point3:
    """Find the direction that points up when the first vent is the highest point of the cavity; a unit vector.

    The cavity is convex, so that a point of its surface is the highest one if the surface is level there.
    """
    vent = place_vents(design)[0]
    (x, y, z), outer = vent.point_mm, design.dimensions.outer
    if vent.kind != "dorsal" or y <= 0.0:
        return (0.0, 0.0, 1.0)
    step = _POSE_STEP_MM
    along_x = (outer.dorsal_height_at(x + step, z) - outer.dorsal_height_at(x - step, z)) / (2 * step)
    along_z = (outer.dorsal_height_at(x, z + step) - outer.dorsal_height_at(x, z - step)) / (2 * step)
    length = math.sqrt(1.0 + along_x**2 + along_z**2)
    return (-along_x / length, 1.0 / length, -along_z / length)


@lru_cache(maxsize=32)
def predict_mold_filling(design: Design) -> FillingPrediction:
    """Predict the filling of a design's mold, with its vents; air at the collar's edge counts as vented."""
    viscosity, (vents, gaps) = design.silicone.material.viscosity_pa_s.high, vent_cavity(design)
    pressure = syringe_pressure_pa(design.mold.thumb_force_n, design.mold_layout.inlet.syringe.bore_mm)
    prediction = follow_design_front(design).predict(
        [*list_openings(vents), *gaps], list_ducts(design), viscosity_pa_s=viscosity, pressure_pa=pressure
    )
    trapped = tuple(pocket for pocket in prediction.air_pockets if not is_at_collar(pocket.point_mm))
    return replace(prediction, air_pockets=trapped)


def trapped_mm3(prediction: FillingPrediction) -> float:
    """Volume of the largest air pocket [mm3]."""
    return max((pocket.volume_mm3 for pocket in prediction.air_pockets), default=0.0)


def injected_cm3(prediction: FillingPrediction) -> float:
    """Volume of silicone that the syringe must hold [cm3]: of the cavity, and of all ducts to it."""
    return (prediction.volume_mm3 + prediction.ducts_mm3) / 1000.0
