"""Skin that lies on the bone: rings against plates and waves, a
study's table, finite elements, what is sensed.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.pad import layer, loose_skin
from fingertip.pad.fem_contact import PadModel
from fingertip.pad.fem_large_strain import LargeStrainSolver, press_large_strain
from fingertip.pad.fem_mesh import MeshSize
from fingertip.pad.layer import find_contacts, map_shares
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.response import Pad
from fingertip.pad.survey import survey_pad
from fingertip.pad.touch import Pose, Touch
from tests.pad.test_calculix import solve, write_deck
from tests.tools import require_tool

FIRST, STUDIED = (
    replace(PadForm.of_design(Design.load("first_finger", changes=changes)), friction=0.0)
    for changes in ((), ("silicone.product=addition_40a", "skin.made=encapsulated"))
)


def lay(
    form: PadForm = STUDIED, gap_mm: float = 0.0, bump_mm: float = 0.0, radius_mm: float = 3.2
) -> PadForm:
    return replace(
        form, bonded=False, gap_mm=gap_mm, bump_height_mm=bump_mm, bump_radius_mm=radius_mm
    )


def test_a_bump_bends_a_clamped_plate() -> None:
    """Force in the middle of a thin circular plate that is clamped: 16 pi D / R^2.

    Source: S. Timoshenko, Plates, 1959.
    """
    thin = lay(replace(STUDIED, platform_mm=STUDIED.platform_mm + 2.6), 1.0, 1.01, 0.3)
    rings = loose_skin.lay_rings(thin, 1.0)
    assert rings
    radius = rings.edges_mm[len(rings.gap_mm)]
    rigidity = thin.over_sensor_mm**3 / 12 / (1 - thin.poisson**2)
    force = float(rings.area_mm2[: len(rings.gap_mm)] @ rings.rest_mpa)
    assert force == pytest.approx(0.01 * 16 * math.pi * rigidity / radius**2, rel=0.06)


def test_rings_that_touch_everywhere_pass_on_what_the_waves_do() -> None:
    form = lay(gap_mm=1e-9)
    rings = loose_skin.lay_rings(form, form.young_mpa)
    x, _, shares = map_shares(lay())
    assert rings
    for distance in (0.0, 1.5, 3.0):
        force = np.zeros(len(rings.area_mm2))
        force[np.searchsorted(rings.edges_mm, distance + 1e-9) - 1] = 1.0
        flush = np.linalg.solve(rings.compliance, rings.sink @ (force / rings.area_mm2))
        middle = np.argmin(np.abs(x)), np.argmin(np.abs(x - distance - 0.1))
        assert rings.on_sensor_n(flush) == pytest.approx(shares[middle], abs=0.03), distance


@pytest.mark.parametrize(
    ("form", "shares", "rest_n", "abs_"),
    [
        (STUDIED, (0.63, 0.59, 0.51), 0.0, 0.06),
        (lay(), (0.73, 0.68, 0.58), 0.0, 0.06),
        (
            lay(gap_mm=0.1),
            (0.354, 0.655, 0.592),
            0.0,
            0.08,
        ),  # elements of 0.8 mm: the study's pad closes later
        (lay(gap_mm=0.2), (0.0,), 0.0, 0.01),
        (lay(bump_mm=0.1), (0.75, 0.69, 0.60), 0.04, 0.06),
        (lay(bump_mm=0.1, radius_mm=2.54), (), 0.22, 0.09),
    ],
)
def test_shares_are_those_of_the_study(
    form: PadForm, shares: tuple[float, ...], rest_n: float, abs_: float
) -> None:
    """Own finite elements of the study on a similar pad, tilted by 2
    degrees, at 0.3, 1 and 5 N; less what rests.
    """
    found = find_contacts(form, Pose(2.0), (0.3, 1.0, 5.0))
    assert [c.share for c in found][: len(shares)] == pytest.approx(list(shares), abs=abs_)
    assert layer.find_rest_n(form) == pytest.approx(rest_n, abs=0.04 if rest_n < 0.1 else abs_)


@pytest.mark.full
@pytest.mark.parametrize("form", [lay(FIRST), lay(FIRST, 0.1, 0.2), lay(FIRST, 0.1)])
def test_layer_and_finite_elements_agree(form: PadForm) -> None:
    """Large strain adds up to 5 % to the share, coarse edges some more."""
    model = PadModel(form, MeshSize(1.8), is_half=True)
    forces = (0.3, 1.0)
    touch, _ = Touch.of_pose(form, Pose(2.0), model.fine_surface())
    assert LargeStrainSolver(model, touch, 0.0).first_touch()[0] == pytest.approx(
        layer.find_rest_n(form), abs=0.01
    )
    for ours, theirs in zip(
        find_contacts(form, Pose(2.0), forces),
        press_large_strain(model, Pose(2.0), forces),
        strict=True,
    ):
        assert ours.share == pytest.approx(
            theirs.share, abs=0.09 if form.gap_mm > form.bump_height_mm else 0.045
        )
        assert ours.depth_mm == pytest.approx(theirs.depth_mm, rel=0.15)


def test_friction_inside_holds_the_skin_between_free_and_bonded() -> None:
    """Shares and depths of finite elements at large strain, edges of
    1.8 mm, with friction inside alone, at 1 N.
    """
    free, bonded = (
        find_contacts(replace(lay(FIRST), bonded=b), Pose(2.0), (1.0,))[0] for b in (False, True)
    )
    for friction, share, depth in ((0.15, 0.718, 0.233), (0.3, 0.700, 0.227), (0.6, 0.669, 0.218)):
        held = find_contacts(replace(lay(FIRST), friction=friction), Pose(2.0), (1.0,))[0]
        way = (free.share - held.share) / (free.share - bonded.share)
        assert way == pytest.approx((0.736 - share) / (0.736 - 0.615), abs=0.06)
        assert (free.depth_mm - held.depth_mm) / (free.depth_mm - bonded.depth_mm) == pytest.approx(
            (0.239 - depth) / (0.239 - 0.201), abs=0.08
        )


@pytest.mark.full
def test_calculix_finds_the_gap_closed_where_the_bump_presses(tmp_path: Path) -> None:
    ccx = require_tool("ccx", "as root on Debian, sh .ci/install-calculix")
    model = PadModel(replace(FIRST, poisson=0.3), MeshSize(1.8), is_half=True)
    contact = LargeStrainSolver(
        model, Touch.of_pose(FIRST, Pose(2.0), model.fine_surface())[0], 0.0
    )
    moved, held = contact.balance(0.0, np.append(np.zeros(model.mesh.nodes.size), -10.0))
    loads = np.where(model.body.is_fixed, 0.0, held)
    used = write_deck(model, loads, tmp_path / "pad.inp", is_large=True)
    theirs = solve(ccx, tmp_path, used)
    ours = moved[:-1].reshape(-1, 3)
    assert np.linalg.norm(theirs - ours[used]) < 0.06 * np.linalg.norm(ours[used])
    trace, into, gap = model.find_bone_planes()
    below = np.zeros_like(loads)
    below[used] = theirs
    mean = trace.T @ below[: model.mesh.count] / np.asarray(trace.sum(axis=0)).ravel()[:, None]
    left = gap - (mean * into).sum(axis=1)
    assert left.min() > -0.03  # of an overlap of 0.2 mm before


@pytest.mark.full
def test_a_bonded_skin_feels_less_and_differs_in_all_that_follows() -> None:
    lying, bonded = (
        Design.load("first_finger", changes=[f"skin.made={value}"])
        for value in ("cast", "encapsulated")
    )
    pads = Pad.from_design(lying), Pad.from_design(bonded)
    assert 0.05 < survey_pad(lying).shares[2] - survey_pad(bonded).shares[2] < 0.12
    assert pads[0].stiffness_1n_n_per_m < 0.85 * pads[1].stiffness_1n_n_per_m
    assert pads[0].rest_n > pads[1].rest_n == 0.0
    loose = survey_pad(
        Design.load("first_finger", changes=["skin.bump_height_mm=0"]), is_loose=True
    )
    assert (
        loose.dead_zone_n(0.0, 10.0) > survey_pad(lying, is_loose=True).dead_zone_n(0.0, 10.0) + 0.1
    )
    assert PadForm.of_design(bonded, is_loose=True) == PadForm.of_design(bonded)


def test_what_rests_on_the_sensor_adds_to_its_force_but_not_to_a_curve_of_a_whole_finger() -> None:
    pad = replace(Pad.from_design(Design.load("first_finger")), rest_n=0.05)
    forces = np.array([0.0, 1.0])
    assert pad.sensed_n(forces) - replace(pad, rest_n=0.0).sensed_n(forces) == pytest.approx(
        [0.05, 0.05]
    )
    assert pad.sensed_n(forces, None, True)[0] == 0.0
