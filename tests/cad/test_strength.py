"""Strength of the bone: sections, stresses and knocks against closed forms, and what
designs hold.
"""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.verification import strength as assess
from fingertip.cad.verification.bone import check_strength
from fingertip.cad.verification.check import Solids
from fingertip.cad.verification.strength import (
    assess_strength,
    describe_loads,
    measure_section,
    strength_data,
    stress_gradients,
)
from fingertip.cli.check_tables import describe_cause
from fingertip.design import Design
from fingertip.design.formulas.stress_and_knock import (
    PIN,
    Springs,
    StressFactors,
    hole_in_tension,
    shoulder_in_bending,
)
from fingertip.design.interfaces import interface_of
from fingertip.design.interfaces.interface import Bolt, base_size
from fingertip.models.clevis import stop_height_mm
from fingertip.models.interfaces import shapes_of
from fingertip.models.parts import PARTS
from fingertip.models.solids import Difference
from tests.conftest import run_fingertip

DESIGN = Design()


def circle(radius: float, corners: int = 2000, at: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """Counter-clockwise polygon."""
    turn = 2 * math.pi * np.arange(corners) / corners
    return np.stack([at[0] + radius * np.cos(turn), at[1] + radius * np.sin(turn)], axis=1)


def strength_of(**tables):
    """Strength of a design."""
    design = Design(**tables)
    return assess_strength(design, MeshEvaluator(0.02))


def test_sections_of_a_rectangle_away_from_the_origin_and_of_a_tube():
    b = 4.0
    h = 6.0
    section = measure_section([np.array([[10, 20], [14, 20], [14, 26], [10, 26]], dtype=float)])
    assert section.area_mm2 == b * h
    assert section.centroid_mm == (12.0, 23.0)
    assert section.second_xx_mm4 == pytest.approx(b * h**3 / 12)
    assert section.second_yy_mm4 == pytest.approx(h * b**3 / 12)
    assert section.second_xy_mm4 == pytest.approx(0.0, abs=1e-9)
    tube = measure_section([circle(5.0), circle(3.0)[::-1]])
    assert tube.area_mm2 == pytest.approx(math.pi * 16, rel=1e-5)
    assert tube.second_xx_mm4 == pytest.approx(math.pi / 4 * (5**4 - 3**4), rel=1e-5)
    assert measure_section([]) is None


def test_round_cantilever_has_the_textbook_stress_in_every_direction():
    section = measure_section([circle(3.5)])
    gradients = stress_gradients(section, np.array([0.0, 0.0, 56.0]), 0.0)
    bending = 56.0 * 32 / (math.pi * 7.0**3)
    assert np.linalg.norm(gradients[:, :2], axis=1) == pytest.approx(
        np.full(2000, bending), rel=1e-3
    )
    assert gradients[:, 2] == pytest.approx(np.full(2000, 4 / (math.pi * 49)), rel=1e-3)
    half = stress_gradients(section, np.array([0.0, 0.0, 56.0]), 0.0, 0.5)
    assert half[:, :2] == pytest.approx(gradients[:, :2] / 2)
    assert half[:, 2] == pytest.approx(gradients[:, 2])


def test_stress_in_an_angle_balances_force_and_moments():
    """The stress field of each unit load has exactly its force and
    its moments, about the section's centroid.
    """
    section = measure_section(
        [np.array([[0, 0], [6, 0], [6, 1], [1, 1], [1, 8], [0, 8]], dtype=float)]
    )
    point = np.array([3.0, -2.0, 40.0])
    gradients = stress_gradients(section, point, 5.0)
    # A stress that is linear in x and y: recover its three coefficients from three corners.
    base = np.column_stack([np.ones(6), section.edge_mm])
    for axis in range(3):
        mean, a, b = np.linalg.lstsq(base, gradients[:, axis], rcond=None)[0]
        mx = a * section.second_xy_mm4 + b * section.second_xx_mm4
        my = -(a * section.second_yy_mm4 + b * section.second_xy_mm4)
        arm = point - np.array([*section.centroid_mm, 5.0])
        moment = np.cross(arm, np.eye(3)[axis])
        assert mean * section.area_mm2 == pytest.approx(float(axis == 2), abs=1e-12)
        assert [mx, my] == pytest.approx(moment[:2].tolist(), abs=1e-9)


@pytest.mark.parametrize(
    ("large", "small", "fillet"), [(10, 8, 1.0), (13, 7, 1.0), (10, 9, 0.2), (13, 7, 0.5)]
)
def test_factor_of_a_shoulder_agrees_with_the_older_edition_of_its_source(large, small, fillet):
    h = (large - small) / 2
    q = h / fillet
    s = 2 * h / large
    root = math.sqrt(q)
    if q <= 2:
        c = (0.947 + 1.206 * root - 0.131 * q, 0.022 - 3.405 * root + 0.915 * q)
        c += (0.869 + 1.777 * root - 0.555 * q, -0.810 + 0.422 * root - 0.260 * q)
    else:
        c = (1.232 + 0.832 * root - 0.008 * q, -3.813 + 0.968 * root - 0.260 * q)
        c += (7.423 - 4.868 * root + 0.869 * q, -3.839 + 3.070 * root - 0.600 * q)
    older = sum(value * s**i for i, value in enumerate(c))
    assert shoulder_in_bending(large, small, fillet) == pytest.approx(older, rel=0.02)


def test_factors_at_their_limits():
    assert shoulder_in_bending(8.0, 8.0, 0.5) == shoulder_in_bending(7.0, 8.0, 0.5) == 1.0
    assert shoulder_in_bending(13.0, 7.0, 0.0) == shoulder_in_bending(13.0, 7.0, 0.15)
    fillets = [shoulder_in_bending(13.0, 7.0, r) for r in (0.2, 0.5, 1.0, 2.0, 3.0)]
    assert fillets == sorted(fillets, reverse=True)
    assert hole_in_tension(0.0, 7.0) == 3.0
    assert hole_in_tension(3.5, 7.0) == pytest.approx(3 - 1.565 + 0.915 - 0.19125)


ROUND = {"post_width_mm": 7.0, "post_height_mm": 7.0, "post_length_mm": 8.0} | {
    "cross_bolt_diameter_mm": 2.2,
    "foot_radius_mm": 1.5,
}
"""A thin round post."""


def test_knock_on_the_bone_alone_on_the_pad_alone_and_on_both() -> None:
    """The spring F = v sqrt(k m); the pad F = c d^2, stated at 50 N,
    whose energy is F d / 3; and both energies.
    """
    mass_kg = 0.4
    speed_m_s = 0.5
    bone = Springs(0.0, 30.0)
    assert bone.force_n(mass_kg, speed_m_s) == pytest.approx(0.5 * math.sqrt(30e3 * 0.4))
    assert bone.speed_m_s(mass_kg, bone.force_n(mass_kg, speed_m_s)) == pytest.approx(speed_m_s)
    pad = Springs(1.2, 1e9)
    constant = 50.0 / 1.2e-3**2
    depth_m = (3 * 0.05 / constant) ** (1 / 3)
    assert pad.force_n(mass_kg, speed_m_s) == pytest.approx(constant * depth_m**2, rel=1e-4)
    both = Springs(1.2, 30.0)
    force_n = both.force_n(mass_kg, speed_m_s)
    assert force_n**2 / 60e3 + force_n * math.sqrt(force_n / constant) / 3 == pytest.approx(0.05)
    assert both.speed_m_s(mass_kg, force_n) == pytest.approx(speed_m_s)


def test_stiffness_of_the_post_is_that_of_a_beam() -> None:
    """A straight bar from z = 0 to 40 mm under a force at its end: 3 E I / L^3."""
    section = measure_section([circle(4.0)])
    none = StressFactors()
    cuts = [((i + 0.5) * 0.1, section, none) for i in range(400)]
    found = assess._bending_stiffness(DESIGN, 40.0, cuts)
    assert found == pytest.approx(3 * 2000.0 * math.pi / 4 * 4.0**4 / 40.0**3, rel=1e-4)


def test_pin_limits_a_knock_and_shears_across_both_ends() -> None:
    stated = DESIGN.strength.model_copy(update={"knock_speed_m_s": 1.0})
    weak = assess.Weakness("eye", 0.0, 1.0)
    springs = Springs(1.2, 100.0)
    held = assess.Knock(weak, springs, 30.0, 20.0)
    assert held.safety_factor(stated) == 1.5
    assert assess.Knock(weak, springs, 30.0, math.inf).safety_factor(stated) < 0.5
    joint = Design.load("adult_finger", changes={"hand.pin": "printed"})
    (shear,) = (
        found.stress_per_n
        for found in interface_of(joint).local_stresses(joint, 25.0)
        if found.place == PIN
    )
    lever = 2 / 3 * stop_height_mm(joint)
    pull = (25.0 + joint.bone.base_length_mm) / lever + 1.0
    assert shear == pytest.approx(
        math.sqrt(3.0) * pull / (2 * math.pi / 4 * (joint.hand.pin_diameter_mm - 0.1) ** 2)
    )


@pytest.mark.parametrize("material", ["petg", "durable"])
def test_loads_that_a_weak_material_holds_pass_as_one_line(material: str) -> None:
    heavy = [
        "strength.grip_force_n=60",
        "strength.knock_speed_m_s=2",
        f"strength.print_material={material}",
    ]
    design = Design.load("first_finger", changes=heavy)
    grip, knock = check_strength(design, Solids.of(design, MeshEvaluator(0.02), ("bone",)))
    assert not grip.passed
    assert not knock.passed
    assert grip.remedy == knock.remedy
    assert f"it passes with --set {grip.remedy}; or" in describe_cause(grip)
    lighter = Design.load("first_finger", changes=[*heavy, *grip.remedy.split(" --set ")])
    for check in check_strength(lighter, Solids.of(lighter, MeshEvaluator(0.02), ("bone",))):
        assert check.limit <= check.value < 1.12 * check.limit


def test_own_material_holds_what_its_figures_say() -> None:
    own = {
        "print_material": "own",
        "own_label": "PLA",
        "own_strength_mpa": 50.0,
        "own_modulus_mpa": 2000.0,
    }
    petg = strength_of()
    strong = strength_of(strength=own)
    assert strong.breaks_n == pytest.approx(2 * petg.breaks_n)
    assert strong.knock_m_s > 1.5 * petg.knock_m_s
    assert "PLA" in describe_loads(strong)
    assert strength_data(strong)["material"] == "own"


def test_nominal_stress_of_the_post_is_that_of_the_beam():
    """Just below its foot, where neither hole nor socket acts, without the factor of the foot."""
    design = Design(bone=ROUND)
    sections = dict(assess._cut(design, MeshEvaluator(0.005), assess.STATIONS))
    bone = design.bone
    foot = interface_of(design).foot_length(design)
    z = max(z for z in sections if z < -bone.base_length_mm - foot)
    apex = assess.list_load_points(design)["apex"]
    cut = (z, sections[z], assess._find_concentration(design, z))
    (weakness,) = assess._find_weakest_section(design, apex, [cut])
    share = (z + bone.base_length_mm + bone.post_length_mm) / (bone.post_length_mm - foot)
    nominal = (34.0 - z) * share * 32 / (math.pi * 7.0**3)
    assert weakness.stress_per_n / weakness.concentration == pytest.approx(nominal, rel=0.02)
    assert 1.4 < weakness.concentration < 2.0


def test_flange_bends_as_a_plate_between_base_and_bolts():
    """Under a load from the side one bolt pulls and the other
    presses; both strips bend at the base.
    """
    flange = {
        "interface": "flange",
        "base_length_mm": 26.0,
        "flange_thickness_mm": 1.5,
        "foot_radius_mm": 1.5,
    }
    flange |= {"flange_width_mm": 28.0, "flange_spacing_x_mm": 22.0}
    found = strength_of(bone=flange)
    arm = 34.0 + 26.0
    width, height = base_size(Design(bone=flange).dimensions)
    sideways = arm / 22.0 * (22.0 - width) / 2 / (12.0 * 1.5**2 / 6)
    upwards = arm / 6.0 * (12.0 - height) / 2 / (28.0 * 1.5**2 / 6)
    assert found.weakest.z_mm == -24.5
    assert found.weakest.stress_per_n == pytest.approx(math.hypot(sideways, upwards))


def test_flange_with_two_rows_has_the_sizes_that_a_section_shows_and_four_bolts_that_pull():
    changes = (
        "interface=flange",
        "base_length_mm=27",
        "flange_spacing_y_mm=12",
        "flange_height_mm=18",
    )
    design = Design.load(changes=[f"bone.{change}" for change in changes])
    flange = interface_of(design)
    sizes = {size.name: size for size in interface_of(design).sizes(design)}
    (plate, _), holes = shapes_of(design)
    outline, *bores = sorted(
        MeshEvaluator(0.001).manifold(Difference(plate, holes)).slice(-25.0).to_polygons(), key=len
    )
    width, height = np.ptp(outline, axis=0)
    found = [sizes[f"{name} of the flange"].value for name in ("width", "height", "bolt holes")]
    assert found == pytest.approx([width, height, np.ptp(bores[0], axis=0)[0]], abs=0.003)
    centres = [tuple(np.round((ring.min(axis=0) + ring.max(axis=0)) / 2, 2)) for ring in bores]
    rows = sizes["spacing of the bolt holes"], sizes["spacing of the rows"]
    assert [size.value for size in rows] == pytest.approx(np.ptp(centres, axis=0))
    assert {tuple(np.round(at[:2], 2)) for size in rows for at in (size.start, size.end)} <= set(
        centres
    )
    assert flange.genus(design) == sizes["bolt holes of the flange"].count == len(bores) == 4
    assert flange.bolt(design) == Bolt(3.0, 10.0, 4.0, 4), (
        "4 mm, a wall of 2.5 mm and a nut of 2.4 mm (ISO 4032)"
    )
    shoulders = zip((width, height), base_size(design.dimensions), strict=True)
    factors = [
        1.15 * shoulder_in_bending(*sizes, design.bone.foot_radius_mm) for sizes in shoulders
    ]
    assert flange.stress_factors(design, -23.0) == StressFactors(*map(pytest.approx, factors)), (
        "1.15 of chords"
    )
    assert flange.stress_factors(design, -23.1) == StressFactors(), "in the plate"
    (stress,) = flange.local_stresses(design, 20.0)
    strips = zip(
        (size.value for size in rows), base_size(design.dimensions), (height, width), strict=True
    )
    wanted = [
        47.0 / span * (span - base) / 2 / (across * 4.0**2 / 6) for span, base, across in strips
    ]
    assert stress.stress_per_n == pytest.approx(math.hypot(*wanted), rel=1e-3)


@pytest.mark.full
def test_report_and_command_state_the_strength(tmp_path):
    done = run_fingertip(
        "build", "fsr400", "--formats", "stl", "--parts", "bone", "--out", tmp_path / "b", "-q"
    )
    assert done.returncode == 0, done.stderr
    found = assess_strength(DESIGN, MeshEvaluator(0.01))
    assert f"breaks at {found.breaks_n:.0f} N (PETG" in done.stdout
    report = json.loads((tmp_path / "b" / "report.json").read_text())["strength"]
    assert report["grip_safety_factor"] == pytest.approx(found.grip_safety_factor, rel=0.02)
    assert report["loads"]["breaks_n"] == round(found.breaks_n)
    assert report["weakest"]["load"] == found.weakest.load == "apex"
    skin = run_fingertip(
        "build", "fsr400", "--formats", "stl", "--parts", "skin", "--out", tmp_path / "s", "-q"
    )
    assert "breaks at" not in skin.stdout
    assert "strength" not in json.loads((tmp_path / "s" / "report.json").read_text())


@pytest.mark.full
def test_sections_agree_with_the_exact_solid():
    """cadquery cuts the B-rep solid at some heights and measures the faces."""
    cq = pytest.importorskip("cadquery")
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    from fingertip import part_solid

    solid = part_solid(DESIGN, "bone")
    mesh = MeshEvaluator(0.002).manifold(PARTS["bone"].solid(DESIGN))
    for z in (-26.0, -19.0, -10.0, -3.0, 10.0, 20.0):
        box = (
            cq.Workplane("XY")
            .rect(60, 60)
            .extrude(1e-3)
            .val()
            .moved(cq.Location(cq.Vector(0, 0, z)))
        )
        properties = GProp_GProps()
        BRepGProp.VolumeProperties_s(solid.intersect(box).wrapped, properties, 1e-6, False, False)
        section = measure_section([np.asarray(p) for p in mesh.slice(z + 5e-4).to_polygons()])
        assert section.area_mm2 == pytest.approx(properties.Mass() / 1e-3, rel=5e-3)
        matrix = properties.MatrixOfInertia()  # about the centre of mass
        thin = 1e-3
        assert section.second_xx_mm4 == pytest.approx(matrix.Value(1, 1) / thin, rel=5e-3)
        assert section.second_yy_mm4 == pytest.approx(matrix.Value(2, 2) / thin, rel=5e-3)
