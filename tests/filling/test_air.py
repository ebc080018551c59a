"""Last points and trapped air on arrival fields made by hand."""

import numpy as np
import pytest

from fingertip.filling.hele_shaw import ClosingVent, LastPoint, TrappedAir, find_air
from fingertip.foundation.numerics import Array
from tests.filling.filling_grids import slot

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


def find(height: Array, *vents_y: float) -> tuple[tuple[LastPoint, ...], tuple[TrappedAir, ...]]:
    arrival = rank(height)
    vents = tuple(ClosingVent(node_at(y), float(arrival[node_at(y)])) for y in vents_y)
    return find_air(LAYER.network, arrival, vents)


TWO_HUMPS = np.interp(Y, [0.0, 10.0, 15.0, 20.0, 30.0], [0.0, 8.0, 5.0, 9.0, 0.0])
"""One region from y = 0 to 30, which splits at y = 15 into parts around 10 and 20. Half the slot is higher than 5."""


def test_vents_at_both_last_points_leave_no_air() -> None:
    points, air = find(TWO_HUMPS, 10.0, 20.0)
    assert [float(Y[point.node]) for point in points] == [20.0, 10.0]
    assert points[0].split_mm3 == points[1].split_mm3 > 0.0
    assert air == ()


def test_part_that_splits_off_without_a_vent_is_trapped_then() -> None:
    _, (air,) = find(TWO_HUMPS, 20.0)
    # Higher than 5: from y = 6.25 to 15 and from 15 to 24.44, of 12 mm3/mm.
    assert float(Y[air.node]) == 10.0
    assert air.volume_mm3 == pytest.approx(8.75 * 12.0, abs=6.0)
    assert air.injected_mm3 == pytest.approx(TOTAL - 18.19 * 12.0, abs=6.0)


def test_vent_covered_before_the_split_does_not_count_after_it() -> None:
    with_early_vent = find(TWO_HUMPS, 2.0, 20.0)
    assert with_early_vent == find(TWO_HUMPS, 20.0)


def test_all_that_is_left_is_trapped_when_the_last_vent_is_covered_before_the_split() -> None:
    _, (air,) = find(TWO_HUMPS, 2.0)
    assert air.injected_mm3 + air.volume_mm3 == pytest.approx(TOTAL)
    assert air.injected_mm3 == pytest.approx(float(rank(TWO_HUMPS)[node_at(2.0)]))
    assert float(Y[air.node]) == 20.0


def test_rest_beside_a_vent_is_trapped_when_the_vent_is_covered() -> None:
    rising = np.where(np.isnan(Y), 0.0, Y)
    _, (air,) = find(rising, 25.0)
    assert air.volume_mm3 == pytest.approx(5.0 * 12.0, abs=0.1)
    assert find(rising, 30.0)[1] == ()


def test_without_vents_all_air_is_trapped_at_once() -> None:
    _, (air,) = find(TWO_HUMPS)
    assert (air.injected_mm3, air.volume_mm3) == (0.0, pytest.approx(TOTAL))


def test_dents_of_the_field_do_not_make_parts() -> None:
    dented = np.where(np.isnan(Y), 0.0, Y) - 0.02 * (np.arange(len(Y)) // 3 % 2)
    points, _ = find(dented, 30.0)
    assert len(points) == 1
