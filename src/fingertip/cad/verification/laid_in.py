"""Checks of a sensor that is laid into an open trough: room for what is sold, open vent, and a hold for its wires."""

from __future__ import annotations

from collections.abc import Iterator

from fingertip.cad.kernel.mesh import Manifold, MeshEvaluator
from fingertip.cad.shapes import bone
from fingertip.cad.shapes.parts import PARTS
from fingertip.cad.verification.check import PLANE_OFFSET_MM, Check, complement
from fingertip.design import Design
from fingertip.design.geometry.dimensions import (
    HEAD_MM,
    LONGER_MM,
    SHORTER_MM,
    TAIL_MM,
    TIE_DEPTH_MM,
    TIE_ROOM_MM,
    TIE_WIDTH_MM,
)
from fingertip.design.geometry.solids import Box, union

_LEAST_OPEN_PERCENT = 50.0
_GAP_MM = 0.1
"""Length of the space behind the tail's end that counts as the mouth of its vent [mm]."""
_TIE_SAMPLES = 5


def check_laid_in(design: Design, evaluator: MeshEvaluator) -> Iterator[Check]:
    """Check the trough of a sensor that is laid in; nothing for others."""
    if not design.dimensions.is_laid_in:
        return
    solid = evaluator.manifold(PARTS["bone"].solid(design))
    bodies = [evaluator.manifold(bone.sensor_body(other)) for other in _list_other_sensors(design)]
    yield Check.zero_volume("sensor.room_overlap", max(float((body ^ solid).volume()) for body in bodies))
    yield Check("sensor.vent_open", _find_open_share(design, evaluator), _LEAST_OPEN_PERCENT, "%", "at least")
    yield Check("sensor.wires_held", _measure_shoulders(design, evaluator, solid), TIE_DEPTH_MM / 2, "mm", "at least")


def _list_other_sensors(design: Design) -> Iterator[Design]:
    """Yield copies of the design with the sensors of other sizes that its trough has to take, tabs included."""
    body, tabs = design.dimensions.sensor, design.sensor.tab_length_mm
    sensor = design.sensor.model_copy(update={"model": "custom"})
    for longer in (-SHORTER_MM, LONGER_MM):
        for wider in (-1.0, 1.0):
            sizes = {
                "active_diameter_mm": body.active_diameter_mm, "thickness_mm": body.thickness_mm,
                "head_diameter_mm": body.head_diameter_mm + wider * HEAD_MM,
                "tail_width_mm": body.tail_width_mm + wider * TAIL_MM, "length_mm": body.length_mm + longer + tabs,
            }  # fmt: skip
            own = design.custom_sensor.model_copy(update=sizes)
            yield design.model_copy(update={"sensor": sensor, "custom_sensor": own})


def _find_open_share(design: Design, evaluator: MeshEvaluator) -> float:
    """Find how much of the mouth of the vent, at the end of the tail, is open to the outside [%].

    The skin lies over the trough, and a bead of adhesive around the collar fills it down to the tail.
    """
    dims, half = design.dimensions, design.dimensions.sensor.tail_width_mm / 2
    far, flat = 2 * design.skin.width_mm, -dims.flat_depth
    bead = Box((-far, -far, -design.bone.collar_length_mm), (far, flat, 0.0))
    parts = [PARTS[name].solid(design) for name in ("bone", "skin")]
    air = complement(evaluator, union(*parts, bone.sensor_body(design), bead))
    # Surfaces come apart here: the largest surrounds all, those of parts enclose negative volumes, the rest is cut off.
    _, *cut_off = sorted((body for body in air.decompose() if body.volume() > 0.0), key=lambda body: -body.volume())
    end = dims.tail_end_z - PLANE_OFFSET_MM
    mouth = evaluator.manifold(Box((-half, flat, end - _GAP_MM), (half, flat + dims.pocket_depth, end)))
    free = (mouth ^ air).volume() - sum((mouth ^ body).volume() for body in cut_off)
    return 100.0 * float(free / mouth.volume())


def _measure_shoulders(design: Design, evaluator: MeshEvaluator, solid: Manifold) -> float:
    """Measure the shoulders that keep a cable tie on the base, behind the hole of the wires [mm]; 0 without a place."""
    dims = design.dimensions
    assert dims.tie_span
    low, high = dims.tie_span
    behind = dims.bone_outline.section.dorsal - dims.channel_depth
    mouth = evaluator.manifold(bone.cable_channel(design)).trim_by_plane((0.0, 1.0, 0.0), behind)
    if mouth.bounding_box()[2] < high:
        return 0.0

    def width(z: float) -> float:
        low_x, _, high_x, _ = solid.slice(z).bounds()
        return float(high_x - low_x)

    begin = low + TIE_ROOM_MM / 2
    within = max(width(begin + TIE_WIDTH_MM * i / (_TIE_SAMPLES - 1)) for i in range(_TIE_SAMPLES))
    return (min(width(z) for z in (low - PLANE_OFFSET_MM, high + PLANE_OFFSET_MM)) - within) / 2
