"""Parameters of a design that follow from the readings of its coupon."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

from fingertip.cad.shapes.coupon import WALLS_MM
from fingertip.calibration.least_squares import CONFIDENCE, PrinterFit, fit_printer
from fingertip.calibration.readings import Measured
from fingertip.calibration.student import chi_square_quantile
from fingertip.design import Design

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
MIN_WALL_RATIO = 0.8
"""Least thickness of a printed wall over the nominal one. An assumption."""
_DECIMALS = {"%": 2, "mm": 3}


@dataclass(frozen=True)
class CalibratedValue:
    """Parameter with its calibrated value."""

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
    """Calibrated parameters, and the fit that they follow from."""

    fit: PrinterFit
    values: tuple[CalibratedValue, ...]
    kept: tuple[str, ...]
    """Sentences on parameters that the readings do not change."""

    @property
    def changes(self) -> dict[str, float]:
        """Parameter -> calibrated value."""
        return {value.path: value.value for value in self.values}


def calibrate_printer(design: Design, measured: Sequence[Measured], keep: Collection[str] = ()) -> Calibration:
    """Derive the parameters of a printer from the readings of the coupon of a design.

    Parameters
    ----------
    design
        The design whose coupon was measured. The gaps between its printed parts shall be as wide as it says: its
        clearances less its printer.offset_mm. A calibrated design can so be calibrated again.
    measured
        Readings, from `calibration.readings`.
    keep
        Parameters that are not changed, such as "sensor.clearance_mm".
    """
    fit = fit_printer(measured)
    values = [_scale(design, fit), _offset(design, fit), *_clearances(design, fit), _surface_error(design, fit)]
    kept = [f"{value.path} is kept, as --keep asks" for value in values if value.path in keep]
    wall = _min_wall(design, measured)
    if isinstance(wall, CalibratedValue):
        values.append(wall)
    else:
        kept.append(wall)
    return Calibration(fit, tuple(value for value in values if value.path not in keep), tuple(kept))


def apply_calibration(design: Design, calibration: Calibration) -> Design:
    """Make the calibrated design.

    Raises
    ------
    DesignError
        If a rule refuses it; the message names the rule and a remedy.
    """
    tables = design.with_values(calibration.changes).model_dump()
    return Design.from_tables(tables, design.model_dump(), tuple(calibration.changes))


def _scale(design: Design, fit: PrinterFit) -> CalibratedValue:
    """Scale of the files at which the printed length is that of the design."""
    before = design.printer.scale_percent
    return _value("printer.scale_percent", "%", before, before / fit.scale, before * fit.scale_uncertainty, fit)


def _offset(design: Design, fit: PrinterFit) -> CalibratedValue:
    """Offset of printed lengths, of which the rules and checks of gaps need to know."""
    before = design.printer.offset_mm
    return _value("printer.offset_mm", "mm", before, fit.offset_mm, fit.offset_uncertainty_mm, fit)


def _clearances(design: Design, fit: PrinterFit) -> Iterator[CalibratedValue]:
    """Clearances at which the printed gap is that of the design: half the offset more for each printed surface."""
    for path, surfaces in CLEARANCES.items():
        before = float(design.value(path))
        added = surfaces / 2 * (fit.offset_mm - design.printer.offset_mm)
        uncertainty = surfaces / 2 * fit.offset_uncertainty_mm
        yield _value(path, "mm", before, before + added, uncertainty, fit)


def _surface_error(design: Design, fit: PrinterFit) -> CalibratedValue:
    """Error that 95 % of all surfaces stay below, after scale and offset are corrected.

    A length lies between two surfaces of equal and independent errors: that of one is the length's over the square root
    of two. Its interval is that of a standard deviation (chi-square).
    """
    value = fit.coverage_factor * fit.length_error_mm / math.sqrt(2.0)
    tail = (1.0 - CONFIDENCE) / 2
    low, high = (
        value * math.sqrt(fit.degrees / chi_square_quantile(share, fit.degrees)) for share in (1.0 - tail, tail)
    )
    before, digits = design.printer.surface_error_mm, _DECIMALS["mm"]
    return CalibratedValue(
        "printer.surface_error_mm", "mm", before, round(value, digits), value / math.sqrt(2.0 * fit.degrees), low, high
    )


def _min_wall(design: Design, measured: Sequence[Measured]) -> CalibratedValue | str:
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
    before = design.printer.min_wall_mm
    return CalibratedValue("printer.min_wall_mm", "mm", before, thinnest, uncertainty, next_thinner, thinnest)


def _value(path: str, unit: str, before: float, value: float, uncertainty: float, fit: PrinterFit) -> CalibratedValue:
    half = fit.coverage_factor * uncertainty
    return CalibratedValue(path, unit, before, round(value, _DECIMALS[unit]), uncertainty, value - half, value + half)
