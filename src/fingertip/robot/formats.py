"""MJCF, the model of MuJoCo, and URDF, that of ROS.

Elements carry the name of their finger: several fit a model.

The fingers of a set stand side by side, as nothing tells where a hand has them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from fingertip.models.solids import Point3
from fingertip.robot.finger_model import (
    Body,
    FingerModel,
    Inertia,
    Joint,
    Strand,
    measure_inertia,
)

TIMESTEP_S = 0.0005
MAX_SPEED_RAD_S = 10.0
"""Speed that a joint of URDF has to state. An assumption: no part of the finger limits it."""
FRAME = Inertia(
    mass_kg=1e-9, centre_m=(0.0, 0.0, 0.0), moments_kg_m2=(1e-12, 1e-12, 1e-12, 0.0, 0.0, 0.0)
)
"""Inertia of a link of URDF that is only a frame.

Bullet takes 1 kg where a link states none, and lets no model fall whose first link weighs 0. MuJoCo
refuses moments of 1e-15 kg m2 and less.
"""
_SCALE = "0.001 0.001 0.001"
_HORN_M = 5e-4
"""Half the length of a horn."""


@dataclass(frozen=True, eq=False)
class Placed:
    """Finger at its place in a model."""

    name: str
    finger: FingerModel
    prefix: str = ""
    """First part of the names of its meshes' files."""
    x_m: float = 0.0
    """Place of its interface."""


def render_model(name: str, fingers: Sequence[Placed], file_format: str, comment: str) -> bytes:
    """Render a model of fingers, each held at its interface; `comment` stands ahead of it."""
    root = _build_mjcf(name, fingers) if file_format == "mjcf" else _build_urdf(name, fingers)
    root.insert(0, ElementTree.Comment(f" {comment} "))
    ElementTree.indent(root)
    data: bytes = ElementTree.tostring(root, "utf-8", xml_declaration=True)
    return data + b"\n"


# MJCF


def _build_mjcf(name: str, fingers: Sequence[Placed]) -> Element:
    root = Element("mujoco", model=name)
    SubElement(root, "compiler", angle="radian")
    # Friction creeps otherwise, and a contact of many points would be as many times as stiff.
    option = SubElement(
        root, "option", timestep=f"{TIMESTEP_S:g}", cone="elliptic", impratio="10000"
    )
    SubElement(option, "flag", multiccd="disable")
    asset = SubElement(root, "asset")
    world = SubElement(root, "worldbody")
    tendon = SubElement(root, "tendon")
    sensor = SubElement(root, "sensor")

    # Fingers of one form share their meshes.
    for finger, prefix in {placed.finger: placed.prefix for placed in fingers}.items():
        _add_meshes(asset, finger, prefix)

    for placed in fingers:
        _add_finger(placed, world, sensor)
        if placed.finger.stub:
            _add_stub(placed, placed.finger.stub, world, tendon)

    return root


def _add_meshes(asset: Element, finger: FingerModel, prefix: str) -> None:
    """Add the meshes of a finger: its files, and the taxels as numbers."""
    for mesh in finger.meshes:
        place = {
            "name": f"{finger.name}_{mesh}",
            "file": f"{prefix}{mesh}.stl",
            "scale": _SCALE,
        }
        SubElement(asset, "mesh", place)

    taxels = finger.sensor.taxels
    points_m = 1e-3 * taxels.points_mm + np.array(finger.offset_m)
    SubElement(
        asset,
        "mesh",
        name=f"{finger.name}_taxels",
        inertia="shell",
        vertex=_text(points_m.ravel()),
        normal=_text(taxels.normals.ravel()),
        face=_text(taxels.triangles.ravel()),
    )


_SEEN = {"contype": "0", "conaffinity": "0", "group": "2"}
"""Attributes of a geom that is shown and touches nothing."""
_HIDDEN = {"contype": "0", "conaffinity": "0", "group": "4", "mass": "0"}
"""Attributes of a geom that is neither shown nor touched."""


def _add_finger(placed: Placed, world: Element, sensor: Element) -> None:
    """Add the body of a finger with its joint, shapes, sites and sensors."""
    finger = placed.finger
    body = SubElement(world, "body", name=placed.name)
    if placed.x_m:
        body.set("pos", _text((placed.x_m, 0.0, 0.0)))

    _add_inertial(body, finger.inertia)
    if finger.joint.turns:
        _add_hinge(body, f"{placed.name}_joint", finger.joint)

    _add_shapes(body, placed)
    _add_sites(body, placed)
    _add_sensors(body, placed, sensor)


def _add_hinge(body: Element, name: str, joint: Joint) -> None:
    attributes = {"name": name, "type": "hinge", "axis": "1 0 0"}
    if joint.travel_deg:
        attributes["range"] = f"0 {_text([math.radians(joint.travel_deg)])}"

    SubElement(body, "joint", attributes)


def _add_shapes(body: Element, placed: Placed) -> None:
    """Add the parts, which are seen, and the collision pieces, which are touched."""
    finger = placed.finger
    contact = finger.contact
    touched = {
        "condim": "4",
        "friction": _text((contact.friction, contact.torsion_m, 1e-4)),
        "solmix": "1000000",
        "solref": _text(contact.solref(contact.inverse_mass_per_kg)),
        "solimp": _text(contact.solimp),
        "group": "3",
    }
    seen = {part.name: {**_SEEN, "rgba": _text((*part.colour, 1.0))} for part in finger.bodies}

    for mesh in finger.parts:
        shape = {
            "name": f"{placed.name}_{mesh}",
            "type": "mesh",
            "mesh": f"{finger.name}_{mesh}",
            "pos": _text(finger.offset_m),
            "mass": "0",
        }
        SubElement(body, "geom", {**shape, **seen.get(mesh, touched)})


def _add_sites(body: Element, placed: Placed) -> None:
    """Add tip and sensor as frames, and the volumes in which contacts count as touch."""
    finger = placed.finger
    sensor = finger.sensor
    to_palm = f"{_text([math.pi / 2])} 0 0"
    x, y, z = sensor.middle_m
    through_m = sensor.below_skin_m
    # Points of contact lie near the skin's surface: the site reaches from the active area as far
    # beyond it.
    middle = (x, y - through_m, z)
    over = (sensor.active_radius_m, through_m)
    reach = [2 * finger.tip_m[2]]

    for site, kind, position, size, more in (
        ("tip", "sphere", finger.tip_m, [5e-4], {}),
        ("sensor", "sphere", sensor.middle_m, [5e-4], {"euler": to_palm}),
        ("touch", "cylinder", middle, over, {"euler": to_palm}),
        ("contact", "sphere", finger.tip_m, reach, {}),
    ):
        shape = {
            "name": f"{placed.name}_{site}",
            "type": kind,
            "pos": _text(position),
            "size": _text(size),
            "group": "4",
        }
        SubElement(body, "site", {**shape, **more})


def _add_sensors(body: Element, placed: Placed, sensor: Element) -> None:
    """Add the taxels of the tactile sensor, and the sensors of the force of touch."""
    name = placed.name
    mesh = f"{placed.finger.name}_taxels"
    taxels = {"name": f"{name}_taxels", "type": "mesh", "mesh": mesh, "mass": "0"}
    SubElement(body, "geom", {**taxels, **_SEEN, "group": "4"})
    SubElement(sensor, "tactile", name=f"{name}_tactile", geom=f"{name}_taxels", mesh=mesh)

    for site in ("touch", "contact"):
        SubElement(sensor, "touch", name=f"{name}_{site}", site=f"{name}_{site}")


def _add_inertial(body: Element, inertia: Inertia) -> None:
    SubElement(
        body,
        "inertial",
        pos=_text(inertia.centre_m),
        mass=_text([inertia.mass_kg]),
        fullinertia=_text(inertia.moments_kg_m2),
    )


def _add_stub(placed: Placed, stub: Body, world: Element, tendon: Element) -> None:
    """Add the stub of the hand as a body that stands still, and the strands of the tendon."""
    name = placed.name
    finger = placed.finger
    moved = world.find(f"body[@name='{name}']")
    assert moved is not None
    fixed = SubElement(world, "body", name=f"{name}_{stub.name}", pos=_text((placed.x_m, 0.0, 0.0)))
    _add_inertial(fixed, measure_inertia((stub,), finger.offset_m))
    shape = {
        "name": f"{name}_{stub.name}",
        "type": "mesh",
        "mesh": f"{finger.name}_{stub.name}",
        "pos": _text(finger.offset_m),
    }
    colour = _text((*stub.colour, 1.0))
    SubElement(fixed, "geom", {**shape, **_SEEN, "mass": "0", "rgba": colour})

    for i, strand in enumerate(finger.strands, 1):
        path = f"{name}_strand_{i}"
        _add_strand_sites(path, strand, fixed, moved)
        spatial = SubElement(tendon, "spatial", name=path, width="4e-4")
        SubElement(spatial, "site", site=f"{path}_guide")
        SubElement(spatial, "geom", geom=f"{path}_horn", sidesite=f"{path}_side")
        SubElement(spatial, "site", site=f"{path}_end")


def _add_strand_sites(path: str, strand: Strand, fixed: Element, moved: Element) -> None:
    """Add the points through which a strand runs, and the horn on which it lies."""
    x, y, z = strand.horn_m
    radius = strand.radius_m

    for body, site, at_m in (
        (fixed, "guide", strand.guide_m),
        (moved, "side", (x, y - radius, z + radius)),
        (moved, "end", (x, y + radius, z + radius)),
    ):
        SubElement(
            body,
            "site",
            name=f"{path}_{site}",
            pos=_text(at_m),
            size="5e-4",
            group="4",
        )

    horn = {
        "name": f"{path}_horn",
        "type": "cylinder",
        "fromto": f"{_text((x - _HORN_M, y, z))} {_text((x + _HORN_M, y, z))}",
        "size": _text([radius]),
    }
    SubElement(moved, "geom", {**horn, **_HIDDEN})


# URDF


def _build_urdf(name: str, fingers: Sequence[Placed]) -> Element:
    root = Element("robot", name=name)
    _add_link(root, f"{name}_interface", FRAME)
    for placed in fingers:
        _add_links(placed, root, f"{name}_interface")

    return root


def _add_links(placed: Placed, robot: Element, parent: str) -> None:
    """Add the links of a finger, of the stub that carries it, and of its frames."""
    name = placed.name
    finger = placed.finger
    link = _add_link(robot, name, finger.inertia)
    colours = {part.name: part.colour for part in finger.bodies}

    for mesh in finger.parts:
        _add_mesh(
            link,
            kind="visual" if mesh in colours else "collision",
            placed=placed,
            mesh=mesh,
            colour=colours.get(mesh),
        )

    at_m = (placed.x_m, 0.0, 0.0)
    if finger.stub:
        _add_stub_link(placed, finger.stub, robot, parent)
        parent = f"{name}_{finger.stub.name}"
        at_m = (0.0, 0.0, 0.0)

    joint = _join(robot, kind=_name_joint(finger.joint), parent=parent, child=name, at_m=at_m)
    _limit_joint(joint, finger.joint)

    for frame, position_m, turn in (
        ("tip", finger.tip_m, 0.0),
        ("sensor", finger.sensor.middle_m, math.pi / 2),
    ):
        _add_link(robot, f"{name}_{frame}", FRAME)
        _join(
            robot,
            kind="fixed",
            parent=name,
            child=f"{name}_{frame}",
            at_m=position_m,
            turn=turn,
        )


def _add_stub_link(placed: Placed, stub: Body, robot: Element, parent: str) -> None:
    name = f"{placed.name}_{stub.name}"
    link = _add_link(robot, name, measure_inertia((stub,), placed.finger.offset_m))
    _add_mesh(link, kind="visual", placed=placed, mesh=stub.name, colour=stub.colour)
    _join(robot, kind="fixed", parent=parent, child=name, at_m=(placed.x_m, 0.0, 0.0))


def _name_joint(joint: Joint) -> str:
    """Return the type of a joint in URDF."""
    if not joint.turns:
        return "fixed"

    return "revolute" if joint.travel_deg else "continuous"


def _limit_joint(element: Element, joint: Joint) -> None:
    if joint.turns:
        SubElement(element, "axis", xyz="1 0 0")

    if joint.travel_deg:
        SubElement(
            element,
            "limit",
            lower="0",
            upper=_text([math.radians(joint.travel_deg)]),
            effort=_text([joint.stop_moment_n_m]),
            velocity=_text([MAX_SPEED_RAD_S]),
        )


def _add_link(robot: Element, name: str, inertia: Inertia) -> Element:
    link = SubElement(robot, "link", name=name)
    inertial = SubElement(link, "inertial")
    _place(inertial, inertia.centre_m)
    SubElement(inertial, "mass", value=_text([inertia.mass_kg]))
    moments = zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), inertia.moments_kg_m2, strict=True)
    SubElement(inertial, "inertia", {key: _text([value]) for key, value in moments})

    return link


def _add_mesh(
    link: Element,
    kind: str,
    placed: Placed,
    mesh: str,
    colour: Point3 | None,
) -> None:
    shape = SubElement(link, kind, name=f"{placed.name}_{mesh}")
    _place(shape, placed.finger.offset_m)
    SubElement(
        SubElement(shape, "geometry"), "mesh", filename=f"{placed.prefix}{mesh}.stl", scale=_SCALE
    )

    if colour:
        material = SubElement(shape, "material", name=f"{placed.name}_{mesh}")
        SubElement(material, "color", rgba=_text((*colour, 1.0)))


def _text(values: Iterable[float]) -> str:
    return " ".join(f"{value + 0.0:.9g}" for value in values)


def _place(parent: Element, position_m: Iterable[float], turn: float = 0.0) -> None:
    SubElement(parent, "origin", xyz=_text(position_m), rpy=f"{_text([turn])} 0 0")


def _join(
    robot: Element,
    kind: str,
    parent: str,
    child: str,
    at_m: Iterable[float],
    turn: float = 0.0,
) -> Element:
    joint = SubElement(robot, "joint", name=f"{child}_joint", type=kind)
    _place(joint, at_m, turn)
    SubElement(joint, "parent", link=parent)
    SubElement(joint, "child", link=child)

    return joint
