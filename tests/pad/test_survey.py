"""Survey of a pad: what the bundled designs feel, turn-on, and the check of a deaf sensor."""

import json
import math
import re
from contextlib import suppress
from importlib import import_module
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from fingertip.cad.verification.skin import check_pad
from fingertip.cli import app
from fingertip.design import Design
from fingertip.foundation.errors import Issue, TraceError
from fingertip.pad.fem_elastic import stiffness
from fingertip.pad.fem_mesh import extrude, quadratic_plan
from fingertip.pad.layer import find_contacts
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.survey import TILTS_DEG, find_own_mode_hz, survey_pad
from fingertip.pad.touch import Pose
from fingertip.page.pad_section import render_pad
from tests.conftest import run_fingertip
from tests.pad.bonded import CROWNED


def test_a_crown_makes_the_sensor_feel_in_every_grasp():
    survey = survey_pad(CROWNED)
    assert survey.least_share(0, 10) >= 0.55
    assert survey.least_share(-5, 15) >= 0.40
    assert survey.shares[TILTS_DEG.index(20.0)] >= 0.20
    assert survey.evenness >= 0.85
    assert survey.worst_turn_on_n <= 0.45
    assert survey.rolled_share >= 0.35


def test_the_turn_on_is_where_the_share_gives_the_sensor_its_own_turn_on():
    design = CROWNED
    form = PadForm.of_design(design)
    survey = survey_pad(design)
    for tilt, force in zip(TILTS_DEG, survey.turn_on_n, strict=True):
        share = find_contacts(form, Pose(tilt), (force,))[0].share
        assert force * share == pytest.approx(design.force_curve.turn_on_n, rel=0.01)
    data = survey.to_dict()
    row = data.pop("tilts")[TILTS_DEG.index(2.0)]
    digits = {"stiffness_n_per_mm": 3}
    assert data == {name: round(getattr(survey, name), digits.get(name, 4)) for name in data}
    assert row == {
        "tilt_deg": 2.0,
        "share": round(survey.shares[2], 4),
        "turn_on_n": round(survey.turn_on_n[2], 3),
    }
    half, one, twice = (
        contact.depth_mm for contact in find_contacts(form, Pose(2.0), (0.5, 1.0, 2.0))
    )
    power = math.log(4.0) / math.log(twice / half)
    assert survey.stiffness_n_per_mm == pytest.approx(power / one, rel=0.01), (
        "dF/dd of a power is power F / d"
    )


@pytest.mark.parametrize("turn_on_n", [0.0, 5e-324, 1e-6])
def test_a_sensor_that_is_on_at_once_turns_on_at_once(turn_on_n):
    design = Design.load(
        "fsr400", changes=["force_curve.curve=calibrated", f"force_curve.turn_on_n={turn_on_n}"]
    )
    assert 0.0 <= survey_pad(design).worst_turn_on_n < 1e-5


@pytest.mark.full
def test_a_pad_without_a_crown_is_deaf_at_some_tilts_and_its_check_fails():
    flat = Design.load("article", changes=["skin.crown_radius_mm=0"])
    check = check_pad(flat)
    assert (check.name, check.passed, check.is_beyond, check.value) == (
        "pad.turn_on_force",
        False,
        True,
        20.0,
    )
    assert survey_pad(flat).worst_turn_on_n == math.inf
    assert check_pad(Design.load("fsr400")).passed


@pytest.mark.full
def test_command_page_and_picture_show_the_survey(tmp_path):
    survey = survey_pad(Design.load("article"))
    answer = json.loads(run_fingertip("pad", "article", "--json").stdout)
    assert {"design": "article", **survey.to_dict()}.items() <= answer.items()
    text = run_fingertip("pad", "article").stdout
    assert f"{survey.shares[2]:.2f}" in text
    said = render_pad(Design.load("article"))
    assert f"Rolled by 10 degrees it gets {survey.rolled_share:.0%}" in said
    assert said.count("at a tilt of") == len(TILTS_DEG) + 2
    drawn = tmp_path / "pad.svg"
    assert run_fingertip("picture", "article", "--pad", "--out", drawn).returncode == 0
    file = drawn.read_text("utf-8")
    assert "var(" not in file
    assert [
        one.text for one in ElementTree.fromstring(file).iter("{http://www.w3.org/2000/svg}title")
    ][1:] == (re.findall("<title>(.*?)</title>", said)[1:])
    refused = run_fingertip("picture", "article", "--pad", "--out", tmp_path / "pad.png")
    assert "end it in .svg" in refused.stderr
    assert "add that" in run_fingertip("pad", "article", "--friction", "0.3").stderr


@pytest.mark.parametrize(
    ("made", "shares"), [("cast", ("0.90", "0.63")), ("encapsulated", ("0.40", "0.28"))]
)
def test_rows_of_the_elements_stand_below_that_of_the_layer_model(
    made, shares, monkeypatch, capsys
):
    """Shares that say half of the mesh's edges, refused at the
    first tilt, with strains that say the tilt.
    """

    def press(model, pose, forces_n, friction=0.0):
        if pose.tilt_deg == TILTS_DEG[0]:
            raise TraceError(Issue("tilt_deg", "too far"))
        assert (model.is_half, forces_n, friction) == (
            True,
            (1.0,),
            0.0 if made == "encapsulated" else 0.3,
        )
        part = dict.fromkeys(("depth_mm", "bond_shear_mpa", "bond_tension_mpa"), 0.1)
        yield SimpleNamespace(share=model.size.edge_mm / 2, strain=pose.tilt_deg / 100, **part)

    elements = import_module("fingertip.pad.fem_contact")
    monkeypatch.setattr(
        elements,
        "PadModel",
        lambda form, size, is_half: SimpleNamespace(size=size, is_half=is_half),
    )

    def patch(model: Any, pose: Any) -> Any:
        return SimpleNamespace(press=lambda force_n: next(press(model, pose, (force_n,))))

    monkeypatch.setattr(elements, "Patch", patch)
    monkeypatch.setattr(
        import_module("fingertip.pad.fem_large_strain"), "press_large_strain", press
    )
    with suppress(SystemExit):
        app(["pad", "fsr400", "--refine", "--set", f"skin.made={made}"])
    text = capsys.readouterr().out
    first, *rows = [re.split("  +", row) for row in text.splitlines()[2:5]]
    assert first[0] == "share of 1 N"
    titles = ("the same, finite elements", "finite elements, edges 0.7")
    assert rows == [
        [title, "-", *[share] * (len(TILTS_DEG) - 1)]
        for title, share in zip(titles, shares, strict=True)
    ]
    assert ("strain 20%" in text) == ("not small" in text) == (made == "encapsulated")


@pytest.mark.full
def test_finite_elements_confirm_what_the_layer_model_promises():
    """The figures that the form of the default design was chosen
    for, by the second model on two meshes.
    """
    found = json.loads(run_fingertip("pad", "fsr400", "--refine", "--json").stdout)
    by_tilt = {
        tilt: contact["share"] for tilt, contact in zip(TILTS_DEG, found["fem"], strict=True)
    }
    grasp = [by_tilt[tilt] for tilt in (0.0, 2.0, 5.0, 10.0)]
    assert min(grasp) >= 0.55
    assert min(by_tilt[-5.0], by_tilt[15.0]) >= 0.40
    assert by_tilt[20.0] >= 0.20
    assert min(grasp) / max(grasp) >= 0.85
    finer = [contact["share"] for contact in found["fem_refined"]]
    assert finer == pytest.approx(list(by_tilt.values()), abs=0.015)
    assert [row["share"] for row in found["tilts"]] == pytest.approx(
        list(by_tilt.values()), abs=0.06
    )


def test_own_mode_is_that_of_a_sheared_layer_by_finite_elements():
    form = PadForm.of_design(CROWNED)
    density_t_mm3 = 1.08e-9
    layers = 8
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
    points, triangles = quadratic_plan(corners, np.array([[0, 1, 2], [1, 3, 2]]))
    mesh = extrude(
        points,
        triangles,
        np.linspace(0.0, form.over_sensor_mm, layers + 1)[:, None] * np.ones(len(points)),
    )
    free = np.flatnonzero(mesh.nodes[:, 2] > 0.0)
    # Shear along x alone.
    matrix = stiffness(mesh, form.young_mpa, form.poisson)[0].toarray()[3 * free][:, 3 * free]
    # A plane moves as one: its springs add up, and so do its masses, 1 : 2 : 1 in the levels of a
    # layer.
    planes = np.unique(mesh.nodes[free, 2], return_inverse=True)[1]
    gather = np.eye(2 * layers)[planes]
    share = np.full(2 * layers, 2.0)
    share[::2] = 4.0
    share[-1] = 1.0
    mass = density_t_mm3 * form.over_sensor_mm / layers * share / 6
    rates = np.linalg.eigvals((gather.T @ matrix @ gather) / mass[:, None])
    assert find_own_mode_hz(CROWNED) == pytest.approx(
        math.sqrt(min(rates.real)) / (2 * math.pi), rel=1e-3
    )
