"""Preferred values (IEC 60063): what can be bought, and which of it comes nearest to what a formula gives.

Nearest means nearest by ratio. For R2 and R3 that is also the best joint choice, see `section_error`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace

from fingertip.board.values.filters import section_frequency_hz, section_quality
from fingertip.design.filter_components import MAX_OHM, MIN_OHM, Components
from fingertip.errors import BoardError, Issue

# Mantissas of one decade. E96 is 10^(i/96) to three digits; E12 and E24 follow no formula throughout.
_E24 = (10, 11, 12, 13, 15, 16, 18, 20, 22, 24, 27, 30, 33, 36, 39, 43, 47, 51, 56, 62, 68, 75, 82, 91)
_MANTISSAS: dict[str, tuple[int, ...]] = {
    "E6": _E24[::4],
    "E12": _E24[::2],
    "E24": _E24,
    "E96": tuple(round(100 * 10 ** (i / 96)) for i in range(96)),
}


def decade(series: str) -> tuple[int, ...]:
    """The whole-number mantissas of one decade: 10 to 68 (E6), 10 to 82 (E12), 10 to 91 (E24), 100 to 976 (E96).

    Raises
    ------
    BoardError
        If there is no such series here.
    """
    if series not in _MANTISSAS:
        raise BoardError(Issue("board.series", f"{series!r} is not known; choose {', '.join(_MANTISSAS)}."))
    return _MANTISSAS[series]


def neighbours(value: float, series: str, minimum: float = MIN_OHM, maximum: float = MAX_OHM) -> tuple[float, ...]:
    """The preferred values next below and above `value`; one if it is preferred itself or beyond the range.

    Parameters
    ----------
    value
        Positive and finite; for resistors in ohm.
    series
        "E12", "E24" or "E96".
    least, most
        Only values within are offered; both must be preferred values themselves.

    Raises
    ------
    BoardError
        If `value` is not positive and finite, or the series is not known.
    """
    mantissas = decade(series)
    if not (value > 0 and math.isfinite(value)):
        raise BoardError(f"{value!r} has no preferred value; give a positive finite number.")
    value = min(max(value, minimum), maximum)
    exponent = math.floor(math.log10(value)) - (len(str(mantissas[0])) - 1)
    # The decade's own values and one more on either side, where rounding of the logarithm cannot matter.
    lower = _scaled(mantissas[-1], exponent - 1)
    values = [lower, *(_scaled(m, exponent) for m in mantissas), _scaled(mantissas[0], exponent + 1)]
    values.append(_scaled(mantissas[1], exponent + 1))
    below = max(v for v in values if v <= value)
    above = min(v for v in values if v >= value)
    return (below,) if below == above else (below, above)


def nearest(value: float, series: str, minimum: float = MIN_OHM, maximum: float = MAX_OHM) -> float:
    """The preferred value nearest to `value` by ratio, or the lower of two. Raises as `neighbours` does."""
    return min(neighbours(value, series, minimum, maximum), key=lambda v: abs(math.log(v / value)))


def spread(value: float, series: str) -> tuple[float, ...]:
    """The preferred values from half of `value` to twice it. Raises as `neighbours` does."""
    mantissas = decade(series)
    exponent = math.floor(math.log10(value)) - (len(str(mantissas[0])) - 1)
    values = (_scaled(m, e) for e in (exponent - 1, exponent, exponent + 1) for m in mantissas)
    return tuple(v for v in values if value / 2 <= v <= 2 * value and MIN_OHM <= v <= MAX_OHM)


def within(low: float, high: float, series: str) -> tuple[float, ...]:
    """The preferred values from `low` to `high`; where none lies between, the one nearest to `low`."""
    mantissas = decade(series)
    digits = len(str(mantissas[0])) - 1
    exponents = range(math.floor(math.log10(low)) - digits, math.floor(math.log10(high)) - digits + 1)
    values = (_scaled(m, e) for e in exponents for m in mantissas)
    # The range is computed, so a value at its very end must not fall out by the last bit.
    found = tuple(v for v in values if low * (1 - 1e-9) <= v <= high * (1 + 1e-9))
    return found or (nearest(low, series, 1e-12, 1e-3),)


def section_error(r2_ohm: float, r3_ohm: float, c_f: float, section_hz: float, quality: float) -> float:
    """How far R2 and R3 miss a Sallen-Key section's f0 and Q: hypot(ln(f0' / f0), ln(Q' / Q)).

    The two count alike because at f0 each shifts the section's magnitude by as much as itself, to first
    order. With x and y the logarithms of R2 and R3 over their ideal values, ln(f0' / f0) = -(x + y) / 2 and
    ln(Q' / Q) = (y - x) / 2, so the error squared is (x^2 + y^2) / 2: each resistor can be chosen alone.
    """
    return math.hypot(
        math.log(section_frequency_hz(r2_ohm, r3_ohm, c_f) / section_hz),
        math.log(section_quality(r2_ohm, r3_ohm) / quality),
    )


def choose_section(section_hz: float, quality: float, c_f: float, series: str) -> tuple[float, float]:
    """The preferred R2 and R3 [ohm] with the least `section_error` of all pairs of the series.

    Four pairs are compared, the neighbours of the ideal R2 = 1 / (2 Q omega_0 C) and R3 = 2 Q / (omega_0 C):
    by the identity given at `section_error` no other can win.
    """
    r2 = 1.0 / (2.0 * quality * math.tau * section_hz * c_f)
    r3 = 2.0 * quality / (math.tau * section_hz * c_f)
    pairs = itertools.product(neighbours(r2, series), neighbours(r3, series))
    return min(pairs, key=lambda pair: section_error(pair[0], pair[1], c_f, section_hz, quality))


def preferred_components(ideal: Components, series: str) -> Components:
    """Preferred resistors for ideal ones; the capacitors stay as the design gives them.

    R5 is chosen first, R4 then by the ratio R5 / R4 that the gain asks for. Raises as `neighbours` does.
    """
    near: Callable[[float], float] = lambda ohm: nearest(ohm, series)  # noqa: E731
    r2_ohm, r3_ohm = choose_section(
        section_frequency_hz(ideal.r2_ohm, ideal.r3_ohm, ideal.c_f),
        section_quality(ideal.r2_ohm, ideal.r3_ohm),
        ideal.c_f,
        series,
    )
    r5_ohm = near(ideal.r5_ohm)
    return replace(
        ideal,
        r1_ohm=near(ideal.r1_ohm),
        r2_ohm=r2_ohm,
        r3_ohm=r3_ohm,
        r4_ohm=near(ideal.r4_ohm * r5_ohm / ideal.r5_ohm),
        r5_ohm=r5_ohm,
        r_lp_ohm=near(ideal.r_lp_ohm),
    )


def _scaled(mantissa: int, exponent: int) -> float:
    """mantissa * 10^exponent, correctly rounded."""
    return float(mantissa * 10**exponent) if exponent >= 0 else mantissa / 10**-exponent
