"""Seals of an overmolding: what keeps silicone out of the bone's hollows while the skin is cast around it.

A tape under the skin covers pocket and slot of the sensor, and its relief. Adhesive fills the passage of the tail
through the collar, and the gap around the lid of a folded tail. The screw of the chaplet closes its own hole. A second
tape is wound around the base, where the mold holds it, and covers the window of a folded tail.
"""

from __future__ import annotations

from fingertip.cad.kernel.solids import Box, Solid, difference, intersection
from fingertip.cad.shapes.bone import lid, sensor_body, tail_space, trough
from fingertip.cad.shapes.insert import filled_bone, pilot_hole
from fingertip.design import Design

TAPE_MM = 0.1
"""Thickness of the tape [mm]. An assumption."""
TAPE_RIM_MM = 0.5
"""Width by which the tape reaches past what it covers [mm]."""
_INTO_COLLAR_MM = 0.3
"""Depth to which the tape reaches under the collar's seal [mm]."""


def tape_outline_mm(design: Design) -> tuple[float, float]:
    """Return half the width of the tape over the sensor, and the height z at which it ends [mm]."""
    dims = design.dimensions
    head = dims.sensor.head_diameter_mm / 2 + design.sensor.clearance_mm
    return max(head, dims.tail_half_width) + TAPE_RIM_MM, dims.sensor_z + head + TAPE_RIM_MM


def tape(design: Design) -> Solid:
    """Build the tape on the flat of the bone, from the collar over the sensor's head."""
    (half, top), flat = tape_outline_mm(design), -design.dimensions.flat_depth
    return Box((-half, flat - TAPE_MM, -_INTO_COLLAR_MM), (half, flat, top))


def passage_seal(design: Design) -> tuple[Solid, ...]:
    """Build the adhesive in the passage of the tail through the collar; none if the tail ends under the skin."""
    dims = design.dimensions
    if not dims.tail_passes_collar:
        return ()
    floor = -dims.flat_depth + dims.pocket_depth
    low = dims.fold.nose_z if dims.fold else -design.bone.collar_length_mm
    passage = Box(
        (-dims.tail_half_width, floor - dims.passage_height, low), (dims.tail_half_width, floor, _INTO_COLLAR_MM)
    )
    return (difference(passage, sensor_body(design)),)


def lid_seal(design: Design) -> tuple[Solid, ...]:
    """Build the adhesive around the lid of a folded tail, above the space of the tail; none without a lid."""
    fold = design.dimensions.fold
    if fold is None:
        return ()
    around = intersection(trough(design, fold), filled_bone(design))
    return (difference(around, lid(design), tail_space(design)),)


def seals(design: Design) -> tuple[Solid, ...]:
    """Build everything that closes the hollows of the bone in the mold."""
    return (tape(design), *passage_seal(design), *lid_seal(design), *pilot_hole(design))
