"""Play of bone and core in the mold: losses against levers and random motions, and the rules that refuse them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.design.geometry import DesignTables
from fingertip.design.geometry import seat as bone_play
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
from fingertip.design.new_design import PRESETS
from tests.conftest import design_file

DESIGNS = ("fsr400", "fsr402", "fsr400_compact", *PRESETS)


def moments(items: list[tuple[tuple[float, float, float], tuple[float, float, float]]]) -> np.ndarray:
    points, normals = (np.array([item[i] for item in items]) for i in (0, 1))
    return np.hstack((normals, np.cross(points, normals)))


@pytest.mark.parametrize("name", DESIGNS)
@pytest.mark.parametrize("method", ["overmold", "sleeve"])
def test_losses_are_those_of_a_library(name: str, method: str) -> None:
    from scipy.optimize import linprog

    design = Design.load(design_file(name), changes=[f"mold.method={method}"])
    contacts = list_contacts(design, design.dimensions)
    rows = moments([(c.point_mm, c.normal) for c in contacts])
    gaps = np.array([c.gap_mm for c in contacts])
    for loss in design.losses:
        (objective,) = moments([(loss.point.point_mm, loss.point.normal)])
        expected = linprog(-objective, A_ub=rows, b_ub=gaps, bounds=[(-100, 100)] * 6)
        assert loss.loss_mm == pytest.approx(-expected.fun, abs=1e-9)
        motion = np.array(loss.motion)
        assert (rows @ motion <= gaps + 1e-9).all()
        assert objective @ motion == pytest.approx(loss.loss_mm, abs=1e-12)
    assert method == "sleeve" or worst(design.losses, over_sensor=True).retained >= 0.95
    assert method == "sleeve" or worst(design.losses, over_sensor=False).retained >= 0.80


def test_tip_of_a_cantilever_moves_by_the_lever_of_its_recess(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two pairs of stops 8 mm apart with a gap of 0.1 mm: at 20 mm from the nearer pair, 0.1 (1 + 2 x 20 / 8) mm."""
    pairs = [((0.0, 0.0, z), (0.0, sign, 0.0)) for z in (0.0, -8.0) for sign in (-1.0, 1.0)]
    others = [((0.0, 0.0, 0.0), normal) for axis in range(3) if axis != 1 for normal in unit_pair(axis)]
    turned = [((1.0, 0.0, 0.0), (0.0, sign, 0.0)) for sign in (-1.0, 1.0)]
    contacts = tuple(Contact(point, normal, 0.1) for point, normal in (*pairs, *others, *turned))
    design = Design.load(design_file("fsr400"))
    monkeypatch.setattr(bone_play, "list_contacts", lambda design, dims, clearance=None: contacts)
    found = bone_play.find_losses(design, design.dimensions)
    losses = [loss for loss in found if loss.point.normal == (0.0, -1.0, 0.0) and loss.point.over_sensor]
    middle = next(loss for loss in losses if loss.point.point_mm[0] == 0.0)
    assert middle.loss_mm == pytest.approx(0.1 * (1 + 2 * middle.point.point_mm[2] / 8))


def unit_pair(axis: int) -> list[tuple[float, float, float]]:
    return [tuple(sign * float(i == axis) for i in range(3)) for sign in (-1.0, 1.0)]  # type: ignore[misc]


def test_the_worst_point_has_least_of_its_silicone_left() -> None:
    def loss(thickness_mm: float, loss_mm: float, over_sensor: bool = False) -> Loss:
        return Loss(SkinPoint((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), thickness_mm, over_sensor), loss_mm, (0.0,) * 6)

    some, all_of_it, thin = loss(2.0, 0.5), loss(2.0, 3.0), loss(0.8, 0.4)
    assert (some.retained, some.left_mm) == (0.75, 1.5)
    assert (all_of_it.retained, all_of_it.left_mm) == (-0.5, 0.0)
    assert worst([some, thin], over_sensor=False) is thin
    assert worst([some, loss(0.8, 0.1)], over_sensor=False) is some, "the smallest share, not the thinnest rest"
    losses = [loss(2.0, 0.5, True), loss(2.0, 1.0), loss(2.0, 0.2, True), loss(2.0, 0.1)]
    assert worst(losses, over_sensor=True) is losses[0]
    assert worst(losses, over_sensor=False) is losses[1]


def test_gaps_are_clearance_less_growth_of_the_print_and_two_errors() -> None:
    design = Design.load(
        changes=["mold.fit_clearance_mm=0.12", "printer.offset_mm=0.02", "printer.surface_error_mm=0.03"]
    )
    chaplet = design.dimensions.chaplet
    gaps = sorted({round(contact.gap_mm, 9) for contact in list_contacts(design, design.dimensions)})
    assert gaps == pytest.approx(sorted({2 * 0.03, 0.12 - 0.02 + 2 * 0.03, chaplet.play + 2 * 0.03}))
    tight = {round(contact.gap_mm, 9) for contact in list_contacts(design, design.dimensions, fit_clearance_mm=0.01)}
    assert min(tight) == pytest.approx(2 * 0.03), "a print that grows by more than the clearance still has its errors"
    assert max(
        contact.gap_mm for contact in list_contacts(design, design.dimensions, fit_clearance_mm=0.3)
    ) == pytest.approx(0.3 + 0.04)


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
    for length, end in ((3.0, -3.0), (100.0, -DESIGN.bone.base_length_mm)):
        tables = DESIGN.with_values({"mold.recess_length_mm": length})
        assert min(c.point_mm[2] for c in list_contacts(tables, tables.dimensions)) == end


def test_chaplet_holds_at_its_facet() -> None:
    """Its screw locates the middle across and along; the boss carries the facet at its rim, up and down."""
    chaplet, error = DESIGN.dimensions.chaplet, 2 * DESIGN.printer.surface_error_mm
    y, z, radius, across = chaplet.facet_y, chaplet.z, chaplet.radius, chaplet.play + error
    middle = [
        ((0.0, y, z), normal, across)
        for normal in ((1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0))
    ]
    rim = [(radius, y, z), (-radius, y, z), (0.0, y, z + radius), (0.0, y, z - radius)]
    expected = [*middle, *((point, (0.0, sign, 0.0), error) for point in rim for sign in (1.0, -1.0))]
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


def test_skin_is_measured_at_its_apex_and_over_middle_and_rim_of_the_sensor() -> None:
    for design, inset in ((DESIGN, 0.0), (SLEEVE, 0.2)):
        assert sleeve_inset_mm(design) == inset
        dims, radius = design.dimensions, design.dimensions.sensor.active_diameter_mm / 2
        flat, z, tip = dims.flat_depth, dims.sensor_z, dims.bone_outline.tip
        found = list_skin_points(design, design.dimensions)
        points = [p for p in found if p.over_sensor]
        places = [(0.0, z), (radius, z), (0.0, z + radius), (0.0, z - radius)]
        assert [p.point_mm for p in points] == [(x, -flat, height) for x, height in places]
        assert {p.normal for p in points} == {(0.0, -1.0, 0.0)}
        assert points[0].thickness_mm == pytest.approx(design.skin.thickness_palmar_mm + inset)
        for point, (x, height) in zip(points, places, strict=True):
            depth = point.thickness_mm - inset + flat
            assert dims.outer.half_width_at(-depth + 1e-9, height) == pytest.approx(x, abs=1e-3)
            assert dims.outer.half_width_at(-depth - 1e-6, height) <= x + 1e-9
        (apex,) = (p for p in found if p.point_mm[2] == tip.z)
        assert apex == SkinPoint((0.0, 0.0, tip.z), (0.0, 0.0, 1.0), design.skin.thickness_tip_mm + inset)
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
