"""Voltages that are added to the tactile voltage: drift, a touched cable, hum, pink noise,
vibration of a hand.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, MutableSequence, Sequence
from itertools import pairwise
from operator import mul

import numpy as np

from fingertip.foundation.jit import CompiledLoop
from fingertip.foundation.numerics import Array, bisect
from fingertip.sim.signal.grid import BASE_HZ, Grid, OpenStream, Stream
from fingertip.sim.signal.parameters import Cable, Drift, Noise

HAND_BAND_HZ = (30.0, 90.0)
"""Band of a hand's vibration [Hz]."""
HAND_LOAD_N = 0.02
"""Force at which half of a hand's vibration reaches the sensor [N]. Assumption."""
_PINK_OCTAVES = 16
"""Number of first-order processes that add up to pink noise, one per octave down from half the base
grid's rate.
"""
_BAND_STATES = 8
"""Number of states of the filters behind a hand's vibration: two sections of order 2 in each of two
filters.
"""
_GONE = 40.0
"""Number of decay times after which a jump of the cable has decayed to nothing."""


class InterferenceSource:
    def __init__(
        self,
        grid: Grid,
        drift: Drift,
        cable: Cable,
        noise: Noise,
        held_s: float,
        open_stream: OpenStream,
    ) -> None:
        self._grid = grid
        self._drift = drift
        self._cable = cable
        self._noise = noise
        self._held_s = held_s
        self._pink = (
            PinkNoise(grid, noise.pink_v, open_stream("pink noise")) if noise.pink_v else None
        )
        self._hand = (
            HandVibration(grid, noise.hand_v, open_stream("hand vibration"))
            if noise.hand_v
            else None
        )
        self._points = 0

    @property
    def is_silent(self) -> bool:
        cable = self._cable
        noise = self._noise
        return not any(
            (
                self._drift.volt_per_s,
                cable.step_v,
                cable.hum_v,
                noise.pink_v,
                noise.hand_v,
                noise.hum_v,
            )
        )

    def process(self, contact_n: Array) -> tuple[Array, Array | None]:
        """Return the voltage right after each of the next points [V] for a contact's force [N], and
        its jump there.
        """
        count = len(contact_n)
        time_s = self._grid.time_s(self._points, count)
        self._points += count
        volts = np.zeros(count)
        jumps = None

        if self._cable.step_v or self._cable.hum_v:
            touch, jumps = compute_cable_v(self._cable, self._held_s, time_s, self._grid.step_s)
            volts += touch

        if self._drift.volt_per_s:
            volts += self._drift.volt_per_s * time_s
        if self._noise.hum_v:
            volts += compute_hum_v(self._noise, time_s)
        if self._pink:
            volts += self._pink.process(count)

        if self._hand:
            # A sensor begins to show force gradually: noise that began all at once would look like
            # a knock.
            load_n = np.maximum(contact_n, 0.0)
            volts += self._hand.process(count) * (load_n / (load_n + HAND_LOAD_N))

        return volts, jumps


def compute_cable_v(
    cable: Cable, held_s: float, time_s: Array, step_s: float
) -> tuple[Array, Array]:
    """Voltage of a touched cable [V], and its jumps, each at the point that follows it.

    Hum is added in between.
    """
    volts = np.zeros(len(time_s))
    jumps = np.zeros(len(time_s))
    begin_s = held_s + cable.at_s
    _touch(
        (begin_s, begin_s + cable.duration_s),
        cable.step_v,
        cable.decay_s,
        _GONE * cable.decay_s,
        step_s * (1 - 1e-9),
        cable.hum_v,
        2 * math.pi * cable.hum_hz,
        time_s,
        volts,
        jumps,
    )

    return volts, jumps


def compute_hum_v(noise: Noise, time_s: Array) -> Array:
    """Mains hum with its third and fifth harmonic [V]."""
    out = np.zeros(len(time_s))
    _hum(2 * math.pi * noise.hum_hz, noise.hum_v, noise.hum_third, noise.hum_fifth, time_s, out)
    return out


class RefinedNoise:
    """Noise that is drawn on the base grid; on a finer grid it is linear between these points."""

    def __init__(self, grid: Grid, draw: Callable[[int], Array]) -> None:
        self._parts = grid.refinement
        self._draw = draw
        self._points = 0
        self._known = np.zeros(0)

    def process(self, count: int) -> Array:
        if self._parts == 1:
            return self._draw(count)

        at = np.arange(self._points, self._points + count)
        first = self._points // self._parts  # base point that `_known` begins with
        needed = (self._points + count - 1) // self._parts + 2 - first
        self._known = np.concatenate((self._known, self._draw(needed - len(self._known))))
        index = at // self._parts - first
        fraction = (at % self._parts) / self._parts
        out = self._known[index] + fraction * (self._known[index + 1] - self._known[index])
        self._points += count
        self._known = self._known[self._points // self._parts - first :]

        return np.asarray(out)


class PinkNoise(RefinedNoise):
    """Noise whose power per decade is the same in every decade, chunk by chunk.

    Its spectrum is that of a sum of independent first-order processes with corner frequencies one
    octave apart, which is within 0.3 dB of 1/f from 0.1 Hz to 1 kHz (A. van der Ziel, Physica 16,
    1950, 359). One white noise drives all of them, with gains that give the same spectrum: one
    random number per point in place of one per process. Units: `volts_per_decade` [V].
    """

    def __init__(self, grid: Grid, volts_per_decade: float, stream: Stream) -> None:
        decays, gains, steady = design_pink()
        # An octave holds log10(2) of a decade's power, and so does each process.
        deviation = volts_per_decade * math.sqrt(math.log10(2.0))
        white = (deviation * stream.standard_normal(_PINK_OCTAVES)).tolist()
        self._state = np.array([math.fsum(map(mul, row, white)) for row in steady])
        self._matrix = np.array(decays), np.array([deviation * gain for gain in gains])
        self._stream = stream
        super().__init__(grid, self._draw_base)

    def _draw_base(self, count: int) -> Array:
        out = np.zeros(count)
        _pink(*self._matrix, self._stream.standard_normal(count), self._state, out)
        return out


@functools.cache
def design_pink() -> tuple[list[float], list[float], list[list[float]]]:
    """Design processes that one white noise drives and whose sum has the spectrum of independent
    ones of deviation 1.

    Return their decays per step, their gains, and a triangular matrix that makes independent
    numbers their states.

    With u = 1 - cos(w), an independent process has the power c / (u + p). The sum of all has one
    zero -q between each two neighbouring -p, and so is the square of a filter with the zeros b,
    whose partial fractions have these gains.
    """
    decays = [math.exp(-math.pi / 2.0**octave) for octave in range(1, _PINK_OCTAVES + 1)]
    power = [(1 - a * a) / (2 * a) for a in decays]
    p = [(1 - a) ** 2 / (2 * a) for a in decays]
    zeros = []
    gain = math.sqrt(math.fsum(power) * math.prod(2 * a for a in decays))

    for low, high in pairwise(sorted(p)):
        q, _ = bisect(
            lambda u: math.fsum(c / (x - u) for c, x in zip(power, p, strict=True)) < 0.0, low, high
        )
        zeros.append(1 + q - math.sqrt(q * q + 2 * q))
        gain /= math.sqrt(2 * zeros[-1])

    gains = [
        gain
        * math.prod(1 - b / a for b in zeros)
        / math.prod(1 - other_pole / a for other_pole in decays if other_pole != a)
        for a in decays
    ]
    # In the steady state, processes i and k have the covariance gain_i gain_k / (1 - a_i a_k). It
    # is the product of two triangular matrices: the processes in the orthonormal basis of Takenaka
    # and Malmquist.
    steady = [
        [
            r
            * math.sqrt(1 - b * b)
            / (1 - a * b)
            * math.prod((a - c) / (1 - a * c) for c in decays[:k])
            for k, b in enumerate(decays[: i + 1])
        ]
        for i, (a, r) in enumerate(zip(decays, gains, strict=True))
    ]
    return decays, gains, steady


class HandVibration(RefinedNoise):
    """Noise in the band of a hand's vibration, by its RMS [V]: white noise behind Butterworth
    filters of order 4.
    """

    def __init__(self, grid: Grid, deviation_v: float, stream: Stream) -> None:
        low, high = HAND_BAND_HZ
        self._sections = (*_design_butterworth(low, True), *_design_butterworth(high, False))
        impulse = np.zeros(round(BASE_HZ))
        response = np.zeros(round(BASE_HZ))
        impulse[0] = 1.0
        _band_pass(self._sections, impulse, np.zeros(_BAND_STATES), response)
        self._deviation = deviation_v / math.sqrt(float(np.sum(response * response)))
        self._state = np.zeros(_BAND_STATES)
        self._stream = stream
        self._draw_base(round(BASE_HZ / 2))  # the filters are settled when the recording begins
        super().__init__(grid, self._draw_base)

    def _draw_base(self, count: int) -> Array:
        out = np.zeros(count)
        _band_pass(
            self._sections, self._deviation * self._stream.standard_normal(count), self._state, out
        )
        return out


def _design_butterworth(corner_hz: float, is_high_pass: bool) -> tuple[float, ...]:
    """Coefficients b0, b1, b2, a1, a2 of both sections of a Butterworth filter of order 4 (bilinear
    transform).
    """
    k = math.tan(math.pi * corner_hz / BASE_HZ)
    coefficients: list[float] = []

    for pole in (1, 3):
        damping = 2 * math.sin(pole * math.pi / 8)  # 1 / Q of the section
        scale = 1 / (1 + damping * k + k * k)
        b0 = scale if is_high_pass else k * k * scale
        b1 = -2 * b0 if is_high_pass else 2 * b0
        coefficients += [b0, b1, b0, 2 * (k * k - 1) * scale, (1 - damping * k + k * k) * scale]

    return tuple(coefficients)


def _touch_loop(
    moments: tuple[float, float],
    step_v: float,
    decay: float,
    gone: float,
    h: float,
    hum_v: float,
    w: float,
    time: Sequence[float],
    out: MutableSequence[float],
    jumps: MutableSequence[float],
) -> None:
    begin, end = moments
    for i in range(len(time)):
        for moment, volts in ((begin, step_v), (end, -step_v)):
            since = time[i] - moment
            if 0.0 <= since < gone:
                part = volts * math.exp(-since / decay)
                out[i] += part
                if since < h:
                    jumps[i] += part

        if begin <= time[i] < end:
            out[i] += hum_v * math.sin(w * (time[i] - begin))


def _hum_loop(
    w: float,
    amplitude: float,
    third: float,
    fifth: float,
    time: Sequence[float],
    out: MutableSequence[float],
) -> None:
    for i in range(len(time)):
        x = w * time[i]
        out[i] = amplitude * (math.sin(x) + third * math.sin(3 * x) + fifth * math.sin(5 * x))


def _pink_loop(
    decays: Sequence[float],
    gains: Sequence[float],
    white: Sequence[float],
    state: MutableSequence[float],
    out: MutableSequence[float],
) -> None:
    count = len(decays)
    for i in range(len(out)):
        total = 0.0
        for j in range(count):
            state[j] = decays[j] * state[j] + gains[j] * white[i]
            total += state[j]

        out[i] = total


def _band_pass_loop(
    sections: tuple[float, ...],
    white: Sequence[float],
    state: MutableSequence[float],
    out: MutableSequence[float],
) -> None:
    """Apply sections of order 2 one after the other (transposed direct form II)."""
    for i in range(len(white)):
        x = white[i]
        for j in range(len(sections) // 5):
            b0 = sections[5 * j]
            b1 = sections[5 * j + 1]
            b2 = sections[5 * j + 2]
            y = b0 * x + state[2 * j]
            state[2 * j] = b1 * x - sections[5 * j + 3] * y + state[2 * j + 1]
            state[2 * j + 1] = b2 * x - sections[5 * j + 4] * y
            x = y

        out[i] = x


_touch = CompiledLoop(_touch_loop, samples="time", plain_us=0.4)
_hum = CompiledLoop(_hum_loop, samples="time", plain_us=0.6)
_pink = CompiledLoop(_pink_loop, samples="out", plain_us=4.0)
_band_pass = CompiledLoop(_band_pass_loop, samples="white", plain_us=3.0)
