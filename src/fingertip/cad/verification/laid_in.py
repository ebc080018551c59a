"""Checks of a sensor in an open trough: room for what is sold, an open vent; and of the stand."""

from __future__ import annotations

from collections.abc import Iterator

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes import bone
from fingertip.cad.shapes.parts import PARTS
from fingertip.cad.verification.check import PLANE_OFFSET_MM, Check, complement
from fingertip.design import Design
from fingertip.design.geometry.dimensions import HEAD_MM, LONGER_MM, TAIL_MM
from fingertip.design.geometry.solids import Box, union

_LEAST_OPEN_PERCENT = 50.0
_GAP_MM = 0.1
"""Length of the space behind the tail's end that counts as the mouth of its vent [mm]."""


def check_laid_in(design: Design, evaluator: MeshEvaluator) -> Iterator[Check]:
    """Check the trough in which the sensor is laid."""
    solid, largest = evaluator.manifold(PARTS["bone"].solid(design)), _with_largest_sensor(design)
    overlap = (evaluator.manifold(bone.sensor_body(largest)) ^ solid).volume()
    yield Check.zero_volume("sensor.room_overlap", float(overlap))
    yield Check("sensor.vent_open", _find_open_share(design, evaluator), _LEAST_OPEN_PERCENT, "%", "at least")


def _with_largest_sensor(design: Design) -> Design:
    """Give the design the largest sensor that its trough has to take, with its tabs as more of its tail."""
    body = design.dimensions.sensor
    sizes = {
        "active_diameter_mm": body.active_diameter_mm, "thickness_mm": body.thickness_mm,
        "head_diameter_mm": body.head_diameter_mm + HEAD_MM, "tail_width_mm": body.tail_width_mm + TAIL_MM,
        "length_mm": body.length_mm + LONGER_MM + design.sensor.tab_length_mm,
    }  # fmt: skip
    own, sensor = design.custom_sensor.model_copy(update=sizes), design.sensor.model_copy(update={"model": "custom"})
    return design.model_copy(update={"sensor": sensor, "custom_sensor": own})


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
