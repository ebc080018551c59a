"""Clevis: presets pass every check, the joint moves as stated, and the tendon lies in its groove
and on its horns.
"""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
from manifold3d import CrossSection

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.verification.strength import assess_strength
from fingertip.catalogues.file_kinds import PRESETS
from fingertip.design import Design
from fingertip.design.formulas.stress_and_knock import OF_CHORDS, pin_peak, shoulder_in_bending
from fingertip.design.interfaces import clevis, clevis_rules, interface_of
from fingertip.models import clevis as clevis_models
from fingertip.models.joint import Joint
from fingertip.models.parts import PARTS, parts_by_name
from fingertip.models.solids import cylinder, union
from tests.cad.part_checks import run_all_checks
from tests.conftest import design_file

MATERIALS = {"petg": 10.0, "durable": 10.0, "clear": 15.0, "surgical_guide": 20.0}
"""Grip that every preset holds at a factor of 2, by the material of the bone [N]."""


def load(name: str, *changes: str) -> Design:
    return Design.load(design_file(name), changes=changes)


@pytest.mark.full
@pytest.mark.parametrize("name", PRESETS)
def test_preset_passes_all_mesh_checks_and_holds_its_loads_in_every_material(name: str) -> None:
    design = load(name)
    stated = design.strength
    assert (stated.min_grip_factor, stated.min_knock_factor) == (2.0, 1.5)
    assert {check.name for check in run_all_checks(design).values() if not check.passed} == set()
    for material, grip_n in MATERIALS.items():
        changed = load(
            name, f"strength.print_material={material}", f"strength.grip_force_n={grip_n}"
        )
        found = assess_strength(changed, MeshEvaluator(0.02))
        assert found.grip_safety_factor >= 2.0
        assert found.knock_safety_factor >= 1.5


@pytest.mark.parametrize("travel_deg", [20.0, 60.0, 90.0, 110.0])
def test_profile_between_the_stops_never_meets_the_shoulder(travel_deg: float) -> None:
    """Every corner stays on the near side of the shoulder, in the frame of the bone, at all angles
    of the travel.
    """
    joint = Joint(
        axis_y=0.0,
        axis_z=0.0,
        pin_radius=1.0,
        radius=4.0,
        clearance=0.3,
        is_fork=True,
        half_width=3.0,
        travel_deg=travel_deg,
        foot=0.0,
    )
    corners = [
        point for point in clevis_models.eye_corners(joint, 20.0) if math.hypot(*point) > 0.0
    ]
    for i in range(101):
        angle = math.radians(travel_deg * i / 100)
        assert max(-y * math.sin(angle) - z * math.cos(angle) for y, z in corners) <= 4.0 + 1e-9
    for angle in (0.0, math.radians(travel_deg)):
        reached = max(-y * math.sin(angle) - z * math.cos(angle) for y, z in corners)
        assert reached == pytest.approx(4.0)


def test_travel_is_free_where_hand_and_finger_do_not_overlap() -> None:
    """Base, collar and hand as quadrants of the middle plane, the hand's turned about the axis of
    the joint.
    """
    whole = load("adult_finger")
    draw = random.Random(7).uniform
    found = list[bool]()
    quadrant = CrossSection.square((200.0, 200.0))
    for _ in range(60):
        sizes = {"hand.axis_height_mm": draw(2.0, 14.0), "bone.collar_length_mm": draw(0.8, 6.0)}
        design = whole.with_values(sizes | {"bone.base_length_mm": draw(8.0, 25.0)})
        dims = design.dimensions
        joint = design.dimensions.joint
        base = quadrant.translate((-dims.base_flat_depth, joint.shoulder_z))
        finger = base + quadrant.translate(
            (-dims.collar.section.palmar, -design.bone.collar_length_mm)
        )
        hand = quadrant.translate((-design.hand.axis_height_mm, -joint.radius - 200.0))
        for angle_deg in (0.0, 30.0, 60.0, 75.0, 90.0):
            shared = finger ^ hand.rotate(-angle_deg).translate((joint.axis_y, joint.axis_z))
            found.append(clevis_rules._is_clear(design, joint, angle_deg))
            assert found[-1] == (shared.area() < 1e-3)
    assert 0.1 < sum(found) / len(found) < 0.9


def test_forces_of_the_joint_follow_from_its_levers() -> None:
    """41.5 mm of lever about the pin against 5.3 mm of the tendon, and two thirds of the stop,
    beside the gap.
    """
    design = load("adult_finger")
    assert clevis.tendon_force_per_n(design, 25.0) == pytest.approx(41.5 / 5.3)
    found = {each.place: each for each in interface_of(design).local_stresses(design, 25.0)}
    section = design.dimensions.collar.section
    joint = design.dimensions.joint
    assert joint
    pull = 41.5 / (2 / 3 * (section.dorsal_height_at(3.8) - joint.axis_y)) + 1.0
    cheek = section.half_width_at(joint.axis_y - 1.5) - joint.half_width
    assert found["end of the eye"].stress_per_n == pytest.approx(
        math.sqrt(3) * pull / (4 * cheek * (5.1 - 1.5))
    )
    assert found["bearing of the pin"].stress_per_n == pytest.approx(
        (41.5 / 5.3 + 1.0) / (2 * cheek * 3.0)
    )
    # Each strand turns by a right angle over a horn that presses 25 MPa at twice the grip of 10 N,
    # with 4 % in reserve.
    assert found["horn of the tendon"].stress_per_n == pytest.approx(25.0 / (1.04 * 2 * 10.0))
    assert not found["horn of the tendon"].at_knock
    # The strands pass the eye 0.4 mm nearer to the pin than the tendon's middle: it is 5.1 mm and
    # 4.9 mm high there.
    at_bore = 3.65 * pin_peak(cheek, 3.0, 200e3 / 2000.0) * pull / (2 * cheek * (5.1 + 4.9 - 3.0))
    assert found["eye"].stress_per_n == pytest.approx(at_bore)


def test_a_steel_pin_presses_more_evenly_and_never_breaks_first() -> None:
    printed = load("adult_finger", "hand.pin=printed")
    steel = load("adult_finger")
    found = {each.place: each for each in interface_of(printed).local_stresses(printed, 25.0)}
    places = {each.place: each for each in interface_of(steel).local_stresses(steel, 25.0)}
    assert set(found) - set(places) == {"pin of the joint", "pin of the joint, by the tendon"}
    # A beam on an elastic bed: rigid in a thin cheek, and in a thick one its end alone presses.
    assert pin_peak(0.1, 2.0, 100.0) == pytest.approx(1.0, abs=1e-3)
    assert pin_peak(30.0, 2.0, 200e3 / 2900.0) == pytest.approx(
        30.0 * (2900.0 / (200e3 * math.pi)) ** 0.25, rel=1e-3
    )
    assert places["eye"].stress_per_n < found["eye"].stress_per_n
    assert assess_strength(steel, MeshEvaluator(0.05)).knock.pin_n == math.inf
    assert "pin" not in parts_by_name(steel)


def test_pressure_on_a_horn_balances_the_pull_at_both_ends_of_its_strand() -> None:
    """Summed up over the quarter circle it is half of the tendon's force, along the finger and
    across it.
    """
    design = load("adult_finger", "hand.tendon_diameter_mm=0.7")
    (horn,) = (
        each for each in interface_of(design).local_stresses(design, 25.0) if "horn" in each.place
    )
    angles = (np.arange(1000) + 0.5) * math.pi / 2 / 1000
    on_part = horn.stress_per_n * 0.7 * design.dimensions.anchor.horn_radius * math.pi / 2 / 1000
    for share in (np.cos(angles), np.sin(angles)):
        assert on_part * share.sum() == pytest.approx(
            clevis.tendon_force_per_n(design, 25.0) / 2, rel=1e-5
        )


def test_eyes_without_stops_have_the_factor_of_a_shoulder_within_two_fillets_of_the_base() -> None:
    design = load(
        "adult_finger", "hand.travel_deg=0", "hand.axis_height_mm=6", "bone.base_length_mm=16.5"
    )
    section = design.dimensions.collar.section
    joint = design.dimensions.joint
    factor = OF_CHORDS * shoulder_in_bending(section.dorsal + section.palmar, 2 * (5.4 - 0.3), 1.5)
    for out_mm, wanted in ((-0.1, 1.0), (0.0, factor), (2.9, factor), (3.1, 1.0)):
        found = interface_of(design).stress_factors(design, joint.shoulder_z - out_mm)
        assert (found.width, found.height) == pytest.approx((1.0, wanted)), "as wide as the base"


@pytest.mark.parametrize("name", ["adult_finger", "child_finger"])
def test_strands_lie_in_groove_and_on_horns(name: str) -> None:
    """Beside the base and below the horns a strand has room, and one that is 0.2 mm nearer cuts
    into the bone.
    """
    design = load(name)
    anchor = design.dimensions.anchor
    joint = design.dimensions.joint
    bone = PARTS["bone"].solid(design)
    assert anchor
    assert joint
    evaluator = MeshEvaluator(0.02)
    solid = evaluator.manifold(bone)
    strands = evaluator.manifold(union(*clevis_models.strands(design, anchor, joint.low_z)))
    assert (strands ^ solid).volume() == pytest.approx(0.0, abs=1e-3)
    for shift in ((0.0, 0.0, -0.2), (0.0, 0.2, 0.0)):
        assert (strands.translate(shift) ^ solid).volume() > 0.05
    # Along the middle of the horn the tendon just touches the bone: its own radius away from the
    # surface.
    for angle in (0.3, 0.8, 1.3):
        at = (
            anchor.horn_y + 4.0 - 4.0 * math.cos(angle),
            anchor.horn_low_z + 4.0 * math.sin(angle),
        )
        inside, outside = (
            evaluator.manifold(
                cylinder(
                    "x",
                    (at[0] + d * math.cos(angle), at[1] - d * math.sin(angle)),
                    anchor.half_width + 0.1,
                    anchor.half_width + anchor.line,
                    0.02,
                )
            )
            for d in (0.1, -0.1)
        )
        assert (inside ^ solid).volume() == pytest.approx(inside.volume(), rel=1e-3)
        assert (outside ^ solid).volume() == 0.0


def test_bone_beside_a_slot_is_blunt_up_to_where_it_is_as_thick_as_a_wall() -> None:
    design = Design.load("adult_finger")
    collar = design.dimensions.collar
    z = -design.bone.collar_length_mm / 2
    for half in (6.0, 6.5, 7.0):
        y = design.dimensions.blunt_up_to_y(half, z, collar)
        assert y is not None
        assert collar.half_width_at(y, z) == pytest.approx(half + design.bone.wall_mm, abs=1e-6)
        assert 0.0 < y < collar.section.dorsal
    assert design.dimensions.blunt_up_to_y(4.0, z, collar) is None, (
        "near the middle the edge above is blunt"
    )


def test_bone_of_a_joint_without_a_tendon_ends_where_its_skin_begins() -> None:
    design = load("adult_finger", "hand.tendon_distance_mm=0")
    evaluator = MeshEvaluator(0.1)
    bone, skin = (evaluator.manifold(PARTS[part].solid(design)) for part in ("bone", "skin"))
    assert (bone ^ skin).volume() == pytest.approx(0.0, abs=1e-3)
