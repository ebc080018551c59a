"""Flow against closed forms and grids: ducts, fronts, last points and trapped air."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from fingertip.filling.ducts_and_mouths import (
    conical_duct,
    fill_in_series,
    mouth_resistance,
    open_mouth,
    rectangular_duct,
    round_duct,
)
from fingertip.filling.hele_shaw import Filling, TrappedAir, fill, find_air
from fingertip.filling.network import RowElimination
from fingertip.filling.surface_links import Layer, hexahedron_volumes
from fingertip.foundation.numerics import Array
from tests.filling.filling_grids import disc, sleeve, slot


def fill_from_first_row(layer: Layer, levels: int = 12) -> Filling:
    columns = layer.network.shape[1]
    volume = layer.network.volume_mm3
    gate = np.zeros_like(volume)
    gate[:columns] = volume[:columns] / volume[:columns].sum()
    return fill(layer.network, gate, levels)


def mean_error(filling: Filling, exact_mm3: Array) -> float:
    """Mean error of the arrival volume, weighted by volume and relative to the whole."""
    volume = filling.network.volume_mm3
    error = np.where(volume > 0.0, np.abs(np.nan_to_num(filling.arrival_mm3 - exact_mm3)), 0.0)
    return float(error @ volume) / filling.network.total_mm3**2


@pytest.mark.parametrize("slope", [0.05, -0.05])
def test_wedge_converges_with_second_order(slope: float) -> None:
    def exact(length: float) -> float:
        """Integral over V of 12 / w * integral of dy / h^3: by parts, integral of (V_full - V) 12 / (w h^3) dy."""
        y = np.linspace(0.0, length, 200_001)
        h = 2.0 + slope * y
        volume = 6.0 * (2.0 * y + 0.5 * slope * y * y)
        # The middle surface is longer than y by this factor, and the thickness across it smaller.
        slant = math.hypot(1.0, slope / 2.0)
        return slant**4 * float(np.trapezoid((volume[-1] - volume) * 12.0 / (6.0 * h**3), y))

    errors = []
    for rows in (20, 40, 80):
        layer = slot(rows, 3, 20.0, 6.0, lambda y: 2.0 + slope * y)
        filling = fill_from_first_row(layer)
        errors.append(abs(filling.gate @ filling.fronts[-1].potential / exact(20.0) - 1.0))
        y = layer.points_mm[:, 1]
        assert mean_error(filling, 6.0 * (2.0 * y + 0.5 * slope * y * y)) < 0.25 / rows
    assert errors[0] < 0.01
    for coarse, fine in pairwise(errors):
        assert math.log2(coarse / fine) == pytest.approx(2.0, abs=0.3)


def test_disc_fills_in_circles_and_its_resistance_is_logarithmic() -> None:
    layer = disc(30, 24, 20.0, 2.0)
    pole = len(layer.points_mm) - 1
    mouth = open_mouth(layer, (0.0, 0.0, 1.0), 3.0)
    filling = fill(layer.network, mouth.shares(pole + 1))
    radius = np.hypot(layer.points_mm[:, 0], layer.points_mm[:, 1])
    area = filling.network.total_mm3 / 20.0**2
    outside = radius > 2.0
    assert np.abs(filling.arrival_mm3 - area * radius**2)[outside].max() < 0.03 * filling.network.total_mm3
    rings = filling.arrival_mm3[:-1].reshape(layer.network.shape)
    assert np.ptp(rings, axis=1).max() < 1e-6 * filling.network.total_mm3
    added = mouth_resistance(layer, mouth, 3.0)
    for front in filling.fronts[3:-1]:
        r = math.sqrt(front.injected_mm3 / area)
        exact = math.log(r / 1.5) / (2.0 * math.pi * 2.0**3 / 12.0)
        assert filling.gate @ front.pressure_per_mm3 + added == pytest.approx(exact, rel=0.05)


@pytest.mark.full
def test_mouth_resistance_makes_the_resistance_independent_of_the_grid() -> None:
    found = []
    for rows, columns in ((16, 24), (24, 36), (64, 96)):
        layer = sleeve(rows, columns, 20.0, (5.0, 7.0))
        for angle in (0.0, 0.05, 0.11):
            mouth = open_mouth(layer, (7.0 * math.cos(angle), 7.0 * math.sin(angle), 6.3), 2.4)
            filling = fill(layer.network, mouth.shares(len(layer.network.volume_mm3)), 2)
            added = mouth_resistance(layer, mouth, 2.4) * filling.network.total_mm3
            found.append(filling.gate @ filling.fronts[-1].potential + added)
    assert found == pytest.approx([found[-1]] * len(found), rel=0.01)


@pytest.mark.parametrize("levels", [4, 12])
def test_mass_is_conserved_and_fronts_grow(levels: int) -> None:
    layer = sleeve(20, 32, 25.0, (5.0, 7.0))
    mouth = open_mouth(layer, (7.0, 0.0, 2.0), 2.4)
    filling = fill(layer.network, mouth.shares(len(layer.network.volume_mm3)), levels)
    volume = filling.network.volume_mm3
    for front in filling.fronts:
        assert front.filled @ volume == pytest.approx(front.injected_mm3, rel=1e-9)
        assert front.filled.min() >= 0.0
        assert front.filled.max() <= 1.0 + 1e-6
    for first, second in zip(filling.fronts, filling.fronts[1:], strict=False):
        assert (second.potential >= first.potential).all()
        assert (second.filled >= first.filled - 1e-6).all()
    # The mean arrival is half the volume, whatever the way of the front.
    open_nodes = filling.network.is_open
    mean = float(filling.arrival_mm3[open_nodes] @ volume[open_nodes]) / filling.network.total_mm3
    assert mean == pytest.approx(0.5 * filling.network.total_mm3, rel=0.01)


def test_volume_of_a_hexahedron_with_warped_faces() -> None:
    rng = np.random.default_rng(3)
    inner = np.stack((*np.meshgrid([0.0, 1.0], [0.0, 1.0], indexing="ij"), np.zeros((2, 2))), axis=2)
    inner, outer = (inner + np.array([0.0, 0.0, z]) + rng.normal(0.0, 0.15, (2, 2, 3)) for z in (1.0, 0.0))
    nodes, weights = np.polynomial.legendre.leggauss(4)
    total = 0.0
    for r, wr in zip((nodes + 1) / 2, weights / 2, strict=True):
        for s, ws in zip((nodes + 1) / 2, weights / 2, strict=True):
            for t, wt in zip((nodes + 1) / 2, weights / 2, strict=True):
                a, b = np.array([1 - r, r]), np.array([1 - s, s])
                d = np.array([-1.0, 1.0])
                mixed = (1 - t) * inner + t * outer
                columns = (
                    np.einsum("i,j,ijk", d, b, mixed), np.einsum("i,j,ijk", a, d, mixed),
                    np.einsum("i,j,ijk", a, b, outer - inner),
                )  # fmt: skip
                total += wr * ws * wt * float(np.linalg.det(np.stack(columns)))
    assert hexahedron_volumes(inner, outer)[0, 0] == pytest.approx(-total, rel=1e-12)


def test_rows_that_stay_wet_give_the_same_solution_as_a_fresh_elimination() -> None:
    """To the last bit, and it solves the equations: the flow into each wet node is its load."""
    network = slot(12, 5, 30.0, 6.0, lambda y: 1.0 + 0.1 * y).network
    loads = np.stack((network.volume_mm3, network.volume_mm3**2), axis=1)
    rng = np.random.default_rng(3)
    solver, wet = RowElimination(network, loads), np.ones(len(loads), dtype=bool)
    for first in (3, 9, 0, 5, 11, 5):
        wet = wet & network.is_open
        wet[5 * first : -1] = rng.random(len(wet) - 1 - 5 * first) < 0.7
        wet[0] = wet[-1] = False
        solved = solver.solve(wet)
        np.testing.assert_array_equal(solved, RowElimination(network, loads).solve(wet))
        for column in range(2):
            np.testing.assert_allclose(-network.inflow(solved[:, column])[wet], loads[wet, column], rtol=1e-9)
        assert not solved[~wet].any()


@pytest.mark.parametrize("outlet", [1.0, 2.9, 3.0, 3.0 + 1e-7, 3.001, 6.0])
def test_conical_duct_against_quadrature(outlet: float) -> None:
    duct = conical_duct(3.0, outlet, 12.0)
    x = np.linspace(0.0, 12.0, 100_001)
    d = 3.0 + (outlet - 3.0) * x / 12.0
    per_length, area = 128.0 / (math.pi * d**4), math.pi / 4 * d**2
    resistance = np.concatenate(([0.0], np.cumsum(0.5 * (per_length[1:] + per_length[:-1]) * np.diff(x))))
    assert duct.resistance == pytest.approx(float(resistance[-1]), rel=1e-6)
    assert duct.volume_mm3 == pytest.approx(float(np.trapezoid(area, x)), rel=1e-8)
    assert duct.resistance_integral == pytest.approx(float(np.trapezoid(resistance * area, x)), rel=1e-6)


def test_ducts_with_closed_forms() -> None:
    whole = round_duct(2.1, 10.0)
    assert whole.resistance == pytest.approx(8 * 10 / (math.pi * 1.05**4), rel=1e-12)
    assert whole.resistance_integral == pytest.approx(0.5 * whole.resistance * whole.volume_mm3)
    assert fill_in_series((round_duct(2.1, 4.0), round_duct(2.1, 6.0))) == pytest.approx(whole)
    # White, Viscous Fluid Flow, table 3-1: f Re = 14.227 in a square, 24 between plates; R = 2 f Re L / (A D_h^2).
    assert rectangular_duct(1.0, 1.0, 1.0).resistance == pytest.approx(2 * 14.2271, rel=1e-4)
    wide = rectangular_duct(1000.0, 1.0, 1.0)
    assert wide.resistance == pytest.approx(12.0 / 1000.0 / (1 - 0.630 / 1000), rel=1e-5)
    assert rectangular_duct(3.0, 2.5, 12.0).resistance == pytest.approx(rectangular_duct(2.5, 3.0, 12.0).resistance)


LAYER = slot(60, 2, 30.0, 6.0, lambda y: np.full_like(y, 2.0))
TOTAL = LAYER.network.total_mm3
Y = LAYER.points_mm[:, 1]


def node_at(y: float) -> int:
    return int(np.nanargmin(np.abs(Y - y)))


def rank(height: Array) -> Array:
    """Turn any field into arrival volumes: the volume of all that is lower."""
    volume = LAYER.network.volume_mm3
    lower = np.array([volume[height < value].sum() + 0.5 * volume[height == value].sum() for value in height])
    return np.where(volume > 0.0, lower, np.nan)


def find(height: Array, *vents_y: float) -> tuple[list[int], tuple[TrappedAir, ...]]:
    arrival = rank(height)
    vents = {node_at(y): float(arrival[node_at(y)]) for y in vents_y}
    return find_air(LAYER.network, arrival, vents)


TWO_HUMPS = np.interp(Y, [0.0, 10.0, 15.0, 20.0, 30.0], [0.0, 8.0, 5.0, 9.0, 0.0])
"""One region from y = 0 to 30, which splits at y = 15 into parts around 10 and 20. Half the slot is higher than 5."""


def test_vents_at_both_last_points_leave_no_air() -> None:
    points, air = find(TWO_HUMPS, 10.0, 20.0)
    assert [float(Y[node]) for node in points] == [20.0, 10.0]
    assert air == ()
    dented = np.where(np.isnan(Y), 0.0, Y) - 0.02 * (np.arange(len(Y)) // 3 % 2)
    assert len(find(dented, 30.0)[0]) == 1, "dents of the field make no parts"


def test_part_that_splits_off_without_a_vent_is_trapped_then() -> None:
    _, (air,) = find(TWO_HUMPS, 20.0)
    # Higher than 5: from y = 6.25 to 15 and from 15 to 24.44, of 12 mm3/mm.
    assert float(Y[air.node]) == 10.0
    assert air.volume_mm3 == pytest.approx(8.75 * 12.0, abs=6.0)
    assert air.injected_mm3 == pytest.approx(TOTAL - 18.19 * 12.0, abs=6.0)
    assert find(TWO_HUMPS, 2.0, 20.0) == find(TWO_HUMPS, 20.0), "a vent that is covered before does not count"


def test_all_that_is_left_is_trapped_when_the_last_vent_is_covered_before_the_split() -> None:
    _, (air,) = find(TWO_HUMPS, 2.0)
    assert air.injected_mm3 + air.volume_mm3 == pytest.approx(TOTAL)
    assert air.injected_mm3 == pytest.approx(float(rank(TWO_HUMPS)[node_at(2.0)]))
    assert float(Y[air.node]) == 20.0
    _, (air,) = find(TWO_HUMPS)
    assert (air.injected_mm3, air.volume_mm3) == (0.0, pytest.approx(TOTAL)), "without vents at once"


def test_rest_beside_a_vent_is_trapped_when_the_vent_is_covered() -> None:
    rising = np.where(np.isnan(Y), 0.0, Y)
    _, (air,) = find(rising, 25.0)
    assert air.volume_mm3 == pytest.approx(5.0 * 12.0, abs=0.1)
    assert find(rising, 30.0)[1] == ()
