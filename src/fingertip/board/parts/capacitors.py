"""Capacitors of the board: which dielectric a value needs, which tolerance is sold, and which values the table has.

C0G is made up to some capacitance in each size. Above it X7R is required, whose capacitance falls with direct voltage
and age, and which is sold with 10 %. Capacitors of 5 % are C0G.
"""

from __future__ import annotations

import functools
from dataclasses import replace

from fingertip.board.parts.requirement import CapacitorRequirement
from fingertip.board.parts.select_part import find_capacitors
from fingertip.board.parts.table import load_capacitors
from fingertip.design.filter_components import MAX_1206_F

MAX_C0G_F = {"1206": 100e-9, "0603": 10e-9}
"""Largest capacitance [F] that each size is made with as C0G."""
SOLD_PERCENT = {"C0G": 5.0, "X7R": 10.0, "X5R": 20.0}
"""Tolerance [%] to expect of a dielectric where the parts table does not have the value."""

_ROUNDING = 1e-9
_C0G = CapacitorRequirement(("C0G",), 25.0, 0.0)
_X7R = CapacitorRequirement(("X7R",), 16.0, 0.0)
_LARGE = CapacitorRequirement(("X5R", "X7R"), 6.3, 0.0)
"""Large capacitors have no direct voltage across them and set no cutoff."""
SUPPLY_CAPACITOR = CapacitorRequirement(("X7R",), 25.0, 10.0)
"""Decoupling capacitors."""
BULK_CAPACITOR = CapacitorRequirement(("X5R", "X7R"), 25.0, 10.0)
"""Large capacitors at the entry of the supply and across dividers, whose capacitance matters little."""


def require_capacitor(farad: float, package: str, stated_percent: float = 0.0) -> CapacitorRequirement:
    """Return the requirement for a capacitor of the signal path.

    Parameters
    ----------
    farad
        Capacitance [F].
    package
        Size by its inch code.
    stated_percent
        Tolerance that the design states [%]; 0 for the one that is sold. Large capacitors ignore it.
    """
    if farad > MAX_1206_F * (1.0 + _ROUNDING):
        return replace(_LARGE, tolerance_percent=find_sold_percent(farad, package, _LARGE))
    kind = _C0G if farad <= MAX_C0G_F[package] * (1.0 + _ROUNDING) else _X7R
    return replace(kind, tolerance_percent=stated_percent or find_sold_percent(farad, package, kind))


def find_sold_percent(farad: float, package: str, kind: CapacitorRequirement) -> float:
    """Find the tolerance [%] with which a capacitor [F] is sold: the table's, or that of its dielectric."""
    any_tolerance = replace(kind, tolerance_percent=float("inf"))
    found = next(find_capacitors(farad, package, any_tolerance), None)
    return found.tolerance_percent if found else max(SOLD_PERCENT[name] for name in kind.dielectrics)


@functools.cache
def list_capacitances(package: str) -> tuple[float, ...]:
    """List the capacitances [F] of the signal path that the table has in a package, in ascending order."""
    farads = {item.farad for item in load_capacitors() if item.package == package}
    return tuple(sorted(f for f in farads if any(find_capacitors(f, package, require_capacitor(f, package)))))
