"""Seat of the bone in the mold: the silicone over it, its play, and how far silicone creeps along it until it sets.

Play: the bone is a rigid body. Base and collar lie in their recess with a clearance on all sides, and the screw of the
chaplet pulls the facet against the boss. Each surface that locates the bone may be off by the error of the print. For
small motions, a shift t and a rotation w, a contact at r with the normal n allows n . (t + w x r) <= gap. The silicone
lost at a point of the skin is the same expression, so its largest value is the solution of a linear program.

References: H. Schlichting, Boundary-Layer Theory, chapter 6 (creeping flow between parallel walls); V. Chvatal, Linear
Programming, 1983, chapter 3 (simplex method).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, TypeAlias

from fingertip.design.geometry.conic import ConicBody, CrossSection, arc_point
from fingertip.foundation.numerics import maximise_linear

if TYPE_CHECKING:
    from fingertip.design.geometry.dimensions import Dimensions
    from fingertip.design.parameters import Tables

_OUTLINE_POINTS, _OUTLINE_CHORDS = 24, 48
"""Points and chords of a quarter of an outline. The sag of a chord is 1e-3 mm on a finger."""

Chord = tuple[float, float, float, float, float]
"""Start (x, y), direction (dx, dy) and squared length of a chord [mm, mm2]."""


@dataclass(frozen=True)
class ThicknessSample:
    """Thickness of the silicone at one point of the bone's outline, in a section across the finger."""

    thickness_mm: float
    x: float
    y: float
    """Unit vector from the bone to the nearest point of the surface."""
    support_mm: float
    """Distance of the surface's nearest chord from the middle of the finger, along that vector."""
    bone_x: float
    bone_y: float


def min_skin_thickness(dims: Dimensions, inset_mm: float) -> float:
    """Compute the minimum skin thickness [mm] over the straight part of the finger.

    Both outlines change linearly between the section where the skin begins and the one where its tip begins, but for
    the arcs of a crown and the ramp of a platform, which bring sections of their own. The tip is left to the check of
    the solids, which covers all three dimensions.
    """
    palmar_alone = [z for z in _bends(dims) if z < dims.taper_end_z]
    both = [z for z, _ in dims.bone_outline.stations if z >= 0.0]
    sections: dict[float, Sequence[bool]] = {z: (False,) for z in palmar_alone} | {z: (True, False) for z in both}
    return min(
        sample.thickness_mm
        for z, sides in sections.items()
        for sample in skin_thicknesses(dims, z, inset_mm, sides=sides)
    )


def _bends(dims: Dimensions) -> list[float]:
    """List the heights at which a crown, or the palmar side of the bone, bends over the skin's length [mm]."""
    knots = [span.z[0] for span in dims.outer.spans if dims.crown]
    if dims.platform_half_width_at(dims.sensor_z):
        # Behind the sensor a ramp leads on; ahead of it the platform ends in a half circle, steepest at its end.
        along_radius = (-0.7, 0.0, 0.4, 0.7, 0.9, 0.99)
        knots += [*dims.ramp, *(dims.sensor_z + share * dims.platform_radius for share in along_radius)]
    return sorted({z for z in knots if 0.0 < z < dims.outer.spans[-1].z[2]})


def skin_thicknesses(
    dims: Dimensions, z: float, inset_mm: float, points: int = _OUTLINE_POINTS, chords: int = _OUTLINE_CHORDS,
    sides: Sequence[bool] = (True, False),
) -> Iterator[ThicknessSample]:  # fmt: skip
    """Sample the silicone over the bone's outline at height z [mm], cut at the palmar flat; one side, x >= 0.

    `sides` are those to sample: dorsal (True) and palmar (False).
    """
    outer, outer_scale, palmar_scale = dims.outer.section, dims.outer.scale_at(z), dims.outer.palmar_scale_at(z)
    inner, inner_scale = dims.bone_outline.section, dims.bone_outline.scale_at(z)
    width, flat = inner.half_width - inset_mm, dims.flat_depth - inset_mm
    for dorsal in sides:
        height = (inner.dorsal if dorsal else inner.palmar) - inset_mm
        weight = inner.dorsal_weight if dorsal else inner.palmar_weight
        rise = outer_scale if dorsal else palmar_scale
        surface = [(outer_scale * x, rise * y) for x, y in quarter_outline(outer, dorsal, chords)]
        bone = [
            (inner_scale * width * x, inner_scale * height * y)
            for x, y in (arc_point(i / points, weight) for i in range(points + 1))
        ]
        if not dorsal:
            # The flat cuts the palmar arc: its edge replaces the points below it.
            edge = inner.half_width_at(-flat, inner_scale)
            bone = [(x, y) for x, y in bone if y < flat]
            bone += [(min(edge, width * inner_scale), flat)] if edge > 0.0 else []
            if platform := dims.platform_half_width_at(z):
                bone.append((platform - inset_mm, dims.flat_depth_at(z) - inset_mm))
        polyline = [_chord(a, b) for a, b in pairwise(surface)]
        for point in bone:
            thickness, (ax, ay, dx, dy, _) = _nearest_chord(point, polyline)
            length = math.hypot(dx, dy) or 1.0
            x, y = dy / length, -dx / length
            side = 1.0 if dorsal else -1.0
            yield ThicknessSample(thickness, x, side * y, ax * x + ay * y, point[0], side * point[1])


def quarter_outline(section: CrossSection, dorsal: bool, count: int) -> list[tuple[float, float]]:
    """Return `count` + 1 points [mm] of the dorsal or palmar quarter of an outline, from its side; both with y >= 0."""
    height, weight = (section.dorsal, section.dorsal_weight) if dorsal else (section.palmar, section.palmar_weight)
    return [(section.half_width * x, height * y) for x, y in (arc_point(i / count, weight) for i in range(count + 1))]


def _chord(a: tuple[float, float], b: tuple[float, float]) -> Chord:
    dx, dy = b[0] - a[0], b[1] - a[1]
    return (*a, dx, dy, dx * dx + dy * dy)


def _nearest_chord(point: tuple[float, float], polyline: list[Chord]) -> tuple[float, Chord]:
    """Distance [mm] to the nearest chord, and that chord: of equally near ones the first by its start (x, y)."""
    px, py = point
    nearest, closest = polyline[0], math.inf
    for chord in polyline:
        ax, ay, dx, dy, squared_length = chord
        # Foot of the perpendicular, clamped to the chord.
        t = ((px - ax) * dx + (py - ay) * dy) / squared_length if squared_length else 0.0
        t = 0.0 if t < 0.0 else 1.0 if t > 1.0 else t
        distance = math.hypot(ax + t * dx - px, ay + t * dy - py)
        if distance < closest or (distance == closest and chord < nearest):
            nearest, closest = chord, distance
    return closest, nearest


_RIM_MM = 0.5
"""Distance that the tape keeps from the skin, from the foot of the collar and from the end of the recess [mm]."""
_LEAST_GAP_MM = 0.01
"""Gap that is left above the tape, because printed surfaces are not smooth [mm]. An assumption."""


def tape_span_mm(design: Tables) -> tuple[float, float] | None:
    """Return where the seat's tape lies [mm below the skin], on the collar or below its foot; None without."""
    collar, recess = design.bone.collar_length_mm, design.mold.recess_length_mm
    if design.mold.seat_tape_mm == 0.0:
        return None
    on_collar, on_base = (_RIM_MM, collar - _RIM_MM), (collar, recess - _RIM_MM)
    return max(on_collar, on_base, key=lambda span: span[1] - span[0])


def creep_mm(integral: float, gap_mm: float, tape_mm: float, span_mm: tuple[float, float] | None) -> float:
    """Compute how far silicone creeps into a gap, of which a tape narrows the part from its beginning on [mm].

    A flow q per width between plates at a distance h loses the pressure 12 mu q / h^3 per length. With x1 from the
    opening to the tape, h1 and h2 the gaps there and above the tape, and x2 the length crept along the tape,

        integral of p / mu over time = 6 (x1 / h1)^2 + 12 h2 x1 x2 / h1^3 + 6 (x2 / h2)^2,

    or 6 (x / h1)^2 where the silicone does not reach the tape.
    """
    free = gap_mm * math.sqrt(integral / 6.0)
    if span_mm is None or free <= span_mm[0]:
        return free
    x1, h1, h2 = span_mm[0], gap_mm, min(gap_mm, max(gap_mm - tape_mm, _LEAST_GAP_MM))
    # a x2^2 + b x2 = c, solved in the form that does not cancel.
    a, b, c = 6.0 / h2**2, 12.0 * h2 * x1 / h1**3, integral - 6.0 * (x1 / h1) ** 2
    return x1 + 2.0 * c / (b + math.sqrt(b * b + 4.0 * a * c))


Vector: TypeAlias = tuple[float, float, float]
Motion: TypeAlias = tuple[float, ...]
"""Shift in x, y, z [mm] and rotation about x, y, z [rad]."""

_CHORDS = 5
"""Contacts of a quarter of an outline."""
_POINTS, _SURFACE_CHORDS = 5, 20
"""Points of a quarter of a section at which the silicone is measured, and chords of the outer surface."""
_TIP_SECTIONS = 2
_STEP_MM = 1e-3
"""Step over which the slope of the outer surface is taken."""
_LIMIT = 100.0
"""Bound of every component of a motion, which no support at all would leave unbounded [mm or rad]."""


@dataclass(frozen=True)
class Contact:
    """Surface that limits the motion of the bone."""

    point_mm: Vector
    normal: Vector
    """Direction in which the bone cannot move further than the gap; a unit vector."""
    gap_mm: float


@dataclass(frozen=True)
class SkinPoint:
    """Point of the skin, and the silicone over it."""

    point_mm: Vector
    """Point of the bone."""
    normal: Vector
    """Direction in which the silicone is thickness_mm thick; a unit vector."""
    thickness_mm: float
    over_sensor: bool = False


@dataclass(frozen=True)
class Loss:
    point: SkinPoint
    loss_mm: float
    motion: Motion

    @property
    def retained(self) -> float:
        """Thickness that is left, relative to the nominal one."""
        return 1.0 - self.loss_mm / self.point.thickness_mm

    @property
    def left_mm(self) -> float:
        return max(0.0, self.point.thickness_mm - self.loss_mm)


def list_contacts(design: Tables, dims: Dimensions, fit_clearance_mm: float | None = None) -> tuple[Contact, ...]:
    """List what limits the motion of the bone."""
    error = 2 * design.printer.surface_error_mm  # one surface of the bone, one of the mold
    drawn = design.mold.fit_clearance_mm if fit_clearance_mm is None else fit_clearance_mm
    gap = max(0.0, drawn - design.printer.offset_mm) + error
    foot = -design.bone.collar_length_mm
    low = max(-design.mold.recess_length_mm, -dims.full_base_length)
    contacts = [
        *_around(dims.collar, 0.0, gap),
        *_around(dims.collar, foot, gap),
        *_around(dims.bone_outline, foot, gap, dims.base_flat_depth),
        *_around(dims.bone_outline, low, gap, dims.base_flat_depth),
    ]
    chaplet = dims.chaplet
    if chaplet is None:
        # The collar's foot lies on its shelf, and nothing else holds the bone along the finger.
        return (*contacts, *(Contact((0.0, 0.0, 0.0), (0.0, 0.0, sign), gap) for sign in (-1.0, 1.0)))
    centre = (0.0, chaplet.facet_y, chaplet.z)
    across = chaplet.play + error
    for sign in (-1.0, 1.0):
        contacts += [Contact(centre, (sign, 0.0, 0.0), across), Contact(centre, (0.0, 0.0, sign), across)]
        # The screw presses the facet on the whole boss.
        for x, z in ((chaplet.radius, 0.0), (-chaplet.radius, 0.0), (0.0, chaplet.radius), (0.0, -chaplet.radius)):
            contacts.append(Contact((x, chaplet.facet_y, chaplet.z + z), (0.0, sign, 0.0), error))
    return tuple(contacts)


def list_skin_points(design: Tables, dims: Dimensions) -> tuple[SkinPoint, ...]:
    """List points of one side: where skin and tip begin, along the tip, at the apex, over the sensor."""
    assert dims.bone_outline.tip is not None
    join, apex = dims.bone_outline.stations[-1][0], dims.bone_outline.tip.z
    inset = sleeve_inset_mm(design)
    points = []
    tip = (join + (apex - join) * (i + 1) / (_TIP_SECTIONS + 1) for i in range(_TIP_SECTIONS))
    # A crown and a platform bend the palmar side alone.
    sections: dict[float, Sequence[bool]] = dict.fromkeys(_bends(dims), (False,))
    sections |= dict.fromkeys((0.0, join, *tip), (True, False))
    for z, sides in sorted(sections.items()):
        if dims.outer.palmar_scale_at(z) == 0.0:
            continue  # a crown or a platform of a design that rules refuse may bend past the tip
        # The rates at which both sides of the outer surface narrow, relative to their size there [1/mm].
        dorsal, palmar = (
            (1.0 - scale_at(z + _STEP_MM) / scale_at(z)) / _STEP_MM
            for scale_at in (dims.outer.scale_at, dims.outer.palmar_scale_at)
        )
        for sample in skin_thicknesses(dims, z, inset, _POINTS, _SURFACE_CHORDS, sides):
            slope = sample.support_mm * (palmar if sample.bone_y < 0.0 else dorsal)
            cosine = 1.0 / math.hypot(1.0, slope)
            normal = (sample.x * cosine, sample.y * cosine, slope * cosine)
            points.append(SkinPoint((sample.bone_x, sample.bone_y, z), normal, sample.thickness_mm * cosine))
    points.append(SkinPoint((0.0, 0.0, apex), (0.0, 0.0, 1.0), design.skin.thickness_tip_mm + inset))
    head = dims.sensor.active_diameter_mm / 2
    for x, z in ((0.0, 0.0), (head, 0.0), (0.0, head), (0.0, -head)):
        thickness = dims.outer.palmar_height_at(x, dims.sensor_z + z) - dims.platform_depth + inset
        point = (x, -dims.platform_depth, dims.sensor_z + z)
        points.append(SkinPoint(point, (0.0, -1.0, 0.0), thickness, over_sensor=True))
    return tuple(points)


def list_insert_points(dims: Dimensions, lower_mm: float = 0.0) -> tuple[SkinPoint, ...]:
    """List points on the edge of an insert, which may be lower, where the skin over it is thinnest; none without."""
    if dims.insert is None:
        return ()
    r, palm, points = dims.insert.radius, dims.outer.palmar_height_at, []
    depth = dims.platform_depth + dims.insert.height - lower_mm
    for x, along in ((0.0, r), (r, 0.0), (0.0, -r)):
        z = dims.sensor_z + along
        by_x, by_z = ((palm(x + _STEP_MM, z) - palm(x, z)) / _STEP_MM, (palm(x, z + _STEP_MM) - palm(x, z)) / _STEP_MM)
        cosine = 1.0 / math.hypot(1.0, by_x, by_z)
        normal = (-by_x * cosine, -cosine, -by_z * cosine)
        points.append(SkinPoint((x, -depth, z), normal, (palm(x, z) - depth) * cosine))
    return tuple(points)


def find_losses(
    design: Tables, dims: Dimensions, fit_clearance_mm: float | None = None, points: Sequence[SkinPoint] | None = None
) -> tuple[Loss, ...]:
    """Find the worst loss of silicone at each point, over all positions that the contacts allow."""
    contacts = list_contacts(design, dims, fit_clearance_mm)
    rows = [_moment(contact.point_mm, contact.normal) for contact in contacts]
    gaps = [contact.gap_mm for contact in contacts]
    points = list_skin_points(design, dims) if points is None else points
    solutions = maximise_linear([_moment(point.point_mm, point.normal) for point in points], rows, gaps, _LIMIT)
    return tuple(Loss(point, value, tuple(m)) for point, (value, m) in zip(points, solutions, strict=True))


def worst(losses: Sequence[Loss], over_sensor: bool) -> Loss:
    """Select the point that keeps the smallest share of its thickness, over the sensor or elsewhere."""
    return min((loss for loss in losses if loss.point.over_sensor == over_sensor), key=lambda loss: loss.retained)


def sleeve_inset_mm(design: Tables) -> float:
    """Return the inset of the silicone's inside from the bone [mm]: the interference of a skin made apart, else 0."""
    return design.mold.core_inset_mm if design.is_cast_apart else 0.0


def _moment(point: Vector, normal: Vector) -> list[float]:
    """Return n and r x n, whose product with a motion is n . (t + w x r)."""
    (x, y, z), (a, b, c) = point, normal
    return [a, b, c, y * c - z * b, z * a - x * c, x * b - y * a]


def _around(body: ConicBody, z: float, gap_mm: float, flat: float | None = None) -> Iterator[Contact]:
    """List contacts around an outline at a height, cut at its palmar flat, on both sides."""
    section = body.section
    for dorsal in (True, False):
        sign = 1.0 if dorsal else -1.0
        for (x0, y0), (x1, y1) in pairwise(quarter_outline(section, dorsal, _CHORDS)):
            x, y = (x0 + x1) / 2, (y0 + y1) / 2
            if not dorsal and flat is not None and y > flat:
                continue
            length = math.hypot(x1 - x0, y1 - y0)
            nx, ny = (y1 - y0) / length, (x0 - x1) / length
            for side in (-1.0, 1.0):
                yield Contact((side * x, sign * y, z), (side * nx, sign * ny, 0.0), gap_mm)
    if flat is not None:
        for side in (-1.0, 1.0):
            yield Contact((side * section.half_width_at(-flat), -flat, z), (0.0, -1.0, 0.0), gap_mm)
