"""Play of the bone in its mold: linear programs against scipy's, supports in closed form, and the sheet's limits."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.design.geometry import seat as bone_play
from fingertip.design.geometry.seat import (
    Contact,
    Loss,
    SkinPoint,
    list_contacts,
    list_skin_points,
    worst,
)
from fingertip.design.new_design import PRESETS
from fingertip.foundation.numerics import maximise_linear
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


@pytest.mark.full
def test_random_polytopes_have_the_maxima_of_a_library() -> None:
    from scipy.optimize import linprog

    rng = random.Random(5)
    for _ in range(60):
        count, size = rng.randint(4, 30), rng.randint(1, 6)
        rows = [[rng.gauss(0, 1) for _ in range(size)] for _ in range(count)]
        bounds = [rng.uniform(0.01, 2.0) for _ in range(count)]
        objectives = [[rng.gauss(0, 1) for _ in range(size)] for _ in range(5)]
        for objective, (value, point) in zip(objectives, maximise_linear(objectives, rows, bounds, 7.0), strict=True):
            expected = linprog([-c for c in objective], A_ub=rows, b_ub=bounds, bounds=[(-7, 7)] * size)
            assert value == pytest.approx(-expected.fun, rel=1e-9)
            assert value == pytest.approx(math.fsum(c * x for c, x in zip(objective, point, strict=True)))


def test_shift_between_two_walls_is_their_gap() -> None:
    ((value, point),) = maximise_linear([[0.0, 3.0]], [[0.0, 1.0], [0.0, -1.0]], [0.2, 1.0], 9.0)
    assert value == pytest.approx(0.6)
    assert point[1] == pytest.approx(0.2)


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


@pytest.mark.parametrize("name", DESIGNS)
def test_bundled_designs_keep_their_skin(name: str) -> None:
    losses = Design.load(design_file(name)).losses
    assert worst(losses, over_sensor=True).retained >= 0.95
    assert worst(losses, over_sensor=False).retained >= 0.80


def test_skin_over_the_sensor_has_its_design_thickness() -> None:
    design = Design.load(design_file("fsr400"))
    centre = next(p for p in list_skin_points(design, design.dimensions) if p.over_sensor and p.point_mm[0] == 0.0)
    assert centre.thickness_mm == pytest.approx(design.skin.thickness_palmar_mm)


def test_chaplet_holds_what_a_base_alone_does_not() -> None:
    design = Design.load(design_file("fsr400"))
    held = worst(design.losses, over_sensor=True)
    base = [c for c in list_contacts(design, design.dimensions) if c.point_mm[2] <= 0.0]
    along = [Contact((0.0, 0.0, 0.0), (0.0, 0.0, sign), 0.15) for sign in (-1.0, 1.0)]
    rows = moments([(c.point_mm, c.normal) for c in (*base, *along)]).tolist()
    gaps = [c.gap_mm for c in (*base, *along)]
    (objective,) = moments([(held.point.point_mm, held.point.normal)]).tolist()
    ((loose, _),) = maximise_linear([objective], rows, gaps, 100.0)
    assert loose > 5 * held.loss_mm


def test_what_is_left_of_the_silicone() -> None:
    point = SkinPoint((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), 2.0)
    still = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    some, all_of_it = Loss(point, 0.5, still), Loss(point, 3.0, still)
    assert (some.retained, some.left_mm) == (0.75, 1.5)
    assert (all_of_it.retained, all_of_it.left_mm) == (-0.5, 0.0)
    thin = Loss(SkinPoint((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), 0.8), 0.4, still)
    assert worst([some, thin], over_sensor=False) is thin


def test_gaps_are_clearance_less_growth_of_the_print_and_two_errors() -> None:
    design = Design.load(
        changes=["mold.fit_clearance_mm=0.12", "printer.offset_mm=0.02", "printer.surface_error_mm=0.03"]
    )
    chaplet = design.dimensions.chaplet
    assert chaplet is not None
    gaps = sorted({round(contact.gap_mm, 9) for contact in list_contacts(design, design.dimensions)})
    assert gaps == pytest.approx(sorted({2 * 0.03, 0.12 - 0.02 + 2 * 0.03, chaplet.play + 2 * 0.03}))
    tight = {round(contact.gap_mm, 9) for contact in list_contacts(design, design.dimensions, fit_clearance_mm=0.01)}
    assert min(tight) == pytest.approx(2 * 0.03), "a print that grows by more than the clearance still has its errors"
    assert max(
        contact.gap_mm for contact in list_contacts(design, design.dimensions, fit_clearance_mm=0.3)
    ) == pytest.approx(0.3 + 0.04)
