"""Least squares of the readings: scale and offset of a printer, with their uncertainty.

Model of a reading y of a length with the nominal value N, printed between two surfaces:

    y = scale * N + offset + error   for outer lengths
    y = scale * N - offset + error   for inner lengths

A positive offset means that the printer prints too much: solids grow and hollows shrink by it, half of it on each
surface. All readings count alike. Readings of one length share the error of its two surfaces, so the errors are not
independent: the residual variance is therefore taken between the means of the lengths, whose number less two are the
degrees of freedom. Under independent errors of equally many readings this is exact, too (analysis of variance; N. R.
Draper and H. Smith, Applied Regression Analysis, 3rd ed., sections 1.5 and 2.1).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from fingertip.calibration.readings import Measured
from fingertip.calibration.student import t_quantile

CONFIDENCE = 0.95
"""Probability with which an interval holds the true value."""
_OUTLIER_RISK = 0.01
"""Probability that any reading of a sound file is named an outlier."""
_LEAST_DOUBT_MM = 0.03
"""Difference below which no length is doubted: calipers resolve little more [mm]."""
_SIGN = {"outer": 1.0, "inner": -1.0}


@dataclass(frozen=True)
class Outlier:
    """Reading that does not fit the others."""

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
        """Mean reading less the prediction."""
        return self.mean_mm - self.predicted_mm


@dataclass(frozen=True)
class PrinterFit:
    """Scale and offset of a printer."""

    scale: float
    """Printed length over nominal length."""
    scale_uncertainty: float
    """Standard uncertainty of the scale."""
    offset_mm: float
    offset_uncertainty_mm: float
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
    scale, offset = (count * ny - ns * sy) / determinant, (nn * sy - ns * ny) / determinant
    degrees = len(rows) - 2
    variance = math.fsum(w * (y - scale * n - offset * s) ** 2 for w, n, s, y in rows) / degrees
    return PrinterFit(
        scale,
        math.sqrt(variance * count / determinant),
        offset,
        math.sqrt(variance * nn / determinant),
        math.sqrt(variance * len(rows) / count),
        degrees,
        count,
        tuple(_find_outliers(used, scale, offset, (nn, ns, float(count)))),
        tuple(_compare_lengths(used, scale, offset, (nn, ns, float(count)))),
    )


def _compare_lengths(
    used: Sequence[Measured], scale: float, offset: float, normal: tuple[float, float, float]
) -> Iterator[Residual]:
    """Compare the mean of each length with the fit, by its externally studentised residual (Bonferroni's bound)."""
    nn, ns, count = normal
    determinant = nn * count - ns * ns
    rows = []
    for each in used:
        n, s, weight = each.length.nominal_mm, _SIGN[each.length.kind], len(each.readings_mm)
        predicted = scale * n + offset * s
        kept = 1.0 - weight * (count * n * n - 2 * ns * n * s + nn) / determinant
        rows.append((each, predicted, weight * (each.mean_mm - predicted) ** 2, kept))
    total, degrees = math.fsum(square for _, _, square, _ in rows), len(rows) - 3
    limit = t_quantile(1.0 - _OUTLIER_RISK / len(rows), degrees) if degrees > 0 else math.inf
    for each, predicted, square, kept in rows:
        doubtful = degrees > 0 and kept > 0.0 and abs(each.mean_mm - predicted) > _LEAST_DOUBT_MM
        if doubtful:
            others = max(total - square / kept, 0.0) / degrees
            doubtful = square > limit * limit * others * kept
        yield Residual(each.length.name, each.length.nominal_mm, each.mean_mm, predicted, doubtful)


def _find_outliers(
    used: Sequence[Measured], scale: float, offset: float, normal: tuple[float, float, float]
) -> Iterator[Outlier]:
    """Find readings whose externally studentised residual is too large (Bonferroni's bound over all readings).

    Reference: Draper and Smith, sections 8.1 and 8.4.
    """
    nn, ns, count = normal
    determinant = nn * count - ns * ns
    residuals = [
        (each, number, reading, reading - scale * each.length.nominal_mm - offset * _SIGN[each.length.kind])
        for each in used
        for number, reading in enumerate(each.readings_mm, 1)
    ]
    degrees = len(residuals) - 3
    total = math.fsum(r * r for _, _, _, r in residuals)
    limit = t_quantile(1.0 - _OUTLIER_RISK / len(residuals), degrees)
    for each, number, reading, residual in residuals:
        n, s = each.length.nominal_mm, _SIGN[each.length.kind]
        kept = 1.0 - (count * n * n - 2.0 * ns * n * s + nn) / determinant  # one less the leverage
        others = max(total - residual * residual / kept, 0.0) / degrees
        if residual * residual > limit * limit * others * kept and abs(residual) > 1e-9:
            yield Outlier(each.length.name, number, reading, residual)
