"""Arguments and answers of checks, their register, and measurements that several of them need.

A check is a function of a design and its solids that yields records of a value and its limit. It
registers by the decorator of the `Checks` of its module, which `cad.verification.verify` lists;
checks of other packages come by the entry points of the group "fingertip.checks".
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cached_property
from types import MappingProxyType
from typing import Any

from fingertip.cad.kernel.mesh import Manifold, Mesh, MeshEvaluator
from fingertip.cad.verification.strength import BoneStrength, assess_strength
from fingertip.design import Design
from fingertip.foundation.files import round_for_output
from fingertip.foundation.validation import Comparison
from fingertip.models.parts import PARTS, print_scale
from fingertip.models.solids import Box, Solid

VOLUME_TOLERANCE_MM3 = 1e-3
"""Largest volume that counts as zero [mm3].
Rounding 10 000 mm2 of surface to a grid of 8 nm stays below it.
"""
PLANE_OFFSET_MM = 0.02
"""Distance of a cut from a plane on which solids end [mm]. In the plane itself they would touch."""

_REACH_GROWTH = 1.25
"""Factor from one search for a distance to the next.
The time of a search grows with about the cube of its reach.
"""
_MIN_REACH_MM = 0.1
"""Reach of a search for a distance of nothing or less, which a coarse mesh leaves of a limit [mm].
"""
_MAX_REACH_MM = 500.0
"""Reach of a search that exceeds the size of every design [mm]."""


@dataclass(frozen=True)
class Check(Comparison):
    """Verified property of a built part."""

    change: tuple[str, ...] = ()
    """Parameters to change if it fails; none if that were a fault of the program."""
    source: str = "fingertip"
    """Program that the check is of."""
    remedy: str = ""
    """Settings with which the check passes if it fails, joined by --set; empty if none is known."""
    is_beyond: bool = False
    """True if the value was looked for up to the limit only, and is larger."""

    @classmethod
    def zero_volume(cls, name: str, volume_mm3: float) -> Check:
        return cls(name, volume_mm3, VOLUME_TOLERANCE_MM3, "mm3")

    @classmethod
    def min_distance(
        cls,
        name: str,
        first: Manifold,
        second: Manifold,
        min_mm: float,
    ) -> Check:
        """Check that two solids are at least `min_mm` apart: on both sides of a wall, they give its
        thickness.
        """
        return cls(
            name=name,
            value=measure_gap(first, second, 2.0 * min_mm),
            limit=min_mm,
            unit="mm",
            relation="at least",
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the entry of this check in report.json."""
        return {
            "name": self.name,
            "value": round_for_output(self.value),
            "limit": round_for_output(self.limit),
            "unit": self.unit,
            "relation": self.relation,
            "passed": self.passed,
            **({} if self.passed else {"change": [*self.change]}),
        }


@dataclass(frozen=True)
class Solids:
    """Parts of a design that are checked together, by their names."""

    design: Design
    evaluator: MeshEvaluator
    parts: Mapping[str, Solid]

    @classmethod
    def of(cls, design: Design, evaluator: MeshEvaluator, parts: Iterable[str]) -> Solids:
        return cls(design, evaluator, {name: PARTS[name].solid(design) for name in parts})

    def __getitem__(self, part: str) -> Manifold:
        """Evaluate a part as a `manifold3d.Manifold`. Raises GeometryError."""
        return self.evaluator.manifold(self.parts[part])

    def mesh(self, part: str) -> Mesh:
        """Evaluate a part as a mesh as its files hold it. Raises GeometryError."""
        return self.evaluator.mesh(self.parts[part].scaled(print_scale(self.design, PARTS[part])))

    @cached_property
    def strength(self) -> BoneStrength:
        return assess_strength(self.design, self.evaluator)


CheckFunction = Callable[[Design, Solids], Iterable[Check]]


@dataclass(frozen=True)
class RegisteredCheck:
    run: CheckFunction
    parts: frozenset[str]
    """Parts without which there is nothing to check."""
    change: Mapping[str, tuple[str, ...]]
    """Pattern of names -> parameters to change if one fails.
    The first pattern that matches counts.
    """

    def find_change(self, name: str) -> tuple[str, ...]:
        return next(
            (change for names, change in self.change.items() if fnmatchcase(name, names)), ()
        )


class Checks(list[RegisteredCheck]):
    """Checks of one subject, in the order in which they are written."""

    def register(
        self, *parts: str, change: Mapping[str, tuple[str, ...]] = MappingProxyType({})
    ) -> Callable[[CheckFunction], CheckFunction]:
        """Register the decorated function, for builds with these parts, and what to change if a
        check of it fails.
        """

        def add(run: CheckFunction) -> CheckFunction:
            self.append(RegisteredCheck(run, frozenset(parts), change))
            return run

        return add


def count_checks(checks: Sequence[Check]) -> str:
    """Say how many checks failed, or that all passed."""
    failed = sum(not check.passed for check in checks)
    return (
        f"{failed} of {len(checks)} checks failed" if failed else f"all {len(checks)} checks passed"
    )


def measure_gap(first: Manifold, second: Manifold, first_reach_mm: float) -> float:
    """Measure the gap between two bodies [mm]; the search begins with this reach."""
    return search_distance(lambda reach_mm: first.min_gap(second, reach_mm), first_reach_mm)


def search_distance(measure: Callable[[float], float], first_reach_mm: float) -> float:
    """Measure a distance [mm] by a search that takes longer the farther it reaches.

    Units: `measure` [mm].
    """
    reach_mm = max(first_reach_mm, _MIN_REACH_MM)
    distance = measure(reach_mm)
    while distance >= reach_mm and reach_mm < _MAX_REACH_MM:
        reach_mm *= _REACH_GROWTH
        distance = measure(reach_mm)

    return distance


def complement(evaluator: MeshEvaluator, solid: Solid) -> Manifold:
    """Evaluate the complement of a solid within a box that extends past it on all sides by the
    solid's width.
    """
    inner = evaluator.manifold(solid)
    low_x, low_y, low_z, high_x, high_y, high_z = inner.bounding_box()
    margin = high_x - low_x
    box = Box(
        (low_x - margin, low_y - margin, low_z - margin),
        (high_x + margin, high_y + margin, high_z + margin),
    )

    return evaluator.manifold(box.cut(solid))


def above_z(solid: Manifold, z: float) -> Manifold:
    """Cut off everything below the height `z` [mm]."""
    return solid.trim_by_plane((0.0, 0.0, 1.0), z)
