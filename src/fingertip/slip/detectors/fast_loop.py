"""The detector `fast`, sample by sample: two bands, their energies, the slope, the bars, and ON or OFF."""

from __future__ import annotations

import math
from collections.abc import MutableSequence, Sequence

from fingertip.slip.detectors.kernel import Loop

STATES = 20
"""High-pass 3, low-pass 2, upper high-pass 2, energies 2, slope 3, quick slope 2, floors 2, ON; for how many samples it
was steep, and ON; and for how many it still settles."""
ENERGY, UPPER_ENERGY = 7, 8
SLOPES = (9, 10, 12)
"""The slopes' poles: where they rest is the voltage."""
FLOOR, UPPER_FLOOR = 14, 15
ON = 16
SETTLING = 19
FRESH = 2.0
"""A slope so many times what is left of the last knock is another knock."""


def _fast_loop(
    coefficients: tuple[float, ...],
    state: MutableSequence[float],
    ring: MutableSequence[float],
    samples: Sequence[float],
    filtered: MutableSequence[float],
    levels: MutableSequence[float],
    bars: MutableSequence[float],
    flags: MutableSequence[float],
) -> None:
    g0, g1, p1, b0, b1, b2, a1, a2, c0, d1, d2, e0, f1, f2 = coefficients[:14]
    energy_share, slope_share, quick_share, floor_share, keep, rate = coefficients[14:20]
    ratio, upper_ratio, stay, slope_bar, upper_slope_bar, slope_noise, steepest, deaf = coefficients[20:28]
    patience, minimum, min_upper = coefficients[28:]
    s1, s2, s3, l1, l2, h1, h2 = state[0], state[1], state[2], state[3], state[4], state[5], state[6]
    energy, upper_energy, q1, q2, held = state[7], state[8], state[9], state[10], state[11]
    r, steep, floor, upper_floor = state[12], state[13], state[14], state[15]
    on, steep_for, on_for, settling = state[16], state[17], state[18], state[19]
    for i in range(len(samples)):
        x = samples[i]
        w = g0 * x + s1
        s1 = g1 * x - p1 * w
        u = b0 * w + s2
        s2 = b1 * w - a1 * u + s3
        s3 = b2 * w - a2 * u
        y = c0 * u + l1
        l1 = 2 * c0 * u - d1 * y + l2
        l2 = c0 * u - d2 * y
        z = e0 * y + h1
        h1 = -2 * e0 * y - f1 * z + h2
        h2 = e0 * y - f2 * z
        energy += energy_share * (y * y - energy)
        upper_energy += energy_share * (z * z - upper_energy)

        q1 += slope_share * (x - q1)
        change = slope_share * (q1 - q2)
        q2 += change
        slope = rate * abs(change)
        held *= keep
        if slope > held:
            held = slope
        # A knock must be known before its energy is seen: by a slope that is smoothed less.
        change = quick_share * (x - r)
        r += change
        slope = rate * abs(change)
        steep *= keep
        if slope > steep:
            if slope > FRESH * steep:
                steep_for = 0.0
            steep = slope
        steep_for = steep_for + 1.0 if steep >= steepest else 0.0

        # Bars as energies: what noise and a change of force leave are independent.
        extra = held * held - slope_noise * floor
        if extra < 0.0:
            extra = 0.0
        noise_bar, upper_noise_bar = ratio * floor, upper_ratio * upper_floor
        if on > 0.0:
            bar, upper_bar = stay * noise_bar, stay * upper_noise_bar
        else:
            bar = noise_bar + slope_bar * extra
            upper_bar = upper_noise_bar + upper_slope_bar * extra
        # After a knock the upper band rings longer than its bar knows. Else the energy is held against what the upper
        # band would have been content with.
        if upper_energy > upper_bar and steep_for == 0.0:
            other = energy * upper_bar / upper_energy
            if other < bar:
                bar = other
        if settling > 0.0:
            settling -= 1.0
            on = 0.0
        else:
            on = 1.0 if energy > bar and (on > 0.0 or steep_for == 0.0 or steep_for > deaf) else 0.0
        on_for = on_for + 1.0 if on > 0.0 else 0.0
        # Frozen while ON, unless that lasts longer than slip does, and while the force changes.
        calm = extra == 0.0 and energy < noise_bar and upper_energy < upper_noise_bar
        if on_for > patience or (on == 0.0 and calm):
            floor += floor_share * (energy - floor)
            upper_floor += floor_share * (upper_energy - upper_floor)
            if floor < minimum:
                floor = minimum
            if upper_floor < min_upper:
                upper_floor = min_upper
        filtered[i] = y
        levels[i] = math.sqrt(energy)
        bars[i] = math.sqrt(bar)
        flags[i] = on
    state[0], state[1], state[2], state[3], state[4], state[5], state[6] = s1, s2, s3, l1, l2, h1, h2
    state[7], state[8], state[9], state[10], state[11] = energy, upper_energy, q1, q2, held
    state[12], state[13], state[14], state[15] = r, steep, floor, upper_floor
    state[16], state[17], state[18] = on, steep_for, on_for
    state[19] = settling


LOOP = Loop(_fast_loop, outputs=4)
