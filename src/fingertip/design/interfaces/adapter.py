"""Adapter: a body that another program has drawn, united with the base, and its rules.

The datum plane of the file passes through a point, across the axis that points to the tip. The
plane is laid on the proximal end of the base, with the point in the middle of that end. Past this
plane the adapter must stay within the base.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fingertip.design.formulas.stress_and_knock import AT_CORNER, CORNER_REACH_MM, StressFactors
from fingertip.design.geometry import DesignTables
from fingertip.design.geometry.sizes import Size
from fingertip.design.interfaces import interface
from fingertip.design.interfaces.interface import JointInterface
from fingertip.design.rules.ruleset import Rule, Ruleset, Violation
from fingertip.design.rules.skin import bone_left_at_sides, bone_left_dorsally
from fingertip.foundation.errors import FingertipError, quote_value
from fingertip.models.adapter import place_adapter
from fingertip.models.conic import quarter_outline

if TYPE_CHECKING:
    from manifold3d import CrossSection, Manifold


_TOUCH_MM = 1e-5
"""Gap that counts as none [mm]."""
_BESIDE_MM = 0.02
"""Length by which an adapter may stand out of the base past the datum plane [mm]."""
_MIN_SHARE = 0.25
"""Least share of the end of the base that the adapter touches."""
_POINTS = 64
"""Chords of a quarter of the outline of the base."""
_LOW_Z = 2
_HIGH_Z = 5
"""Indices of the heights in a bounding box of manifold3d."""


class Adapter(JointInterface):
    """Body of a file, at the end of the base. Its holes end at the base."""

    name = "file"
    face_on_plate = weakest = "the adapter"
    supports_below = "under the foot of the collar, the end of the base and the adapter"

    def genus(self, design: DesignTables) -> int:
        """Count the through holes by Euler's formula.

        The body has 1 - (vertices - triangles / 2) / 2 of them. Where it touches the base in
        several pieces, each piece after the first makes one hole more. Where it touches in a ring,
        the base closes the hole inside.
        """
        body = design.read_adapter()
        half_characteristic = (len(body.vertices) - len(body.triangles) // 2) // 2
        pieces = _measure(design).touch.decompose()
        touching: int = sum(2 - piece.num_contour() for piece in pieces)

        return touching - half_characteristic

    def low_z(self, design: DesignTables) -> float:
        return float(place_adapter(design).move()[:, 2].min())

    def sizes(self, design: DesignTables) -> list[Size]:
        return [interface.base_length_size(design)]

    def notes(self, design: DesignTables) -> tuple[str, ...]:
        return ("All other sizes of the adapter: see its own drawing.",)

    def moment_share(self, design: DesignTables, z: float) -> float:
        """Fraction of the bending moment that a section carries.

        It falls from 1, where the hand begins to hold the adapter, to 0 at the end of the adapter.
        """
        low = self.low_z(design)
        held = -design.bone.base_length_mm - design.bone.adapter_free_mm
        if held <= low:
            return 1.0

        return min(1.0, max(0.0, (z - low) / (held - low)))

    def stress_factors(self, design: DesignTables, z: float) -> StressFactors:
        """Find the factors at the corner between base and adapter; those within it are unknown."""
        is_at_corner = abs(z + design.bone.base_length_mm) <= CORNER_REACH_MM
        return AT_CORNER if is_at_corner else StressFactors()


RULES = Ruleset(when=lambda design: design.bone.interface == "file")


@RULES.rule("bone.adapter_file", bone_left_at_sides, bone_left_dorsally)
def adapter_is_read(design: DesignTables) -> Violation | None:
    if not design.bone.adapter_file:
        return Violation("no file is named; add --set bone.adapter_file=PATH of a STEP or STL file")

    try:
        design.read_adapter()
    except FingertipError as error:
        reason = error.issues[0].message.removesuffix(".")
        return Violation(f"{quote_value(design.bone.adapter_file)} {reason}")

    return None


def _rule_along(axis: str) -> Rule:
    """Add a rule for the place of the datum plane along one axis of the file.

    The adapter reaches the end of the base, and past it lies within the base.
    """

    @RULES.rule(
        f"bone.adapter_{axis}_mm",
        adapter_is_read,
        when=lambda design: design.bone.adapter_axis[-1] == axis,
    )
    def adapter_on_base(design: DesignTables) -> Violation | None:
        measured = _measure(design)
        if measured.reach_mm >= -_TOUCH_MM and not measured.beside_mm:
            return None

        place = design.value(f"bone.adapter_{axis}_mm")
        problem = f"leaves a gap of {-measured.reach_mm:.4g} mm between adapter and base"
        if measured.beside_mm:
            problem = (
                f"lets the adapter reach {measured.beside_mm:.4g} mm past the end of the base, "
                "beside it or wholly within it"
            )

        return Violation(f"{place:g} mm {problem}", (_find_passing(design, place, measured),))

    return adapter_on_base


def _find_passing(design: DesignTables, place: float, measured: _Measured) -> tuple[float, float]:
    """Find the places of the datum plane, by its coordinate [mm], that pass the rule."""
    up = -1.0 if design.bone.adapter_axis[0] == "-" else 1.0
    touching = math.floor(100.0 * (up * place + measured.reach_mm + _TOUCH_MM / 2)) / 100.0
    if measured.beside_mm:
        inside = round(up * place + measured.beside_mm, 2)
        ends = (up * touching, up * min(touching, inside))
    else:
        ends = (up * touching, -up * math.inf)

    return min(ends), max(ends)


_ALONG = tuple(map(_rule_along, "xyz"))


@RULES.rule("bone.adapter_file", adapter_is_read, *_ALONG)
def adapter_touches_base(design: DesignTables) -> Violation | None:
    share = _measure(design).share
    if share >= _MIN_SHARE:
        return None

    problem = f"touches {share:.0%} of the end of the base, less than {_MIN_SHARE:.0%}"
    return Violation(f"{problem}; draw it wider there, or move its datum plane")


@dataclass(frozen=True, eq=False)
class _Measured:
    """Place of an adapter at the base."""

    reach_mm: float
    """Length by which it reaches past the end of the base, negative with a gap."""
    beside_mm: float
    """Length by which it reaches past that end outside the base; 0 if it does not.

    All of an adapter of which nothing is left outside the base counts as beside it.
    """
    touch: CrossSection
    """Section in which both touch."""
    share: float
    """Share of the end of the base that it touches."""


def _measure(design: DesignTables) -> _Measured:
    from manifold3d import Manifold, Mesh64  # noqa: PLC0415

    placed = place_adapter(design)
    adapter = Manifold(Mesh64(placed.move(), placed.body.triangles.astype("uint64")))
    end = -design.bone.base_length_mm
    outline = _outline_base(design)
    touch = adapter.slice(end - _BESIDE_MM / 2) ^ outline

    return _Measured(
        reach_mm=adapter.bounding_box()[_HIGH_Z] - end,
        beside_mm=_measure_beside_mm(design, adapter, outline),
        touch=touch,
        share=touch.area() / outline.area(),
    )


def _outline_base(design: DesignTables) -> CrossSection:
    """Outline the end of the base, with its palmar flat."""
    from manifold3d import CrossSection  # noqa: PLC0415

    section = design.dimensions.bone_outline.section
    flat = design.dimensions.base_flat_depth
    palmar_y = [-flat * i / _POINTS for i in range(_POINTS, 0, -1)]
    palmar = [(section.half_width_at(y), y) for y in palmar_y]
    right = [*palmar, *quarter_outline(section, True, _POINTS)]
    left = [(-x, y) for x, y in reversed(right[:-1])]
    return CrossSection([[*right, *left]])


def _measure_beside_mm(design: DesignTables, adapter: Manifold, outline: CrossSection) -> float:
    """Measure `beside_mm` of `_Measured`."""
    end = -design.bone.base_length_mm
    past = adapter.trim_by_plane((0.0, 0.0, 1.0), end + _BESIDE_MM)
    is_partly_outside = adapter.bounding_box()[_LOW_Z] < end - _BESIDE_MM

    if is_partly_outside:
        height = -design.bone.collar_length_mm - end
        past = past - outline.offset(_BESIDE_MM).extrude(height).translate((0.0, 0.0, end))

    return past.bounding_box()[_HIGH_Z] - end if past.volume() > 0.0 else 0.0
