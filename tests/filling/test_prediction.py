"""Predictions of a filling, and their picture."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.insert import cavity
from fingertip.casting.quantities import measure_volumes
from fingertip.design import Design
from fingertip.filling.ducts_and_mouths import mouth_resistance, open_mouth, rectangular_duct, round_duct
from fingertip.filling.hele_shaw import fill
from fingertip.filling.mold_filling import find_pose, place_vents
from fingertip.filling.network import Mask
from fingertip.filling.predict import Course, FillingPrediction, Opening, Point3, head_pressure_pa, syringe_pressure_pa
from fingertip.filling.surface_links import SkinGrid, build_skin_grid
from fingertip.foundation.numerics import Array
from tests.conftest import design_file

DUCTS = (round_duct(2.1, 10.0), rectangular_duct(3.0, 2.5, 12.0))
PRESSURE_PA = syringe_pressure_pa(30.0, 12.06)
NAMES = ("fsr400", "adult_finger", "fsr402")
WITHOUT_CHAPLET = ("mold.chaplet_diameter_mm=0", "mold.fit_clearance_mm=0.01", "printer.surface_error_mm=0")
"""The grid neglects the facet; the rules accept a bone without chaplet if it has no play."""


@cache
def load(name: str, *changes: str) -> Design:
    return Design.load(design_file(name), changes=changes)


def on_cavity(design: Design, x: float, y: float, z: float) -> Point3:
    """Point of the cavity's surface: x and y relative to half width and half height."""
    dims = design.dimensions
    section, scale = dims.outer.section, dims.shrinkage * dims.outer.scale_at(z / dims.shrinkage)
    return x * section.half_width * scale, y * (section.dorsal if y > 0 else section.palmar) * scale, z


def predict(
    design: Design, grid: SkinGrid, gate: Point3 | None = None, vents: tuple[Point3, ...] | None = None
) -> FillingPrediction:
    if vents is None:
        vents = (on_cavity(design, 0.0, 1.0, 0.88 * design.skin.length_mm),)
    course = Course.follow(grid, Opening(gate or on_cavity(design, 1.0, 0.0, 1.5), 2.74))
    openings = [Opening(point, 1.2) for point in vents]
    return course.predict(openings, DUCTS, viscosity_pa_s=35.0, pressure_pa=PRESSURE_PA)


@pytest.mark.full
@pytest.mark.parametrize("name", NAMES)
def test_volume_equals_that_of_the_solids(name: str) -> None:
    design = load(name, *WITHOUT_CHAPLET)
    exact_mm3 = 1000.0 * measure_volumes(design, MeshEvaluator(0.005)).skin_cm3
    for rows, columns in ((24, 32), (40, 48)):
        assert build_skin_grid(design, rows, columns).layer.network.total_mm3 == pytest.approx(exact_mm3, rel=0.004)


def test_areas_and_thicknesses_are_those_of_the_design() -> None:
    design = load("fsr400")
    grid = build_skin_grid(design)
    dims, layer = design.dimensions, grid.layer
    base = replace(dims.outer.section, palmar=dims.base_palmar_height).area() * dims.shrinkage**2
    assert grid.insert_area_mm2.sum(axis=0) == pytest.approx([0.0, 0.0, base], abs=0.005 * base)
    z = np.linspace(0.0, dims.outer.tip.z, 4001)
    silhouette = np.trapezoid([2 * dims.outer.half_width_at(0.0, float(h)) for h in z], z) * dims.shrinkage**2
    assert grid.parting_area_mm2.sum() == pytest.approx(float(silhouette), rel=0.005)
    for place, thickness_mm in (
        (on_cavity(design, 0.95, 0.0, 18.0), design.skin.thickness_side_mm),
        (on_cavity(design, 0.0, -0.8, dims.sensor_z), design.skin.thickness_palmar_mm),
    ):
        nearest = int(np.argmin(((layer.points_mm - place) ** 2).sum(axis=1)))
        assert layer.thickness_mm[nearest] == pytest.approx(thickness_mm, rel=0.1)


@pytest.mark.full
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("z", [1.5, 10.0])
def test_errors_against_a_finer_grid(name: str, z: float) -> None:
    """Compare with a moderately finer grid; benchmarks/filling.py takes the time for one four times as fine."""
    design = load(name)
    coarse_grid, fine_grid = build_skin_grid(design), build_skin_grid(design, 80, 64)
    gate = on_cavity(design, 1.0, 0.0, z)
    coarse, fine = (predict(design, grid, gate) for grid in (coarse_grid, fine_grid))
    assert coarse.cavity_integral == pytest.approx(fine.cavity_integral, rel=0.01)
    assert coarse.fill_s == pytest.approx(fine.fill_s, rel=0.002)
    assert math.dist(coarse.last_points[0].point_mm, fine.last_points[0].point_mm) < 1.0
    points = fine_grid.layer.points_mm
    nearest = [int(np.argmin(((points - point) ** 2).sum(axis=1))) for point in coarse_grid.layer.points_mm]
    error = np.abs(coarse.arrival_mm3 - fine.arrival_mm3[nearest]) @ coarse_grid.layer.network.volume_mm3
    assert error < 0.02 * coarse.volume_mm3**2


def test_time_and_pressures_follow_from_the_resistances() -> None:
    design = load("fsr400")
    found = predict(design, build_skin_grid(design))
    assert 8.0 < found.fill_s < 30.0
    assert found.fill_s == pytest.approx(35.0 / PRESSURE_PA * found.total_integral, rel=1e-9)
    assert found.force_for_time_n(found.fill_s, 12.06) == pytest.approx(30.0, rel=1e-9)
    assert found.force_for_time_n(2.0 * found.fill_s, 12.06) == pytest.approx(15.0, rel=1e-9)
    assert found.ducts_resistance == pytest.approx(sum(duct.resistance for duct in DUCTS))
    assert found.ducts_resistance > 18.0 * found.cavity_integral / found.volume_mm3
    assert 0.0 < found.gate_pressure_pa < 0.15 * found.pressure_pa
    assert 0.0 <= found.ducts_s < float(np.nanmin(found.arrival_s)) + 1e-9
    assert float(np.nanmax(found.arrival_s)) == pytest.approx(found.fill_s)
    assert head_pressure_pa(1.08, 50.0) == pytest.approx(530.0, rel=0.01)


def test_front_flows_around_a_nail_and_traps_air_behind_it() -> None:
    design = load("fsr402")
    low, high = 18.0, 30.0

    def touches(points: Array) -> Mask:
        nail: Mask = (points[..., 1] > 4.0) & (np.abs(points[..., 0]) < 6.0) & (points[..., 2] > low)
        return nail & (points[..., 2] < high)

    grid, gate = build_skin_grid(design, is_closed=touches), on_cavity(design, 0.0, -1.0, 30.0)
    found = predict(design, grid, gate, vents=(on_cavity(design, 0.0, 1.0, 33.0),))
    closed = ~grid.layer.network.is_open
    assert closed.any()
    assert np.isnan(found.arrival_mm3[closed]).all()
    air = found.air_pockets[0]
    assert air.volume_mm3 > 100.0
    assert air.point_mm[1] > 0.0
    assert air.point_mm[2] < low + 0.5
    x, y, _ = air.point_mm
    assert abs(x) < 1.0
    assert y > 0.0


def test_region_cut_off_by_closed_quads_is_an_air_pocket() -> None:
    design = load("fsr400")

    def touches(points: Array) -> Mask:
        ring: Mask = np.abs(points[..., 2] - 15.0) < 1.5
        return ring

    found = predict(design, build_skin_grid(design, is_closed=touches))
    whole = build_skin_grid(design).layer.network.total_mm3
    cut_off = next(air for air in found.air_pockets if air.injected_mm3 == 0.0)
    assert cut_off.volume_mm3 > 0.3 * whole
    assert found.volume_mm3 + cut_off.volume_mm3 < whole
    assert np.isnan(found.arrival_mm3[-1])


def test_symmetric_gate_gives_a_symmetric_filling() -> None:
    design = load("adult_finger")
    grid = build_skin_grid(design)
    found = predict(design, grid, on_cavity(design, 0.0, -1.0, 8.0))
    rows, columns = grid.layer.network.shape
    arrival = found.arrival_mm3[:-1].reshape(rows, columns)
    mirrored = arrival[:, (columns // 2 - np.arange(columns)) % columns]
    assert arrival == pytest.approx(mirrored, abs=1e-4 * found.volume_mm3)
    assert abs(found.side_force_direction[0]) < 1e-3


def test_forces_are_the_largest_over_all_fronts() -> None:
    design = load("adult_finger")
    grid = build_skin_grid(design)
    gate = on_cavity(design, 1.0, 0.0, 10.0)
    found = predict(design, grid, gate)
    mouth = open_mouth(grid.layer, gate, 2.74)
    filling = fill(grid.layer.network, mouth.shares(len(grid.layer.points_mm)))
    side, axial, opening = [], [], []
    for front in filling.fronts[:-1]:
        cavity = float(filling.gate @ front.pressure_per_mm3) + mouth_resistance(grid.layer, mouth, 2.74)
        pressure = PRESSURE_PA * 1e-6 * front.pressure_per_mm3 / (found.ducts_resistance + max(cavity, 0.0))
        x, y, z = pressure @ grid.insert_area_mm2
        side.append(math.hypot(x, y))
        axial.append(z)
        opening.append(pressure @ grid.parting_area_mm2)
    largest = (max(side), max(axial), max(opening))
    assert (found.side_force_n, found.axial_force_n, found.opening_force_n) == pytest.approx(largest)
    assert found.side_force_direction[0] < -0.9, "away from the gate"
    assert 0.0 < found.axial_force_n < 0.1 * found.static_axial_force_n
    assert 0.0 < found.opening_force_n < 0.1 * found.static_opening_force_n


@pytest.mark.parametrize("name", ["fsr400", "fsr402", "adult_finger", "child_thumb"])
def test_first_vent_is_the_highest_point_in_the_pose_of_filling(name: str) -> None:
    """No corner of the cavity's mesh lies above the surface at the vent, and tip up some do."""
    design = Design.load(design_file(name))
    up, vent = np.array(find_pose(design)), place_vents(design)[0]
    x, _, z = vent.point_mm
    corners = MeshEvaluator(0.01).mesh(cavity(design)).vertices
    at_vent = np.array([x, design.dimensions.outer.dorsal_height_at(x, z), z])
    assert np.linalg.norm(up) == pytest.approx(1.0)
    assert (corners @ up).max() <= at_vent @ up + 0.05  # the cavity is larger by the shrinkage
    assert corners[:, 2].max() > z + 0.5
