"""Extreme cases: the table of the page, a broken kernel, kernels
that once failed, and the pad by identities.
"""

from __future__ import annotations

import math
from contextlib import nullcontext
from dataclasses import replace

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.foundation.errors import FingertipError, Issue, TraceError
from fingertip.foundation.jit import compiled
from fingertip.lab.accuracy import extremes
from fingertip.lab.accuracy.accuracy_summary import EXTREMES, _list_refusals, _list_wrong_cases
from fingertip.lab.accuracy.extremes import Draw
from fingertip.pad.layer import find_contacts
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.response import Backing, Pad
from fingertip.pad.touch import Pose
from fingertip.sim.contact import dragged_pad
from fingertip.sim.contact.dragged_pad import (
    DraggedPad,
    Mount,
    NormalContact,
    PadMotion,
    integrate,
)
from fingertip.sim.contact.friction import Friction
from tests.conftest import ROOT

CONTACT = "contact, given load"


def test_page_holds_the_table_of_the_command():
    lines = (ROOT / "docs/accuracy.md").read_text().splitlines()
    begin = lines.index(f"| {' | '.join(EXTREMES)} |") + 2
    rows = [line.strip("| ").split(" | ") for line in lines[begin : begin + len(extremes.FAMILIES)]]
    assert [row[:2] for row in rows] == [
        [name, against] for name, (against, *_) in extremes.FAMILIES.items()
    ]
    assert all(row[6] == "0" for row in rows)
    assert sum(int(row[2]) for row in rows) > 45_000


def test_kernel_that_returns_no_number_or_raises_is_wrong(monkeypatch):
    monkeypatch.setattr(extremes, "FAMILIES", {CONTACT: extremes.FAMILIES[CONTACT]})
    assert extremes.try_families(7)[0].is_passed  # of which 4 are of this family
    for broken in (
        lambda *_: PadMotion(*4 * [np.full(101, math.nan)], steps=100, rejected=0),
        lambda *_: 1 / 0,
    ):
        monkeypatch.setattr(extremes, "integrate", broken)
        (found,) = extremes.try_families(7)
        assert not found.is_passed
        assert len(found.wrong) == 4


def test_too_many_refusals_inside_the_bounds_are_a_failure(monkeypatch):
    def refuse(draw: Draw) -> float:
        if draw.number == 4:
            raise TraceError(Issue("f", "no."))
        return 0.5

    monkeypatch.setattr(extremes, "FAMILIES", {"f": ("a", 1.0, refuse)})
    few = extremes.try_families(20)[0]
    many = extremes.try_families(200)[0]
    assert (few.refused_inside, many.refused_inside) == (0.1, 0.01)
    assert (few.is_passed, many.is_passed, len(few.wrong)) == (False, True, 0)
    assert [*_list_refusals(few), *_list_wrong_cases(few)] == ["f: 1 refused by f"]


@pytest.mark.parametrize("number", [9, 39])
def test_a_board_driven_by_ten_volts_comes_to_what_a_finer_tolerance_gives(number):
    assert extremes.board(Draw("board", number)) < 0.1


@pytest.mark.parametrize("number", [3493, 3511, 37645])
def test_errors_of_a_velocity_do_not_add_up(number):
    """A pad that bounces and bristles that stick were once off by 1.5 to 3.5 times the bound."""
    assert extremes.resonance(Draw("contact, error control", number)) < 1.0


def test_bristles_that_slide_within_a_step_stay_within_sliding():
    """The relaxation of bristles far beyond breakaway once grew by 13 % per step, up to no
    number.
    """
    mu = 1e-6
    friction = Friction(mu, mu, 1e-3, 1e7)
    step_s = 1e-4
    at_m = 0.1 * step_s * np.arange(2001)
    load_n = np.repeat((2.0, 0.0), (1000, 1001))
    mount = Mount(0.005, 1000.0, 0.5)
    motion = integrate(friction, mount, None, step_s, at_m, np.full_like(at_m, 0.1), load_n)
    assert np.abs(motion.bristle_m[1:1000] * friction.sigma0 / mu - 1).max() < 0.05
    assert np.abs(motion.velocity_m_s).max() < 0.3


@pytest.mark.parametrize("normal", [NormalContact(90.0, 0.3), None], ids=["resonance", "given"])
@pytest.mark.parametrize("context", [nullcontext, compiled], ids=["plain", "compiled"])
def test_motion_that_is_no_number_is_refused(monkeypatch, normal, context):
    monkeypatch.setattr(dragged_pad, "MAX_STEPS", 20_000)
    pad = DraggedPad(Friction(0.6, 0.48), Mount(0.01, 1000.0, 0.5), normal, 1e-4, 1.0)
    far = np.array([0.0, 1e308])
    with context(), pytest.raises(TraceError, match="sample 1: needs more than 20000 steps"):
        pad.process(far, far, np.ones(2))


def test_pad_that_swings_by_itself_is_compared_as_long_as_its_motion_is_known(monkeypatch):
    with compiled():
        assert extremes.resonance(Draw("contact, resonance", 109)) < 1.0
        monkeypatch.setattr(extremes, "CONTACT_ERROR", 0.5)
        monkeypatch.setattr(extremes, "BOUNCING_ERROR", 0.0)
        assert extremes.resonance(Draw("contact, resonance", 109)) > 1.0


@pytest.mark.full
@pytest.mark.parametrize("number", range(60))
def test_pad_obeys_its_identities_or_refuses(number):
    """Twice modulus and force press alike, more force presses
    deeper, and force over depth has its inverse.
    """
    draw = Draw("pad", number)
    form = PadForm.of_design(Design.load(draw.choose("design", ("fsr400", "fsr402", "article"))))
    young = draw.log("modulus [MPa]", (0.01, 50.0), (1e-3, 1e3))
    form = replace(
        form, young_mpa=young, poisson=0.5 - draw.log("0.5 - Poisson", (0.001, 0.1), (1e-9, 0.45))
    )
    shape = draw.choose("object", ("plate", "cylinder", "sphere"))
    radius = draw.log("radius [mm]", (1.0, 500.0), (0.5, 1e5)) if shape != "plate" else 0.0
    tilt = draw.rng.uniform(-5.0, 20.0) if draw.is_inside else draw.rng.uniform(-89.0, 89.0)
    force = draw.log("force / (modulus mm2)", (0.01, 5.0), (1e-6, 100.0)) * young
    try:
        one, more = find_contacts(
            form, Pose(tilt, 0.0, shape, radius), [force, 2 * force], math.inf
        )
    except FingertipError:
        return
    two = find_contacts(
        replace(form, young_mpa=2 * young), Pose(tilt, 0.0, shape, radius), [2 * force], math.inf
    )[0]
    assert two.depth_mm == pytest.approx(one.depth_mm, rel=5e-3)
    assert two.share == pytest.approx(one.share, abs=5e-3)
    assert more.depth_mm > one.depth_mm
    assert more.area_mm2 >= one.area_mm2
    assert one.share <= 1.005
    backing = Backing(0.035, draw.log("stiffness behind it [N/m]", (10.0, 1e5), (1e-3, 1e9)))
    curve = Pad(
        draw.log("stiffness [N/m]", (300.0, 3e4), (1.0, 1e8)),
        1e-5,
        (0.5,),
        (0.0,),
        0.5,
        backing=backing,
    )
    forces = np.logspace(-6, 1.7, 40) if draw.is_inside else np.logspace(-12, 6, 40)
    assert curve.force_n(np.array([curve.depth_m(f) for f in forces])) == pytest.approx(
        forces, rel=5e-3
    )
