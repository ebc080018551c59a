"""The loop of `fingertip.sim.electronics.analog`: exact linear steps, and a diode that charges R parallel to C.

    C dv/dt = i - v / R,   i = Is (exp((u - v - i Rs) / nVt) - 1)     article
    C dv/dt = (max(u, 0) - v) / R                                      variant precision

Where the diode hardly conducts, the decay is exact and its current a correction by Simpson's rule. Elsewhere SDIRK4
(Hairer and Wanner, as in `sim.rosenbrock`, table IV.6.5; L-stable, order 4, embedded order 3): every stage, also with
Rs, is one value of Wright's omega function, so there is no iteration that could fail. Steps are the sample's divided
by powers of two. The shortest is taken as it is, by Euler's implicit rule: after a jump of 100 V into a diode without
Rs the stages of any higher order overshoot, and what has flown through a diode does not flow back.
"""

from __future__ import annotations

import math
from collections.abc import MutableSequence, Sequence

from fingertip.jit import CompiledLoop

LEVELS = 25
"""Steps down to the sample's over 2^24: 30 ps at 2 kHz."""
ABSCISSAE = (0.25, 0.75, 0.55, 0.5, 1.0)
"""Where within a step the method needs the filter's output."""
WIDTH = 8
"""Least length of a row of the matrices, for up to five states; longer rows take their own."""


def omega(y: float) -> float:
    """Wright's omega: the w with w + ln w = y.

    Start as in P. W. Lawrence, R. M. Corless, D. J. Jeffrey, ACM TOMS 38(3), 2012, doi:10.1145/2168773.2168779, then
    their (Fritsch's) iteration of order 4, twice: error below 4e-16 of the value.
    """
    if y < -40.0:
        return math.exp(y)
    if y < -2.0:
        w = math.exp(y)
        w = w * (1 - w * (1 - 1.5 * w))
    elif y < 1.0:
        w = math.exp(2 * (y - 1) / 3)
    else:
        w = math.log(y)
        w = y - w + w / y
    for _ in range(2):
        r = y - w - math.log(w)
        s = 1 + w
        t = 2 * s * (s + 2 * r / 3)
        w = w * (1 + r / s * (t - r) / (t - 2 * r))
    return w


def dot(row: Sequence[float], at: int, z: Sequence[float], width: int) -> float:
    """A row times the state; what is not used is 0."""
    first = row[at] * z[0] + row[at + 1] * z[1] + row[at + 2] * z[2] + row[at + 3] * z[3]
    total = first + (row[at + 4] * z[4] + row[at + 5] * z[5] + row[at + 6] * z[6] + row[at + 7] * z[7])
    for i in range(8, width):
        total += row[at + i] * z[i]
    return total


def _loop(
    tolerance: float,
    H: float,
    n: int,
    width: int,
    levels: int,
    rail: float,
    ideal: bool,
    diode: tuple[float, float, float],
    load: tuple[float, float],
    before: Sequence[float],
    after: Sequence[float],
    step: Sequence[float],
    rows: Sequence[float],
    out: Sequence[float],
    first: Sequence[float],
    carried: MutableSequence[float],
    z: MutableSequence[float],
    new: MutableSequence[float],
    decays: MutableSequence[float],
    filtered: MutableSequence[float],
    enveloped: MutableSequence[float],
    count: MutableSequence[float],
) -> None:
    saturation, nvt, series = diode
    R, C = load
    top = levels - 1
    whole = 1 << top
    for a in range(levels):
        decays[a] = math.exp(-H / (1 << a) / (R * C))
    v = carried[0]
    level = int(carried[1])
    steps = rejected = implicit = 0
    filtered[0] = 0.0
    enveloped[0] = v
    mode = 0
    for i in range(len(before) - 1):
        z[n] = after[i]
        z[n + 1] = (before[i + 1] - after[i]) / H
        z[n + 2] = 1.0
        u0 = dot(out, 0, z, width)
        place = 0
        if before[i] != after[i]:
            level = top  # a jump: what follows it may be as fast as it likes
        while place < whole:
            size = whole >> level
            while place & (size - 1):
                level += 1
                size >>= 1
            if rail > 0.0:
                p = dot(first, 0, z, width)
                o1 = rail if p > rail else -rail if p < -rail else p
                o2 = o1 - z[1] - z[2]
                mode = (1 if p > rail else 2 if p < -rail else 0) * 3 + (1 if o2 > rail else 2 if o2 < -rail else 0)
                u0 = rail if o2 > rail else -rail if o2 < -rail else o2
            h = H / (1 << level)
            at = (mode * levels + level) * n * width
            for a in range(n):
                new[a] = dot(step, at + a * width, z, width)
            at = (mode * levels + level) * 5 * width
            u4, u5 = dot(rows, at + 3 * width, z, width), dot(rows, at + 4 * width, z, width)
            # Between three points the output bends by no more than they do; twice that is a bound with room.
            highest = max(max(u0, u4), u5) + abs(u0 - 2 * u4 + u5)
            decay = decays[level]
            lowest = v * decay - saturation * R * (1 - decay)
            if v < lowest:
                lowest = v
            strongest = (highest - lowest) / nvt
            flow = saturation * math.exp(strongest) if strongest < 300.0 else 1e300
            if ideal:
                # An amplifier takes the diode's drop away: R and C follow the positive half waves.
                if highest <= 0.0:
                    ve = v * decay
                    error = 0.0
                else:
                    implicit += 1
                    u1, u2, u3 = (
                        dot(rows, at, z, width),
                        dot(rows, at + width, z, width),
                        dot(rows, at + 2 * width, z, width),
                    )
                    g = 0.25 * h / (R * C)
                    alpha = g / (1 + g)
                    k1 = alpha * (max(u1, 0.0) - v)
                    k2 = alpha * (max(u2, 0.0) - v - 2 * k1)
                    k3 = alpha * (max(u3, 0.0) - v - 1.36 * k1 + 0.16 * k2)
                    k4 = alpha * (max(u4, 0.0) - v - 371 / 340 * k1 + 137 / 680 * k2 - 15 / 136 * k3)
                    base = v + 25 / 6 * k1 - 49 / 12 * k2 + 31.25 * k3 - 85 / 3 * k4
                    k5 = alpha * (max(u5, 0.0) - base)
                    ve = base + k5
                    error = abs(-0.75 * k1 - 3.375 * k2 + 3.125 * k3 + k5)
                    if min(min(min(u0, u1), min(u2, u3)), min(u4, u5)) < 0.0:
                        # The bend at u = 0 lies within the step, and the stages may all miss it.
                        error = max(error, 0.4 * g * highest)
            elif flow * h < 1e-3 * tolerance * C and saturation * R < 1e-2 * tolerance:
                ve = v * decay
                error = 0.0
            elif flow * h < tolerance * C and flow * series < 0.01 * nvt:
                # What the reverse current and R do is exact, what conducts is within the tolerance.
                half = math.sqrt(decay)
                leak = saturation * R
                vm = (v + leak) * half - leak
                ve = (v + leak) * decay - leak
                feed = (
                    decay * math.exp((u0 - v) / nvt) + 4 * half * math.exp((u4 - vm) / nvt) + math.exp((u5 - ve) / nvt)
                )
                ve += h / 6 / C * saturation * feed
                error = 0.0
            elif level == top:
                implicit += 1
                alpha = 1 / (1 + h / (R * C))
                charge = alpha * h / C
                rho = (series + charge) / nvt
                current = omega(math.log(rho * saturation) + rho * saturation + (u5 - alpha * v) / nvt) / rho
                ve = alpha * v + charge * (current - saturation)
                error = 0.0
            else:
                implicit += 1
                u1, u2, u3 = (
                    dot(rows, at, z, width),
                    dot(rows, at + width, z, width),
                    dot(rows, at + 2 * width, z, width),
                )
                g = 0.25 * h
                alpha = 1 / (1 + g / (R * C))
                charge = alpha * g / C
                rho = (series + charge) / nvt
                shift = math.log(rho * saturation) + rho * saturation
                drop = g / (R * C)
                # z_i = gamma h k_i; the stage's own value is then base + z_i.
                base = v
                k1 = charge * (omega(shift + (u1 - alpha * base) / nvt) / rho - saturation) - alpha * drop * base
                base = v + 2 * k1
                k2 = charge * (omega(shift + (u2 - alpha * base) / nvt) / rho - saturation) - alpha * drop * base
                base = v + 1.36 * k1 - 0.16 * k2
                k3 = charge * (omega(shift + (u3 - alpha * base) / nvt) / rho - saturation) - alpha * drop * base
                base = v + 371 / 340 * k1 - 137 / 680 * k2 + 15 / 136 * k3
                k4 = charge * (omega(shift + (u4 - alpha * base) / nvt) / rho - saturation) - alpha * drop * base
                base = v + 25 / 6 * k1 - 49 / 12 * k2 + 31.25 * k3 - 85 / 3 * k4
                k5 = charge * (omega(shift + (u5 - alpha * base) / nvt) / rho - saturation) - alpha * drop * base
                ve = base + k5
                error = abs(-0.75 * k1 - 3.375 * k2 + 3.125 * k3 + k5)
            if rail > 0.0 and level < top:
                # Did an amplifier reach or leave a rail on the way? Then the step is cut there.
                p = dot(first, 0, new, width) + first[n] * (z[n] + h * z[n + 1])
                o1 = rail if p > rail else -rail if p < -rail else p
                o2 = o1 - new[1] - new[2]
                now = (1 if p > rail else 2 if p < -rail else 0) * 3 + (1 if o2 > rail else 2 if o2 < -rail else 0)
                if now != mode:
                    error = 1e300
            if error > tolerance and level < top:
                rejected += 1
                level += 1
                continue
            steps += 1
            v = ve
            u0 = u5
            for a in range(n):
                z[a] = new[a]
            place += size
            z[n] = before[i + 1] if place == whole else after[i] + z[n + 1] * (H * (place / whole))
            if level > 0 and error < 0.03 * tolerance and not place & (2 * size - 1):
                level -= 1
        if rail > 0.0:
            u0 = rail if u0 > rail else -rail if u0 < -rail else u0
        filtered[i + 1] = u0
        enveloped[i + 1] = v
    carried[0] = v
    carried[1] = float(level)
    count[0], count[1], count[2] = steps, rejected, implicit


run = CompiledLoop(_loop, omega, dot, outputs=7, samples="before", plain_us=10.0)
"""Carries (envelope, level of the next step) and z (the states); new and decays are scratch; fills filtered, enveloped,
and (steps, rejected, implicit steps)."""
