"""Frequency response of the filter with an amplifier of finite gain-bandwidth product, and its passband.

The transfer functions are those of eqs. (1), (4) and (9) with the amplifier A(s) = A0 / (1 + s A0 / (2 pi GBW)), which
has one pole. Eqs. (1) to (9) are their limit for an infinite gain-bandwidth product.

The formulas of `ideal_response` contain neither C14, which costs a little gain at the lower end of the passband, nor
C20, which ends the passband above the vibrations, nor the amplifier's bandwidth. `find_passband` evaluates the whole
transfer function.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from fingertip.board.values.ideal_response import FrequencyResponse, decibel, ideal_response, passband_gain, pole_hz
from fingertip.board.values.preferred_values import nearest_value
from fingertip.design.filter_components import FilterComponents, compute_limiting_capacitor_f, select_series_capacitor_f
from fingertip.numerics import find_maximum, find_root


@dataclass(frozen=True)
class FirstStageCapacitors:
    """Capacitors that variants other than `article` add to the first stage [F]."""

    series_capacitor_f: float
    """C14 in series with R4: the stage does not amplify the amplifier's offset."""
    limiting_capacitor_f: float
    """C20 across R5: the stage does not amplify frequencies above the vibrations."""
    limit_hz: float
    """Frequency at which C20 has reduced the gain by 3 dB: 1 / (2 pi R5 C20)."""


def select_first_stage_capacitors(components: FilterComponents, band_limit_hz: float) -> FirstStageCapacitors:
    """Select preferred capacitors of the first stage for preferred resistors and a band limit [Hz]."""
    c20_f = nearest_value(compute_limiting_capacitor_f(components.r5_ohm, band_limit_hz), "E6", 1e-12, 1e-3)
    c14_f = select_series_capacitor_f(components.r4_ohm, pole_hz(components.r1_ohm, components.c_f))
    return FirstStageCapacitors(c14_f, c20_f, pole_hz(components.r5_ohm, c20_f))


LARGE_CAPACITOR_PERCENT = 20.0
"""Tolerance of a series capacitor above `MAX_1206_F`: nothing better is available in its size."""

OPEN_LOOP_GAIN = 2e5
"""Open-loop gain A0 of the TL082 (typical, its data sheet): 106 dB. The TLV2372's 110 dB give the same response."""


def open_loop_transfer(f_hz: float, gain_bandwidth_hz: float) -> complex:
    """Open-loop gain A(s) of the amplifier at f [Hz]."""
    return OPEN_LOOP_GAIN / (1.0 + 1j * f_hz * OPEN_LOOP_GAIN / gain_bandwidth_hz)


def first_stage_transfer(
    f_hz: float, components: FilterComponents, gain_bandwidth_hz: float, capacitors: FirstStageCapacitors | None = None
) -> complex:
    """Transfer function H1 at f [Hz]: the high-pass C1, R1, then G / (1 + G / A).

    Variants other than `article` have G = 1 + Z5 / Z4 with Z4 = R4 + 1 / (s C14) and Z5 = R5 / (1 + s R5 C20).
    """
    R1, R4, R5, C = components.r1_ohm, components.r4_ohm, components.r5_ohm, components.c_f
    s = 2j * math.pi * f_hz
    G: complex = passband_gain(R4, R5)
    if capacitors is not None:
        G = 1.0 + R5 / (1.0 + s * R5 * capacitors.limiting_capacitor_f) / (
            R4 + 1.0 / (s * capacitors.series_capacitor_f)
        )
    return s / (s + 1.0 / (R1 * C)) * G / (1.0 + G / open_loop_transfer(f_hz, gain_bandwidth_hz))


def second_stage_transfer(f_hz: float, components: FilterComponents, gain_bandwidth_hz: float) -> complex:
    """Transfer function H2 at f [Hz], with K = A / (1 + A) for the buffer's unity gain.

    Kirchhoff's current law between C2 and C3 and at the amplifier's input gives
    H2 = K s^2 C^2 R2 R3 / (s^2 C^2 R2 R3 + s C (2 R2 + (1 - K) R3) + 1), which is eq. (4) for K = 1.
    """
    R2, R3, C = components.r2_ohm, components.r3_ohm, components.c_f
    s = 2j * math.pi * f_hz
    A = open_loop_transfer(f_hz, gain_bandwidth_hz)
    K = A / (1.0 + A)
    square = s * R2 * C * s * R3 * C
    return K * square / (square + s * C * (2.0 * R2 + R3 / (1.0 + A)) + 1.0)


def filter_transfer(
    f_hz: float, components: FilterComponents, gain_bandwidth_hz: float, capacitors: FirstStageCapacitors | None = None
) -> complex:
    """Transfer function Hc = H1 H2 at f [Hz], from the tactile voltage to the diode; the article's figure 4."""
    first_stage = first_stage_transfer(f_hz, components, gain_bandwidth_hz, capacitors)
    return first_stage * second_stage_transfer(f_hz, components, gain_bandwidth_hz)


_STEPS_PER_DECADE = 6
_START_RATIO = 3.0
"""Ratio of the formulas' cutoff to the frequency at which the search starts."""
_PEAK_TOLERANCE = 1e-6
"""Tolerance of the logarithm of the peak's frequency. The gain is then exact to about 1e-12."""
_CUTOFF_TOLERANCE = 1e-13
"""Tolerance of the logarithm of the cutoff frequencies."""


@dataclass(frozen=True)
class Passband:
    """Maximum gain and cutoff frequencies from the tactile voltage to the rectifier."""

    gain: float
    """Maximum gain."""
    low_hz: float
    """Lower -3.0103 dB frequency."""
    high_hz: float
    """Upper -3.0103 dB frequency."""


def find_passband(
    components: FilterComponents, gain_bandwidth_hz: float, capacitors: FirstStageCapacitors | None = None
) -> Passband:
    """Find the passband of preferred components. `tolerance.find_passbands` is its counterpart for arrays."""
    formulas = ideal_response(components, gain_bandwidth_hz)

    def log_gain(x: float) -> float:
        return math.log(abs(filter_transfer(math.exp(x), components, gain_bandwidth_hz, capacitors)))

    # A grid over the logarithm of the frequency brackets the peak.
    first = math.log(min(formulas.cutoff_hz, formulas.section_hz) / _START_RATIO)
    last = math.log(10.0 * max(formulas.amplifier_bandwidth_hz, formulas.cutoff_hz))
    count = math.ceil((last - first) / math.log(10.0) * _STEPS_PER_DECADE)
    step = (last - first) / count
    grid = [log_gain(first + i * step) for i in range(count + 1)]
    peak = max(range(1, count), key=grid.__getitem__)
    _, found = find_maximum(log_gain, first + (peak - 1) * step, first + (peak + 1) * step, _PEAK_TOLERANCE)
    maximum = max(found, grid[peak])
    level = maximum - 0.5 * math.log(2.0)

    def find_cutoff(direction: int) -> float:
        i = peak
        while grid[i + direction] >= level:
            i += direction
        ends = (first + i * step, first + (i + direction) * step)
        values = (grid[i] - level, grid[i + direction] - level)
        return math.exp(find_root(lambda x: log_gain(x) - level, ends, _CUTOFF_TOLERANCE, values))

    return Passband(math.exp(maximum), find_cutoff(-1), find_cutoff(1))


def nonideal_response(
    components: FilterComponents, gain_bandwidth_hz: float, capacitors: FirstStageCapacitors | None = None
) -> FrequencyResponse:
    """Compute the response of components. Gain and cutoffs are those of the whole transfer function."""
    passband = find_passband(components, gain_bandwidth_hz, capacitors)
    return replace(
        ideal_response(components, gain_bandwidth_hz),
        passband_gain=passband.gain,
        passband_gain_db=decibel(passband.gain),
        cutoff_hz=passband.low_hz,
        upper_cutoff_hz=passband.high_hz,
    )
