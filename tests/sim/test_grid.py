"""Time grid, and the instants at which a converter samples what happens on it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from fingertip.sim.signal.grid import BASE_HZ, Grid, SampleClock, Sampler, count_samples


def test_points_are_equidistant_from_time_0():
    grid = Grid(4)
    assert grid.rate_hz == 4 * BASE_HZ
    assert grid.step_s == 1 / (4 * BASE_HZ)
    assert grid.time_s(0, 3).tolist() == [0.0, 1 / grid.rate_hz, 2 / grid.rate_hz]
    assert np.array_equal(grid.time_s(7, 5), grid.time_s(0, 12)[7:])


@pytest.mark.parametrize(("longest", "refinement"), [(1.0, 1), (1.01e-4, 1), (9.9e-5, 2), (4.9e-5, 3), (1e-6, 100)])
def test_grid_is_the_coarsest_that_is_fine_enough(longest, refinement):
    grid = Grid.finer_than(longest)
    assert grid == Grid(refinement)
    assert grid.step_s <= longest * (1 + 1e-12)


@pytest.mark.parametrize(("duration", "rate", "count"), [(0.0, 2000.0, 1), (1.0, 2000.0, 2001), (0.00051, 2000.0, 3)])
def test_recording_has_a_sample_at_its_end_or_after_it(duration, rate, count):
    assert count_samples(duration, rate) == count


@pytest.mark.parametrize("rate", [1000.0, 1999.7, 3000.0, 10_000.0, 20_000.0])
@pytest.mark.parametrize("refinement", [1, 3])
def test_last_point_is_the_first_that_is_not_before_the_last_sample(rate, refinement):
    grid = Grid(refinement)
    last = (count_samples(0.7531, rate) - 1) / rate
    points = grid.count_points(0.7531, rate)
    assert (points - 2) / grid.rate_hz < last - 1e-12
    assert last <= (points - 1) / grid.rate_hz + 1e-9


@pytest.mark.parametrize("rate", [1000.0, 2000.0, 3000.0, 2500.0, 1999.7, 20_000.0])
def test_samples_lie_on_the_straight_line_between_points(rate):
    grid, clock, sampler = Grid(), SampleClock(Grid(), rate), Sampler()
    count = grid.count_points(0.5, rate)
    values = 3.0 * grid.time_s(0, count) + 1.0
    times, found = [], []
    for a, b in pairwise((0, 1, 2, 5, 1000, 1001, count)):
        at = clock.advance(b - a)
        times.append(at.time_s)
        found.append(sampler.process(values[a:b], at))
    time_s = np.concatenate(times)
    assert np.array_equal(time_s, np.arange(count_samples(0.5, rate)) / rate)
    assert np.concatenate(found) == pytest.approx(3.0 * time_s + 1.0, abs=1e-12)


def test_instants_on_points_have_no_fraction():
    at = SampleClock(Grid(), 2000.0).advance(11)
    assert at.index.tolist() == [0, 5, 10]
    assert not at.fraction.any()
    between = SampleClock(Grid(), 20_000.0).advance(3)
    assert between.index.tolist() == [0, 0, 1, 1, 2]
    assert between.fraction.tolist() == [0.0, 0.5, 0.0, 0.5, 0.0]


def test_chunk_without_a_sample_gives_none():
    clock, sampler = SampleClock(Grid(), 1000.0), Sampler()
    assert len(sampler.process(np.zeros(1), clock.advance(1))) == 1
    at = clock.advance(3)
    assert len(at.index) == len(at.time_s) == len(sampler.process(np.arange(3.0), at)) == 0
    at = clock.advance(7)
    assert at.time_s.tolist() == [0.001]
    assert sampler.process(np.arange(10.0, 17.0), at).tolist() == [16.0]
