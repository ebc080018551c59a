"""Crown of the pad and platform of the bone: the form, both kernels, mold, film and rules."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.catalogues.file_kinds import PRESETS
from fingertip.design import Design
from fingertip.design.geometry import DesignTables
from fingertip.design.geometry.skin_thickness import min_skin_thickness
from fingertip.models.bone import bone, filled_bone
from fingertip.models.conic import ConicBody
from fingertip.models.sensor_pocket import sensor_body, sensor_recess
from fingertip.models.skin_dimensions import RAMP_SLOPE
from fingertip.models.solids import Box, SuperconicSolid
from tests.conftest import DESIGNS, design_file
from tests.oracles.conic_area import section_area

CROWNED = [
    name for name in (*DESIGNS, *PRESETS) if Design.load(design_file(name)).skin.crown_radius_mm
]
FORMS = {
    "default": {},
    "ends on the taper": {
        "skin.crown_radius_mm": 6.0,
        "skin.crown_drop_mm": 1.0,
        "skin.crown_offset_mm": 4.0,
    },
    "no drop": {"skin.crown_drop_mm": 0.0},
    "from the skin's end on": {"skin.crown_radius_mm": 16.0, "skin.crown_drop_mm": 99.0},
}
"""Crowns whose arcs end at different places; a drop of 99 mm stands for the largest one."""


def outer(name: str) -> ConicBody:
    tables = DesignTables().with_values(FORMS[name])
    if tables.skin.crown_drop_mm == 99.0:
        tables = tables.with_values({"skin.crown_drop_mm": tables.dimensions.max_crown_drop})
    body = tables.dimensions.outer
    assert body.crown
    return body


def profile(body: ConicBody, z: float) -> float:
    return body.palmar_scale_at(z) * body.section.palmar


@pytest.mark.parametrize("name", FORMS)
def test_the_pad_follows_two_circles_on_its_taper(name: str) -> None:
    """Distances from the centres, one below the apex and one beyond the base, both found from three
    numbers by hand.
    """
    body = outer(name)
    assert body.crown
    apex = body.crown.z
    radius = body.crown.radius
    height = body.section.palmar
    base = height * (1.0 - body.crown.drop)
    half_drop = (height - base) / 2
    reach = math.sqrt(radius**2 - (radius - half_drop) ** 2)  # of one of both arcs along z
    join = body.stations[-1][0]
    end = min(apex + radius * math.sin(math.radians(25.0)), join)
    for z in np.linspace(apex - reach, end, 40):
        assert math.hypot(z - apex, profile(body, z) - (height - radius)) == pytest.approx(
            radius, abs=1e-9
        )
    for z in np.linspace(max(0.0, apex - 2 * reach), apex - reach, 40):
        assert math.hypot(
            z - (apex - 2 * reach), profile(body, z) - (base + radius)
        ) == pytest.approx(radius, abs=1e-9)
    for z in np.linspace(0.0, max(0.0, apex - 2 * reach), 5):
        assert profile(body, z) == pytest.approx(base, abs=1e-9)
    assert body.palmar_scale_at(body.spans[-1].z[2]) == 0.0


@pytest.mark.parametrize("name", FORMS)
def test_a_crown_leaves_width_and_dorsal_side_alone(name: str) -> None:
    body = outer(name)
    straight = ConicBody(body.section, body.stations, body.tip)
    for span in body.spans:
        assert span.z[2] - span.z[0] >= 1e-3
        for t in np.linspace(0.0, 1.0, 9)[:-1]:
            z, scale, palmar = span.evaluate(float(t))
            assert span.parameter_at(z) == pytest.approx(float(t), abs=1e-6)
            assert scale == pytest.approx(straight.scale_at(z), abs=1e-9)
            assert body.palmar_scale_at(z) == pytest.approx(palmar, abs=1e-9)
    for z in np.linspace(0.1, body.spans[-1].z[2] - 0.1, 30):
        assert body.half_width_at(1.0, z) == straight.half_width_at(1.0, z)
        assert body.dorsal_height_at(2.0, z) == straight.dorsal_height_at(2.0, z)


@pytest.mark.parametrize("name", FORMS)
def test_mesh_follows_the_palmar_side_which_no_line_across_it_meets_twice(name: str) -> None:
    """A palmar side that is a height field over the parting plane lets its mold half go."""
    body = outer(name)
    evaluator = MeshEvaluator(0.02)
    whole = evaluator.manifold(SuperconicSolid(body))
    palmar = whole.trim_by_plane((0.0, -1.0, 0.0), 0.0)
    shadow = palmar.rotate((90.0, 0.0, 0.0)).project().area()
    mesh = evaluator.mesh(SuperconicSolid(body))
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 1]
    below = (corners[:, :, 1] <= 1e-9).all(axis=1)
    assert normals[below].max() < 1e-9
    assert -normals[below].sum() / 2 == pytest.approx(shadow, rel=1e-6)
    for x, y, z in mesh.vertices[(mesh.vertices[:, 1] < -0.1) & (mesh.vertices[:, 2] > 0.0)][::7]:
        assert body.palmar_height_at(abs(x), z) == pytest.approx(-y, abs=1e-3)


@pytest.mark.full
@pytest.mark.parametrize("name", FORMS)
def test_both_kernels_and_an_integral_agree_in_volume(name: str) -> None:
    from fingertip.cad.kernel import brep

    body = outer(name)
    z = np.linspace(0.0, body.spans[-1].z[2], 20001)
    section = body.section
    palmar, dorsal = (
        section_area(section._replace(**{side: 0.0})) for side in ("dorsal", "palmar")
    )
    scales = np.array([(body.scale_at(h), body.palmar_scale_at(h)) for h in z])
    areas = scales[:, 0] * (palmar * scales[:, 1] + dorsal * scales[:, 0])
    expected = float(np.trapezoid(areas, z))
    assert brep.volume(brep.BrepEvaluator().solid(SuperconicSolid(body))) == pytest.approx(
        expected, rel=1e-5
    )
    assert MeshEvaluator(0.002).manifold(SuperconicSolid(body)).volume() == pytest.approx(
        expected, rel=3e-4
    )


@pytest.mark.parametrize(
    ("name", "platform_mm"), [*((name, None) for name in CROWNED), ("fsr400", 2.6)]
)
def test_the_rule_finds_the_thinnest_place_of_the_straight_part(
    name: str, platform_mm: float | None
) -> None:
    """Between the solids, the skin is no thinner than at the sections and points that the rules
    look at.
    """
    design = Design.load(design_file(name))
    evaluator = MeshEvaluator(0.02)
    if platform_mm:  # the thinnest place lies beside the ramp
        design = design.with_values({"bone.platform_mm": platform_mm})
    dims = design.dimensions
    reach = 99.0
    interior = evaluator.manifold(filled_bone(design)).trim_by_plane((0.0, 0.0, 1.0), 0.02)
    beside = evaluator.manifold(
        Box((-reach, -reach, 0.02), (reach, reach, dims.taper_end_z)).cut(
            SuperconicSolid(dims.outer)
        )
    )
    found = interior.min_gap(beside, 5.0)
    least = min_skin_thickness(design, dims)
    assert least - 0.03 < found < least + 0.12, (
        "what the rules measure in sections is rather too thin than too thick"
    )
    assert found > design.skin.min_thickness_mm


@pytest.mark.parametrize("name", CROWNED)
def test_the_film_lies_in_its_slot_along_the_ramp(name: str) -> None:
    """Head and tail clear the bone, keep the adhesive's distance from the floor, and lie below flat
    and ramp.
    """
    design = Design.load(design_file(name))
    evaluator = MeshEvaluator(0.01)
    dims = design.dimensions
    film = evaluator.manifold(sensor_body(design))
    solid = evaluator.manifold(bone(design))
    assert evaluator.manifold(filled_bone(design)).genus() == 0, "no gap below ramp or platform"
    assert (film ^ solid).volume() < 1e-3
    over = film.trim_by_plane((0.0, 0.0, 1.0), max(0.5, dims.tail_end_z))
    recess = evaluator.manifold(sensor_recess(design)) ^ evaluator.manifold(filled_bone(design))
    assert (over - recess).volume() < 1e-3 * over.volume()
    sheet = over.volume() / dims.sensor.thickness_mm
    lifted = film.translate((0.0, design.sensor.adhesive_thickness_mm * 0.9, 0.0)) ^ solid
    assert lifted.volume() < 0.02 * sheet, "the floor follows the film"


def test_a_film_on_a_ramp_ends_where_its_length_says() -> None:
    dims = Design().dimensions
    flat = DesignTables().with_values({"bone.platform_mm": 0.0}).dimensions
    low, high = dims.ramp
    assert (high - low) * RAMP_SLOPE == pytest.approx(1.7)
    assert dims.tail_end_z - flat.tail_end_z == pytest.approx(
        math.hypot(1.7, high - low) - (high - low)
    )
