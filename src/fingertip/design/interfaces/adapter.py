"""Adapter: a body that another program has drawn, united with the base, and its rules.

The datum plane of the file passes through a point, across the axis that points to the tip. It comes
to lie on the proximal end of the base, the point in its middle. Past this plane the adapter stays
within the base.
"""

from __future__ import annotations

import math
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
    from manifold3d import CrossSection


_TOUCH_MM = 1e-5
_BESIDE_MM = 0.02
"""Gap that counts as none, and length by which an adapter may stand
out of the base past the datum plane [mm].
"""
_MIN_SHARE = 0.25
_POINTS = 64
"""Least share of the end of the base that the adapter touches,
and chords of a quarter of its outline.
"""


class Adapter(JointInterface):
    """Body of a file, at the end of the base. Its holes end at the base."""

    name = "file"
    face_on_plate = weakest = "the adapter"
    supports_below = "under the foot of the collar, the end of the base and the adapter"

    def genus(self, design: DesignTables) -> int:
        """Count the holes of the file by Euler's formula; the base
        closes that of a ring on which both touch.
        """
        body = design.read_adapter()
        touch = _measure(design)[2]
        pieces: int = sum(2 - piece.num_contour() for piece in touch.decompose())

        return pieces - (len(body.vertices) - len(body.triangles) // 2) // 2

    def low_z(self, design: DesignTables) -> float:
        return float(place_adapter(design).move()[:, 2].min())

    def sizes(self, design: DesignTables) -> list[Size]:
        return [interface.base_length_size(design)]

    def notes(self, design: DesignTables) -> tuple[str, ...]:
        return ("All other sizes of the adapter: see its own drawing.",)

    def moment_share(self, design: DesignTables, z: float) -> float:
        """The moment falls from where the hand begins to hold the adapter to nothing at its end."""
        low = self.low_z(design)
        held = -design.bone.base_length_mm - design.bone.adapter_free_mm
        return min(1.0, max(0.0, (z - low) / (held - low))) if held > low else 1.0

    def stress_factors(self, design: DesignTables, z: float) -> StressFactors:
        """Find the factors at the corner where the base begins;
        those within the adapter are not known.
        """
        return (
            AT_CORNER if abs(z + design.bone.base_length_mm) <= CORNER_REACH_MM else StressFactors()
        )


RULES = Ruleset(when=lambda design: design.bone.interface == "file")


@RULES.rule("bone.adapter_file", bone_left_at_sides, bone_left_dorsally)
def adapter_is_read(design: DesignTables) -> Violation | None:
    if not design.bone.adapter_file:
        return Violation("no file is named; add --set bone.adapter_file=PATH of a STEP or STL file")

    try:
        design.read_adapter()
    except FingertipError as error:
        return Violation(
            f"{quote_value(design.bone.adapter_file)} {error.issues[0].message.removesuffix('.')}"
        )

    return None


def _rule_along(axis: str) -> Rule:
    """Add the rule, for one axis, that the adapter reaches the datum
    plane, and past it lies within the base.
    """

    @RULES.rule(
        f"bone.adapter_{axis}_mm",
        adapter_is_read,
        when=lambda design: design.bone.adapter_axis[-1] == axis,
    )
    def adapter_on_base(design: DesignTables) -> Violation | None:
        past_mm, beside_mm, *_ = _measure(design)
        if past_mm >= -_TOUCH_MM and not beside_mm:
            return None

        at = design.value(f"bone.adapter_{axis}_mm")
        up = -1.0 if design.bone.adapter_axis[0] == "-" else 1.0
        face = math.floor(100.0 * (up * at + past_mm + _TOUCH_MM / 2)) / 100.0
        low, high = sorted(
            (
                up * face,
                up * min(face, round(up * at + beside_mm, 2)) if beside_mm else -up * math.inf,
            )
        )
        beside = (
            f"lets the adapter reach {beside_mm:.4g} mm past the end of the base, beside it "
            "or wholly within it"
        )
        gap = f"leaves a gap of {-past_mm:.4g} mm between adapter and base"

        return Violation(f"{at:g} mm {beside if beside_mm else gap}", ((low, high),))

    return adapter_on_base


_ALONG = tuple(map(_rule_along, "xyz"))


@RULES.rule("bone.adapter_file", adapter_is_read, *_ALONG)
def adapter_touches_base(design: DesignTables) -> Violation | None:
    *_, share = _measure(design)
    what = f"touches {share:.0%} of the end of the base, less than {_MIN_SHARE:.0%}"
    return (
        None
        if share >= _MIN_SHARE
        else Violation(f"{what}; draw it wider there, or move its datum plane")
    )


def _measure(design: DesignTables) -> tuple[float, float, CrossSection, float]:
    """Measure how far an adapter reaches past its datum plane [mm], negative with a gap, and how
    far beside the base.

    One of which nothing is left outside the base counts as beside it. Also returns the section in
    which both touch, and its share of the end of the base.
    """
    from manifold3d import CrossSection, Manifold, Mesh64  # noqa: PLC0415

    placed = place_adapter(design)
    end = -design.bone.base_length_mm
    section = design.dimensions.bone_outline.section
    flat = design.dimensions.base_flat_depth
    below = [
        (section.half_width_at(-flat * i / _POINTS), -flat * i / _POINTS)
        for i in range(_POINTS, 0, -1)
    ]
    right = [*below, *quarter_outline(section, True, _POINTS)]
    outline = CrossSection([[*right, *((-x, y) for x, y in reversed(right[:-1]))]])
    solid = Manifold(Mesh64(placed.move(), placed.body.triangles.astype("uint64")))
    room = (
        outline.offset(_BESIDE_MM)
        .extrude(-design.bone.collar_length_mm - end)
        .translate((0.0, 0.0, end))
    )
    beside = solid.trim_by_plane((0.0, 0.0, 1.0), end + _BESIDE_MM)
    beside = (
        beside - room if solid.bounding_box()[2] < end - _BESIDE_MM else beside
    )  # something must stay outside
    beside_mm = beside.bounding_box()[5] - end if beside.volume() > 0.0 else 0.0
    touch = solid.slice(end - _BESIDE_MM / 2) ^ outline

    return solid.bounding_box()[5] - end, beside_mm, touch, touch.area() / outline.area()
