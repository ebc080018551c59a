"""Interfaces of the bone to the proximal phalanx: post, socket, flange, clevis and adapter, each
with all it brings.

In: the tables of a design. Out: shapes, rules, sizes, stresses and words of its interface.

>>> from fingertip import Design
>>> from fingertip.design.interfaces import interface_of
>>> interface_of(Design()).face_on_plate
'the end of the post'
"""

from __future__ import annotations

from collections.abc import Mapping

from fingertip.catalogues.electronics import SENSORS
from fingertip.design.geometry import DesignTables
from fingertip.design.interfaces.adapter import Adapter
from fingertip.design.interfaces.clevis import Clevis
from fingertip.design.interfaces.flange import Flange
from fingertip.design.interfaces.interface import JointInterface
from fingertip.design.interfaces.post_and_socket import Post, Socket
from fingertip.design.rules.ruleset import SLACK, Ruleset, Violation, at_least

INTERFACES: Mapping[str, JointInterface] = {
    one.name: one for one in (Post(), Socket(), Flange(), Clevis(), Adapter())
}


def interface_of(design: DesignTables) -> JointInterface:
    return INTERFACES[design.bone.interface]


LENGTH_RULES = Ruleset()


@LENGTH_RULES.rule("bone.base_length_mm")
def base_holds_everything(design: DesignTables) -> Violation | None:
    dims = design.dimensions
    bone = design.bone
    within = interface_of(design).depth(design)
    minimum = bone.wall_mm - dims.trough_end_z + within
    if bone.base_length_mm >= minimum - SLACK:
        return None

    what = (
        f"the hole of the wires, a wall and the {bone.interface}"
        if within
        else "the hole of the wires and a wall"
    )
    short = dims.sensor.short
    is_shorter = dims.joint is not None and short  # no joint carries the load of so long a base
    other = f", the {SENSORS[short].label} {SENSORS[short].length_mm:g} mm" if is_shorter else ""

    return Violation(
        f"{bone.base_length_mm:g} mm does not hold {what} (the {dims.sensor.label} is "
        f"{dims.sensor.length_mm:g} mm long{other})",
        () if is_shorter else at_least(minimum),
        alternatives={"sensor.model": short} if is_shorter else {},
    )
