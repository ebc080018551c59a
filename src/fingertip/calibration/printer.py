"""Scale and offset of a printer, from caliper readings of two parts that every finger needs.

A reading of a length N between two printed surfaces is scale * N + offset: a positive offset means
that solids grow and hollows shrink by it, half of it on each surface. The palmar half of the cup is
thin, so its thickness shows the offset; the plate of the core is wide, so the difference of both
shows the scale. Both lie in the plane of the bed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from fingertip.design import Design
from fingertip.foundation.errors import DesignError, Issue, raise_issues
from fingertip.models.mold_layout import PLATE_LEDGE_MM

CALIPER_MM = 0.03
"""Error of a reading, of the calipers and of the hand together [mm]. An assumption."""
_USUAL_SCALE_ERROR = 0.003
"""Error of a printer's scale where it is not measured. An assumption."""
_MAX_SCALE_ERROR = 0.02
_MAX_OFFSET_MM = 0.3
"""Largest deviation of a printer that is believed: a share of the length, and a length [mm].
More is a mistake.
"""
_FACTORS = {"inches": 25.4, "centimetres": 10.0}
"""Units that are mistaken for millimetres, with their size in millimetres."""
_OFFSET = "printer.offset_mm"
_SCALE = "printer.scale_percent"


@dataclass(frozen=True)
class Calibration:
    scale: float
    """Printed length over that of the file.
    Without readings that show another, it is the one that the design corrects.
    """
    scale_uncertainty: float
    offset_mm: float
    offset_uncertainty_mm: float
    """Standard uncertainty, as that of the scale."""
    changes: Mapping[str, float]
    """Parameter -> value for this printer."""


def find_nominal_mm(design: Design) -> tuple[float, float]:
    """Return the thickness of the cup's palmar half and the width of the core's plate, as the files
    hold them.
    """
    layout = design.mold_layout
    scale = design.printer.scale_percent / 100.0
    return scale * layout.palmar_height, scale * 2.0 * (layout.half_width + PLATE_LEDGE_MM)


def calibrate_printer(
    design: Design, half_thickness_mm: float, plate_width_mm: float | None = None
) -> Calibration:
    """Derive a printer's parameters from the thickness of `mold_palmar` and the width of the core's
    plate.

    Without the second reading the scale stays. Raises DesignError.
    """
    half, plate = find_nominal_mm(design)
    readings = {"--half-thickness-mm": (half_thickness_mm, half)}
    if plate_width_mm is not None:
        readings["--plate-width-mm"] = plate_width_mm, plate

    issues = list[Issue]()
    for option, (reading_mm, nominal_mm) in readings.items():
        issues += _find_mistakes(option, reading_mm, nominal_mm)

    raise_issues(DesignError, issues)
    percent = design.printer.scale_percent
    scale = 100.0 / percent
    uncertainty = _USUAL_SCALE_ERROR

    if plate_width_mm is not None:
        uncertainty = math.sqrt(2.0) * CALIPER_MM / (plate - half)
        measured = (plate_width_mm - half_thickness_mm) / (plate - half)
        scale = measured if abs(measured - scale) > uncertainty else scale

    offset = half_thickness_mm - scale * half
    stated = round(offset, 2)  # as the design will hold it: calipers read no thousandths
    if abs(scale - 1.0) > _MAX_SCALE_ERROR or abs(stated) > _MAX_OFFSET_MM:
        message = (
            f"the readings mean a scale of {100 * scale:.1f} % and an offset of {stated:.2f} mm, "
            "more than a sound "
            f"printer's {100 * _MAX_SCALE_ERROR:g} % and {_MAX_OFFSET_MM:g} mm; measure again, or "
            "mend the slicer's "
            "settings and print again."
        )
        raise DesignError(Issue(" and ".join(readings), message))

    changes = {_OFFSET: stated}
    if scale != 100.0 / percent:
        changes[_SCALE] = round(100.0 / scale, 2)

    return Calibration(
        scale=scale,
        scale_uncertainty=uncertainty,
        offset_mm=offset,
        offset_uncertainty_mm=math.hypot(CALIPER_MM, half * uncertainty),
        changes=changes,
    )


def apply_calibration(
    design: Design, changes: Mapping[str, Any], name: str | None = None
) -> Design:
    """Make a calibrated design, under a name of its own if one is given: its files then stand in
    another folder.

    Raises DesignError.
    """
    tables = design.with_values(changes).model_dump() | {"name": name or design.name}
    return Design.from_tables(tables, design.model_dump(), tuple(changes), design.provisional)


def _find_mistakes(option: str, reading_mm: float, nominal_mm: float) -> Iterator[Issue]:
    limit = _MAX_SCALE_ERROR * nominal_mm + _MAX_OFFSET_MM
    if math.isfinite(reading_mm) and abs(reading_mm - nominal_mm) <= limit:
        return

    for unit, size in _FACTORS.items():
        if abs(reading_mm * size - nominal_mm) <= limit:
            message = (
                f"{reading_mm:g} looks like {unit}; write it in millimetres, about "
                f"{nominal_mm:.2f}."
            )
            yield Issue(option, message)
            return

    yield Issue(
        option,
        f"{reading_mm:g} mm is more than {limit:.2g} mm off the {nominal_mm:.2f} mm of the file; "
        "set the calipers to "
        "zero, and measure a part of this design again.",
    )
