"""Mass, inertia, frames and collision pieces of the written models,
against meshes and readers of other libraries.
"""

from __future__ import annotations

import math
from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from fingertip import Design
from fingertip.cad.convert import part_mesh
from fingertip.cad.kernel.mesh import MeshEvaluator, to_arrays, to_manifold
from fingertip.models.outline import skin_outline
from fingertip.pad.pad_geometry import PadForm
from fingertip.robot.collision_pieces import cut_skin
from fingertip.robot.contact import fit_contact
from tests.conftest import ROOT, run_fingertip, some_of
from tests.robot.conftest import DESIGNS, INSTALL, Model
from tests.tools import require_module


def sample(points: np.ndarray) -> np.ndarray:
    """Points near the middle plane, where the skin is hollow, and a few others."""
    return np.concatenate([points[np.abs(points[:, 0]) < 0.3], points[::20]])


OTHERS = ("fsr402", "article")


def numbers(text: str | None) -> np.ndarray:
    return np.array([float(word) for word in (text or "").split()])


@pytest.mark.second
def test_mass_and_inertia_are_the_integrals_of_trimesh_over_the_written_files(model: Model) -> None:
    trimesh = require_module("trimesh")
    mass = 0.0
    first = np.zeros(3)
    about = np.zeros((3, 3))
    for name, (density, _) in model.figures["parts"].items():
        mesh = trimesh.load(model.folder / f"{name}.stl")
        assert mesh.is_watertight
        mesh.apply_scale(1e-3)
        mesh.apply_translation(model.figures["offset_m"])
        mesh.density = 1e3 * density
        at = mesh.center_mass
        own = mesh.mass
        mass = mass + own
        first = first + own * at
        about += mesh.moment_inertia + own * (at @ at * np.eye(3) - np.outer(at, at))
    centre = first / mass
    about -= mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    inertial = ElementTree.parse(model.folder / "finger.xml").find("worldbody/body/inertial")
    assert inertial is not None
    written = numbers(inertial.get("fullinertia"))[[0, 3, 4, 3, 1, 5, 4, 5, 2]].reshape(3, 3)
    assert float(inertial.get("mass", "")) == pytest.approx(mass, rel=1e-6)
    assert numbers(inertial.get("pos")) == pytest.approx(
        centre, abs=1e-6 * float(np.linalg.norm(centre))
    )
    assert written == pytest.approx(about, abs=1e-6 * float(np.trace(about)))


def test_densities_are_those_of_the_catalogues_and_volumes_those_of_the_parts(model: Model) -> None:
    parts = model.figures["parts"]
    for name, density_g_cm3 in (("bone", 1.27), ("skin", 1.18)):
        assert parts[name][0] == density_g_cm3
        exact_g = 1e-3 * parts[name][0] * part_mesh(model.design, name, 0.005).volume()
        assert parts[name][1] == pytest.approx(exact_g, rel=5e-3)
    assert ("joint_pin" in parts, "cross_bolt" in parts) in ((True, False), (False, True))
    assert model.figures["mass_kg"] == pytest.approx(
        1e-3 * sum(mass for _, mass in parts.values()), rel=1e-5
    )


def test_frames_are_at_pin_or_base_at_the_tip_and_on_the_sensor(model: Model) -> None:
    """In the axes of the design these places follow from its parameters."""
    design, form = model.design, PadForm.of_design(model.design)
    tip, sensor = (
        1e3 * (np.array(model.figures[name]) - model.figures["offset_m"])
        for name in ("tip_m", "sensor_m")
    )
    assert tip == pytest.approx([0.0, 0.0, design.skin.length_mm], abs=1e-3)
    assert sensor == pytest.approx([0.0, -form.platform_mm, form.sensor_z_mm], abs=1e-3)
    from_base_mm = design.hand.clearance_radius_mm if design.bone.interface == "clevis" else 0.0
    assert 1e3 * model.figures["offset_m"][2] == pytest.approx(
        design.bone.base_length_mm, abs=from_base_mm + 1e-3
    )
    # The pin of a joint is the axis of the interface, and a cross bolt crosses it.
    held = next(name for name in ("joint_pin", "cross_bolt") if name in model.figures["parts"])
    middle = require_module("trimesh").load(model.folder / f"{held}.stl").bounds.mean(axis=0)
    in_frame = 1e-3 * middle + model.figures["offset_m"]
    assert in_frame[: 3 if held == "joint_pin" else 2] == pytest.approx(0.0, abs=1e-6)
    hinge = ElementTree.parse(model.folder / "finger.xml").find(".//joint")
    travel = [] if hinge is None else numbers(hinge.get("range")).tolist()
    assert travel == pytest.approx(
        [] if hinge is None else [0.0, math.radians(design.hand.travel_deg)]
    )
    assert (hinge is not None) == (design.bone.interface == "clevis")
    skin = (form.skin_mm(np.zeros(1), np.array([form.sensor_z_mm]))[0] + sensor[1]) / 1e3
    site = ElementTree.parse(model.folder / "finger.xml").find(".//site[@type='cylinder']")
    assert site is not None
    assert numbers(site.get("size")) == pytest.approx([form.active_radius_mm / 1e3, skin], abs=1e-6)


@pytest.mark.parametrize(
    "name", some_of([path.stem for path in sorted((ROOT / "params").glob("*.toml"))], *DESIGNS)
)
def test_the_contact_is_within_four_percent_of_the_pad(name: str) -> None:
    assert fit_contact(Design.load(name)).error < 0.04  # as the docs say


@pytest.mark.parametrize(
    "name", [*DESIGNS[:1], *(pytest.param(name, marks=pytest.mark.full) for name in OTHERS)]
)
def test_pieces_are_convex_and_as_near_to_the_skin_as_stated(name: str) -> None:
    """Distances by trimesh, from the skin to the pieces
    together and back; the cut faces lie inside.
    """
    trimesh = require_module("trimesh")
    design = Design.load(name)
    pieces, error_mm = cut_skin(design)
    for piece in pieces:
        assert piece.volume() == pytest.approx(ConvexHull(piece.vertices).volume, rel=1e-7)
    solids = [to_manifold(piece.vertices, piece.triangles) for piece in pieces]
    solids = [sum(solids[1:], start=solids[0]), MeshEvaluator(0.02).manifold(skin_outline(design))]
    both = [trimesh.Trimesh(*to_arrays(solid)) for solid in solids]
    found = [
        float(trimesh.proximity.closest_point_naive(surface, sample(other.vertices))[1].max())
        for surface, other in (both, both[::-1])
    ]
    assert max(found) < error_mm + 0.03  # tolerance of the mesh that stands for the skin here
    assert max(found) > error_mm - 0.03


@pytest.mark.full
@pytest.mark.usefixtures("readers")
def test_urdf_and_mjcf_hold_the_same_finger_for_three_readers(
    model: Model, capfd: pytest.CaptureFixture[str]
) -> None:
    yourdfpy = require_module("yourdfpy", INSTALL)
    urdf = require_module("urdf_parser_py.urdf", INSTALL)
    name = model.design.name
    path = model.folder / "finger.urdf"
    robot = yourdfpy.URDF.load(str(path))
    parsed = urdf.URDF.from_xml_file(str(path))
    assert capfd.readouterr() == ("", "")
    link = parsed.link_map[name]
    figures = model.figures
    assert (link.inertial.mass, robot.link_map[name].inertial.mass) == pytest.approx(
        [figures["mass_kg"]] * 2, rel=1e-5
    )
    moments = link.inertial.inertia
    found = [moments.ixx, moments.iyy, moments.izz, moments.ixy, moments.ixz, moments.iyz]
    assert found == pytest.approx(figures["moments_kg_m2"], rel=1e-5, abs=1e-15)
    assert len(link.collisions) == figures["collision_pieces"]
    is_held = model.design.bone.interface == "clevis"
    assert len(link.visuals) == len(figures["parts"]) == len(robot.scene.geometry) - is_held
    assert is_held == (f"{name}_hand_stub" in parsed.link_map)
    scene = robot.scene.bounds
    # Meshes in metres, in their place.
    assert scene[1, 2] == pytest.approx(figures["tip_m"][2], abs=1e-4)
    for frame in ("tip", "sensor"):
        assert robot.get_transform(f"{name}_{frame}", name)[:3, 3] == pytest.approx(
            figures[f"{frame}_m"], abs=1e-7
        )
    assert robot.get_transform(f"{name}_sensor", name)[:3, 2] == pytest.approx(
        [0.0, -1.0, 0.0], abs=1e-7
    )
    joint = parsed.joint_map[f"{name}_joint"]
    if model.design.bone.interface == "clevis":
        assert (joint.type, joint.axis, joint.limit.lower) == ("revolute", [1.0, 0.0, 0.0], 0.0)
        assert joint.limit.upper == pytest.approx(math.radians(model.design.hand.travel_deg))
    else:
        assert joint.type == "fixed"


@pytest.mark.parametrize("model", DESIGNS[:1], indirect=True)
def test_bad_input_is_refused_and_the_same_design_gives_the_same_bytes(
    model: Model, tmp_path
) -> None:
    done = run_fingertip("robot", model.design.name, "--format", "mjfc", "--out", tmp_path / "a")
    assert (done.returncode, done.stdout) == (2, "")
    assert "--format: 'mjfc' is no format of a model; did you mean mjcf?" in done.stderr
    assert not (tmp_path / "a").exists()
    assert run_fingertip("robot", model.design.name, "--out", tmp_path / "b", "-q").returncode == 0
    written = {
        path.name: path.read_bytes()
        for path in (tmp_path / "b").iterdir()
        if path.name != "manifest.json"
    }
    assert written == {name: (model.folder / name).read_bytes() for name in written}
