"""Plates: printed parts side by side on the bed of a printer."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

_ROUNDING_MM = 1e-6
"""Overlap that counts as none [mm]."""
_SHIFT_DIGITS = 3
"""Decimals of the shift to the middle of the bed [mm]."""


@dataclass(frozen=True)
class PlateKind:
    """Process for which plates are made."""

    name: str
    gap_mm: float
    """Distance between two parts, seen from above [mm]."""

    def file_names(self, count: int) -> tuple[str, ...]:
        """Names of the files of a number of plates; a single plate has no number."""
        numbers = [""] if count == 1 else [f"_{number}" for number in range(1, count + 1)]
        return tuple(f"plate_{self.name}{number}.3mf" for number in numbers)


FDM = PlateKind("fdm", 5.0)
"""Filament: room for the nozzle, and for a brim around each part."""
SLA = PlateKind("sla", 2.5)
"""Resin: room for supports and their raft around each part."""
PLATE_KINDS = (FDM, SLA)


@dataclass(frozen=True)
class Placed:
    """Part on a plate, as the rectangle that it covers [mm]."""

    name: str
    is_turned: bool
    """True if the part is turned by a quarter turn about the vertical."""
    x: float
    y: float
    width: float
    depth: float

    def distance(self, other: Placed) -> float:
        """Measure the gap to another part along x or y, the larger of both; negative if they overlap."""
        along_x = max(other.x - self.x - self.width, self.x - other.x - other.width)
        along_y = max(other.y - self.y - self.depth, self.y - other.y - other.depth)
        return max(along_x, along_y)


Plate = tuple[Placed, ...]


def arrange(footprints: Mapping[str, tuple[float, float]], bed: tuple[float, float], gap: float) -> tuple[Plate, ...]:
    """Place parts on as few plates as a simple search finds, each in the middle of its bed.

    A part that is larger than the bed has a plate of its own, beyond whose edges it reaches.

    Parameters
    ----------
    footprints
        Width and depth of each part [mm].
    bed
        Width and depth of the bed [mm].
    gap
        Distance between parts [mm].
    """
    # Large parts come first. Turns are tried from none to all, until everything lies on one plate.
    names = sorted(footprints, key=lambda name: (-footprints[name][0] * footprints[name][1], name))
    best: list[list[Placed]] = []
    for turns in product((False, True), repeat=len(names)):
        plates: list[list[Placed]] = []
        for name, is_turned in zip(names, turns, strict=True):
            width, depth = footprints[name][::-1] if is_turned else footprints[name]
            _place(plates, Placed(name, is_turned, 0.0, 0.0, width, depth), bed, gap)
        if not best or len(plates) < len(best):
            best = plates
        if len(best) <= 1:
            break
    return tuple(_centred(plate, bed) for plate in best)


def _place(plates: list[list[Placed]], part: Placed, bed: tuple[float, float], gap: float) -> None:
    """Place a part on the first plate with room, as near to its front left corner as possible; else on a new one."""
    for plate in plates:
        free = [
            spot
            for spot in _spots(plate, part, gap)
            if spot.x + spot.width <= bed[0] + _ROUNDING_MM
            and spot.y + spot.depth <= bed[1] + _ROUNDING_MM
            and all(spot.distance(other) >= gap - _ROUNDING_MM for other in plate)
        ]
        if free:
            plate.append(min(free, key=lambda spot: (spot.y + spot.depth, spot.x)))
            return
    plates.append([part])


def _spots(plate: Sequence[Placed], part: Placed, gap: float) -> Iterator[Placed]:
    """List the places of a part at the left or the front edge of the bed, or right of or behind another part."""
    columns = [0.0, *(other.x + other.width + gap for other in plate)]
    rows = [0.0, *(other.y + other.depth + gap for other in plate)]
    for x, y in product(columns, rows):
        yield Placed(part.name, part.is_turned, x, y, part.width, part.depth)


def _centred(plate: Sequence[Placed], bed: tuple[float, float]) -> Plate:
    """Move the parts of a plate together to the middle of the bed."""
    right, back = max(part.x + part.width for part in plate), max(part.y + part.depth for part in plate)
    dx, dy = (round((size - used) / 2, _SHIFT_DIGITS) for size, used in zip(bed, (right, back), strict=True))
    return tuple(
        Placed(part.name, part.is_turned, part.x + dx, part.y + dy, part.width, part.depth) for part in plate
    )  # fmt: skip
