"""Checks of the cup, what is lowered into it, and the skin between them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from fingertip.cad.kernel.mesh import Manifold, MeshEvaluator
from fingertip.cad.verification.assembly import HALVES, LIFT_MM
from fingertip.cad.verification.check import (
    PLANE_OFFSET_MM,
    Check,
    Checks,
    Solids,
    complement,
    measure_gap,
)
from fingertip.cad.verification.skin import check_fitting_stretch
from fingertip.cad.verification.trapped_air import LEANS_DEG, trapped_mm3
from fingertip.design import Design
from fingertip.design.geometry.casting_layout import BAND_N, MAX_BENDING_MM
from fingertip.foundation.numerics import Array
from fingertip.models import mold
from fingertip.models.making import making_of
from fingertip.models.mold import cavity
from fingertip.models.mold_layout import (
    GAP_MM,
    NOTCH_MM,
    RIDGE_END_MM,
    RIDGE_HEIGHT_MM,
    RIDGE_LENGTH_MM,
)
from fingertip.models.parts import PARTS
from fingertip.models.skin import skin
from fingertip.models.solids import Solid, union

CHECKS = Checks()
_THINNER = ("silicone.product", "silicone.viscosity_pa_s")

_RISE_MM = 0.5
"""Rise of the core by a print that is too large by 0.3 mm at each seat, which costs no skin [mm].
"""
_GRAVITY_M_S2 = 9.81
_SHARE_PER_MM = 1.0
_ERRORS_MM = (0.05, 0.1)
"""Share of the palmar skin that may be missing over the error of a flank: 5 % at 0.05 mm, 10 % at
0.1 mm.
"""
_MAX_FILM_MM = 0.02
_MAX_AIR_MM3 = 0.05
_SECTIONS = 24


@CHECKS.register(
    *HALVES,
    change={
        "mold.trapped_air": ("skin.bump_height_mm", "bone.groove_depth_mm"),
        "mold.palmar_error": ("printer.surface_error_mm", "skin.thickness_palmar_mm"),
        "mold.plunge_pressure": _THINNER,
        "mold.core_bending": _THINNER,
        "mold.creep": ("printer.surface_error_mm", *_THINNER),
        "mold.seat_film": _THINNER,
        "mold.wall": ("mold.wall_mm", "mold.engraving_depth_mm"),
        "skin.fitting_stretch": ("bone.groove_depth_mm", "mold.core_inset_mm"),
    },
)
def check_mold(design: Design, solids: Solids) -> Iterator[Check]:
    evaluator = solids.evaluator
    making = making_of(design)
    if making.hanger not in solids.parts:
        return

    yield from _check_motions(design, evaluator)
    yield Check("mold.trapped_air", worst_air_mm3(design, evaluator), _MAX_AIR_MM3, "mm3")
    share = palmar_error_share(design)
    yield Check(
        "mold.palmar_error", palmar_error_mm(design), share * design.skin.thickness_palmar_mm, "mm"
    )
    pressure = plunge_pressure_kpa(design, evaluator)
    yield Check("mold.plunge_pressure", pressure, design.mold_layout.held_kpa, "kPa")
    yield Check(
        "mold.core_bending", design.mold_layout.core_bending_mm(pressure), MAX_BENDING_MM, "mm"
    )
    layout = design.mold_layout
    width, depth = NOTCH_MM
    dorsal = layout.dorsal_height - design.skin.semi_axis_dorsal_mm
    # Flows back where some is lost.
    notches_mm3 = 2 * width * (depth + GAP_MM) * (dorsal + design.mold.wall_mm)
    yield Check("mold.creep", seam_mm3(design, pressure), notches_mm3, "mm3")
    yield Check("mold.seat_film", seat_film_mm(design), _MAX_FILM_MM, "mm")
    # The wall between the cavity and everything else that is open, but for rim and seam, where it
    # opens.
    below = PLANE_OFFSET_MM + GAP_MM + max(NOTCH_MM[1], RIDGE_HEIGHT_MM)
    whole: Solid = mold.block(design).cut(
        *mold.belts(design), *mold.label(design), *mold.key_sockets(design)
    )
    room = evaluator.manifold(cavity(design)).trim_by_plane((0.0, 0.0, 1.0), below)
    outside = complement(evaluator, whole).trim_by_plane((0.0, 0.0, 1.0), below)
    limit = design.printer.min_wall_mm - evaluator.tolerance_mm
    yield Check(
        name="mold.wall",
        value=measure_gap(room, outside, 2 * limit),
        limit=limit,
        unit="mm",
        relation="at least",
    )
    if not making.is_bonded:
        yield check_fitting_stretch(design, evaluator)


def _check_motions(design: Design, evaluator: MeshEvaluator) -> Iterator[Check]:
    """Check that what is lowered goes straight down into the closed cup, and comes out of the
    dorsal half with its skin.
    """
    palmar = evaluator.manifold(mold.mold_palmar(design))
    dorsal = evaluator.manifold(mold.mold_dorsal(design))
    lowered = build_lowered(design)
    core = evaluator.manifold(lowered)
    length = core.bounding_box()[5]
    way = [length * i / 8 for i in range(1, 9)]
    overlaps = []
    for up in way:
        raised = core.translate((0.0, 0.0, -up))
        overlaps += [float((raised ^ palmar).volume()), float((raised ^ dorsal).volume())]

    yield Check.zero_volume("mold.lowering_overlap", max(overlaps))
    cast = evaluator.manifold(lowered.union(making_of(design).silicone(design, skin(design))))
    lifts = (LIFT_MM * i / 2 for i in (1, 2))
    lifting = max(float((cast.translate((0.0, 0.0, -up)) ^ dorsal).volume()) for up in lifts)
    yield Check.zero_volume("mold.lifting_overlap", lifting)


def build_lowered(design: Design) -> Solid:
    """Build what is lowered into the cup, as one solid."""
    return union(*(PARTS[name].solid(design) for name in making_of(design).lowered))


def worst_air_mm3(design: Design, evaluator: MeshEvaluator) -> float:
    free = evaluator.manifold(cavity(design).cut(making_of(design).in_cup(design)))
    return max(trapped_mm3(free, lean) for lean in LEANS_DEG)


def palmar_error_share(design: Design) -> float:
    """Largest palmar error over the thickness of the silicone there."""
    return _SHARE_PER_MM * min(max(design.printer.surface_error_mm, _ERRORS_MM[0]), _ERRORS_MM[1])


def palmar_error_mm(design: Design) -> float:
    """Compute by how much less silicone lies over the sensor [mm] where each flank is off by the
    printer's error.
    """
    dims = design.dimensions
    return design.printer.surface_error_mm * worst_motion(
        design, (0.0, -dims.platform_depth, dims.sensor_z)
    )


def worst_motion(design: Design, point_mm: tuple[float, float, float]) -> float:
    """Compute how far a point of the core lies off along y at most, over the error of a flank.

    Six flanks hold the core in six directions: n . (t + w x p) = d for each. Of all signs of the
    errors d the worst adds up the absolute values of their effects.
    """
    points, normals = (np.array(part) for part in zip(*design.mold_layout.flanks, strict=True))
    rows = np.hstack([normals, np.cross(points, normals)])
    palmar = np.array([0.0, 1.0, 0.0])
    effects = np.linalg.solve(rows.T, np.concatenate([palmar, np.cross(point_mm, palmar)]))

    return float(np.abs(effects).sum())


class SeatLimits(NamedTuple):
    """Readings of a caliper from the foot to the top of the plate, on the core that lies in the
    closed cup [mm].
    """

    low: float
    high: float
    tilt: float
    """Largest difference between its palmar and its dorsal edge, at which 10 % of the palmar skin
    may be lost.
    """


def palmar_limits(design: Design) -> SeatLimits:
    """Find the limits of the readings: a core that is off as a whole only rises, and one that tilts
    moves at its tip.

    What a reading does not show is the shift of the seat itself, for which its largest value is
    allowed.
    """
    layout = design.mold_layout
    thickness = design.skin.thickness_palmar_mm
    flank = design.mold_layout.flanks[0]
    hidden = worst_motion(design, (0.0, 0.0, flank.point_mm[2]))
    lever = (design.dimensions.sensor_z - flank.point_mm[2]) / layout.overall_depth
    tilt = _ERRORS_MM[1] * max(0.0, _SHARE_PER_MM * thickness - hidden) / lever
    height = layout.overall_height

    return SeatLimits(height - _ERRORS_MM[1] * math.sqrt(2.0), height + _RISE_MM, tilt)


def plunge_pressure_kpa(design: Design, evaluator: MeshEvaluator) -> float:
    """Compute the pressure at the tip as `plunge.estimate_pressure_kpa`, from sections of both
    solids.
    """
    room = evaluator.manifold(cavity(design))
    core = evaluator.manifold(making_of(design).in_cup(design))
    length = core.bounding_box()[5]
    pressure = 0.0
    speed = (length - design.mold_layout.pour_z) / making_of(design).lowering_s

    for i in range(_SECTIONS):
        gaps, along, area = _measure_gap_around(room, core, length * (i + 0.5) / _SECTIONS)
        slope = 12.0 * speed * (area + (gaps * along).sum() / 2) / (gaps**3 * along).sum()
        pressure += 1e-3 * design.silicone.material.viscosity_pa_s.high * slope * length / _SECTIONS

    return pressure


def _measure_gap_around(room: Manifold, core: Manifold, z: float) -> tuple[Array, Array, float]:
    """Measure the gap from each edge of the core's section to the cup [mm], the edges' lengths, and
    the area.
    """
    inner = core.slice(z)
    outer = room.slice(z)
    a, b = _edges(inner.to_polygons())
    c, d = _edges(outer.to_polygons())
    middle = ((a + b) / 2)[:, None]
    along = d - c
    share = np.clip(
        ((middle - c) * along).sum(axis=2) / np.maximum((along**2).sum(axis=1), 1e-12), 0.0, 1.0
    )
    gaps = np.linalg.norm(c + share[:, :, None] * along - middle, axis=2).min(axis=1)

    return gaps, np.linalg.norm(b - a, axis=1), float(inner.area())


def _edges(outlines: list[Array]) -> tuple[Array, Array]:
    rings = [np.asarray(ring) for ring in outlines]
    return np.concatenate(rings), np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])


def seam_mm3(design: Design, pressure_kpa: float) -> float:
    """Compute how much silicone creeps into the seam until it sets [mm3]: while the core goes down,
    then by its head.

    The depth at the foot is taken at the tip; up the sides it falls with the root of the head.
    """
    silicone = design.silicone.material
    layout = design.mold_layout
    gap = 2 * design.printer.surface_error_mm
    lowering = 1e3 * pressure_kpa * making_of(design).lowering_s / silicone.viscosity_pa_s.high
    head = silicone.density_g_cm3.high * _GRAVITY_M_S2 * design.skin.length_mm
    # A flow q per width loses the pressure 12 mu q / h^3 per length (H. Schlichting, Boundary-Layer
    # Theory, chapter 6).
    spent = lowering + head * 60 * silicone.planned_pot_life_min / silicone.viscosity_pa_s.low
    depth = gap * math.sqrt(spent / 6.0)

    return gap * depth * (2 * layout.cavity_half_width + 2 * design.skin.length_mm * 2 / 3)


def seat_film_mm(design: Design) -> float:
    """Compute the film of silicone that is left on the flanks after half the pot life, if it came
    there [mm].

    Between long strips of width b a load F per length L leaves h with 2 F t / L = mu b^3 / h^2
    (Reynolds).
    """
    flanks = design.mold_layout.flanks
    silicone = design.silicone.material
    share = BAND_N / (len(flanks) * math.sqrt(0.5))
    width = 1e-3 * math.sqrt(2.0) * 2 * flanks[0].point_mm[2]
    length = 1e-3 * (RIDGE_LENGTH_MM - 2 * RIDGE_END_MM)
    time_s = 30 * silicone.planned_pot_life_min

    return 1e3 * math.sqrt(silicone.viscosity_pa_s.high * length * width**3 / (2 * share * time_s))
