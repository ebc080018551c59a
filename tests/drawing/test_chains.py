"""Segments of projected edges are joined to lines, and nothing is lost or doubled."""

from __future__ import annotations

import math
import random
from itertools import pairwise

import pytest

from fingertip.pictures.drawing.chains import Segment, chain_segments
from fingertip.pictures.drawing.primitives import Line2, Point


def cut_up(lines: list[list[Point]]) -> list[Segment]:
    segments = [segment for line in lines for segment in pairwise(line)]
    random.Random(7).shuffle(segments)
    return segments


def length(lines: tuple[Line2, ...]) -> float:
    return sum(math.dist(a, b) for line in lines for a, b in pairwise(line))


def test_a_line_and_a_ring_are_found_again() -> None:
    line = [(0.0, 0.0), (1.0, 2.0), (3.0, 1.0), (4.0, 4.0)]
    ring = [(10.0, 0.0), (12.0, 0.0), (11.0, 2.0), (10.0, 0.0)]
    chains = chain_segments(cut_up([line, ring]), 1e-6)
    assert len(chains) == 2
    assert set(chains[0]) == set(line)
    assert chains[1][0] == chains[1][-1]
    assert set(chains[1]) == set(ring)


def test_segments_that_fork_are_each_drawn_once() -> None:
    middle = (0.0, 0.0)
    rays = [[middle, (math.cos(angle), math.sin(angle))] for angle in (0.1, 1.3, 2.9, 4.0, 5.5)]
    chains = chain_segments(cut_up(rays), 1e-6)
    assert length(chains) == pytest.approx(5.0)


def test_points_on_the_way_straight_on_are_left_out() -> None:
    line = [(0.1 * i, 0.3 * i) for i in range(50)]
    assert chain_segments(cut_up([line]), 1e-3) == ((line[0], line[-1]),)


def test_a_curve_keeps_its_form() -> None:
    arc = [(5.0 * math.cos(0.01 * i), 5.0 * math.sin(0.01 * i)) for i in range(600)]
    (chain,) = chain_segments(cut_up([arc]), 2e-3)
    assert len(chain) < len(arc)
    sagittas = [5.0 - math.hypot((a[0] + b[0]) / 2, (a[1] + b[1]) / 2) for a, b in pairwise(chain)]
    assert max(sagittas) < 3 * 2e-3
