"""Surfaces: bundled files, own values, ridges and measured
profiles, and the laws of vibration against load.
"""

from __future__ import annotations

import math
import random
from pathlib import Path

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.foundation.errors import TraceError
from fingertip.foundation.numerics import Array
from fingertip.sim.contact.friction import Friction
from fingertip.sim.contact.surface_files import (
    ARTICLE_SURFACES,
    SURFACES,
    SurfaceFile,
    SurfaceTable,
)
from fingertip.sim.contact.surfaces import SurfaceProfile, average_over_patch, generate_profile
from fingertip.sim.contact.vibration import ProfileForce
from fingertip.sim.runs.manipulation import ManipulationResult
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile, SceneFile
from fingertip.sim.simulation import load_simulation
from fingertip.sim.simulation_summary import find_warnings
from tests.conftest import run_fingertip

DESIGN = Design()
SLIDE = {"distance_m": 0.04, "speed_m_s": 0.04}


def slide(name: str = "medium", force_n: float = 1.0, **surface: object) -> tuple[Array, Array]:
    """Normal force in the middle of a slide, and the frequencies of its spectrum."""
    scene = SceneFile(
        contact={"surface": name},
        surface=surface,
        slide=SLIDE,
        hold={"min_force_n": force_n, "max_force_n": force_n},
        outputs=["force_n", "slip"],
    )
    found = run_scene(DESIGN, scene, 3).columns
    first = int(np.flatnonzero(found["slip"])[0]) + 300
    force = found["force_n"][first : first + 1600]
    return force - force.mean(), np.fft.rfftfreq(1600, 1 / DESIGN.detector.sample_rate_hz)


def test_bundled_files_state_every_value_and_begin_with_the_articles() -> None:
    assert tuple(SURFACES)[:6] == ARTICLE_SURFACES
    for name, surface in SURFACES.items():
        stated = ("roughness_um", "felt_um", "felt_exponent", "longest_wave_mm", "hurst")
        assert (
            min(*(getattr(surface, key) for key in stated), surface.friction.stribeck_m_s) > 0.0
        ), name
        assert surface.material
        assert (surface.ridge_depth_um > 0.0) == name.startswith("ridged"), name
    roughness = {name: SURFACES[name].roughness_um for name in ARTICLE_SURFACES[:3]}
    assert roughness == {"smooth": 0.2, "medium": 0.8, "gross": 3.2}


def test_a_value_of_ones_own_changes_the_named_surface() -> None:
    own = SurfaceTable(roughness_um=10.0, static_friction=0.6).complete("wood")
    assert (own.roughness_um, own.friction.mu_s) == (10.0, 0.6)
    assert own.friction.mu_c == SURFACES["wood"].friction.mu_c
    assert own.material == "own surface, else as wood"
    plain, _ = slide()
    for changed, ratio in ({"felt_um": 3.1}, 2.0), ({"roughness_um": 1.6}, 2.0**0.05):
        assert slide(**changed)[0].std() / plain.std() == pytest.approx(ratio, rel=0.01)
    slippery = SceneFile(surface={"static_friction": 0.2, "kinetic_friction": 0.2}, slide=SLIDE)
    assert (
        run_scene(DESIGN, slippery, 3).slips[0].onset_s
        < run_scene(DESIGN, SceneFile(slide=SLIDE), 3).slips[0].onset_s
    )
    held = ManipulationFile(surface={"static_friction": 1.2, "kinetic_friction": 1.0})
    assert held.surface.static_friction == 1.2


def test_a_profile_of_too_few_points_for_the_board_is_reported(tmp_path: Path) -> None:
    """Half a wave of 67 Hz is 298.5 um long at 0.04 m/s."""
    fine, coarse = (
        str(write_profile(tmp_path / f"{step}.csv", 1.0, step_mm=step)) for step in (0.298, 0.299)
    )
    assert not [*load_simulation(surface=fine).find_warnings()]
    (warning,) = load_simulation(surface=coarse).find_warnings()
    assert "299 um apart carry 66.9 Hz at most at 0.04 m/s" in warning
    assert warning.endswith("at most 298 um")


@pytest.mark.second
@pytest.mark.parametrize(
    ("scene", "table"), [("sliding_finger", "contact"), ("real_manipulation", "object")]
)
def test_a_pad_that_leaves_its_surface_is_reported(scene: str, table: str) -> None:
    rough = load_simulation(scene, changes=["surface.felt_um=30"]).run()
    (warning,) = find_warnings(rough)
    assert f"for {rough.out_of_contact_share:.0%} of its slip" in warning
    remedy = warning.removesuffix(" in a scene").rpartition(" ")[2]
    assert remedy == f"{table}.patch_average=true"
    assert not [
        *find_warnings(load_simulation(scene, changes=["surface.felt_um=30", remedy]).run())
    ]
    find = rough.output if isinstance(rough, ManipulationResult) else rough.columns.__getitem__
    slip = find("slip")
    force_n = find("force_n")
    assert rough.out_of_contact_share == np.mean(force_n[slip] == 0.0) > 0.2


def test_ridges_shake_at_the_speed_over_their_pitch() -> None:
    force, frequency_hz = slide(ridge_pitch_mm=0.5, ridge_depth_um=20.0, roughness_um=0.01)
    assert frequency_hz[np.argmax(np.abs(np.fft.rfft(force)))] == pytest.approx(
        0.04 / 0.5e-3, abs=1.5
    )


def write_profile(
    path: Path, wave_mm: float, length_mm: float = 50.0, step_mm: float = 0.01
) -> Path:
    x = np.arange(round(length_mm / step_mm) + 1) * step_mm
    rows = (f"{a:.4f},{5 * math.sin(2 * math.pi * a / wave_mm):.6f}" for a in x)
    path.write_text("position_mm,height_um\n" + "\n".join(rows) + "\n")
    return path


def test_a_measured_profile_is_what_the_pad_feels(tmp_path: Path) -> None:
    table = SurfaceFile.load(write_profile(tmp_path / "plate.csv", 0.8)).surface
    assert table.profile_step_um == pytest.approx(10.0)
    surface = table.complete("medium")
    assert surface.material == "plate.csv"
    profile = generate_profile(random.Random(1), surface, 0.0, 0.04)
    assert np.ptp(profile.height_m(np.linspace(0.0, 0.04, 5001))) == pytest.approx(10e-6, rel=1e-3)
    averaged = generate_profile(random.Random(1), surface, 0.0, 0.04, 0.3e-3)
    ratio = np.ptp(averaged.heights_m[100:-100]) / np.ptp(profile.heights_m)
    assert ratio == pytest.approx(average_over_patch(2 * math.pi * 0.3 / 0.8), rel=0.01)
    force, frequency_hz = slide(**table.model_dump())
    assert frequency_hz[np.argmax(np.abs(np.fft.rfft(force)))] == pytest.approx(
        0.04 / 0.8e-3, abs=1.5
    )


@pytest.mark.parametrize(("is_proportional", "exponent"), [(False, 1 / 3), (True, 1.0)])
def test_vibration_follows_the_law_of_the_load(is_proportional: bool, exponent: float) -> None:
    pad = SceneFile().draw_pad(DESIGN, 0)
    heights = np.sin(np.arange(4000) / 30)
    profile = SurfaceProfile(0.0, heights, np.gradient(heights, 5e-6))
    path = np.linspace(0.0, 0.01, 1000)
    loads = [
        ProfileForce(pad, profile, is_proportional, 1e-4).process(np.full(1000, load_n), path)
        for load_n in (0.5, 2.0)
    ]
    assert np.ptp(loads[1]) / np.ptp(loads[0]) == pytest.approx(4.0**exponent, rel=2e-3)


def test_surface_files_reach_the_command(tmp_path: Path) -> None:
    own = tmp_path / "own.toml"
    own.write_text('[surface]\nmaterial = "sandpaper"\nroughness_um = 20.0\n')
    done = run_fingertip("simulate", "fsr400", "--surface", own, "--out", tmp_path / "a.csv")
    assert done.stdout.startswith("sandpaper, 0.04 m/s")
    simulation = load_simulation(
        "sliding_finger", surface=str(write_profile(tmp_path / "p.csv", 1.0))
    )
    assert len(simulation.scene.surface.profile_um) == 5001
    done = run_fingertip("simulate", "--surface", "woood", "--out", tmp_path / "b.csv")
    assert "did you mean wood?" in done.stderr


@pytest.mark.parametrize(
    ("changes", "message", "remedy"),
    [
        ({"static_friction": 2.0}, "at least 0.48 and below 0.624", {"static_friction": 0.623}),
        ({"static_friction": 0.3}, "below surface.kinetic_friction", {"static_friction": 0.48}),
        ({"ridge_depth_um": 5.0}, "such as 1", {"ridge_pitch_mm": 1.0}),
        ({"profile_um": [0.0, 1.0]}, "such as 5", {"profile_step_um": 5.0}),
        ({"roughness_um": -1.0}, "at least 0", {"roughness_um": 0.0}),
        ({"profile_um": [math.nan]}, "finite", {"profile_um": []}),
    ],
)
def test_a_surface_that_cannot_be_is_refused_with_what_passes(changes, message, remedy) -> None:
    with pytest.raises(TraceError, match=message):
        SceneFile(surface=changes)
    SceneFile(surface=changes | remedy)


def test_a_profile_shorter_than_the_path_is_refused_with_a_path_that_passes() -> None:
    profile = {"profile_um": [0.0, 1.0, 0.0], "profile_step_um": 1000.0}
    with pytest.raises(
        TraceError, match=r"path of 4 mm; measure more, or set slide\.distance_m=0\.002"
    ):
        SceneFile(surface=profile, slide={"distance_m": 0.004})
    SceneFile(surface=profile, slide={"distance_m": 0.002})


def test_ridges_that_pass_faster_than_samples_show_are_refused() -> None:
    for pitch_mm, is_refused in ((0.04, True), (0.0401, False)):
        scene = SceneFile(slide=SLIDE, surface={"ridge_pitch_mm": pitch_mm, "ridge_depth_um": 1.0})
        assert bool(list(scene.find_design_issues(DESIGN, 0))) == is_refused


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x,y\n0,1\n", "columns position_mm and height_um"),
        ("position_mm,height_um\n0,1\n", "two lines or more"),
        ("position_mm,height_um\n0,1\n1,nan\n", "finite"),
        ("position_mm,height_um\n0,1\n1,2\n5,2\n", "uneven"),
        ("position_mm,height_um\n0,1\n1,a\n", "position_mm,height_um"),
    ],
)
def test_a_profile_that_cannot_be_read_is_refused(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "p.csv").write_text(text)
    with pytest.raises(TraceError, match=message):
        SurfaceFile.load(tmp_path / "p.csv")


def test_the_largest_ratio_of_friction_is_the_edge_of_passivity() -> None:
    ratio = Friction(1.0, 1.0).max_ratio
    Friction(0.999 * ratio, 1.0)
    with pytest.raises(TraceError):
        Friction(1.001 * ratio, 1.0)


def test_the_direction_of_a_slide_turns_the_sign_of_its_shear() -> None:
    """The force along the surface adds to what the sensor feels in
    one direction what it takes in the other.
    """
    sensed = {}
    for towards in ("tip", "base"):
        scene = SceneFile(
            surface={"felt_um": 0.4},
            slide={**SLIDE, "towards": towards},
            outputs=["force_n", "shear_m", "slip", "voltage_v"],
        )
        found = run_scene(DESIGN, scene, 3).columns
        rest = slice(2000, 3000)
        sliding = np.flatnonzero(found["slip"])[300:1500]
        sensed[towards] = found["voltage_v"][sliding].mean() - found["voltage_v"][rest].mean()
        assert found["shear_m"][sliding].mean() > 0.0
    assert sensed["tip"] * sensed["base"] < 0.0
    # What is left without a direction is the hysteresis of the sensor under vibration.
    assert abs(sensed["tip"] + sensed["base"]) < 0.4 * abs(sensed["tip"] - sensed["base"])
