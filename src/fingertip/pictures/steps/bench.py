"""Bench of the pictures: parts, seals, tools and hardware of a design as meshes, built when a scene uses them."""

from __future__ import annotations

import math

import numpy as np

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator, to_canonical_mesh
from fingertip.cad.shapes.bone import sensor_body
from fingertip.cad.shapes.insert import cavity, filled_bone
from fingertip.cad.shapes.mold import runners, vents
from fingertip.cad.shapes.parts import PARTS, hardware, parts_by_name
from fingertip.catalogues.hardware import LUER_DEPTH_MM, LUER_MOUTH_MM, LUER_TAPER, NOZZLE_DEPTH_MM, NOZZLE_LENGTH_MM
from fingertip.design import Design
from fingertip.design.geometry.conic import ConicBody, offset_section
from fingertip.design.geometry.seat import tape_span_mm
from fingertip.design.geometry.solids import (
    Box,
    Cone,
    ElbowTube,
    Point3,
    Solid,
    SuperconicSolid,
    cylinder,
    difference,
    intersection,
    union,
)
from fingertip.pictures.raster import Colour
from fingertip.pictures.steps.scene import Shown

_TOLERANCE_MM = 0.05
SENSOR, TAPE, SEAL = (0.86, 0.68, 0.24), (0.85, 0.50, 0.15), (0.80, 0.25, 0.20)
WIRE, STEEL, GLASS, HAND_COLOUR = (0.72, 0.20, 0.16), (0.62, 0.63, 0.66), (0.80, 0.86, 0.90), (0.80, 0.80, 0.78)
PRODUCT, PATCH = PARTS["skin"].colour, (0.78, 0.48, 0.40)
PAPER = (0.93, 0.91, 0.86)
"""Colours of what lies beside the parts; PRODUCT is the silicone."""
_TAPE_SHOWN_MM = 0.2
"""Thickness with which a tape is drawn: its own would not be seen [mm]."""
_WALL_MM = 0.8
"""Wall of drawn barrels and cups [mm]."""


class Bench:
    """Meshes of one design."""

    def __init__(self, design: Design) -> None:
        self.design = design
        self.evaluator = MeshEvaluator(_TOLERANCE_MM)

    @property
    def insert(self) -> str:
        """Name of the part that lies in the mold while the skin is cast."""
        return "core" if self.design.mold.method == "sleeve" else "bone"

    @property
    def apart_mm(self) -> float:
        """Distance by which parts are drawn apart."""
        return 1.2 * self.design.mold_layout.palmar_height

    def solid(self, solid: Solid, colour: Colour, shift: Point3 = (0.0, 0.0, 0.0), *, cut: bool = False) -> Shown:
        """Show a solid, shifted, and cut open along x = 0 if asked for."""
        manifold = self.evaluator.manifold(solid)
        if cut:
            manifold = manifold.trim_by_plane((1.0, 0.0, 0.0), 0.0)
        mesh = to_canonical_mesh(manifold)
        return Shown(Mesh(mesh.vertices + np.array(shift), mesh.triangles), colour)

    def part_solid(self, name: str) -> tuple[Solid, Colour]:
        """Return solid and colour of a part."""
        return PARTS[name].solid(self.design), PARTS[name].colour

    def part(self, name: str, shift: Point3 = (0.0, 0.0, 0.0), *, cut: bool = False) -> Shown:
        """Show a part."""
        solid, colour = self.part_solid(name)
        return self.solid(solid, colour, shift, cut=cut)

    def assembled_bone(self, *, cut: bool = False, lid: bool = True) -> list[Shown]:
        """Show the bone with sensor and lid."""
        shown = [self.part("bone", cut=cut), self.solid(sensor_body(self.design), SENSOR, cut=cut)]
        if lid and "lid" in parts_by_name(self.design):
            shown.append(self.part("lid", cut=cut))
        return shown

    def in_mold(self, *, cut: bool = False) -> list[Shown]:
        """Show bone with its sensor, or core, as it lies in the mold."""
        return [self.part("core", cut=cut)] if self.insert == "core" else self.assembled_bone(cut=cut)

    def bolts(
        self, bolt_shift: Point3 = (0.0, 0.0, 0.0), nut_shift: Point3 = (0.0, 0.0, 0.0), *, cut: bool = False
    ) -> list[Shown]:
        """Show the bolts of the mold and their nuts."""
        return [
            self.solid(item.solid, item.colour, nut_shift if "nut" in item.name else bolt_shift, cut=cut)
            for item in hardware(self.design, ("mold_palmar", "mold_dorsal"))
            if item.name.startswith("mold_")
        ]

    def chaplet_screw(self, shift: Point3 = (0.0, 0.0, 0.0), *, cut: bool = False) -> list[Shown]:
        """Show the screw of the chaplet; none without one."""
        return [
            self.solid(item.solid, item.colour, shift, cut=cut)
            for item in hardware(self.design, ("mold_dorsal",))
            if item.name == "chaplet_screw"
        ]

    def casting(self, *, cut: bool = False) -> Shown:
        """Show the silicone as it leaves the mold, with runner and vents."""
        block = Box(*self._block())
        cast = intersection(union(cavity(self.design), *runners(self.design)), block)
        return self.solid(difference(cast, PARTS[self.insert].solid(self.design)), PRODUCT, cut=cut)

    def vents(self) -> list[Shown]:
        """Show the silicone in the vents, whole where the casting is cut open."""
        block = Box(*self._block())
        return [self.solid(intersection(vent, block), PRODUCT) for vent in vents(self.design)]

    def _block(self) -> tuple[Point3, Point3]:
        m = self.design.mold_layout
        return (-m.half_width, -m.palmar_height, m.proximal_z), (m.half_width, m.dorsal_height, m.distal_z)

    def seat_tape(self) -> list[Shown]:
        """Show the tape around the seat, on the collar or on the base below it; none without one."""
        dims, span = self.design.dimensions, tape_span_mm(self.design)
        if span is None:
            return []
        on_collar = span[1] <= self.design.bone.collar_length_mm
        section = offset_section((dims.collar if on_collar else dims.bone_outline).section, _TAPE_SHOWN_MM)
        around: Solid = SuperconicSolid(ConicBody(section, ((-span[1], 1.0), (-span[0], 1.0))))
        if not on_collar:
            far, flat = 2 * section.half_width, -dims.base_flat_depth - _TAPE_SHOWN_MM
            around = difference(around, Box((-far, -2 * section.palmar, -2 * span[1]), (far, flat, 0.0)))
        return [self.solid(difference(around, filled_bone(self.design)), TAPE)]

    def wires(self, radius_mm: float) -> list[Shown]:
        """Show the wires of a straight tail as one tube through the cable channel and out of it."""
        dims, bone = self.design.dimensions, self.design.bone
        path = ElbowTube(
            start_y=-dims.flat_depth + dims.channel_depth, start_z=dims.relief_proximal_z + dims.relief_half_length,
            exit_z=dims.channel_exit_z, end_y=3 * dims.bone_outline.section.dorsal,
            bend_radius=bone.channel_bend_radius_mm, radius=radius_mm,
        )  # fmt: skip
        return [self.solid(path, WIRE)]

    def syringe(self, fill_share: float = 0.0, lift_mm: float = 0.0, drawn_share: float = 0.0) -> list[Shown]:
        """Show the syringe above its cone, its barrel cut open, with silicone up to a share of its volume.

        `drawn_share` is the share up to which the plunger is pulled back at least.
        """
        inlet, face = self.design.mold_layout.inlet, self.design.mold_layout.dorsal_height
        assert inlet
        centre, kind = (inlet.z, inlet.x), inlet.syringe
        tip = face - NOZZLE_DEPTH_MM + lift_mm
        shoulder = tip + NOZZLE_LENGTH_MM
        bore, outer = kind.bore_mm / 2, kind.barrel_mm / 2
        stroke = 1000.0 * kind.volume_ml / (math.pi * bore**2)
        end, level = shoulder + 1.15 * stroke, shoulder + max(fill_share, drawn_share, 0.02) * stroke
        mouth = (LUER_MOUTH_MM - LUER_TAPER * (LUER_DEPTH_MM - NOZZLE_DEPTH_MM)) / 2
        nozzle = Cone("y", centre, tip, shoulder, mouth - LUER_TAPER * NOZZLE_DEPTH_MM / 2, mouth)
        barrel = difference(
            cylinder("y", centre, shoulder, end, outer), cylinder("y", centre, shoulder + _WALL_MM, end + 1.0, bore)
        )
        viewer_side = Box((-4 * outer, shoulder - 1.0, inlet.z - 4 * outer), (inlet.x, end + 1.0, inlet.z + 4 * outer))
        plunger = union(
            cylinder("y", centre, level, level + 3.0, 0.98 * bore), cylinder("y", centre, level, end + 6.0, 0.4 * bore),
            cylinder("y", centre, end + 4.0, end + 6.0, bore),
        )  # fmt: skip
        silicone = cylinder("y", centre, shoulder + _WALL_MM, level, 0.99 * bore)
        shown = [self.solid(union(nozzle, difference(barrel, viewer_side)), GLASS), self.solid(plunger, STEEL)]
        return [*shown, self.solid(silicone, PRODUCT)] if fill_share else shown

    def nozzle_cap(self) -> list[Shown]:
        """Show the cap on the nozzle of a syringe that stands as `syringe` shows it."""
        inlet = self.design.mold_layout.inlet
        assert inlet
        tip = self.design.mold_layout.dorsal_height - NOZZLE_DEPTH_MM
        cap = cylinder("y", (inlet.z, inlet.x), tip - 1.5, tip + 0.7 * NOZZLE_LENGTH_MM, LUER_MOUTH_MM / 2 + 1.0)
        return [self.solid(cap, SEAL)]

    def plunger_wire(self, level: float) -> list[Shown]:
        """Show the wire between plunger and barrel that lets the air out above a level of silicone [mm]."""
        inlet = self.design.mold_layout.inlet
        assert inlet
        bore = inlet.syringe.bore_mm / 2
        aside = (inlet.z + 0.7 * bore, inlet.x - 0.75 * bore)
        stroke = 1000.0 * inlet.syringe.volume_ml / (math.pi * bore**2)
        return [self.solid(cylinder("y", aside, level - 0.5, level + 0.5 * stroke, 0.3), SENSOR)]

    def patch(self) -> list[Shown]:
        """Show the patch in the hole of the chaplet; none without one."""
        chaplet, outer = self.design.dimensions.chaplet, self.design.dimensions.outer
        if chaplet is None:
            return []
        height = outer.dorsal_height_at(0.9 * chaplet.radius, chaplet.z + 0.9 * chaplet.radius)
        return [self.solid(cylinder("y", (chaplet.z, 0.0), chaplet.facet_y, height, 0.99 * chaplet.radius), PATCH)]

    def cup(self, x: float, radius: float, height: float, level: float) -> list[Shown]:
        """Show a cup that stands on z = 0, cut open, filled to a level [mm]."""
        outside = cylinder("z", (x, 0.0), 0.0, height, radius + _WALL_MM)
        inside = cylinder("z", (x, 0.0), _WALL_MM, height + 1.0, radius)
        front = Box((x - 2 * radius, -2 * radius, _WALL_MM), (x + 2 * radius, 0.0, height + 1.0))
        content = cylinder("z", (x, 0.0), _WALL_MM, _WALL_MM + level, 0.99 * radius)
        return [self.solid(difference(outside, inside, front), GLASS), self.solid(content, PRODUCT)]
