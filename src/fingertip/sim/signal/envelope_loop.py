"""Loop of `fingertip.sim.signal.filter_board`: exact linear steps, and a diode that charges R
parallel to C.

    C dv/dt = i - v / R,   i = Is (exp((u - v - i Rs) / nVt) - 1)     variant article
    C dv/dt = (max(u, 0) - v) / R    variants precision, comparator

u is the filter's output and v the envelope. Where the diode hardly conducts, the decay of v is
exact and the diode's current is a correction by Simpson's rule. Elsewhere v follows SDIRK4 (E.
Hairer, G. Wanner, Solving Ordinary Differential Equations II, table IV.6.5; L-stable, order 4,
embedded order 3). Every stage, also with Rs, is one value of Wright's omega function, so no
iteration can fail.

Both amplifiers of the filter end at rails, cannot follow beyond a largest rate, and the second one
of a TL082 jumps up where its input leaves its range. An output that is held there has a given rate,
0 or the largest; a step in which an amplifier begins or ceases to be held is bisected.

A step is the sampling interval divided by a power of two, its level. The shortest step is accepted
without an error estimate and taken by the implicit Euler rule: after a jump of 100 V into a diode
without Rs, the stages of any method of higher order overshoot, and charge that has passed the diode
does not return.
"""

from __future__ import annotations

import math

from fingertip.foundation.jit import CompiledLoop, Floats, MutableFloats

LEVELS = 25
"""Number of step sizes, from the sampling interval down to the interval over 2^24: 30 ps at 2 kHz.
"""
ABSCISSAE = (0.25, 0.75, 0.55, 0.5, 1.0)
"""Positions within a step at which SDIRK4 needs the filter's output (the method's c)."""
BLOCK = 8
"""Rows of the step matrices that one pass computes: the length of a column is a multiple of it."""
ENVELOPE, LEVEL, OUTPUT, RATES = range(4)
"""Indices of the values that a chunk carries beside the states.

They are envelope [V], level of the step, and output [V]; then the rates that both amplifiers would
have [V/s], the input of the second one [V], and 1 where its output has jumped up.
"""
CARRIED = 7
FREE, RISING, FALLING, HIGH, LOW = range(5)
"""States of an amplifier: it follows, rises or falls at its largest rate, or its output stands at a
rail.
"""
RECOVERY_V = 0.1
"""Voltage by which the input comes back before an output that jumped up returns [V]. Assumption:
data sheets are silent, and without it the output would oscillate at once, because its jump pulls
the input up.
"""
EVENT_S = 1e-9
"""Time within which the moment is found at which an amplifier begins or ceases to be held [s]."""
LOG_OFF = math.log(1e-3)
"""Logarithm of the fraction of the tolerance below which the diode's charge is neglected."""
STEPS, REJECTED, IMPLICIT = range(3)
"""Indices of the statistics: accepted steps, rejected steps, and steps that were solved implicitly.
"""

# SDIRK4 in the variables z_i = gamma h k_i with gamma = 1/4: the table's a_ij times 4, and its
# error weights times 4.
A21 = 2.0
A31 = 1.36
A32 = -0.16
A41 = 371 / 340
A42 = -137 / 680
A43 = 15 / 136
A51 = 25 / 6
A52 = -49 / 12
A53 = 31.25
A54 = -85 / 3
E1 = -0.75
E2 = -3.375
E3 = 3.125


def wright_omega(y: float) -> float:
    """Wright's omega function: the w with w + ln w = y.

    Initial values are those of P. W. Lawrence, R. M. Corless, D. J. Jeffrey, ACM TOMS 38(3), 2012,
    doi:10.1145/2168773.2168779, and between -3 and 1 a polynomial within 3.3e-4 of the function.
    There one iteration of order 4 (theirs, after Fritsch) suffices, above 1 there are two: the
    relative error is below 1e-15 above -4, and some 2e-16 |y| below, where y - ln w cancels.
    """
    if y < -40.0:
        return math.exp(y)

    if y < -3.0:
        w = math.exp(y)
        w = w * (1 - w * (1 - 1.5 * w))
    elif y < 1.0:
        w = (0.567024 + 0.362221 * y) + y * y * (
            (0.0745859 - 0.00138001 * y) - y * y * (0.00250178 + 0.000251905 * y)
        )
    else:
        w = math.log(y)
        w = y - w + w / y

    for _ in range(1 if y < 1.0 else 2):
        r = y - w - math.log(w)
        s = 1 + w
        t = 2 * s * (s + 2 * r / 3)
        w = w * (1 + r / s * (t - r) / (t - 2 * r))

    return w


def dot(rows: Floats, start: int, z: Floats, width: int) -> float:
    """Product of the row that begins at `start` with the first `width` values of z."""
    total = rows[start] * z[0]
    for i in range(1, width):
        total += rows[start + i] * z[i]

    return total


def multiply(
    columns: Floats,
    start: int,
    z: Floats,
    width: int,
    rows: int,
    out: MutableFloats,
) -> None:
    """Multiply a matrix, stored by columns, with z: eight sums at a time do not wait for each
    other.

    A mask that changes no index spares the compiled code the test for negative ones: the sums
    become vectors.
    """
    for block in range(0, rows, BLOCK):
        a0 = a1 = a2 = a3 = a4 = a5 = a6 = a7 = 0.0
        for i in range(width):
            value = z[i]
            at = (start + block + i * rows) & 0x7FFFFFFF
            a0 += columns[at] * value
            a1 += columns[at + 1] * value
            a2 += columns[at + 2] * value
            a3 += columns[at + 3] * value
            a4 += columns[at + 4] * value
            a5 += columns[at + 5] * value
            a6 += columns[at + 6] * value
            a7 += columns[at + 7] * value

        out[block] = a0
        out[block + 1] = a1
        out[block + 2] = a2
        out[block + 3] = a3
        out[block + 4] = a4
        out[block + 5] = a5
        out[block + 6] = a6
        out[block + 7] = a7


def find_state(
    output: float,
    rate: float,
    low: float,
    high: float,
    slew: float,
) -> int:
    """State of an amplifier from its output [V], the rate that it would have, and its limits."""
    if rate > 0.0:
        if output >= high:
            return HIGH
        if rate > slew:
            return RISING

        return FREE

    if output <= low:
        return LOW
    if rate < -slew:
        return FALLING

    return FREE


Limits = tuple[int, int, float, float, float, float]
"""Places of both amplifiers' outputs among the states, lower and upper limit of both [V], their
largest rate [V/s], and the input of the second one below which its output jumps up [V]. Both places
are 0 for ideal amplifiers.
"""
Constants = tuple[
    float, float, int, int, int, Limits, bool, tuple[float, float, float], tuple[float, float]
]
"""Tolerance of a step [V], sampling interval [s], numbers of states, of rows of a column and of
levels, limits of the amplifiers, whether the rectifier is `precision`, and the values of diode and
load.
"""


def _envelope_loop(
    constants: Constants,
    before: Floats,
    after: Floats,
    bend: Floats,
    step_columns: Floats,
    output_rows: Floats,
    watched_rows: Floats,
    carried: MutableFloats,
    z: MutableFloats,
    z_next: MutableFloats,
    tables: MutableFloats,
    filtered: MutableFloats,
    envelope: MutableFloats,
    is_held: MutableFloats,
    statistics: MutableFloats,
) -> None:
    """Follow the envelope over a chunk: exact steps of the circuit, and an implicit method where
    the diode conducts.
    """
    # The input is given right before and right after each sample. Between two samples it is one
    # straight line, or two that meet in the middle of the step, higher than the one by `bend` of
    # the step's end. A second stage that jumps needs the moment: there the input is the parabola of
    # the same area. step_columns, output_rows and watched_rows are those of
    # `fingertip.sim.signal.analog_circuit.compute_step_matrices`.
    tolerance, H, states, rows, levels, limits, precision, (saturation, nvt, series), (R, C) = (
        constants
    )
    at1, at2, low, high, slew, reversal = limits
    is_limited = at1 != at2
    is_curved = is_limited and reversal > -math.inf

    if is_curved:
        width = states + 5
    elif is_limited:
        width = states + 4
    else:
        width = states + 2

    watched_at = states + 5
    rate1 = carried[RATES]
    rate2 = carried[RATES + 1]
    input2 = carried[RATES + 2]
    is_up = carried[RATES + 3]
    state1 = state2 = mode = 0
    begin1 = rate1
    begin2 = rate2
    begin_input2 = input2
    u1_at = states  # places of the filter's output at `ABSCISSAE` in a product with step_columns
    shortest = levels - 1
    # A tick is the shortest step; a step at level l takes 2^(levels - 1 - l) of them.
    ticks_per_sample = 1 << shortest
    # Tables by level, filled when a level is first used: decay of the envelope, exponents of the
    # diode's current below which it is off or hardly conducts, and a term of SDIRK4's stages.
    off_at = levels
    weak_at = 2 * levels
    shift_at = 3 * levels
    for a in range(levels):
        tables[a] = 0.0

    v = carried[ENVELOPE]
    level = int(carried[LEVEL])
    u0 = carried[OUTPUT]
    steps = rejected = implicit = 0
    filtered[0] = 0.0
    envelope[0] = v
    is_held[0] = 0.0

    for i in range(len(before) - 1):
        # z holds the circuit's states, the input, its slope, given rates, and the slope's rate.
        slope = (before[i + 1] - after[i]) / H
        bow = bend[i + 1]
        z[states] = after[i]
        z[states + 1] = slope + (3 if is_curved else 2) * bow / H
        tick = 0
        corner = 0
        is_held[i + 1] = 0.0

        if is_curved:
            z[states + 4] = -6 * bow / (H * H)
        elif bow != 0.0:
            corner = ticks_per_sample >> 1
            level = max(level, 1)

        if before[i] != after[i]:
            u0 = dot(output_rows, 0, z, width)
            if is_limited:
                rate1 = dot(watched_rows, 0, z, width)
                rate2 = dot(watched_rows, width, z, width)
                input2 = dot(watched_rows, 2 * width, z, width)

            level = shortest  # after a jump the response may be arbitrarily fast

        while tick < ticks_per_sample:
            # A step begins at a multiple of its own length, so that every step size divides the
            # interval.
            step_ticks = ticks_per_sample >> level
            while tick & (step_ticks - 1):
                level += 1
                step_ticks >>= 1

            # Amplifiers: those that are held have a given rate, and the mode selects the matrices.
            if is_limited:
                state1 = find_state(z[at1], rate1, low, high, slew)
                is_up = 1.0 if input2 < reversal + is_up * RECOVERY_V else 0.0
                state2 = find_state(z[at2], math.inf if is_up > 0.0 else rate2, low, high, slew)
                mode = (2 if state1 else 0) + (1 if state2 else 0)
                if state2 != FREE:
                    is_held[i + 1] = 1.0

                if state1 == RISING:
                    z[states + 2] = slew
                elif state1 == FALLING:
                    z[states + 2] = -slew
                else:
                    z[states + 2] = 0.0

                if state2 == RISING:
                    z[states + 3] = slew
                elif state2 == FALLING:
                    z[states + 3] = -slew
                else:
                    z[states + 3] = 0.0

                begin1 = rate1
                begin2 = rate2
                begin_input2 = input2

            # Linear part: exact states at the end of the step, and the filter's output in its
            # middle and at its end.
            h = H / (1 << level)
            multiply(step_columns, (mode * levels + level) * width * rows, z, width, rows, z_next)
            u4 = z_next[u1_at + 3]
            u5 = z_next[u1_at + 4]
            decay = tables[level]

            if decay == 0.0:
                decay = math.exp(-h / (R * C))
                charge = 0.25 * h / C / (1 + 0.25 * h / (R * C))
                rho = (series + charge) / nvt
                weak = math.log(tolerance * C / (h * saturation))
                tables[level] = decay
                tables[off_at + level] = weak + LOG_OFF
                tables[weak_at + level] = weak

                if saturation * series > 0.0:
                    tables[weak_at + level] = min(
                        weak, math.log(0.01 * nvt / (saturation * series))
                    )

                tables[shift_at + level] = math.log(rho * saturation) + rho * saturation

            # Bounds for the step: the largest output, the smallest envelope, and from them the
            # largest exponent of the diode's current. Between three points the output bends by no
            # more than they do; twice that is a bound with a margin.
            max_output = max(max(u0, u4), u5) + abs(u0 - 2 * u4 + u5)
            min_envelope = v * decay - saturation * R * (1 - decay)
            if v < min_envelope:
                min_envelope = v

            max_exponent = (max_output - min_envelope) / nvt

            if precision:
                # Amplifiers compensate the diode's drop: R and C follow the positive half waves.
                if max_output <= 0.0:
                    v_next = v * decay
                    error = 0.0
                else:
                    # SDIRK4; every stage is linear in its own value.
                    implicit += 1
                    u1 = z_next[u1_at]
                    u2 = z_next[u1_at + 1]
                    u3 = z_next[u1_at + 2]
                    g = 0.25 * h / (R * C)
                    alpha = g / (1 + g)
                    k1 = alpha * (max(u1, 0.0) - v)
                    k2 = alpha * (max(u2, 0.0) - v - A21 * k1)
                    k3 = alpha * (max(u3, 0.0) - v - A31 * k1 - A32 * k2)
                    k4 = alpha * (max(u4, 0.0) - v - A41 * k1 - A42 * k2 - A43 * k3)
                    base = v + A51 * k1 + A52 * k2 + A53 * k3 + A54 * k4
                    k5 = alpha * (max(u5, 0.0) - base)
                    v_next = base + k5
                    error = abs(E1 * k1 + E2 * k2 + E3 * k3 + k5)

                    if min(min(min(u0, u1), min(u2, u3)), min(u4, u5)) < 0.0:
                        # The corner at u = 0 lies within the step, and all stages may miss it.
                        error = max(error, 0.4 * g * max_output)
            elif max_exponent < tables[off_at + level] and saturation * R < 1e-2 * tolerance:
                # The diode is off: neither its forward nor its reverse current matters.
                v_next = v * decay
                error = 0.0
            elif max_exponent < tables[weak_at + level]:
                # The diode hardly conducts: reverse current and decay are exact, the forward
                # current is within the tolerance and integrated by Simpson's rule.
                half_decay = math.sqrt(decay)
                leakage_v = saturation * R
                v_middle = (v + leakage_v) * half_decay - leakage_v
                v_next = (v + leakage_v) * decay - leakage_v
                conduction = (
                    decay * math.exp((u0 - v) / nvt)
                    + 4 * half_decay * math.exp((u4 - v_middle) / nvt)
                    + math.exp((u5 - v_next) / nvt)
                )
                v_next += h / 6 / C * saturation * conduction
                error = 0.0
            elif level == shortest:
                # The implicit Euler rule, solved by Wright's omega function.
                implicit += 1
                alpha = 1 / (1 + h / (R * C))
                charge = alpha * h / C
                rho = (series + charge) / nvt
                current = (
                    wright_omega(
                        math.log(rho * saturation) + rho * saturation + (u5 - alpha * v) / nvt
                    )
                    / rho
                )
                v_next = alpha * v + charge * (current - saturation)
                error = 0.0
            else:
                # SDIRK4. With k_i = gamma h dv/dt, a stage's own value is base + k_i.
                implicit += 1
                u1 = z_next[u1_at]
                u2 = z_next[u1_at + 1]
                u3 = z_next[u1_at + 2]
                g = 0.25 * h
                alpha = 1 / (1 + g / (R * C))
                charge = alpha * g / C
                rho = (series + charge) / nvt
                shift = tables[shift_at + level]
                drop = g / (R * C)
                base = v
                k1 = (
                    charge * (wright_omega(shift + (u1 - alpha * base) / nvt) / rho - saturation)
                    - alpha * drop * base
                )
                base = v + A21 * k1
                k2 = (
                    charge * (wright_omega(shift + (u2 - alpha * base) / nvt) / rho - saturation)
                    - alpha * drop * base
                )
                base = v + A31 * k1 + A32 * k2
                k3 = (
                    charge * (wright_omega(shift + (u3 - alpha * base) / nvt) / rho - saturation)
                    - alpha * drop * base
                )
                base = v + A41 * k1 + A42 * k2 + A43 * k3
                k4 = (
                    charge * (wright_omega(shift + (u4 - alpha * base) / nvt) / rho - saturation)
                    - alpha * drop * base
                )
                base = v + A51 * k1 + A52 * k2 + A53 * k3 + A54 * k4
                k5 = (
                    charge * (wright_omega(shift + (u5 - alpha * base) / nvt) / rho - saturation)
                    - alpha * drop * base
                )
                v_next = base + k5
                error = abs(E1 * k1 + E2 * k2 + E3 * k3 + k5)

            # Reject a step in which an amplifier begins or ceases to be held, or overshoots a rail.
            if is_limited:
                output1 = z_next[at1]
                output2 = z_next[at2]
                rate1 = z_next[watched_at]
                rate2 = z_next[watched_at + 1]
                input2 = z_next[watched_at + 2]
                end1 = find_state(output1, rate1, low, high, slew)
                remains_up = input2 < reversal + is_up * RECOVERY_V
                end2 = find_state(output2, math.inf if remains_up else rate2, low, high, slew)

                if (end1 != state1 or end2 != state2) and h > EVENT_S:
                    # A rail that an output has just reached may be overshot a little, and is then
                    # put back.
                    beyond = max(max(output1, output2) - high, low - min(output1, output2))
                    is_slow = end1 in (RISING, FALLING) or end2 in (RISING, FALLING)
                    if is_slow or state1 != FREE or state2 != FREE or beyond > 0.1 * tolerance:
                        error = 1e300

            if error > tolerance and level < shortest:
                rejected += 1
                level += 1
                if is_limited:
                    rate1 = begin1
                    rate2 = begin2
                    input2 = begin_input2

                continue

            # Accept the step; double the next one where the error is far below the tolerance and
            # the grid allows it.
            steps += 1
            v = v_next
            for a in range(states):
                z[a] = z_next[a]

            if is_limited:
                z[at1] = min(max(z[at1], low), high)
                z[at2] = u5 = min(max(z[at2], low), high)

            u0 = u5
            tick += step_ticks
            part = tick / ticks_per_sample
            z[states] = before[i + 1] if tick == ticks_per_sample else after[i] + slope * (H * part)

            if is_curved:
                z[states] += 3 * bow * part * (1 - part)
                z[states + 1] = slope + 3 * bow * (1 - 2 * part) / H
            elif corner:
                z[states] += 2 * bow * min(part, 1 - part)
                if tick == corner:
                    z[states + 1] = slope - 2 * bow / H

            if level > 0 and error < 0.03 * tolerance and not tick & (2 * step_ticks - 1):
                level -= 1

        filtered[i + 1] = u0
        envelope[i + 1] = v

    carried[ENVELOPE] = v
    carried[LEVEL] = float(level)
    carried[OUTPUT] = u0
    carried[RATES] = rate1
    carried[RATES + 1] = rate2
    carried[RATES + 2] = input2
    carried[RATES + 3] = is_up
    statistics[STEPS] = steps
    statistics[REJECTED] = rejected
    statistics[IMPLICIT] = implicit


run = CompiledLoop(
    _envelope_loop, wright_omega, dot, multiply, find_state, samples="before", plain_us=7.0
)
"""Follows one board over one chunk of samples.

It carries `CARRIED` numbers and z (the states) to the next chunk, uses z_next and tables as scratch
memory, and fills filtered, envelope, whether the second amplifier was held since the sample before,
and the statistics.
"""
