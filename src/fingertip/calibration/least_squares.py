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
    )


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
