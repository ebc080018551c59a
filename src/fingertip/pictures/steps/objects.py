"""Objects of the scenes: parts, seals, tools and hardware of a design, as meshes on one bench."""

from __future__ import annotations

import math

import numpy as np

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator, to_canonical_mesh
from fingertip.cad.shapes.bone import sensor_body
from fingertip.cad.shapes.insert import cavity, seat_tape, sensor_insert
from fingertip.cad.shapes.mold import block, runners, vents
from fingertip.cad.shapes.parts import PARTS, hardware, parts_by_name
from fingertip.catalogues.hardware import LUER_DEPTH_MM, LUER_MOUTH_MM, LUER_TAPER, NOZZLE_DEPTH_MM, NOZZLE_LENGTH_MM
from fingertip.design import Design
from fingertip.design.geometry.solids import Box, Cone, Point3, Solid, cylinder, difference, intersection, union
from fingertip.pictures.raster import Colour
from fingertip.pictures.steps.scene import Paint, Shown

_TOLERANCE_MM = 0.05
_TAPE_SHOWN_MM = 0.2
"""Thickness with which a tape is drawn: its own would not be seen [mm]."""
_WALL_MM = 0.8
"""Wall of drawn barrels and cups [mm]."""
CUP_RADIUS_MM, _CUP_HEIGHT_MM = 22.0, 45.0


class Bench:
    """Parts of one design and what lies with them, as meshes."""

    def __init__(self, design: Design) -> None:
        self.design, self.dims, self.layout = design, design.dimensions, design.mold_layout
        self.evaluator = MeshEvaluator(_TOLERANCE_MM)
        self._meshes: dict[tuple[Solid, bool], Mesh] = {}

    @property
    def head(self) -> Point3:
        """Middle of the sensor's head, on the flat or its platform."""
        return 0.0, -self.dims.platform_depth, self.dims.sensor_z

    @property
    def apart_mm(self) -> float:
        return 1.2 * self.layout.palmar_height

    def solid(self, solid: Solid, colour: Colour, shift: Point3 = (0.0, 0.0, 0.0), *, cut: bool = False) -> Shown:
        """Show a solid, shifted, and cut open along x = 0 if asked for."""
        mesh = self._meshes.get((solid, cut))
        if mesh is None:
            manifold = self.evaluator.manifold(solid)
            mesh = to_canonical_mesh(manifold.trim_by_plane((1.0, 0.0, 0.0), 0.0) if cut else manifold)
            self._meshes[solid, cut] = mesh
        return Shown(Mesh(mesh.vertices + np.array(shift), mesh.triangles), colour)

    def part_solid(self, name: str) -> tuple[Solid, Colour]:
        return PARTS[name].solid(self.design), PARTS[name].colour

    def part(self, name: str, shift: Point3 = (0.0, 0.0, 0.0), *, cut: bool = False) -> Shown:
        solid, colour = self.part_solid(name)
        return self.solid(solid, colour, shift, cut=cut)

    def sensor(self, shift: Point3 = (0.0, 0.0, 0.0), *, cut: bool = False) -> Shown:
        return self.solid(sensor_body(self.design), Paint.SENSOR, shift, cut=cut)

    def assembled_bone(self, *, cut: bool = False, lid: bool = True) -> list[Shown]:
        shown = [self.part("bone", cut=cut), self.sensor(cut=cut)]
        if lid and "lid" in parts_by_name(self.design):
            shown.append(self.part("lid", cut=cut))
        return shown

    def in_mold(self, *, cut: bool = False) -> list[Shown]:
        """Show the bone with its sensor as it lies in the mold."""
        return [*self.assembled_bone(cut=cut), *self.stiff(cut=cut)]

    def stiff(self, *, cut: bool = False) -> list[Shown]:
        """Show the insert on the sensor; none without one."""
        return [self.part("sensor_insert", cut=cut)] if self.dims.insert else []

    def bolts(
        self, bolt_shift: Point3 = (0.0, 0.0, 0.0), nut_shift: Point3 = (0.0, 0.0, 0.0), *, cut: bool = False
    ) -> list[Shown]:
        return [
            self.solid(item.solid, item.colour, nut_shift if "nut" in item.name else bolt_shift, cut=cut)
            for item in hardware(self.design, ("mold_palmar", "mold_dorsal"))
            if item.name.startswith("mold_")
        ]

    def chaplet_screw(self, shift: Point3 = (0.0, 0.0, 0.0), *, cut: bool = False) -> list[Shown]:
        return [
            self.solid(item.solid, item.colour, shift, cut=cut)
            for item in hardware(self.design, ("mold_dorsal",))
            if item.name == "chaplet_screw"
        ]

    def casting(self, *, cut: bool = False) -> Shown:
        cast = intersection(union(cavity(self.design), *runners(self.design)), block(self.design))
        inside = (PARTS["bone"].solid(self.design), *sensor_insert(self.design))
        return self.solid(difference(cast, *inside), Paint.SILICONE, cut=cut)

    def vents(self) -> list[Shown]:
        """Show the silicone in the vents, whole where the casting is cut open."""
        return [self.solid(intersection(vent, block(self.design)), Paint.SILICONE) for vent in vents(self.design)]

    def seat_tape(self) -> list[Shown]:
        return [self.solid(around, Paint.TAPE) for around in seat_tape(self.design, _TAPE_SHOWN_MM)]

    def syringe(self, fill_share: float = 0.0, lift_mm: float = 0.0, drawn_share: float = 0.0) -> list[Shown]:
        """Show the syringe over its cone, its barrel cut open, filled to a share, drawn to `drawn_share` or more."""
        inlet = self.layout.inlet
        centre, kind = (inlet.z, inlet.x), inlet.syringe
        tip = self.layout.dorsal_height - NOZZLE_DEPTH_MM + lift_mm
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
        shown = [
            self.solid(union(nozzle, difference(barrel, viewer_side)), Paint.GLASS),
            self.solid(plunger, Paint.STEEL),
        ]
        return [*shown, self.solid(silicone, Paint.SILICONE)] if fill_share else shown

    def cup(self, level: float) -> list[Shown]:
        """Show a cup that stands on z = 0, cut open, filled to a level [mm]."""
        middle, reach = (0.0, 0.0), 2 * CUP_RADIUS_MM
        outside = cylinder("z", middle, 0.0, _CUP_HEIGHT_MM, CUP_RADIUS_MM + _WALL_MM)
        inside = cylinder("z", middle, _WALL_MM, _CUP_HEIGHT_MM + 1.0, CUP_RADIUS_MM)
        front = Box((-reach, -reach, _WALL_MM), (reach, 0.0, _CUP_HEIGHT_MM + 1.0))
        content = cylinder("z", middle, _WALL_MM, _WALL_MM + level, 0.99 * CUP_RADIUS_MM)
        return [self.solid(difference(outside, inside, front), Paint.GLASS), self.solid(content, Paint.SILICONE)]
