"""The filter's figures for any component values, as arrays: what tolerances and sensitivities are made of.

Unlike in the formulas of `filters`, C1, C2 and C3 may differ here, as bought capacitors do, and cutoff and gain are
those of the circuit with all its parts, which the command calls achieved.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from fingertip.arrays import Array
from fingertip.board.values.built import LARGE_PERCENT, FirstStage
from fingertip.board.values.passbands import passbands
from fingertip.design.filter_components import MAX_FOOTPRINT_F, Components

NAMES = ("R1", "R2", "R3", "R4", "R5", "C1", "C2", "C3")
"""Order of the values in every array here."""
FIRST_STAGE_NAMES = ("C14", "C20")
"""The same where the first stage has these, which variant article has not."""
FIGURES = ("cutoff_hz", "section_quality", "passband_gain", "first_pole_hz", "section_hz")


def names(extra: FirstStage | None) -> tuple[str, ...]:
    """Of the parts of a board with or without the first stage's capacitors."""
    return NAMES if extra is None else (*NAMES, *FIRST_STAGE_NAMES)


def nominal(c: Components, extra: FirstStage | None = None) -> Array:
    """The fitted values [ohm, F] in the order of `names`."""
    others = () if extra is None else (extra.series_f, extra.limit_f)
    return np.array([c.r1_ohm, c.r2_ohm, c.r3_ohm, c.r4_ohm, c.r5_ohm, c.c_f, c.c_f, c.c_f, *others])


def figures(values: Array, gain_bandwidth_hz: float) -> dict[str, Array]:
    """`FIGURES` of values in rows of eight, or of ten with C14 and C20.

    Cutoff and largest gain are those of the circuit as built. The second-order section with unequal capacitors:
    f0 = 1 / (2 pi sqrt(R2 R3 C2 C3)) and Q = sqrt(R3 / R2) sqrt(C2 C3) / (C2 + C3), which are eqs. (10, corrected)
    and (8) for C2 = C3.
    """
    R1, R2, R3, _, _, C1, C2, C3 = np.moveaxis(values[..., : len(NAMES)], -1, 0)
    gain, cutoff_hz = passbands(values, gain_bandwidth_hz)
    return {
        "cutoff_hz": cutoff_hz,
        "section_quality": np.sqrt(R3 / R2) * np.sqrt(C2 * C3) / (C2 + C3),
        "passband_gain": gain,
        "first_pole_hz": 1.0 / (2.0 * np.pi * R1 * C1),
        "section_hz": 1.0 / (2.0 * np.pi * np.sqrt(R2 * R3 * C2 * C3)),
    }


@dataclass(frozen=True)
class Spread:
    """What a figure comes to over many boards."""

    nominal: float
    mean: float
    deviation: float
    """Standard deviation."""
    low_95: float
    high_95: float
    """Between these lie 95 % of the boards."""
    worst_low: float
    worst_high: float
    """With every part at the end of its tolerance that is worst."""


def monte_carlo(
    c: Components,
    gain_bandwidth_hz: float,
    extra: FirstStage | None,
    resistor_percent: float,
    capacitor_percent: float,
    boards: int = 10_000,
    seed: int = 1,
) -> dict[str, Spread]:
    """Figure -> spread over boards whose parts lie anywhere within their tolerance, evenly, each for itself.

    Parameters
    ----------
    c
        The fitted values.
    gain_bandwidth_hz
        Of the amplifier, which is taken to have it.
    extra
        The first stage's capacitors; None in variant article.
    resistor_percent, capacitor_percent
        Tolerances. A C14 too large for them has its own.
    boards
        How many.
    seed
        The same seed gives the same boards.
    """
    percent = [resistor_percent] * 5 + [capacitor_percent] * 3
    if extra is not None:
        large = extra.series_f > MAX_FOOTPRINT_F * (1 + 1e-9)
        percent += [LARGE_PERCENT if large else capacitor_percent, capacitor_percent]
    tolerance, base = np.array(percent) / 100.0, nominal(c, extra)
    rng = np.random.default_rng(seed)
    drawn = figures(base * (1.0 + tolerance * rng.uniform(-1.0, 1.0, (boards, len(base)))), gain_bandwidth_hz)
    ends = np.array(list(product((-1.0, 1.0), repeat=len(base))))
    corners = figures(base * (1.0 + tolerance * ends), gain_bandwidth_hz)
    exact = figures(base, gain_bandwidth_hz)
    result = {}
    for name in FIGURES:
        values = drawn[name]
        low, high = np.quantile(values, (0.025, 0.975))
        result[name] = Spread(
            nominal=float(exact[name]),
            mean=float(values.mean()),
            deviation=float(values.std(ddof=1)),
            low_95=float(low),
            high_95=float(high),
            worst_low=float(corners[name].min()),
            worst_high=float(corners[name].max()),
        )
    return result


def sensitivities(
    c: Components, gain_bandwidth_hz: float, extra: FirstStage | None = None
) -> dict[str, dict[str, float]]:
    """Figure -> part -> percent that the figure moves for one percent of the part (d ln figure / d ln part)."""
    step = 1e-4
    base = nominal(c, extra)
    up, down = (figures(base * (1.0 + sign * step * np.eye(len(base))), gain_bandwidth_hz) for sign in (1.0, -1.0))
    width = np.log((1.0 + step) / (1.0 - step))
    return {
        figure: {
            name: round(float(np.log(up[figure][i] / down[figure][i]) / width), 6) + 0.0
            for i, name in enumerate(names(extra))
        }
        for figure in FIGURES
    }
