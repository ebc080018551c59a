"""Scale and offset of a printer, fitted to the readings of a coupon, and the parameters of its design that follow."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from fingertip.cad.shapes.coupon_layout import WALLS_MM
from fingertip.calibration.readings import Length, Measured
from fingertip.design import Design
from fingertip.foundation.errors import DesignError, Issue
from fingertip.foundation.numerics import CONFIDENCE, chi_square_quantile, t_quantile

# Least squares of the readings. A reading y of a length with the nominal value N, printed between two surfaces, is
#
#   y = scale * N + offset + error for an outer length
#   y = scale * N - offset + error for an inner length
#
# A positive offset means that the printer prints too much: solids grow and hollows shrink by it, half of it on each
# surface. All readings count alike. Readings of one length share the error of its two surfaces, so the errors are not
# independent: the residual variance is therefore taken between the means of the lengths, whose number less two are the
# degrees of freedom. Under independent errors of equally many readings this is exact, too (analysis of variance; N. R.
# Draper and H. Smith, Applied Regression Analysis, 3rd ed., sections 1.5 and 2.1).

_OUTLIER_RISK = 0.01
"""Probability that any reading of a sound file is named an outlier."""
_LEAST_DOUBT_MM = 0.03
"""Difference below which no length is doubted: calipers resolve little more [mm]."""
_SIGN = {"outer": 1.0, "inner": -1.0}


@dataclass(frozen=True)
class Outlier:
    name: str
    number: int
    """Position among the readings of its length, from 1."""
    reading_mm: float
    deviation_mm: float
    """Reading less the fitted value."""


@dataclass(frozen=True)
class Residual:
    """Mean reading of a length, beside what the fit predicts."""

    name: str
    nominal_mm: float
    mean_mm: float
    predicted_mm: float
    is_doubtful: bool
    """True if it differs from the fit by more than chance explains, compared with all other lengths."""

    @property
    def difference_mm(self) -> float:
        return self.mean_mm - self.predicted_mm


@dataclass(frozen=True)
class PrinterFit:
    scale: float
    """Printed length over nominal length."""
    scale_uncertainty: float
    offset_mm: float
    offset_uncertainty_mm: float
    """Standard uncertainty, as that of the scale."""
    length_error_mm: float
    """Standard deviation of the mean of a length about the model."""
    degrees: int
    """Degrees of freedom."""
    readings: int
    outliers: tuple[Outlier, ...]
    residuals: tuple[Residual, ...]
    """Every length that was fitted."""

    @property
    def coverage_factor(self) -> float:
        """Half width of an interval over the standard uncertainty: Student's t."""
        return t_quantile(CONFIDENCE, self.degrees)


def fit_printer(measured: Sequence[Measured]) -> PrinterFit:
    """Fit scale and offset to the readings of outer and inner lengths; thin walls are left out.

    The lengths are at least three, some outer and some inner, and not all equal.
    """
    used = [each for each in measured if each.length.kind in _SIGN]
    rows = [(len(e.readings_mm), e.length.nominal_mm, _SIGN[e.length.kind], e.mean_mm) for e in used]
    nn = math.fsum(w * n * n for w, n, _, _ in rows)
    ns = math.fsum(w * n * s for w, n, s, _ in rows)
    count = sum(w for w, _, _, _ in rows)
    ny = math.fsum(w * n * y for w, n, _, y in rows)
    sy = math.fsum(w * s * y for w, _, s, y in rows)
    determinant = nn * count - ns * ns
    if not determinant or len(rows) < 3:
        message = f"holds {len(rows)} readable lengths; give three or more, outer and inner, as read_readings does."
        raise DesignError(Issue("measured", message))
    scale, offset = (count * ny - ns * sy) / determinant, (nn * sy - ns * ny) / determinant
    degrees = len(rows) - 2
    variance = math.fsum(w * (y - scale * n - offset * s) ** 2 for w, n, s, y in rows) / degrees

    def predict(length: Length) -> float:
        return scale * length.nominal_mm + offset * _SIGN[length.kind]

    def find_leverage(length: Length) -> float:
        """Leverage of one reading of a length: the share of it in the value that is fitted there."""
        n, s = length.nominal_mm, _SIGN[length.kind]
        return (count * n * n - 2.0 * ns * n * s + nn) / determinant

    readings = [(each.length, number, mm) for each in used for number, mm in enumerate(each.readings_mm, 1)]
    deviations = [mm - predict(length) for length, _, mm in readings]
    stands_out = _find_extremes([d * d for d in deviations], [1.0 - find_leverage(length) for length, _, _ in readings])
    means = [(each, predict(each.length), len(each.readings_mm)) for each in used]
    is_doubtful = _find_extremes(
        [weight * (each.mean_mm - predicted) ** 2 for each, predicted, weight in means],
        [1.0 - weight * find_leverage(each.length) for each, _, weight in means],
    )
    return PrinterFit(
        scale, math.sqrt(variance * count / determinant), offset, math.sqrt(variance * nn / determinant),
        math.sqrt(variance * len(rows) / count), degrees, count,
        tuple(
            Outlier(length.name, number, mm, deviation)
            for (length, number, mm), deviation, out in zip(readings, deviations, stands_out, strict=True)
            if out and abs(deviation) > 1e-9
        ),
        tuple(
            Residual(
                each.length.name, each.length.nominal_mm, each.mean_mm, predicted,
                doubtful and abs(each.mean_mm - predicted) > _LEAST_DOUBT_MM,
            )
            for (each, predicted, _), doubtful in zip(means, is_doubtful, strict=True)
        ),
    )  # fmt: skip


def _find_extremes(squares: Sequence[float], kept: Sequence[float]) -> list[bool]:
    """Tell which residuals are too large by chance, from their squares and the parts of them that the fit leaves.

    They are studentised externally, and judged by Bonferroni's bound over all (Draper and Smith, sections 8.1 and 8.4).
    """
    total, degrees = math.fsum(squares), len(squares) - 3
    if degrees <= 0:
        return [False] * len(squares)
    limit = t_quantile(1.0 - _OUTLIER_RISK / len(squares), degrees)
    return [
        left > 0.0 and square > limit * limit * (max(total - square / left, 0.0) / degrees) * left
        for square, left in zip(squares, kept, strict=True)
    ]


CLEARANCES = {
    "sensor.clearance_mm": 1,
    "mold.fit_clearance_mm": 2,
    "mold.key_clearance_mm": 2,
    "mold.nut_width_mm": 2,
    "mold.bolt_diameter_mm": 2,
}
"""Parameters of fits that the coupon shows -> number of printed surfaces between which each is measured.

The sensor is bought, and its pocket is printed. Base and recess, and key and socket, are both printed. Trap and hole
are measured from one printed surface to the other.
"""
_SCALE, _OFFSET, _SURFACE_ERROR, _MIN_WALL = (
    f"printer.{key}" for key in ("scale_percent", "offset_mm", "surface_error_mm", "min_wall_mm")
)
CALIBRATED = (_SCALE, _OFFSET, *CLEARANCES, _SURFACE_ERROR, _MIN_WALL)
MIN_WALL_RATIO = 0.8
"""Least thickness of a printed wall over the nominal one. An assumption."""
_DECIMALS = {"%": 2, "mm": 3}


@dataclass(frozen=True)
class CalibratedValue:
    path: str
    unit: str
    before: float
    value: float
    uncertainty: float
    """Standard uncertainty."""
    low: float
    high: float
    """Ends of the 95 % interval."""


@dataclass(frozen=True)
class Calibration:
    fit: PrinterFit
    values: tuple[CalibratedValue, ...]
    kept: tuple[str, ...]
    """Sentences on parameters that the readings do not change."""

    @property
    def changes(self) -> dict[str, float]:
        """Parameter -> calibrated value."""
        return {value.path: value.value for value in self.values}


def calibrate_printer(design: Design, measured: Sequence[Measured], keep: Collection[str] = ()) -> Calibration:
    """Derive the parameters of a printer from the readings of the coupon of a design."""
    fit, printer = fit_printer(measured), design.printer
    # Scale of the files at which a printed length is that of the design: the fit is to the lengths in the files.
    scale, uncertainty = 100.0 / fit.scale, 100.0 * fit.scale_uncertainty / fit.scale**2
    values = [
        _value(_SCALE, "%", printer.scale_percent, scale, uncertainty, fit),
        _value(_OFFSET, "mm", printer.offset_mm, fit.offset_mm, fit.offset_uncertainty_mm, fit),
    ]
    for path, surfaces in CLEARANCES.items():
        # The printed gap is that of the design at half the offset more for each printed surface.
        before, added = float(design.value(path)), surfaces / 2 * (fit.offset_mm - printer.offset_mm)
        values.append(_value(path, "mm", before, before + added, surfaces / 2 * fit.offset_uncertainty_mm, fit))
    error, kept = _surface_error(printer.surface_error_mm, fit), []
    if error.value >= printer.surface_error_mm:
        values.append(error)
    else:
        kept.append(f"{error.path} is kept: {error.value:g} mm is that of x and y, and heights were not measured")
    kept += [f"{value.path} is kept, as --keep asks" for value in values if value.path in keep]
    wall = _min_wall(printer.min_wall_mm, measured)
    if isinstance(wall, CalibratedValue):
        values.append(wall)
    else:
        kept.append(wall)
    return Calibration(fit, tuple(value for value in values if value.path not in keep), tuple(kept))


def apply_calibration(design: Design, changes: Mapping[str, Any], name: str | None = None) -> Design:
    """Make a calibrated design, under a name of its own if one is given: its files then stand in another folder.

    Raises DesignError.
    """
    tables = design.with_values(changes).model_dump() | {"name": name or design.name}
    return Design.from_tables(tables, design.model_dump(), tuple(changes))


def find_kept(design: Design, calibration: Calibration, passes: Callable[[Design], bool]) -> str | None:
    """Find the parameter with which, if it is kept, the calibrated design passes all rules and `passes`."""
    for path in CLEARANCES:
        fewer = replace(calibration, values=tuple(value for value in calibration.values if value.path != path))
        with contextlib.suppress(DesignError):
            if passes(Design.without_remedies(**design.with_values(fewer.changes).model_dump())):
                return path
    return None


def _surface_error(before: float, fit: PrinterFit) -> CalibratedValue:
    """Error that 95 % of all surfaces stay below, after scale and offset are corrected.

    A length lies between two surfaces of equal and independent errors: that of one is the length's over the square root
    of two. Its interval is that of a standard deviation (chi-square).
    """
    value = fit.coverage_factor * fit.length_error_mm / math.sqrt(2.0)
    tail = (1.0 - CONFIDENCE) / 2
    low, high = (
        value * math.sqrt(fit.degrees / chi_square_quantile(share, fit.degrees)) for share in (1.0 - tail, tail)
    )
    uncertainty = value / math.sqrt(2.0 * fit.degrees)
    return CalibratedValue(_SURFACE_ERROR, "mm", before, round(value, _DECIMALS["mm"]), uncertainty, low, high)


def _min_wall(before: float, measured: Sequence[Measured]) -> CalibratedValue | str:
    """Return the thinnest wall from which on all printed, or a sentence if no wall or not even the thickest did.

    The true limit lies between it and the next thinner one; its standard uncertainty is that of a uniform distribution.
    """
    walls = sorted((e for e in measured if e.length.kind == "wall"), key=lambda e: -e.length.nominal_mm)
    thicknesses = sorted(WALLS_MM, reverse=True)
    if not any(each.readings_mm for each in walls):
        return "printer.min_wall_mm is kept: no thin wall has a reading"
    printed = 0
    for each in walls:
        if not each.readings_mm or each.mean_mm < MIN_WALL_RATIO * each.length.nominal_mm:
            break
        printed += 1
    if not printed:
        return f"printer.min_wall_mm is kept: not even the wall of {thicknesses[0]:g} mm printed; slice it anew"
    thinnest = thicknesses[printed - 1]
    next_thinner = thicknesses[printed] if printed < len(thicknesses) else 0.0
    uncertainty = (thinnest - next_thinner) / math.sqrt(12.0)
    return CalibratedValue(_MIN_WALL, "mm", before, thinnest, uncertainty, next_thinner, thinnest)


def _value(path: str, unit: str, before: float, value: float, uncertainty: float, fit: PrinterFit) -> CalibratedValue:
    half = fit.coverage_factor * uncertainty
    return CalibratedValue(path, unit, before, round(value, _DECIMALS[unit]), uncertainty, value - half, value + half)
