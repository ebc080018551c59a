"""Workbench: the parts of one design and the tools beside them, as meshes for the scenes."""

from __future__ import annotations

import numpy as np

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator, to_canonical_mesh
from fingertip.design import Design
from fingertip.models.parts import PARTS
from fingertip.models.sensor_pocket import sensor_body
from fingertip.models.solids import Box, Point3, Solid, cylinder
from fingertip.pictures import colours
from fingertip.pictures.labelled_scene import PaintedMesh
from fingertip.pictures.raster import Colour

_TOLERANCE_MM = 0.05
"""Tolerance of the meshes."""
CUP_RADIUS_MM = 22.0
"""Inner radius of the mixing cup."""
_CUP_HEIGHT_MM = 45.0
"""Height of the mixing cup."""
_CUP_WALL_MM = 0.8
"""Thickness of the mixing cup's wall and bottom."""
_CONTENT_RADIUS_MM = 0.99 * CUP_RADIUS_MM
"""Radius of what is in the mixing cup, a little smaller, so that the wall is drawn in front."""
_CUT_PAST_MM = 1.0
"""Distance by which what is cut from the mixing cup reaches past its rim."""
_UNMOVED = (0.0, 0.0, 0.0)
"""Shift of what is drawn in its place."""
_TOWARDS_CUT_HALF = (1.0, 0.0, 0.0)
"""Direction in which the half that a section shows lies from x = 0."""
_DISTAL = (0.0, 0.0, 1.0)
"""Direction to the tip of the finger."""
_PROXIMAL = (0.0, 0.0, -1.0)
"""Direction to the hand."""


class Workbench:
    """Parts of one design and what lies with them, as meshes."""

    def __init__(self, design: Design) -> None:
        self.design = design
        self.dims = design.dimensions
        self.evaluator = MeshEvaluator(_TOLERANCE_MM)
        self._meshes: dict[tuple[Solid, bool], Mesh] = {}

    @property
    def head(self) -> Point3:
        """Middle of the sensor's head, on the flat or its platform [mm]."""
        return 0.0, -self.dims.platform_depth, self.dims.sensor_z

    def solid(
        self,
        solid: Solid,
        colour: Colour,
        shift: Point3 = _UNMOVED,
        *,
        cut: bool = False,
    ) -> PaintedMesh:
        """Show a solid, shifted [mm], and cut open along x = 0 if asked for."""
        mesh = self._mesh(solid, cut=cut)
        return PaintedMesh(Mesh(mesh.vertices + np.array(shift), mesh.triangles), colour)

    def part(self, name: str, shift: Point3 = _UNMOVED, *, cut: bool = False) -> PaintedMesh:
        """Show a part by its name in `PARTS`, shifted [mm], and cut open if asked for."""
        part = PARTS[name]
        return self.solid(part.solid(self.design), part.colour, shift, cut=cut)

    def sensor(self, shift: Point3 = _UNMOVED) -> PaintedMesh:
        """Show the sensor, shifted [mm]."""
        return self.solid(sensor_body(self.design), colours.SENSOR, shift)

    def assembled_bone(self) -> list[PaintedMesh]:
        """Show the bone with the sensor in its place."""
        return [self.part("bone"), self.sensor()]

    def turned_up_skin(self, fold_z: float, shift_z: float) -> list[PaintedMesh]:
        """Show half of the skin, shifted along z, its edge turned inside out up to a fold [mm]."""
        skin = PARTS["skin"]
        whole = self.evaluator.manifold(skin.solid(self.design)).translate((0.0, 0.0, shift_z))
        half = whole.trim_by_plane(_TOWARDS_CUT_HALF, 0.0)

        tip = to_canonical_mesh(half.trim_by_plane(_DISTAL, fold_z))
        edge = to_canonical_mesh(half.trim_by_plane(_PROXIMAL, -fold_z))

        return [
            PaintedMesh(tip, skin.colour),
            PaintedMesh(self._turn_inside_out(edge, fold_z), skin.colour),
        ]

    def mixing_cup(self, level_mm: float) -> list[PaintedMesh]:
        """Show a cup that stands on z = 0, cut open, filled to a level above its bottom."""
        rim = _CUP_HEIGHT_MM
        past_rim = rim + _CUT_PAST_MM
        reach = 2 * CUP_RADIUS_MM
        outside = _upright_cylinder(0.0, rim, CUP_RADIUS_MM + _CUP_WALL_MM)
        inside = _upright_cylinder(_CUP_WALL_MM, past_rim, CUP_RADIUS_MM)
        front = Box((-reach, -reach, _CUP_WALL_MM), (reach, 0.0, past_rim))
        content = _upright_cylinder(_CUP_WALL_MM, _CUP_WALL_MM + level_mm, _CONTENT_RADIUS_MM)

        return [
            self.solid(outside.cut(inside, front), colours.GLASS),
            self.solid(content, colours.SILICONE),
        ]

    def _mesh(self, solid: Solid, *, cut: bool) -> Mesh:
        """Return the mesh of a solid or of its half at x > 0, built once."""
        if (solid, cut) not in self._meshes:
            manifold = self.evaluator.manifold(solid)
            if cut:
                manifold = manifold.trim_by_plane(_TOWARDS_CUT_HALF, 0.0)

            self._meshes[solid, cut] = to_canonical_mesh(manifold)

        return self._meshes[solid, cut]

    def _turn_inside_out(self, edge: Mesh, fold_z: float) -> Mesh:
        """Mirror the edge of the skin in the plane of its fold and in its outer surface."""
        outer = self.dims.outer.section
        x, y, z = edge.vertices.T
        outer_y = np.where(y < 0.0, outer.palmar, outer.dorsal)
        stretch = 2.0 / np.hypot(x / outer.half_width, y / outer_y) - 1.0
        vertices = np.stack((x * stretch, y * stretch, 2.0 * fold_z - z), axis=1)

        return Mesh(vertices, edge.triangles)


def _upright_cylinder(low: float, high: float, radius: float) -> Solid:
    """Build a cylinder about the z axis between two heights [mm]."""
    return cylinder("z", centre=(0.0, 0.0), low=low, high=high, radius=radius)
