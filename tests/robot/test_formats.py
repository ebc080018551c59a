"""Values in the written models, read as XML: joints and places
of a cube, and the law of its contact.
"""

from __future__ import annotations

import math
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from fingertip import Design
from fingertip.cad.kernel.mesh import Mesh
from fingertip.design.finger_set import load_set
from fingertip.pad.response import Pad
from fingertip.robot.contact import FORCES_N, ContactLaw, fit_contact
from fingertip.robot.finger_model import (
    Body,
    CollisionShape,
    FingerModel,
    Joint,
    SensorSite,
    Strand,
    measure_inertia,
)
from fingertip.robot.formats import Placed, render_model
from fingertip.robot.tactile_mesh import TactileMesh
from fingertip.sim.contact.surface_files import SURFACES
from fingertip.tasks.robot_files import _place
from tests.robot.test_model import numbers

CORNERS = np.array([[x, y, z] for x in (0.0, 10.0) for y in (0.0, 10.0) for z in (0.0, 10.0)])
FACES = np.array(
    [
        [0, 1, 3],
        [0, 3, 2],
        [4, 6, 7],
        [4, 7, 5],
        [0, 4, 5],
        [0, 5, 1],
        [2, 3, 7],
        [2, 7, 6],
        [0, 2, 6],
        [0, 6, 4],
        [1, 5, 7],
        [1, 7, 3],
    ]
)
CUBE = Mesh(CORNERS, FACES)
GRAY = (0.5, 0.5, 0.5)
CONTACT = ContactLaw(0.02, 2.0, 1e-3, 5e3, 7.0, 0.03, (), (), 25.0, 9e3, 0.4, 5e-4)
OFFSET_M = (0.001, 0.002, 0.003)
FINGER = FingerModel(
    name="cube",
    bodies=(Body("bone", CUBE, 2.0, GRAY),),
    inertia=measure_inertia((Body("bone", CUBE, 2.0, GRAY),), OFFSET_M),
    offset_m=OFFSET_M,
    tip_m=(0.0, 0.0, 0.03),
    joint=Joint(turns=True, travel_deg=60.0, stop_moment_n_m=0.7),
    sensor=SensorSite(
        middle_m=(0.0, -0.004, 0.02),
        active_radius_m=0.0025,
        below_skin_m=0.003,
        taxels=TactileMesh(CORNERS[:3], np.tile([0.0, -1.0, 0.0], (3, 3)), FACES[:1]),
    ),
    collision=CollisionShape(pieces=(CUBE,), error_mm=0.1),
    contact=CONTACT,
    stub=Body("hand_stub", CUBE, 1.0, GRAY),
    strands=(Strand((0.006, -0.005, -0.008), (0.006, -0.001, 0.006), 0.0044),),
)


def read(finger: FingerModel, file_format: str, x_m: float = 0.0) -> ElementTree.Element:
    return ElementTree.fromstring(
        render_model("hand", [Placed("index", finger, "f_", x_m)], file_format, "made here")
    )


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("turns", "travel_deg", "kind"),
    [(True, 60.0, "revolute"), (True, 0.0, "continuous"), (False, 0.0, "fixed")],
)
def test_the_joint_is_of_its_kind_with_its_stops(turns: bool, travel_deg: float, kind: str) -> None:
    joint = Joint(turns, travel_deg, FINGER.joint.stop_moment_n_m)
    finger = replace(FINGER, joint=joint, stub=FINGER.stub if turns else None)
    robot = read(finger, "urdf", 0.02)
    scene = read(finger, "mjcf", 0.02)
    joints = {joint.get("name"): joint for joint in robot.iter("joint")}
    joint = joints["index_joint"]
    ends = [
        (one.find("parent").get("link"), one.find("child").get("link"))
        for one in robot.iter("joint")
    ]
    first = ("hand_interface", "index_hand_stub") if turns else ("hand_interface", "index")
    assert joint.get("type") == kind
    assert ends[0] == first
    assert ends[-2:] == [("index", "index_tip"), ("index", "index_sensor")]
    assert numbers(joints[f"{first[1]}_joint"].find("origin").get("xyz")).tolist() == [
        0.02,
        0.0,
        0.0,
    ]
    assert numbers(joints["index_sensor_joint"].find("origin").get("rpy")) == pytest.approx(
        [math.pi / 2, 0.0, 0.0]
    )
    limit = joint.find("limit")
    hinge = scene.find("worldbody/body/joint")
    if kind == "revolute":
        assert limit.attrib == {
            "lower": "0",
            "upper": "1.04719755",
            "effort": "0.7",
            "velocity": "10",
        }
        assert hinge.get("range") == "0 1.04719755"
    else:
        assert limit is None
        assert hinge is None or "range" not in hinge.attrib
    axes = [one.get("xyz") for one in robot.iter("axis")] + [
        one.get("axis") for one in scene.iter("joint")
    ]
    assert axes == ["1 0 0"] * (2 * turns)


@pytest.mark.parametrize("turns", [True, False])
def test_every_link_states_its_mass_and_the_stub_that_of_its_mesh(turns: bool) -> None:
    """A cube of 10 mm weighs 2 g as the finger, and 1 g as the stub."""
    joint = replace(FINGER.joint, turns=turns)
    finger = replace(FINGER, joint=joint, stub=FINGER.stub if turns else None)
    robot = read(finger, "urdf")
    scene = read(finger, "mjcf")
    masses = {
        link.get("name"): float(link.find("inertial/mass").get("value"))
        for link in robot.iter("link")
    }
    frames = dict.fromkeys(("hand_interface", "index_tip", "index_sensor"), 1e-9)
    expected = {"index": 2e-3, **({"index_hand_stub": 1e-3} if turns else {})}
    assert masses == pytest.approx({**frames, **expected})
    moments = {
        link.get("name"): float(link.find("inertial/inertia").get("ixx"))
        for link in robot.iter("link")
    }
    about_middle = {name: mass_kg * 0.01**2 / 6 for name, mass_kg in expected.items()}
    assert moments == pytest.approx({**dict.fromkeys(frames, 1e-12), **about_middle})
    in_mjcf = {
        body.get("name"): float(body.find("inertial").get("mass")) for body in scene.iter("body")
    }
    assert in_mjcf == pytest.approx(expected)


def test_frames_meshes_and_the_touched_pieces_are_in_their_places() -> None:
    scene = read(FINGER, "mjcf", -0.01)
    finger, stub = scene.findall("worldbody/body")
    assert finger.get("pos") == stub.get("pos") == "-0.01 0 0"
    sites = {site.get("name"): site for site in finger.iter("site")}
    places = {"tip": [0.0, 0.0, 0.03], "sensor": [0.0, -0.004, 0.02], "touch": [0.0, -0.007, 0.02]}
    for name, place in places.items():
        assert numbers(sites[f"index_{name}"].get("pos")) == pytest.approx(place)
    assert numbers(sites["index_touch"].get("size")).tolist() == [0.0025, 0.003]
    assert numbers(sites["index_contact"].get("size")).tolist() == [0.06]
    horn = next(geom for geom in finger.iter("geom") if geom.get("type") == "cylinder")
    assert numbers(horn.get("fromto")) == pytest.approx(
        [0.0055, -0.001, 0.006, 0.0065, -0.001, 0.006]
    )
    assert numbers(horn.get("size")).tolist() == [0.0044]
    assert numbers(sites["index_strand_1_side"].get("pos")) == pytest.approx(
        [0.006, -0.0054, 0.0104]
    )
    assert numbers(sites["index_strand_1_end"].get("pos")) == pytest.approx([0.006, 0.0034, 0.0104])
    geoms = {geom.get("name"): geom for geom in finger.iter("geom")}
    assert geoms["index_bone"].get("rgba") == "0.5 0.5 0.5 1"
    assert (geoms["index_bone"].get("contype"), geoms["index_collision_1"].get("contype")) == (
        "0",
        None,
    )
    assert geoms["index_collision_1"].get("pos") == "0.001 0.002 0.003"
    assert {mesh.get("file") for mesh in scene.iter("mesh")} == {
        "f_bone.stl",
        "f_collision_1.stl",
        "f_hand_stub.stl",
        None,
    }
    taxels = next(mesh for mesh in scene.iter("mesh") if mesh.get("vertex"))
    assert numbers(taxels.get("vertex"))[:6] == pytest.approx(
        [0.001, 0.002, 0.003, 0.001, 0.002, 0.013]
    )
    assert [sensor.get("site") for sensor in scene.findall("sensor/touch")] == [
        "index_touch",
        "index_contact",
    ]


def test_the_contact_holds_the_forces_of_the_pad_by_the_formula_of_mujoco() -> None:
    """F = s r d^2 / (dmax^2 (1 - d) w), with d = dmin + (dmax - dmin) (1 - (1 - r /
    width)^power).
    """
    law = fit_contact(Design.load("fsr400"))
    geom = next(
        one
        for one in read(replace(FINGER, contact=law), "mjcf").iter("geom")
        if one.get("condim") == "4"
    )
    (stiffness, damping), (least, most, width, _, power) = (
        numbers(geom.get(key)) for key in ("solref", "solimp")
    )
    depth_m = 1e-3 * np.array(law.depths_mm)
    inverse_mass = law.inverse_mass_per_kg
    impedance = least + (most - least) * (1.0 - (1.0 - depth_m / width) ** power)
    force_n = -stiffness * depth_m * impedance**2 / (most**2 * (1.0 - impedance) * inverse_mass)
    assert force_n == pytest.approx(law.forces_n, rel=1e-6)
    assert force_n == pytest.approx(FORCES_N, rel=law.error + 1e-6)
    assert max(abs(force_n / FORCES_N - 1.0)) == pytest.approx(law.error, rel=0.1)
    # The damper of a damping ratio of 0.15 at 1 N: 2 zeta sqrt(slope w) = impedance damping / dmax
    at_1_n = float(np.interp(1.0, FORCES_N, impedance))
    ratio = -damping * at_1_n / most / (2 * math.sqrt(law.pad_stiffness_n_per_m * inverse_mass))
    assert ratio == pytest.approx(0.15, rel=1e-6)
    friction = SURFACES["smooth"].friction.mu_c
    radius_m = Pad.from_design(Design.load("fsr400")).patch_radius_m(1.0)
    assert law.torsion_m == pytest.approx(2 / 3 * friction * radius_m), "a disk under even pressure"
    assert numbers(geom.get("friction")) == pytest.approx([friction, law.torsion_m, 1e-4])


def test_fingers_stand_about_the_middle_with_five_millimetres_between_the_widest_skins() -> None:
    hand = load_set("adult_hand")
    step_m = 1e-3 * (5.0 + max(design.skin.width_mm for design in hand.designs.values()))
    for side, sign in (("left", 1.0), ("right", -1.0)):
        places_m = _place(replace(hand, side=side))
        assert list(places_m.values()) == pytest.approx([sign * i * step_m for i in range(-2, 3)])
        assert list(places_m) == [finger for finger, _ in hand.fingers]
