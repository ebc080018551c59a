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
from fingertip.robot.model import Body, FingerModel, Inertia, measure_inertia

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
    name: str
    finger: FingerModel
    prefix: str = ""
    """First part of the names of its meshes' files."""
    x_m: float = 0.0
    """Place of its interface."""


def render_model(name: str, fingers: Sequence[Placed], file_format: str, comment: str) -> bytes:
    """Render a model of fingers, each held at its interface; `comment` stands ahead of it."""
    if file_format == "mjcf":
        root = Element("mujoco", model=name)
        SubElement(root, "compiler", angle="radian")
        # Friction creeps otherwise, and a contact of many points would be as many times as stiff.
        option = SubElement(
            root, "option", timestep=f"{TIMESTEP_S:g}", cone="elliptic", impratio="10000"
        )
        SubElement(option, "flag", multiccd="disable")
        asset, world, tendon, sensor = (
            SubElement(root, tag) for tag in ("asset", "worldbody", "tendon", "sensor")
        )

        for form, prefix in {placed.finger: placed.prefix for placed in fingers}.items():
            for mesh in form.meshes:
                place = {
                    "name": f"{form.name}_{mesh}",
                    "file": f"{prefix}{mesh}.stl",
                    "scale": _SCALE,
                }
                SubElement(asset, "mesh", place)

            points_m = 1e-3 * form.taxels.points_mm + np.array(form.offset_m)
            SubElement(
                asset,
                "mesh",
                name=f"{form.name}_taxels",
                inertia="shell",
                vertex=_text(points_m.ravel()),
                normal=_text(form.taxels.normals.ravel()),
                face=_text(form.taxels.triangles.ravel()),
            )

        for placed in fingers:
            _add_to_mjcf(placed, world, sensor)
            if placed.finger.stub:
                _add_stub_to_mjcf(placed, placed.finger.stub, world, tendon)
    else:
        root = Element("robot", name=name)
        _add_link(root, f"{name}_interface", FRAME)
        for placed in fingers:
            _add_to_urdf(placed, root, f"{name}_interface")

    root.insert(0, ElementTree.Comment(f" {comment} "))
    ElementTree.indent(root)
    data: bytes = ElementTree.tostring(root, "utf-8", xml_declaration=True)
    return data + b"\n"


def _add_to_mjcf(placed: Placed, world: Element, sensor: Element) -> None:
    name = placed.name
    finger = placed.finger
    body = SubElement(world, "body", name=name)
    contact = finger.contact
    if placed.x_m:
        body.set("pos", _text((placed.x_m, 0.0, 0.0)))

    _add_inertial_to_mjcf(body, finger.inertia)
    if finger.turns:
        stops = (
            {"range": f"0 {_text([math.radians(finger.travel_deg)])}"} if finger.travel_deg else {}
        )
        SubElement(
            body,
            "joint",
            {
                "name": f"{name}_joint",
                "type": "hinge",
                "axis": "1 0 0",
                **stops,
            },
        )

    seen = {"contype": "0", "conaffinity": "0", "group": "2"}
    touched = {
        "condim": "4",
        "friction": _text((contact.friction, contact.torsion_m, 1e-4)),
        "solmix": "1000000",
        "solref": _text(contact.solref(contact.inverse_mass_per_kg)),
        "solimp": _text(contact.solimp),
        "group": "3",
    }
    colours = {part.name: {**seen, "rgba": _text((*part.colour, 1.0))} for part in finger.bodies}

    for mesh in finger.parts:
        shape = {"name": f"{name}_{mesh}", "type": "mesh", "mesh": f"{finger.name}_{mesh}"}
        SubElement(
            body,
            "geom",
            {
                **shape,
                "pos": _text(finger.offset_m),
                "mass": "0",
                **colours.get(mesh, touched),
            },
        )

    to_palm = f"{_text([math.pi / 2])} 0 0"
    (x, y, z) = finger.sensor_m
    through_m = finger.over_sensor_m
    # Points of contact lie near the skin's surface: the site reaches from the active area as far
    # beyond it.
    middle = (x, y - through_m, z)
    over = (finger.active_radius_m, through_m)
    reach = [2 * finger.tip_m[2]]

    for site, kind, position, size, more in (
        ("tip", "sphere", finger.tip_m, [5e-4], {}),
        ("sensor", "sphere", finger.sensor_m, [5e-4], {"euler": to_palm}),
        ("touch", "cylinder", middle, over, {"euler": to_palm}),
        ("contact", "sphere", finger.tip_m, reach, {}),
    ):
        shape = {
            "name": f"{name}_{site}",
            "type": kind,
            "pos": _text(position),
            "size": _text(size),
            "group": "4",
        }
        SubElement(body, "site", {**shape, **more})

    unseen = {
        "name": f"{name}_taxels",
        "type": "mesh",
        "mesh": f"{finger.name}_taxels",
        "mass": "0",
    }
    SubElement(body, "geom", {**unseen, **seen, "group": "4"})
    SubElement(
        sensor,
        "tactile",
        name=f"{name}_tactile",
        geom=f"{name}_taxels",
        mesh=f"{finger.name}_taxels",
    )
    for site in ("touch", "contact"):
        SubElement(sensor, "touch", name=f"{name}_{site}", site=f"{name}_{site}")


def _add_inertial_to_mjcf(body: Element, inertia: Inertia) -> None:
    SubElement(
        body,
        "inertial",
        pos=_text(inertia.centre_m),
        mass=_text([inertia.mass_kg]),
        fullinertia=_text(inertia.moments_kg_m2),
    )


def _add_stub_to_mjcf(placed: Placed, stub: Body, world: Element, tendon: Element) -> None:
    """Add the stub of the hand as a body that stands still, and the
    strands of the tendon, which lie on the horns.
    """
    name = placed.name
    finger = placed.finger
    fixed = SubElement(world, "body", name=f"{name}_{stub.name}")
    moved = world.find(f"body[@name='{name}']")
    assert moved is not None
    fixed.set("pos", _text((placed.x_m, 0.0, 0.0)))
    _add_inertial_to_mjcf(fixed, measure_inertia((stub,), finger.offset_m))
    seen = {
        "contype": "0",
        "conaffinity": "0",
        "group": "2",
        "mass": "0",
        "rgba": _text((*stub.colour, 1.0)),
    }
    shape = {"name": f"{name}_{stub.name}", "type": "mesh", "mesh": f"{finger.name}_{stub.name}"}
    SubElement(fixed, "geom", {**shape, "pos": _text(finger.offset_m), **seen})

    for i, strand in enumerate(finger.strands, 1):
        path = f"{name}_strand_{i}"
        unseen = {
            "contype": "0",
            "conaffinity": "0",
            "group": "4",
            "mass": "0",
        }
        (x, y, z) = strand.horn_m
        radius = strand.radius_m
        ends = f"{_text((x - _HORN_M, y, z))} {_text((x + _HORN_M, y, z))}"

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
            "fromto": ends,
            "size": _text([radius]),
            **unseen,
        }
        SubElement(moved, "geom", horn)
        spatial = SubElement(tendon, "spatial", name=path, width="4e-4")
        SubElement(spatial, "site", site=f"{path}_guide")
        SubElement(spatial, "geom", geom=f"{path}_horn", sidesite=f"{path}_side")
        SubElement(spatial, "site", site=f"{path}_end")


def _add_to_urdf(placed: Placed, robot: Element, parent: str) -> None:
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

    kind = ("revolute" if finger.travel_deg else "continuous") if finger.turns else "fixed"
    at_m = placed.x_m, 0.0, 0.0
    stub = finger.stub

    if stub:
        stub_link = _add_link(
            robot, f"{name}_{stub.name}", measure_inertia((stub,), finger.offset_m)
        )
        _add_mesh(
            stub_link,
            kind="visual",
            placed=placed,
            mesh=stub.name,
            colour=stub.colour,
        )
        _join(
            robot,
            kind="fixed",
            parent=parent,
            child=f"{name}_{stub.name}",
            at_m=at_m,
        )
        parent = f"{name}_{stub.name}"
        at_m = (0.0, 0.0, 0.0)

    joint = _join(
        robot,
        kind=kind,
        parent=parent,
        child=name,
        at_m=at_m,
    )
    if finger.turns:
        SubElement(joint, "axis", xyz="1 0 0")

    if finger.travel_deg:
        limits = math.radians(finger.travel_deg), finger.stop_moment_n_m, MAX_SPEED_RAD_S
        upper, effort, velocity = (_text([limit]) for limit in limits)
        SubElement(
            joint,
            "limit",
            lower="0",
            upper=upper,
            effort=effort,
            velocity=velocity,
        )

    for frame, position_m, turn in (
        ("tip", finger.tip_m, 0.0),
        ("sensor", finger.sensor_m, math.pi / 2),
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
