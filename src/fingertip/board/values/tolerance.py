"""Effect of component tolerances on the filter: Monte Carlo spread, worst case and sensitivities. Needs numpy.

Unlike in the formulas of `ideal_response`, C1, C2 and C3 may differ, as purchased capacitors do. Cutoff and gain
are those of the circuit with all its components, as in the achieved response.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product

import numpy as np

from fingertip.arrays import Array
from fingertip.board.values.nonideal_response import LARGE_CAPACITOR_PERCENT, OPEN_LOOP_GAIN, FirstStageCapacitors
from fingertip.design.filter_components import MAX_1206_F, FilterComponents
from fingertip.numerics import bisect_arrays, find_maximum_arrays

COMPONENTS = ("R1", "R2", "R3", "R4", "R5", "C1", "C2", "C3")
"""Order of the component values in every array of this module."""
FIRST_STAGE_COMPONENTS = ("C14", "C20")
"""Capacitors of the first stage, which follow `COMPONENTS`; absent in variant article."""
QUANTITIES = ("cutoff_hz", "section_quality", "passband_gain", "first_pole_hz", "section_hz")
"""Quantities of the filter whose tolerance is computed."""

_STEPS_PER_DECADE = 6
_START_RATIO = 4.0
"""Ratio of f0 to the frequency at which the search for the passband starts."""
_GOLDEN_STEPS = 24
"""Golden-section steps around the peak: its frequency is then exact to 1e-5, its gain to 1e-10."""
_HALVINGS = 36
"""Halvings of the step that contains the cutoff, which is then exact to 1e-11."""


def component_names(capacitors: FirstStageCapacitors | None) -> tuple[str, ...]:
    """Names of the components of a board with or without capacitors in the first stage."""
    return COMPONENTS if capacitors is None else (*COMPONENTS, *FIRST_STAGE_COMPONENTS)


def nominal_values(components: FilterComponents, capacitors: FirstStageCapacitors | None = None) -> Array:
    """Nominal component values [ohm, F] in the order of `component_names`."""
    values = [components.r1_ohm, components.r2_ohm, components.r3_ohm, components.r4_ohm, components.r5_ohm]
    values += [components.c_f] * 3
    if capacitors is not None:
        values += [capacitors.series_capacitor_f, capacitors.limiting_capacitor_f]
    return np.array(values)


def power_gain(f_hz: Array, columns: Array, gain_bandwidth_hz: float) -> Array:
    """Compute the squared gain from the tactile voltage to the rectifier, as `nonideal_response.filter_transfer` does.

    Parameters
    ----------
    f_hz
        Frequency for each board [Hz].
    columns
        R1 to R5 and C1 to C3, one row for each component and one column for each board; then C14 and C20, where the
        board has them.
    gain_bandwidth_hz
        Gain-bandwidth product of the amplifier [Hz].
    """
    R1, R2, R3, R4, R5, C1, C2, C3 = columns[:8]
    s = 2j * np.pi * f_hz
    inverse = 1.0 / OPEN_LOOP_GAIN + 1j * f_hz / gain_bandwidth_hz
    if len(columns) > 8:
        C14, C20 = columns[8:]
        G = 1.0 + R5 / ((1.0 + s * (R5 * C20)) * (R4 + 1.0 / (s * C14)))
    else:
        G = 1.0 + R5 / R4
    pole, square = s * (R1 * C1), s * s * (R2 * R3 * C2 * C3)
    # The buffer's gain is K = A / (1 + A), and 1 - K adds a little of R3 to the damping of the section.
    K = 1.0 / (1.0 + inverse)
    section = K * square / (square + s * (R2 * (C2 + C3) + (1.0 - K) * R3 * C3) + 1.0)
    transfer = pole / (1.0 + pole) / (1.0 / G + inverse) * section
    result: Array = transfer.real**2 + transfer.imag**2
    return result


def find_passbands(values: Array, gain_bandwidth_hz: float) -> tuple[Array, Array]:
    """Find maximum gain and lower -3.0103 dB frequency [Hz] of many boards at once.

    The function is the counterpart of `nonideal_response.find_passband` for arrays, with capacitors that may differ.

    Parameters
    ----------
    values
        Component values, one row for each board.
    gain_bandwidth_hz
        Gain-bandwidth product of the amplifier [Hz].
    """
    columns = np.ascontiguousarray(np.moveaxis(values, -1, 0).reshape(values.shape[-1], -1))
    _, R2, R3, R4, R5, _, C2, C3 = columns[:8]
    f0 = 1.0 / (2.0 * np.pi * np.sqrt(R2 * R3 * C2 * C3))

    def power(x: Array) -> Array:
        return power_gain(f0 * np.exp(x), columns, gain_bandwidth_hz)

    # A grid over the logarithm of f / f0 brackets the peak.
    last = math.log(10.0 * max(1.0, float(np.max(gain_bandwidth_hz / (1.0 + R5 / R4) / f0))))
    first = -math.log(_START_RATIO)
    count = math.ceil((last - first) / math.log(10.0) * _STEPS_PER_DECADE)
    step = (last - first) / count
    grid = np.array([power(np.full_like(f0, first + i * step)) for i in range(count + 1)])
    peak = np.clip(grid.argmax(axis=0), 1, count - 1)
    _, found = find_maximum_arrays(power, first + (peak - 1) * step, first + (peak + 1) * step, _GOLDEN_STEPS)
    maximum = np.maximum(found, grid.max(axis=0))

    # The last grid point before the peak that lies below half the maximum power brackets the cutoff.
    index = np.arange(count + 1)[:, None]
    low = first + step * np.where((grid < 0.5 * maximum) & (index < peak), index, 0).max(axis=0)
    _, cutoff = bisect_arrays(lambda x: power(x) < 0.5 * maximum, low, low + step, _HALVINGS)
    shape = values.shape[:-1]
    return np.sqrt(maximum).reshape(shape), (f0 * np.exp(cutoff)).reshape(shape)


def compute_quantities(values: Array, gain_bandwidth_hz: float) -> dict[str, Array]:
    """Compute `QUANTITIES` for component values in rows of eight, or of ten with C14 and C20.

    Cutoff and maximum gain are those of the whole circuit. A Sallen-Key section with unequal capacitors has
    f0 = 1 / (2 pi sqrt(R2 R3 C2 C3)) and Q = sqrt(R3 / R2) sqrt(C2 C3) / (C2 + C3), which are eqs. (10, corrected) and
    (8) for C2 = C3.
    """
    R1, R2, R3, _, _, C1, C2, C3 = np.moveaxis(values[..., : len(COMPONENTS)], -1, 0)
    gain, cutoff_hz = find_passbands(values, gain_bandwidth_hz)
    return {
        "cutoff_hz": cutoff_hz,
        "section_quality": np.sqrt(R3 / R2) * np.sqrt(C2 * C3) / (C2 + C3),
        "passband_gain": gain,
        "first_pole_hz": 1.0 / (2.0 * np.pi * R1 * C1),
        "section_hz": 1.0 / (2.0 * np.pi * np.sqrt(R2 * R3 * C2 * C3)),
    }


@dataclass(frozen=True)
class Spread:
    """Distribution of a quantity over many boards."""

    nominal: float
    mean: float
    deviation: float
    """Standard deviation."""
    low_95: float
    """Lower end of the central interval that contains 95 % of the boards."""
    high_95: float
    """Upper end of the central interval that contains 95 % of the boards."""
    worst_low: float
    """Minimum over all corners of the tolerances."""
    worst_high: float
    """Maximum over all corners of the tolerances."""


def monte_carlo(
    components: FilterComponents,
    gain_bandwidth_hz: float,
    capacitors: FirstStageCapacitors | None,
    resistor_percent: float,
    capacitor_percent: float,
    boards: int = 10_000,
    seed: int = 1,
) -> dict[str, Spread]:
    """Compute the spread of each quantity over boards with independent, uniformly distributed component values.

    Parameters
    ----------
    components
        Nominal component values.
    gain_bandwidth_hz
        Gain-bandwidth product of the amplifier [Hz], which is assumed to be exact.
    capacitors
        Capacitors of the first stage; None in variant article.
    resistor_percent, capacitor_percent
        Tolerances. A C14 too large for them has `LARGE_CAPACITOR_PERCENT`.
    boards
        Number of boards.
    seed
        Seed of the random numbers; the same seed gives the same boards.
    """
    percent = [resistor_percent] * 5 + [capacitor_percent] * 3
    if capacitors is not None:
        is_large = capacitors.series_capacitor_f > MAX_1206_F * (1 + 1e-9)
        percent += [LARGE_CAPACITOR_PERCENT if is_large else capacitor_percent, capacitor_percent]
    tolerance, base = np.array(percent) / 100.0, nominal_values(components, capacitors)
    rng = np.random.default_rng(seed)
    drawn = compute_quantities(
        base * (1.0 + tolerance * rng.uniform(-1.0, 1.0, (boards, len(base)))), gain_bandwidth_hz
    )
    ends = np.array(list(product((-1.0, 1.0), repeat=len(base))))
    corners = compute_quantities(base * (1.0 + tolerance * ends), gain_bandwidth_hz)
    exact = compute_quantities(base, gain_bandwidth_hz)
    result = {}
    for name in QUANTITIES:
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


def compute_sensitivities(
    components: FilterComponents, gain_bandwidth_hz: float, capacitors: FirstStageCapacitors | None = None
) -> dict[str, dict[str, float]]:
    """Compute the sensitivity of each quantity to each component: d ln quantity / d ln component.

    It is the change of the quantity in percent for a change of the component by one percent.
    """
    step = 1e-4
    base = nominal_values(components, capacitors)
    up, down = (
        compute_quantities(base * (1.0 + sign * step * np.eye(len(base))), gain_bandwidth_hz) for sign in (1.0, -1.0)
    )
    width = np.log((1.0 + step) / (1.0 - step))
    return {
        quantity: {
            name: round(float(np.log(up[quantity][i] / down[quantity][i]) / width), 6) + 0.0
            for i, name in enumerate(component_names(capacitors))
        }
        for quantity in QUANTITIES
    }
