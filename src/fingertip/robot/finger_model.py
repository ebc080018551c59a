"""Model of one rigid finger: parts with their densities, mass and inertia, frames, collision pieces
and contact.

Meshes keep the axes of the design in mm: x across, y dorsal, z towards the tip. All else is in m
and kg, in the frame of the interface to the hand, whose axes are parallel to these.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.catalogues.electronics import FILM_G_CM3
from fingertip.catalogues.hardware import STEEL_G_CM3
from fingertip.design import Design
from fingertip.design.interfaces import interface_of
from fingertip.design.interfaces.interface import CrossBolted
from fingertip.models.frames import find_frames
from fingertip.models.hand_stub import guide as tendon_guide
from fingertip.models.hardware import hardware
from fingertip.models.parts import PARTS, parts_by_name
from fingertip.models.solids import Point3, cylinder
from fingertip.pad.pad_geometry import PadForm
from fingertip.robot.collision_pieces import cut_skin
from fingertip.robot.contact import ContactLaw, fit_contact
from fingertip.robot.tactile_mesh import TactileMesh, mesh_active_area

TOLERANCE_MM = 0.02
"""Largest distance of a facet of the parts from the exact surface [mm]."""
_STEEL = (0.55, 0.56, 0.58)


@dataclass(frozen=True, eq=False)
class Body:
    """Part of the finger, with its mesh [mm]."""

    name: str
    mesh: Mesh
    density_g_cm3: float
    colour: Point3


@dataclass(frozen=True)
class Inertia:
    """Mass, centre of mass and inertia of the bodies of a finger together."""

    mass_kg: float
    centre_m: Point3
    moments_kg_m2: tuple[float, ...]
    """Inertia about the centre: xx, yy, zz, xy, xz, yz."""


@dataclass(frozen=True)
class Strand:
    """Strand of the tendon: from its guide in the stub around a horn of the bone, and up its side
    [m].
    """

    guide_m: Point3
    horn_m: Point3
    """Middle of the horn, whose axis is parallel to x."""
    radius_m: float
    """Radius of the horn at the middle of the strand."""


@dataclass(frozen=True)
class Joint:
    """Joint between finger and hand, about the x axis of the interface, towards the palm."""

    turns: bool
    """False if the finger is fixed to the hand."""
    travel_deg: float
    """Angle between the stops; 0 without stops."""
    stop_moment_n_m: float
    """Moment of the grip force at the tip, which the stops hold."""


@dataclass(frozen=True, eq=False)
class SensorSite:
    """Place of the sensor in the finger, and the points at which a simulator reads the skin."""

    middle_m: Point3
    """Middle of the active area. Its frame has z out of the pad, and y towards the tip."""
    active_radius_m: float
    below_skin_m: float
    """Thickness of the skin over the active area."""
    taxels: TactileMesh


@dataclass(frozen=True, eq=False)
class CollisionShape:
    """Convex pieces that together stand for the skin in collisions."""

    pieces: tuple[Mesh, ...]
    error_mm: float
    """Greatest distance between the pieces together and the skin."""


@dataclass(frozen=True, eq=False)
class FingerModel:
    """Rigid finger as a simulator needs it. Lengths are in the frame of the interface [m]."""

    name: str
    bodies: tuple[Body, ...]
    inertia: Inertia
    offset_m: Point3
    """Place of the meshes' origin in the frame of the interface."""
    tip_m: Point3
    joint: Joint
    sensor: SensorSite
    collision: CollisionShape
    contact: ContactLaw
    stub: Body | None
    """Stub of the hand, which carries a finger that turns."""
    strands: tuple[Strand, ...]

    @property
    def parts(self) -> dict[str, Mesh]:
        """Meshes of the finger by the names of their files, without suffix, then collision pieces
        from the hand on.
        """
        parts = {body.name: body.mesh for body in self.bodies}
        pieces = enumerate(self.collision.pieces, 1)
        return parts | {f"collision_{i}": piece for i, piece in pieces}

    @property
    def meshes(self) -> dict[str, Mesh]:
        """Meshes of the finger, and of the stub of the hand."""
        return {**self.parts, **({self.stub.name: self.stub.mesh} if self.stub else {})}


def build_finger(design: Design) -> FingerModel:
    """Build the model of a design's finger. Raises GeometryError or TraceError."""
    evaluator = MeshEvaluator(TOLERANCE_MM)
    bodies = _mesh_bodies(design, evaluator)
    pieces, error_mm = cut_skin(design)

    frames = find_frames(design)
    origin = frames["interface"]
    tip = _to_interface(frames["tip"], origin)
    offset = _to_interface((0.0, 0.0, 0.0), origin)

    dims = design.dimensions
    joint = dims.joint
    return FingerModel(
        name=design.name,
        bodies=bodies,
        inertia=measure_inertia(bodies, offset),
        offset_m=offset,
        tip_m=tip,
        joint=Joint(
            turns=joint is not None,
            travel_deg=joint.travel_deg if joint else 0.0,
            stop_moment_n_m=tip[2] * design.strength.grip_force_n,
        ),
        sensor=SensorSite(
            middle_m=_to_interface(frames["sensor"], origin),
            active_radius_m=5e-4 * dims.sensor.active_diameter_mm,
            below_skin_m=1e-3 * design.skin.thickness_palmar_mm,
            taxels=mesh_active_area(PadForm.of_design(design)),
        ),
        collision=CollisionShape(pieces, error_mm),
        contact=fit_contact(design),
        stub=_mesh_stub(design, evaluator) if joint else None,
        strands=tuple(_lead_tendon(design, origin)),
    )


def _to_interface(point_mm: Point3, origin_mm: Point3) -> Point3:
    """Convert a point of the design [mm] to the frame of the interface [m].

    The frame lies in the middle of the finger: x is that of the design.
    """
    return (
        1e-3 * point_mm[0],
        1e-3 * (point_mm[1] - origin_mm[1]),
        1e-3 * (point_mm[2] - origin_mm[2]),
    )


def _mesh_bodies(design: Design, evaluator: MeshEvaluator) -> tuple[Body, ...]:
    """Mesh everything that moves with the finger: parts, sensor, pin and cross bolt."""
    print_g_cm3 = design.strength.material.density_g_cm3
    pin_g_cm3 = print_g_cm3 if design.hand.pin == "printed" else STEEL_G_CM3
    silicone = design.silicone.material.density_g_cm3
    skin_g_cm3 = (silicone.low + silicone.high) / 2
    bodies = []

    for name, part in parts_by_name(design).items():
        if part.is_in_finger:
            density = print_g_cm3 if part.is_printed else skin_g_cm3
            bodies.append(Body(name, evaluator.mesh(part.solid(design)), density, part.colour))

    for item in hardware(design, ("bone",)):
        density = FILM_G_CM3 if item.name == "sensor" else pin_g_cm3
        bodies.append(Body(item.name, evaluator.mesh(item.solid), density, item.colour))

    interface = interface_of(design)
    if isinstance(interface, CrossBolted):
        bolt = interface.bolt(design)
        half = bolt.crossed_mm / 2
        solid = cylinder(
            "x",
            centre=(design.dimensions.base_middle_y, interface.cross_bolt_z(design)),
            low=-half,
            high=half,
            radius=bolt.thread_mm / 2,
        )
        bodies.append(Body("cross_bolt", evaluator.mesh(solid), STEEL_G_CM3, _STEEL))

    return tuple(bodies)


def _mesh_stub(design: Design, evaluator: MeshEvaluator) -> Body:
    part = PARTS["hand_stub"]
    density = design.strength.material.density_g_cm3
    return Body(part.name, evaluator.mesh(part.solid(design)), density, part.colour)


def _lead_tendon(design: Design, origin_mm: Point3) -> Iterator[Strand]:
    """Yield the strands of the tendon; none without one."""
    anchor = design.dimensions.anchor
    guide = tendon_guide(design) if anchor else None
    if not anchor or not guide:
        return

    for x in guide.x:
        horn = (x, anchor.horn_y + anchor.horn_radius, anchor.horn_low_z)
        radius = anchor.horn_radius + anchor.line / 2
        yield Strand(
            guide_m=_to_interface((x, guide.y, guide.mouth_z), origin_mm),
            horn_m=_to_interface(horn, origin_mm),
            radius_m=1e-3 * radius,
        )


def measure_inertia(bodies: tuple[Body, ...], offset_m: Point3) -> Inertia:
    """Integrate mass, centre and inertia over the meshes, by a tetrahedron from the origin to each
    triangle.
    """
    mass = 0.0
    first_moment = np.zeros(3)
    second_moment = np.zeros((3, 3))

    for body in bodies:
        corners = 1e-3 * body.mesh.vertices[body.mesh.triangles] + np.array(offset_m)
        mass_kg = 1e3 * body.density_g_cm3 * np.linalg.det(corners) / 6.0
        corner_sum = corners.sum(axis=1)
        mass += float(mass_kg.sum())
        first_moment += mass_kg @ corner_sum / 4.0
        second_moment += np.einsum("t,tci,tcj->ij", mass_kg, corners, corners) / 20.0
        second_moment += np.einsum("t,ti,tj->ij", mass_kg, corner_sum, corner_sum) / 20.0

    about_centre = second_moment - np.outer(first_moment, first_moment) / mass
    tensor = np.trace(about_centre) * np.eye(3) - about_centre
    x, y, z = (first_moment / mass).tolist()
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = tensor.tolist()
    return Inertia(mass, (x, y, z), (xx, yy, zz, xy, xz, yz))
