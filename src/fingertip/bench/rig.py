"""Rig: a printed slide on which the finger, in its stand, slips, and whose contacts tell when it moves.

A weight on a string pulls the slide between two guides, from a screw against which it rests to another one. Copper foil
on the slide closes a circuit at both, so that it is open while the slide moves. The finger hangs on an arm, whose hinge
is as high as the surface: friction has no lever, and the force stays that of the weights. Lengths in mm; x runs from
the hinge to the tip of the finger, z up from the table. Each part lies as it is printed, without supports.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.bench.trials import OPEN_MM, STROKE_M, onset_s
from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.printing.orientations import build_volume_excess
from fingertip.cad.printing.overhang import MAX_UNSUPPORTED_MM2, find_ceilings
from fingertip.cad.shapes import bench
from fingertip.cad.shapes.parts import Part
from fingertip.cad.verification.check import Check
from fingertip.cad.verification.printing import check_mesh_file
from fingertip.cad.verification.walls import measure_walls
from fingertip.design import Design
from fingertip.design.geometry.solids import Box, Solid, cylinder, difference, union
from fingertip.documents.template import render_page
from fingertip.foundation.errors import DesignError, Issue

SHEET, STROKE_MM = "rig.md", 1000 * STROKE_M
FILES = ("rig_base.stl", "rig_slide.stl", "rig_arm.stl", SHEET)
_LONGEST_S = 0.35
"""Longest travel of the slide that the sheet allows [s]."""
_PLATE, _SLIDE, _STRIP, _PLAY = 4.0, 9.0, 1.0, 0.3
"""Thickness of plate, slide and strip, and play beside the slide."""
_HALF_WIDTH, _GUIDE, _WALL, _CONTACT_Y = 22.0, 5.0, 8.0, 16.0
"""Half the width of the slide, width of a guide, thickness of the end walls, and place of the screws across."""
_BEFORE, _BEHIND, _ROOM = 14.0, 12.0, 1.5
"""Surface on both sides of the pad at the ends of its way, and room for the tip of a contact's screw."""
_TILT_DEG, _HINGE_GAP, _EYE, _CHEEK = 6.0, 12.0, 6.0, 3.0
"""Tilt of the finger, distance from hinge to bar, radius of the eye, and wall beside the bar."""
_SCREW, _THREAD, _TIE, _FREE = 1.65, 1.35, 1.5, 4.0
"""Radii of M3 with clearance and where it cuts its thread, thickness of a cable tie, and free edge of the bar."""


@dataclass(frozen=True)
class Rig:
    """Sizes that follow from the design. Raises DesignError for a finger without stand or stub."""

    design: Design

    def __post_init__(self) -> None:
        if self.design.bone.interface not in ("post", "clevis"):
            message = f"{self.design.bone.interface!r} has no bar that the rig could hold; choose post or clevis."
            raise DesignError(Issue("bone.interface", message))

    @property
    def bar(self) -> Box:
        """Bar of the stand or of the stub, in the coordinates of the finger."""
        is_post = self.design.bone.interface == "post"
        return bench.stand_outline(self.design) if is_post else bench.bars(self.design)[1]

    @property
    def bar_size(self) -> tuple[float, float, float]:
        x, y, z = (high - low for low, high in zip(self.bar.low, self.bar.high, strict=True))
        return x, y, z

    @property
    def pad_depth(self) -> float:
        """Height of the bar's axis above the pad."""
        return (self.bar.low[1] + self.bar.high[1]) / 2 + self.design.skin.semi_axis_palmar_mm

    @property
    def reach(self) -> float:
        """Distance along the bar from the hinge to the pad."""
        return self.design.dimensions.sensor_z - self.bar.low[2] + _HINGE_GAP

    @property
    def hinge_depth(self) -> float:
        """Depth of the hinge below the bar's axis, at which it is as high as the pad that touches."""
        return self.pad_depth + self.reach * math.tan(math.radians(_TILT_DEG))

    @property
    def pad_x(self) -> float:
        return self.reach / math.cos(math.radians(_TILT_DEG))

    @property
    def clearance(self) -> float:
        """Room between the cable ties around the front of the bar and the surface."""
        tilt, front = math.radians(_TILT_DEG), _HINGE_GAP + self.bar_size[2]
        height = (self.hinge_depth - self.bar_size[1] / 2) * math.cos(tilt) - front * math.sin(tilt)
        return height - _TIE

    def base(self) -> Solid:
        """Plate with two guides, two end walls with their screws, and two posts of the hinge."""
        half, surface = _HALF_WIDTH + _PLAY, _PLATE + _SLIDE + _STRIP
        low = self.pad_x - _BEFORE - STROKE_MM - _ROOM
        high = self.pad_x - _BEFORE + self.slide_length + _ROOM
        side, top, screw_z = half + _GUIDE, _PLATE + _SLIDE, _PLATE + _SLIDE / 2
        guides = [Box((low - _WALL, min(y, y + w), 0.0), (high + _WALL, max(y, y + w), top - 2.0))
                  for y, w in ((half, _GUIDE), (-half, -_GUIDE))]  # fmt: skip
        walls = [Box((x, -side, 0.0), (x + _WALL, side, top)) for x in (low - _WALL, high)]
        inner = self.leg_half + 2 * _PLAY
        posts = [Box((-_EYE, min(y, y + w), 0.0), (_EYE, max(y, y + w), surface + _EYE))
                 for y, w in ((inner, _EYE), (-inner, -_EYE))]  # fmt: skip
        plate = Box((-_EYE - 4.0, -side, 0.0), (high + _WALL, side, _PLATE))
        holes = [cylinder("x", (_CONTACT_Y, screw_z), x - 1.0, x + _WALL + 1.0, _THREAD) for x in (low - _WALL, high)]
        string = cylinder("x", (0.0, _PLATE + 3.0), low - _WALL - 1.0, low + 1.0, 1.8)
        hinge = cylinder("y", (surface, 0.0), -side, side, _SCREW)
        return difference(union(plate, *guides, *walls, *posts), *holes, string, hinge)

    @property
    def slide_length(self) -> float:
        return _BEFORE + STROKE_MM + _BEHIND

    @property
    def leg_half(self) -> float:
        return 10.0

    def slide(self) -> Solid:
        """Block, upside down: a pocket for the knot opens at its bottom, and the string leaves through its end."""
        block = Box((0.0, -_HALF_WIDTH, 0.0), (self.slide_length, _HALF_WIDTH, _SLIDE))
        knot = cylinder("z", (7.0, 0.0), 3.0, _SLIDE + 1.0, 3.0)
        return difference(block, knot, cylinder("x", (0.0, _SLIDE - 3.0), -1.0, 7.0, 1.2))

    def arm(self) -> Solid:
        """Beam that lies on its upper side, with a channel for the bar and the leg of the hinge."""
        width, height, length = self.bar_size
        front, beam, inner = _HINGE_GAP + length, 5.0, width / 2 + _PLAY
        hinge = beam + height / 2 + self.hinge_depth
        cheeks = [Box((_HINGE_GAP, min(y, y + w), 0.0), (front, max(y, y + w), beam + height - _FREE))
                  for y, w in ((inner, _CHEEK), (-inner, -_CHEEK))]  # fmt: skip
        half = max(20.0, inner + _CHEEK)
        whole = union(
            Box((-_EYE, -half, 0.0), (front, half, beam)), *cheeks,
            Box((-_EYE, -self.leg_half, 0.0), (_EYE, self.leg_half, hinge + _EYE)),
        )  # fmt: skip
        return difference(whole, cylinder("y", (hinge, 0.0), -half - 1.0, half + 1.0, _SCREW))


def make_rig(design: Design, tolerance_mm: float = 0.01) -> tuple[dict[str, bytes], list[Check]]:
    """Make the STL files and the sheet of a rig, and its checks. Raises DesignError."""
    rig, evaluator = Rig(design), MeshEvaluator(tolerance_mm)
    files, checks = dict[str, bytes](), [Check("rig.clearance", rig.clearance, 0.5, "mm", "at least")]
    for name, solid, genus in (("rig_base", rig.base(), 5), ("rig_slide", rig.slide(), 1), ("rig_arm", rig.arm(), 1)):
        part = _as_part(name, solid, genus)
        mesh = evaluator.mesh(solid)
        files[f"{name}.stl"] = stl.to_bytes(mesh, name)
        checks += check_mesh_file(design, part, mesh, "stl")
        checks.append(Check(f"{name}.build_volume_excess", build_volume_excess(design, mesh), 0.0, "mm"))
        overhang = max((ceiling.unsupported_mm2() for ceiling in find_ceilings(mesh)), default=0.0)
        checks.append(Check(f"{name}.overhang", overhang, MAX_UNSUPPORTED_MM2, "mm2"))
        thin = measure_walls(evaluator.manifold(solid), design.printer.min_wall_mm)
        checks.append(Check(f"{name}.thin_walls", thin.area_mm2, 0.0, "mm2"))
    lag_s, error_s = onset_s(_LONGEST_S, STROKE_MM / 1000, design.detector.sample_rate_hz)
    is_jointed = design.bone.interface == "clevis"
    files[SHEET] = render_page(
        "rig.md", name=design.name, stroke_mm=STROKE_MM, longest_ms=1000 * _LONGEST_S, lag_ms=round(1000 * lag_s, 1),
        error_ms=round(1000 * error_s, 1), open_mm=OPEN_MM, holder="hand_stub" if is_jointed else "stand",
        is_jointed=is_jointed,
    ).encode()  # fmt: skip
    return files, checks


def _as_part(name: str, solid: Solid, genus: int) -> Part:
    return Part(name, lambda _: solid, lambda _: genus, (0.7, 0.7, 0.7), True)
