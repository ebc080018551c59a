"""Extreme cases: the command and its table, a broken kernel, and kernels that once failed."""

from __future__ import annotations

import math

import numpy as np
import pytest
from typer.testing import CliRunner

from benchmarks.extremes import contact, grasp, run
from benchmarks.extremes.draw import Draw
from fingertip.cli import app
from fingertip.foundation.errors import TraceError
from fingertip.foundation.jit import compiled
from fingertip.pad.response import Backing, Pad
from fingertip.sim.contact.friction import Friction
from fingertip.sim.contact.tangential import DraggedPad, Mount, PadMotion, admissible_step_s
from tests.conftest import ROOT


@pytest.mark.full
def test_command_holds_all_cases_and_writes_the_table(tmp_path):
    report = tmp_path / "page.md"
    report.write_text(f"before\n{run.BEGIN}\nold\n{run.END}\nafter\n")
    words = ["bench", "extremes", "--cases", "60", "--out", str(tmp_path / "x"), "--report", str(report)]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    text = report.read_text()
    assert all(f"| {family.name} | {family.against} |" in text for family in run.FAMILIES)
    assert text.startswith(f"before\n{run.BEGIN}\n\n{run.HEADER}\n")
    assert text.endswith(f" |\n\n{run.END}\nafter\n")


def test_page_holds_the_table_of_the_command():
    text = (ROOT / "docs/accuracy.md").read_text()
    table = text[text.index(run.BEGIN) : text.index(run.END)].splitlines()
    rows = [line.strip("| ").split(" | ") for line in table[4 : 4 + len(run.FAMILIES)]]
    assert table[2] == run.HEADER
    assert [row[:2] for row in rows] == [[family.name, family.against] for family in run.FAMILIES]
    assert all(row[6] == "0" for row in rows)
    assert sum(int(row[2]) for row in rows) > 47_000


def test_kernel_that_returns_no_number_or_raises_is_wrong(monkeypatch):
    monkeypatch.setattr(run, "FAMILIES", run.FAMILIES[:1])
    assert run.run(7, None).is_passed  # of which 4 are of this family
    for broken in (lambda *_: PadMotion(*3 * [np.full(contact.STEPS + 1, math.nan)]), lambda *_: 1 / 0):
        monkeypatch.setattr(contact.DraggedPad, "process", broken)
        found = run.run(7, None)
        assert not found.is_passed
        assert len(found.counts[0].wrong) == 4
        assert "WRONG contact, fixed steps, case 0: nan of the bound; mu_c " in found.as_text()


def test_bristles_that_slide_within_a_step_stay_within_sliding():
    """The relaxation of bristles far beyond breakaway once grew by 13 % per step, up to no number."""
    mu = 1e-6
    friction, mount, load = Friction(mu, mu, 1e-3, 1e7), Mount(0.005, 1000.0, 0.5), 2.0
    step = admissible_step_s(friction, mount, load)
    at, loads = 0.1 * step * np.arange(2001), np.repeat((load, 0.0), (1000, 1001))
    motion = DraggedPad(friction, mount, step).process(at, np.full_like(at, 0.1), loads)
    assert np.abs(motion.bristle_m[1:1000] * friction.sigma0 / mu - 1).max() < 0.05
    assert np.abs(motion.velocity_m_s).max() < 0.3


@pytest.mark.parametrize("number", [3493, 3511, 37645])
def test_errors_of_a_velocity_do_not_add_up(number):
    """A pad that bounces and bristles that stick were once off by 1.5 to 3.5 times the bound."""
    assert contact.error_control(Draw("contact, error control", number)) < 1.0


def test_motion_that_is_no_number_is_refused():
    pad = DraggedPad(Friction(0.6, 0.48), Mount(0.01, 1000.0, 0.5), 1e-4)
    far = np.array([0.0, 1e308])
    with pytest.raises(TraceError, match=r"step_s: 0.0001 s leads to .* choose less than 5e-05 s, or use coupled"):
        pad.process(far, far, np.ones(2))


def test_stiff_pad_on_a_soft_hand_has_the_force_of_its_depth():
    pad = Pad(3e4, 1e-5, (0.5,), (0.0,), 0.5, backing=Backing(stiffness_n_per_m=10.0))
    assert pad.force_n(np.array([pad.depth_m(50.0)]))[0] == pytest.approx(50.0)


@pytest.mark.parametrize("number", [737, 2572])
def test_object_on_a_stiff_pin_keeps_to_its_bound(number):
    """Bristles that slid within a step once grew to no number, and a light object rang on a pin with too long steps."""
    with compiled():
        assert grasp.grasp(Draw("object in a hand", number)) < 0.5
