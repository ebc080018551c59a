"""Model of one rigid finger: parts with their densities, mass and inertia, frames, collision pieces
and contact.

Meshes keep the axes of the design in mm: x across, y dorsal, z towards the tip. All else is in m
and kg, in the frame of the interface to the hand, whose axes are parallel to these.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.catalogues.electronics import FILM_G_CM3
from fingertip.catalogues.hardware import STEEL_G_CM3
from fingertip.design import Design
from fingertip.design.interfaces import interface_of
from fingertip.design.interfaces.interface import CrossBolted
from fingertip.models.hand_stub import guide
from fingertip.models.parts import PARTS, find_frames, hardware, parts_by_name
from fingertip.models.solids import Point3, cylinder
from fingertip.pad.pad_geometry import PadForm
from fingertip.robot.contact import ContactLaw, TactileMesh, cut_skin, fit_contact, mesh_active_area

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
    mass_kg: float
    centre_m: Point3
    moments_kg_m2: tuple[float, ...]
    """Inertia about the centre: xx, yy, zz, xy, xz, yz."""


@dataclass(frozen=True)
class Strand:
    """Strand of the tendon: from its guide in the stub around a
    horn of the bone, and up its side [m].
    """

    guide_m: Point3
    horn_m: Point3
    """Middle of the horn, whose axis is parallel to x."""
    radius_m: float
    """Radius of the horn at the middle of the strand."""


@dataclass(frozen=True, eq=False)
class FingerModel:
    name: str
    bodies: tuple[Body, ...]
    inertia: Inertia
    offset_m: Point3
    """Place of the meshes' origin in the frame of the interface."""
    turns: bool
    """True if the finger turns about the x axis of the interface, towards the palm."""
    travel_deg: float
    """Angle between the stops; 0 without stops."""
    stop_moment_n_m: float
    """Moment of the grip force at the tip."""
    tip_m: Point3
    sensor_m: Point3
    """Middle of the active area. Its frame has z out of the pad, and y towards the tip."""
    active_radius_m: float
    over_sensor_m: float
    """Thickness of the skin over the active area."""
    pieces: tuple[Mesh, ...]
    piece_error_mm: float
    """Greatest distance between the pieces together and the skin."""
    contact: ContactLaw
    taxels: TactileMesh
    stub: Body | None
    """Stub of the hand, which carries a finger that turns."""
    strands: tuple[Strand, ...]

    @property
    def parts(self) -> dict[str, Mesh]:
        """Meshes of the finger by the names of their files, without
        suffix, then collision pieces from the hand on.
        """
        parts = {body.name: body.mesh for body in self.bodies}
        return parts | {f"collision_{i}": piece for i, piece in enumerate(self.pieces, 1)}

    @property
    def meshes(self) -> dict[str, Mesh]:
        """Meshes of the finger, and of the stub of the hand."""
        return {**self.parts, **({self.stub.name: self.stub.mesh} if self.stub else {})}


def build_finger(design: Design) -> FingerModel:
    """Build the model of a design's finger. Raises GeometryError or TraceError."""
    dims = design.dimensions
    evaluator = MeshEvaluator(TOLERANCE_MM)
    interface = interface_of(design)
    print_g_cm3 = design.strength.material.density_g_cm3
    silicone = design.silicone.material.density_g_cm3
    skin_g_cm3 = (silicone.low + silicone.high) / 2
    solids = [
        (name, part.solid(design), print_g_cm3 if part.is_printed else skin_g_cm3, part.colour)
        for name, part in parts_by_name(design).items()
        if part.is_in_finger
    ]
    pin_g_cm3 = print_g_cm3 if design.hand.pin == "printed" else STEEL_G_CM3

    for item in hardware(design, ("bone",)):
        solids.append(
            (item.name, item.solid, {"sensor": FILM_G_CM3}.get(item.name, pin_g_cm3), item.colour)
        )

    if isinstance(interface, CrossBolted):
        bolt = interface.bolt(design)
        at = (dims.base_middle_y, interface.cross_bolt_z(design))
        half = bolt.crossed_mm / 2
        solids.append(
            (
                "cross_bolt",
                cylinder(
                    "x",
                    centre=at,
                    low=-half,
                    high=half,
                    radius=bolt.thread_mm / 2,
                ),
                STEEL_G_CM3,
                _STEEL,
            )
        )

    bodies = tuple(
        Body(name, evaluator.mesh(solid), density, colour)
        for name, solid, density, colour in solids
    )
    joint = dims.joint
    (pieces, error_mm) = cut_skin(design)
    frames = find_frames(design)
    (_, y, z) = frames["interface"]

    def place(at_mm: Point3) -> Point3:
        return 1e-3 * at_mm[0], 1e-3 * (at_mm[1] - y), 1e-3 * (at_mm[2] - z)

    tip = place(frames["tip"])
    offset = place((0.0, 0.0, 0.0))
    stub = None
    strands = list[Strand]()

    if joint:
        part = PARTS["hand_stub"]
        stub = Body(part.name, evaluator.mesh(part.solid(design)), print_g_cm3, part.colour)

    anchor = dims.anchor
    if anchor and (way := guide(design)):
        for x in way.x:
            horn = (x, anchor.horn_y + anchor.horn_radius, anchor.horn_low_z)
            radius = anchor.horn_radius + anchor.line / 2
            strands.append(Strand(place((x, way.y, way.mouth_z)), place(horn), 1e-3 * radius))

    return FingerModel(
        name=design.name,
        bodies=bodies,
        inertia=measure_inertia(bodies, offset),
        offset_m=offset,
        turns=joint is not None,
        travel_deg=joint.travel_deg if joint else 0.0,
        stop_moment_n_m=tip[2] * design.strength.grip_force_n,
        tip_m=tip,
        sensor_m=place(frames["sensor"]),
        active_radius_m=5e-4 * dims.sensor.active_diameter_mm,
        over_sensor_m=1e-3 * design.skin.thickness_palmar_mm,
        pieces=pieces,
        piece_error_mm=error_mm,
        contact=fit_contact(design),
        taxels=mesh_active_area(PadForm.of_design(design)),
        stub=stub,
        strands=tuple(strands),
    )


def measure_inertia(bodies: tuple[Body, ...], offset_m: Point3) -> Inertia:
    """Integrate mass, centre and inertia over the meshes, by a
    tetrahedron from the origin to each triangle.
    """
    mass = 0.0
    first = np.zeros(3)
    second = np.zeros((3, 3))

    for body in bodies:
        corners = 1e-3 * body.mesh.vertices[body.mesh.triangles] + np.array(offset_m)
        mass_kg = 1e3 * body.density_g_cm3 * np.linalg.det(corners) / 6.0
        total = corners.sum(axis=1)
        mass += float(mass_kg.sum())
        first += mass_kg @ total / 4.0
        second += np.einsum("t,tci,tcj->ij", mass_kg, corners, corners) / 20.0
        second += np.einsum("t,ti,tj->ij", mass_kg, total, total) / 20.0

    about = second - np.outer(first, first) / mass
    x, y, z = (first / mass).tolist()
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = (np.trace(about) * np.eye(3) - about).tolist()
    return Inertia(mass, (x, y, z), (xx, yy, zz, xy, xz, yz))
