"""Contacts of the bone and points of its skin: where they lie, and which way they face, against the outlines."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.design.geometry import DesignTables
from fingertip.design.geometry.conic import ConicBody, CrossSection
from fingertip.design.geometry.seat import (
    Contact,
    Loss,
    SkinPoint,
    Vector,
    find_losses,
    list_contacts,
    list_skin_points,
    sleeve_inset_mm,
    worst,
)
from tests.conftest import design_file

DESIGN = Design.load(design_file("fsr400"))
FREE = DESIGN.with_values({"mold.chaplet_diameter_mm": 0.0})
SLEEVE = Design.load(design_file("fsr400"), changes=["mold.method=sleeve", "mold.sleeve_interference_mm=0.2"])


def outline(section: CrossSection, scale: float = 1.0, flat: float = math.inf, count: int = 20_000) -> np.ndarray:
    """Points of a section's outline, palmar below; what lies under the flat is cut away."""
    y = np.linspace(-min(section.palmar * scale, flat), section.dorsal * scale, count)
    x = np.array([section.half_width_at(value, scale) for value in y.tolist()])
    return np.concatenate([np.stack([sign * x, y], axis=1) for sign in (1.0, -1.0)])


def mirror(point: Vector) -> Vector:
    return -point[0], point[1], point[2]


def around(contacts: Iterable[Contact], z: float) -> list[Contact]:
    return [c for c in contacts if c.point_mm[2] == z and c.normal[2] == 0.0]


@pytest.mark.parametrize("design", [DESIGN, FREE, SLEEVE], ids=["fsr400", "free", "sleeve"])
def test_contacts_are_unit_vectors_in_mirrored_pairs(design: DesignTables) -> None:
    contacts = list_contacts(design, design.dimensions)
    assert [math.hypot(*c.normal) for c in contacts] == pytest.approx([1.0] * len(contacts), rel=1e-12)
    found = {(c.point_mm, c.normal, c.gap_mm) for c in contacts}
    assert {(mirror(point), mirror(normal), gap) for point, normal, gap in found} == found
    assert min(c.gap_mm for c in contacts) > 0.0


def check_around(contacts: list[Contact], section: CrossSection, flat: float) -> None:
    """Check that contacts touch an outline: at chords no deeper than their sag, all around, each with its normal."""
    points = outline(section, flat=flat)
    for contact in contacts:
        point, normal = np.array(contact.point_mm[:2]), np.array(contact.normal[:2])
        # The chord through the point lies under the tangent that is parallel to it.
        depth = float((points @ normal).max() - point @ normal)
        assert -1e-6 < depth < 0.15, contact
        assert abs(point[1]) < max(section.palmar, section.dorsal)
    angles = sorted(math.atan2(c.normal[1], c.normal[0]) for c in contacts)
    angles.append(angles[0] + math.tau)
    largest = max(b - a for a, b in itertools.pairwise(angles))
    assert largest < math.radians(120 if flat < math.inf else 45)


def test_collar_touches_its_recess_all_around_at_both_ends() -> None:
    dims, contacts = DESIGN.dimensions, list_contacts(DESIGN, DESIGN.dimensions)
    foot = -DESIGN.bone.collar_length_mm
    low = -min(DESIGN.mold.recess_length_mm, DESIGN.bone.base_length_mm)
    assert dims.chaplet is not None
    heights = [c.point_mm[2] for c in contacts if c.point_mm[2] <= 0.0]
    assert sorted(set(heights)) == [low, foot, 0.0]
    collar = around(contacts, 0.0)
    assert len(collar) == 20, "five chords of each quarter"
    check_around(collar, dims.collar.section, math.inf)
    at_foot = around(contacts, foot)
    for contact in collar:
        assert Contact((*contact.point_mm[:2], foot), contact.normal, contact.gap_mm) in at_foot
    base = [c for c in at_foot if Contact((*c.point_mm[:2], 0.0), c.normal, c.gap_mm) not in collar]
    assert sorted((c.point_mm[:2], c.normal) for c in base) == sorted(
        (c.point_mm[:2], c.normal) for c in around(contacts, low)
    )


def test_base_touches_its_recess_down_to_the_edges_of_its_flat() -> None:
    dims, contacts = DESIGN.dimensions, list_contacts(DESIGN, DESIGN.dimensions)
    low = -min(DESIGN.mold.recess_length_mm, DESIGN.bone.base_length_mm)
    base, flat = around(contacts, low), dims.base_flat_depth
    section = dims.bone_outline.section
    on_flat = [c for c in base if c.normal == (0.0, -1.0, 0.0)]
    edge = section.half_width_at(-flat)
    assert sorted(c.point_mm for c in on_flat) == [(-edge, -flat, low), (edge, -flat, low)]
    others = [c for c in base if c not in on_flat]
    check_around(others, section, flat)
    assert min(c.point_mm[1] for c in others) >= -flat
    assert len(others) > 10


def test_a_base_that_is_shorter_than_the_recess_touches_at_its_own_end() -> None:
    for length, low in ((3.0, -3.0), (100.0, -DESIGN.bone.base_length_mm)):
        tables = DESIGN.with_values({"mold.recess_length_mm": length})
        assert min(c.point_mm[2] for c in list_contacts(tables, tables.dimensions)) == low


def test_chaplet_holds_at_its_facet() -> None:
    """Its screw locates the middle across and along; the boss carries the facet at its rim, up and down."""
    chaplet, error = DESIGN.dimensions.chaplet, 2 * DESIGN.printer.surface_error_mm
    assert chaplet is not None
    y, z, radius, across = chaplet.facet_y, chaplet.z, chaplet.radius, chaplet.play + error
    middle = [
        ((0.0, y, z), normal, across)
        for normal in ((1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0))
    ]
    rim = [
        ((radius, y, z), error),
        ((-radius, y, z), error),
        ((0.0, y, z + radius), error),
        ((0.0, y, z - radius), error),
    ]
    expected = [*middle, *((point, (0.0, sign, 0.0), gap) for point, gap in rim for sign in (1.0, -1.0))]
    found = [(c.point_mm, c.normal, c.gap_mm) for c in list_contacts(DESIGN, DESIGN.dimensions) if c.point_mm[2] > 0.0]
    assert sorted(found) == sorted(expected)


def test_without_a_chaplet_the_shelf_holds_the_collar_along_the_finger() -> None:
    error = 2 * FREE.printer.surface_error_mm
    gap = max(0.0, FREE.mold.fit_clearance_mm - FREE.printer.offset_mm) + error
    contacts = list_contacts(FREE, FREE.dimensions)
    along = [(c.point_mm, c.normal, c.gap_mm) for c in contacts if c.normal[2]]
    assert sorted(along) == [((0.0, 0.0, 0.0), (0.0, 0.0, sign), gap) for sign in (-1.0, 1.0)]
    assert {c.gap_mm for c in contacts} == {gap}
    assert max(c.point_mm[2] for c in contacts) == 0.0


def scale_slope(body: ConicBody, z: float) -> float:
    """Rate at which a body narrows above a height."""
    return (body.scale_at(z) - body.scale_at(z + 1e-6)) / 1e-6


@pytest.mark.parametrize("design", [DESIGN, SLEEVE], ids=["overmold", "sleeve"])
def test_skin_is_measured_across_the_nearest_surface(design: Design) -> None:
    dims, inset = design.dimensions, sleeve_inset_mm(design)
    bone, outer = dims.bone_outline, dims.outer
    assert bone.tip is not None
    join, apex = bone.stations[-1][0], bone.tip.z
    points = [p for p in list_skin_points(design, design.dimensions) if not p.over_sensor and p.point_mm[2] < apex]
    heights = sorted({p.point_mm[2] for p in points})
    assert heights == pytest.approx([0.0, join, join + (apex - join) / 3, join + 2 * (apex - join) / 3])
    for z in heights:
        here = [p for p in points if p.point_mm[2] == z]
        assert len(here) >= 6
        surface = outline(outer.section, outer.scale_at(z))
        for point in here:
            a, b, c = point.normal
            assert math.hypot(a, b, c) == pytest.approx(1.0)
            across = math.hypot(a, b)
            direction = np.array([a, b]) / across
            support = float((surface @ direction).max())
            assert c / across == pytest.approx(support * scale_slope(outer, z) / outer.scale_at(z), rel=0.01)
            x, y, _ = point.point_mm
            nearest = float(np.hypot(*(surface - (x, y)).T).min())
            assert point.thickness_mm / across == pytest.approx(nearest, rel=0.02)
            assert x >= 0.0
            # The inside of the silicone is the bone, or smaller by the interference of a sleeve.
            width, height = bone.section.half_width, bone.section.dorsal if y > 0 else bone.section.palmar
            assert x <= (width - inset) * bone.scale_at(z) + 1e-9
            assert abs(y) <= (height - inset) * bone.scale_at(z) + 1e-9


def test_skin_at_the_apex_is_that_of_the_design() -> None:
    for design, inset in ((DESIGN, 0.0), (SLEEVE, 0.2)):
        tip = design.dimensions.bone_outline.tip
        assert tip is not None
        (point,) = (p for p in list_skin_points(design, design.dimensions) if p.point_mm[2] == tip.z)
        assert point == SkinPoint((0.0, 0.0, tip.z), (0.0, 0.0, 1.0), design.skin.thickness_tip_mm + inset)


def test_skin_over_the_sensor_is_measured_at_its_middle_and_rim() -> None:
    for design, inset in ((DESIGN, 0.0), (SLEEVE, 0.2)):
        dims, radius = design.dimensions, design.dimensions.sensor.active_diameter_mm / 2
        flat, z = dims.flat_depth, dims.sensor_z
        points = [p for p in list_skin_points(design, design.dimensions) if p.over_sensor]
        places = [(0.0, z), (radius, z), (0.0, z + radius), (0.0, z - radius)]
        assert [p.point_mm for p in points] == [(x, -flat, height) for x, height in places]
        assert {p.normal for p in points} == {(0.0, -1.0, 0.0)}
        for point, (x, height) in zip(points, places, strict=True):
            depth = point.thickness_mm - inset + flat
            assert dims.outer.half_width_at(-depth + 1e-9, height) == pytest.approx(x, abs=1e-3)
            assert dims.outer.half_width_at(-depth - 1e-6, height) <= x + 1e-9


def test_interference_counts_only_where_there_is_a_sleeve() -> None:
    assert sleeve_inset_mm(SLEEVE) == 0.2
    assert sleeve_inset_mm(Design.load(changes=["mold.sleeve_interference_mm=0.2"])) == 0.0


def test_losses_are_those_of_the_points_that_are_asked_for() -> None:
    points = list_skin_points(DESIGN, DESIGN.dimensions)
    all_of_them = find_losses(DESIGN, DESIGN.dimensions)
    assert tuple(loss.point for loss in all_of_them) == points
    for loss in all_of_them:
        # The motion of the point: shift, and rotation crossed with the place.
        motion = np.array(loss.motion[:3]) + np.cross(loss.motion[3:], loss.point.point_mm)
        assert motion @ loss.point.normal == pytest.approx(loss.loss_mm)
    (one,) = find_losses(DESIGN, DESIGN.dimensions, points=points[3:4])
    assert one.point == points[3]
    assert one.loss_mm == pytest.approx(all_of_them[3].loss_mm, rel=1e-12)
    assert find_losses(DESIGN, DESIGN.dimensions, points=()) == ()
    looser = find_losses(DESIGN, DESIGN.dimensions, fit_clearance_mm=0.4)
    assert worst(looser, over_sensor=True).loss_mm > worst(all_of_them, over_sensor=True).loss_mm


def test_worst_point_is_chosen_over_the_sensor_or_elsewhere() -> None:
    still = (0.0,) * 6
    losses = [
        Loss(SkinPoint((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), 2.0, over_sensor=over), loss_mm, still)
        for over, loss_mm in ((True, 0.5), (False, 1.0), (True, 0.2), (False, 0.1))
    ]
    assert worst(losses, over_sensor=True) is losses[0]
    assert worst(losses, over_sensor=False) is losses[1]
