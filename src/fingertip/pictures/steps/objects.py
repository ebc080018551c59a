"""Objects of the scenes: parts and tools of a design, as meshes on one bench."""

from __future__ import annotations

import numpy as np

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator, to_canonical_mesh
from fingertip.cad.shapes.bone import sensor_body
from fingertip.cad.shapes.parts import PARTS
from fingertip.design import Design
from fingertip.design.geometry.solids import Box, Point3, Solid, cylinder, difference
from fingertip.pictures.raster import Colour
from fingertip.pictures.steps.scene import Paint, Shown

_TOLERANCE_MM, _WALL_MM = 0.05, 0.8
"""Tolerance of the meshes, and wall of drawn cups [mm]."""
CUP_RADIUS_MM, _CUP_HEIGHT_MM = 22.0, 45.0


class Bench:
    """Parts of one design and what lies with them, as meshes."""

    def __init__(self, design: Design) -> None:
        self.design, self.dims = design, design.dimensions
        self.evaluator = MeshEvaluator(_TOLERANCE_MM)
        self._meshes: dict[tuple[Solid, bool], Mesh] = {}

    @property
    def head(self) -> Point3:
        """Middle of the sensor's head, on the flat or its platform."""
        return 0.0, -self.dims.platform_depth, self.dims.sensor_z

    def solid(self, solid: Solid, colour: Colour, shift: Point3 = (0.0, 0.0, 0.0), *, cut: bool = False) -> Shown:
        """Show a solid, shifted, and cut open along x = 0 if asked for."""
        mesh = self._meshes.get((solid, cut))
        if mesh is None:
            manifold = self.evaluator.manifold(solid)
            mesh = to_canonical_mesh(manifold.trim_by_plane((1.0, 0.0, 0.0), 0.0) if cut else manifold)
            self._meshes[solid, cut] = mesh
        return Shown(Mesh(mesh.vertices + np.array(shift), mesh.triangles), colour)

    def part(self, name: str, shift: Point3 = (0.0, 0.0, 0.0), *, cut: bool = False) -> Shown:
        return self.solid(PARTS[name].solid(self.design), PARTS[name].colour, shift, cut=cut)

    def sensor(self, shift: Point3 = (0.0, 0.0, 0.0)) -> Shown:
        return self.solid(sensor_body(self.design), Paint.SENSOR, shift)

    def assembled_bone(self) -> list[Shown]:
        return [self.part("bone"), self.sensor()]

    def cup(self, level: float) -> list[Shown]:
        """Show a cup that stands on z = 0, cut open, filled to a level [mm]."""
        middle, reach = (0.0, 0.0), 2 * CUP_RADIUS_MM
        outside = cylinder("z", middle, 0.0, _CUP_HEIGHT_MM, CUP_RADIUS_MM + _WALL_MM)
        inside = cylinder("z", middle, _WALL_MM, _CUP_HEIGHT_MM + 1.0, CUP_RADIUS_MM)
        front = Box((-reach, -reach, _WALL_MM), (reach, 0.0, _CUP_HEIGHT_MM + 1.0))
        content = cylinder("z", middle, _WALL_MM, _WALL_MM + level, 0.99 * CUP_RADIUS_MM)
        return [self.solid(difference(outside, inside, front), Paint.GLASS), self.solid(content, Paint.SILICONE)]
