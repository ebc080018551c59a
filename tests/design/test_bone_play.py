"""Play of the bone in the mold: losses against levers and random motions, and the rules that refuse them."""

from __future__ import annotations

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.design.geometry import seat as bone_play
from fingertip.design.geometry.seat import Contact, Loss, SkinPoint, list_contacts, worst
from fingertip.design.new_design import PRESETS
from tests.conftest import design_file

DESIGNS = ("fsr400", "fsr402", "fsr400_compact", *PRESETS)


def moments(items: list[tuple[tuple[float, float, float], tuple[float, float, float]]]) -> np.ndarray:
    points, normals = (np.array([item[i] for item in items]) for i in (0, 1))
    return np.hstack((normals, np.cross(points, normals)))


@pytest.mark.parametrize("name", DESIGNS)
def test_losses_are_those_of_a_library(name: str) -> None:
    from scipy.optimize import linprog

    design = Design.load(design_file(name))
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
    assert worst(design.losses, over_sensor=True).retained >= 0.95
    assert worst(design.losses, over_sensor=False).retained >= 0.80


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
