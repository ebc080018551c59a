"""Print time and filament of a plate, estimated from volume and surface of its parts.

Lines beside the surfaces take most of the time: a slicer prints them slowly, and the shorter they are, the slower. The
two rates are fitted to eight plates of five designs, sliced by PrusaSlicer 2.5 at its default speeds. They were within
12 % of its times and 6 % of its volumes; `first_finger` is 6 % too long. Supports are left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.printing.orientations import print_orientations
from fingertip.cad.printing.overhang import bed_pose
from fingertip.cad.printing.settings import PROFILE, infill_percent
from fingertip.cad.shapes.parts import PARTS
from fingertip.design import Design

ERROR_PERCENT = 15
"""Error within which PrusaSlicer's times lie, rounded up."""
_COARSE_MM = 0.2
"""Tolerance of the meshes [mm]: finer ones change the time by 0.2 %."""
_LINE_MM, _CLOSED_LAYERS = 0.45, 3
"""Width of a line, and layers without infill above and below [mm]: the slicer's defaults."""
_BESIDE_SURFACE, _WITHIN, _FITTED_LAYER_MM = 12.0, 4.0, 0.15
"""Minutes per cm3 of lines beside surfaces and of what lies between them, in layers of this height."""


@dataclass(frozen=True)
class PrintEstimate:
    minutes: float
    filament_cm3: float
    """Volume of the filament, without supports."""


@lru_cache(maxsize=8)
def estimate_print(design: Design) -> PrintEstimate:
    """Estimate one plate with all parts, printed as the design's profile says."""
    evaluator, minutes, filament = MeshEvaluator(_COARSE_MM), 0.0, 0.0
    for name, lies in print_orientations(design).items():
        mesh = evaluator.mesh(PARTS[name].solid(design))
        mesh = bed_pose(mesh, lies.rotate_x_deg).apply(mesh)
        corners = mesh.vertices[mesh.triangles]
        areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2000.0
        upright, flat = (np.hypot(areas[:, 0], areas[:, 1]).sum(), np.abs(areas[:, 2]).sum())  # from beside, from above
        volume = mesh.volume() / 1000.0
        beside = min(volume, float(upright) * PROFILE.walls * _LINE_MM)
        closed = min(volume - beside, float(flat) * _CLOSED_LAYERS * PROFILE.layer_mm)
        within = closed + (volume - beside - closed) * infill_percent(name) / 100.0
        minutes += (_BESIDE_SURFACE * beside + _WITHIN * within) * _FITTED_LAYER_MM / PROFILE.layer_mm
        filament += beside + within
    return PrintEstimate(minutes, filament)
