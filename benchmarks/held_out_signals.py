# mypy: disable-error-code="no-any-return"
"""Labelled test recordings of one force-sensing resistor under silicone, for judging a slip detector it never met.

Sources: slip as vibration: Johansson and Westling, Exp Brain Res, 1987; Howe and Cutkosky, IEEE ICRA, 1989.  Creep
before gross slip: Tremblay and Cutkosky, IEEE ICRA, 1993; Delhaye, Lefevre and Thonnard, J R Soc Interface, 2014.
Lines at speed / period on a falling background: Bensmaia and Hollins, Somatosens Mot Res, 2003; Wiertlewski, Lozada
and Hayward, IEEE Trans Robotics, 2011.  Friction noise and stick-slip: Akay, J Acoust Soc Am, 2002.  Contact area as
force to the 2/3 to 1: Archard, Proc R Soc A, 1957; Greenwood and Williamson, Proc R Soc A, 1966.  Tremor: Elble and
Randall, Electroencephalogr Clin Neurophysiol, 1978; McAuley and Marsden, Brain, 2000; its harmonics: Gresty and
Buckwell, JNNP, 1990.  Minimum jerk: Flash and Hogan, J Neurosci, 1985.
The brief gives the ranges of amplitude and time.  Every other number is an assumption: pad corner 120-250 Hz, peak
40-150 Hz, mix of slip kinds, modulation depths, 200 mV per newton, contact creep, drift, harmonics, the power 1/3.

Labels: `motion_s` first movement; `onset_s` the amplitude envelope first reaches half its full rms; `end_s` it falls to
half.  The rms of a slip is that of 20-300 Hz of T, over the whole slip, before its rise and fall are applied.
The first contact is no event (it ends before `quiet_from_s`), except in "vibration with the grasp".  Hand motion,
hum and ramps stay in `events` where a slip overlaps them; the force change that belongs to a slip does not.
T is computed and filtered at 8 kHz (bilinear), then every fourth sample is taken.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple
from zlib import crc32

import numpy as np
from numpy.typing import NDArray
from scipy import fft, signal

RATE_HZ = 2000.0
FINE_HZ = 8000.0
BUFFER_S = 31.0
MV_PER_N = 200.0
HIGH_PASS = signal.butter(3, 67.0, "highpass", fs=FINE_HZ, output="sos")
RAMP_KINDS = ("minimum jerk", "rounded", "exponential")
STEP_KINDS = ("linear", "minimum jerk", "underdamped")
LAWS = {"1/3": 1.0 / 3.0, "2/3": 2.0 / 3.0, "1": 1.0}
CHANGES = {"drop": -1.0, "none": 0.0, "rise": 1.0}
MOTION_BANDS_HZ = {"hand motion 0.5-4 Hz": (0.5, 4.0), "hand motion 4-8 Hz": (4, 8), "hand motion 8-15 Hz": (8, 15)}
COUNTS = {
    **{"slide after load": 32, "slip at constant force": 16, **dict.fromkeys(MOTION_BANDS_HZ, 26)},
    **{"slip within tremor": 16, "servo steps": 38, "isolated step": 16, "isolated step with gear vibration": 16},
    **{"set-down": 22, "release": 64, "force ramp": 16, "tap": 13, "knock": 13, "ring": 13},
    **{f"quiet noise x{scale}": 18 for scale in ("0.5", "1", "2", "4")},
    **{f"law {law} {change}": 22 for law in LAWS for change in CHANGES},
    **{"weak slip": 16, "vibration with the grasp": 64, "slip in pauses": 12, "hum that begins late": 64},
}
ROWS: tuple[str, ...] = tuple(COUNTS)
Array = NDArray[np.float64]
Rng = np.random.Generator


class Recording(NamedTuple):
    row: str
    board: str  # "S" or "A"
    tactile_v: Array
    filtered_v: Array | None
    slips: tuple[tuple[float, float, float], ...]  # motion_s, onset_s, end_s
    events: tuple[tuple[float, float], ...]  # start_s, end_s
    quiet_from_s: float


def log_uniform(rng: Rng, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def samples(duration_s: float) -> int:
    return max(1, round(duration_s * FINE_HZ))


def shaped_noise(rng: Rng, n: int, gain: Callable[[Array], Array], top_hz: float) -> Array:
    """Gaussian noise of unit rms whose amplitude spectrum follows `gain` up to `top_hz` and is zero above."""
    length = fft.next_fast_len(n, real=True)
    freq_hz = fft.rfftfreq(length, 1.0 / FINE_HZ)
    used = int(np.searchsorted(freq_hz, top_hz))
    spectrum = np.zeros(len(freq_hz), complex)
    spectrum[1:used] = (rng.standard_normal((used - 1, 2)) @ [1.0, 1j]) * gain(freq_hz[1:used])
    noise = fft.irfft(spectrum, length)[:n]
    return noise / noise.std()


def wander(rng: Rng, n: int, cut_hz: float) -> Array:
    """Slow random curve of about unit variance, with knots every half period of `cut_hz`."""
    knots = int(n / FINE_HZ * 2.0 * cut_hz) + 3
    return np.interp(np.arange(n) * 2.0 * cut_hz / FINE_HZ, np.arange(knots), rng.standard_normal(knots))


def band_rms(x: Array, rate_hz: float = FINE_HZ) -> float:
    """Rms of x between 20 and 300 Hz."""
    length = fft.next_fast_len(len(x), real=True)
    power = np.abs(fft.rfft(x - x.mean(), length)) ** 2
    freq_hz = fft.rfftfreq(length, 1.0 / rate_hz)
    return float(np.sqrt(2.0 * power[(freq_hz >= 20.0) & (freq_hz <= 300.0)].sum() / (length * len(x))))


def transition(rng: Rng, kind: str, duration_s: float) -> Array:
    """A change from 0 to 1; exponential (98 %) and underdamped (first peak) ones settle after `duration_s`."""
    n = samples(duration_s)
    x = np.arange(1, n + 1) / n
    if kind == "minimum jerk":
        return x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    if kind == "linear":
        return x
    if kind == "rounded":
        width = max(1, round(rng.uniform(0.1, 0.3) * n))
        return np.cumsum(np.convolve(np.ones(n - width), np.ones(width))) / ((n - width) * width)
    x = np.arange(1, 4 * n + 1) / n
    if kind == "exponential":
        return 1.0 - np.exp(-4.0 * x)
    decay = -np.log(rng.uniform(0.01, 0.1))
    return 1.0 - np.exp(-decay * x) * (np.cos(np.pi * x) + decay / np.pi * np.sin(np.pi * x))


def slip_source(rng: Rng, n: int, kind: str, peak_hz: float) -> Array:
    """What the moving surface does to the pad, before the pad filters it."""
    if kind == "roughness":
        impulses, many = np.zeros(n), round(n / FINE_HZ * rng.uniform(100.0, 400.0))
        impulses[rng.integers(n, size=many)] = rng.laplace(0.0, 4.5, many)
        bursts = np.exp(rng.uniform(0.3, 0.8) * wander(rng, n, 60.0)) * rng.standard_normal(n)
        return bursts + impulses * rng.uniform(0.3, 1.0)
    glide = 1.0 - rng.uniform(0.0, 0.5) * np.exp(-np.arange(n) / FINE_HZ / rng.uniform(0.02, 0.1))
    speed = glide * np.exp(rng.uniform(0.03, 0.15) * wander(rng, n, rng.uniform(1.0, 6.0)))
    if kind == "texture":
        cycles, slope = np.cumsum(speed * peak_hz) / FINE_HZ, rng.uniform(0.6, 1.6)
        sizes = ((0.5, rng.uniform(0.0, 0.6)), *((k, k**-slope) for k in (1.0, 2.0, 3.0)))
        return sum(size * np.sin(2.0 * np.pi * (k * cycles + rng.random())) for k, size in sizes)
    cycles = np.cumsum(speed * log_uniform(rng, 20.0, 80.0)) / FINE_HZ + rng.random()
    whole = cycles.astype(int)
    return np.exp(0.25 * rng.standard_normal(whole[-1] + 1))[whole] * (2.0 * (cycles - whole) - 1.0)


def slip_vibration(rng: Rng, n: int) -> Array:
    """Vibration of unit rms in 20-300 Hz: lines, friction noise or stick-slip through a resonance and a soft pad."""
    m = fft.next_fast_len(max(n, samples(0.1)), real=True)
    peak_hz, quality = log_uniform(rng, 40.0, 150.0), rng.uniform(0.8, 3.0)
    freq_hz = fft.rfftfreq(m, 1.0 / FINE_HZ)
    pad = (freq_hz / 15.0) ** 2 / (1.0 + (freq_hz / 15.0) ** 2) / (1.0 + 1j * freq_hz / rng.uniform(120.0, 250.0)) ** 2
    detune = 1j * freq_hz / (peak_hz * quality)
    resonance = detune / (1.0 - (freq_hz / peak_hz) ** 2 + detune) + 0.1 / (1.0 + freq_hz / 50.0)
    kind = str(rng.choice(["texture", "roughness", "stick-slip"], p=[0.4, 0.35, 0.25]))
    x = fft.irfft(fft.rfft(slip_source(rng, m, "roughness", peak_hz)) * pad * resonance, m)
    if kind != "roughness":
        main = fft.irfft(fft.rfft(slip_source(rng, m, kind, peak_hz)) * pad, m)
        x = main / band_rms(main) + rng.uniform(0.2, 0.8) * x / band_rms(x)
    x = (x * np.exp(rng.uniform(0.1, 0.35) * wander(rng, m, log_uniform(rng, 2.0, 15.0))))[:n]
    return x / band_rms(x)


def hand_motion(rng: Rng, n: int, low_hz: float, high_hz: float, steady: bool) -> Array:
    """Force variation in the band, plus the small parts tremor always has; unit rms where its envelope is 1.

    It starts at once (within half a period), grows, fades or is modulated."""
    if rng.random() < 0.5:
        centre_hz, width_hz = rng.uniform(low_hz * 1.1, high_hz * 0.95), rng.uniform(0.04, 0.12) * high_hz
        x = shaped_noise(rng, n, lambda f: np.exp(-0.25 * ((f - centre_hz) / width_hz) ** 2), 60.0)
        x += rng.uniform(0.0, 0.1) * (x**2 - 1.0)
    else:
        tilt = rng.uniform(0.0, 1.0)
        x = shaped_noise(rng, n, lambda f: f**-tilt / np.sqrt((1 + (low_hz / f) ** 8) * (1 + (f / high_hz) ** 8)), 60.0)
    for share, part_hz, part_width_hz in ((0.08, rng.uniform(8.0, 12.0), 1.0), (0.03, rng.uniform(15.0, 27.0), 3.0)):
        part = shaped_noise(rng, n, lambda f: np.exp(-0.25 * ((f - part_hz) / part_width_hz) ** 2), 60.0)  # noqa: B023
        x += rng.uniform(0.0, share) * part
    t_s, total_s = np.arange(n) / FINE_HZ, n / FINE_HZ
    edges = np.sin(np.pi * np.minimum(np.minimum(t_s, t_s[::-1]) * np.sqrt(low_hz * high_hz), 0.5)) ** 2
    slow = np.minimum(t_s / rng.uniform(0.2 * total_s, 0.7 * total_s), 1.0)
    swing = np.sin(2.0 * np.pi * (rng.uniform(0.1, 0.6) * t_s + rng.random()))
    shapes = (np.ones(n), slow, slow[::-1], 1.0 - rng.uniform(0.5, 1.0) * (0.5 + 0.5 * swing))
    waxing = np.exp(np.minimum(0.15 * wander(rng, n, 0.5), 0.3))
    return x / x.std() * edges * waxing * shapes[0 if steady else rng.integers(4)]


def impact_wave_mv(rng: Rng, row: str) -> Array:
    """Half sine (tap), ring with a pulse of force (knock), or ring of one or two modes, beating, or growing first."""
    half_sine = np.sin(np.pi * np.linspace(0.0, 1.0, samples(log_uniform(rng, 0.004, 0.02 if row == "tap" else 0.008))))
    if row == "tap":
        return half_sine * log_uniform(rng, 10.0, 100.0) * rng.choice([1.0, -1.0], p=[0.75, 0.25])
    kind = "one" if row == "knock" else str(rng.choice(["one", "two modes", "beating", "growing"]))
    freq_hz, decay_s = rng.uniform(60.0, 180.0), log_uniform(rng, 0.003, 0.015)
    t_s = np.arange(samples(8.0 * decay_s + 3.0 / freq_hz)) / FINE_HZ
    x = np.sin(2.0 * np.pi * freq_hz * t_s)
    if kind in ("two modes", "beating"):
        other_hz = freq_hz * rng.uniform(1.05, 1.2) if kind == "beating" else rng.uniform(60.0, 180.0)
        x += rng.uniform(0.4, 1.0) * np.sin(2.0 * np.pi * other_hz * t_s)
    grow_s = rng.uniform(1.0, 2.0) / freq_hz if kind == "growing" else 1.0 / FINE_HZ
    x *= np.minimum(t_s / grow_s, 1.0) * np.exp(-np.maximum(t_s - grow_s, 0.0) / decay_s) / np.abs(x).max()
    if row == "knock":
        x[: len(half_sine)] += rng.uniform(0.2, 0.8) * half_sine[: len(x)]
    return x * log_uniform(rng, 5.0, 100.0) * rng.choice([-1.0, 1.0]) / np.abs(x).max()


def lasting_wave_mv(rng: Rng, n: int, row: str) -> Array:
    """Vibration that lasts: of hand or arm (a band of noise or a wandering line), or hum of the mains."""
    if row == "hum that begins late":
        phase = 2.0 * np.pi * rng.choice([50.0, 60.0]) * rng.uniform(0.999, 1.001) * np.arange(n) / FINE_HZ
        sizes = ((1, 1.0), (2, 0.1), (3, rng.uniform(0.0, 0.3)))
        x = sum(size * np.sin(k * phase + 2.0 * np.pi * rng.random()) for k, size in sizes)
        rms_mv, fade_s = log_uniform(rng, 0.3, 1.0), float(rng.choice([0.001, 0.1, 1.0]))
    else:
        centre_hz, width_hz = rng.uniform(35.0, 85.0), log_uniform(rng, 0.3, 15.0)
        x = shaped_noise(rng, n, lambda f: np.exp(-0.25 * ((f - centre_hz) / width_hz) ** 2) * (f > 30.0), 90.0)
        rms_mv, fade_s = log_uniform(rng, 0.1, 0.6), 0.03
    place = np.arange(n)
    return rms_mv * x / x.std() * np.minimum(place / samples(fade_s), 1.0) * np.minimum(place[::-1] / 240.0, 1.0)


class Take:
    """A recording being made: slow force and vibration in mV of T on the fine grid, labels, and a time cursor."""

    def __init__(self, rng: Rng, hold_mv: float | None = None, contact: bool | None = None) -> None:
        self.rng = rng
        self.hold_mv = rng.uniform(130.0, 330.0) if hold_mv is None else hold_mv
        self.change_mv, self.vibration_mv = np.zeros(samples(BUFFER_S)), np.zeros(samples(BUFFER_S))
        self.slips: list[tuple[float, float, float]] = []
        self.events: list[tuple[float, float]] = []
        self.contact_s, self.quiet_from_s, self.now_s = 0.0, 0.5, 0.0
        if rng.random() < 0.4 if contact is None else contact:
            self.contact_s, closing_s = rng.uniform(0.7, 1.0), rng.uniform(0.05, 0.3)
            self.change_mv[0] -= self.hold_mv
            self.shift(self.contact_s, self.hold_mv, transition(rng, str(rng.choice(RAMP_KINDS)), closing_s))
            self.now_s = self.contact_s + closing_s
            self.quiet_from_s = self.now_s + 0.3
            creep = np.log10(1.0 + np.arange(len(self.change_mv)) / FINE_HZ / 0.2)
            self.shift(self.now_s, self.hold_mv * rng.uniform(0.0, 0.02), creep)
        else:
            self.change_mv += rng.uniform(-0.3, 0.3) / FINE_HZ
        self.wait(1.0, 1.5)

    def wait(self, low_s: float, high_s: float) -> None:
        self.now_s += self.rng.uniform(low_s, high_s)

    def shift(self, at_s: float, size_mv: float, shape: Array) -> None:
        room = self.change_mv[samples(at_s) :][: len(shape)]
        room += size_mv * np.diff(shape, prepend=0.0)[: len(room)]

    def vibrate(self, at_s: float, wave_mv: Array, event: bool = False) -> None:
        self.vibration_mv[samples(at_s) :][: len(wave_mv)] += wave_mv
        self.events += [(at_s, at_s + len(wave_mv) / FINE_HZ)] * event

    def ramp(self, size_mv: float, duration_s: float, kinds: tuple[str, ...] = RAMP_KINDS) -> None:
        """A labelled change of force that begins at the cursor; the cursor moves to its end."""
        self.shift(self.now_s, size_mv, transition(self.rng, str(self.rng.choice(kinds)), duration_s))
        self.events.append((self.now_s, self.now_s + duration_s))
        self.now_s += duration_s

    def force_mv(self) -> Array:
        return self.hold_mv + np.cumsum(self.change_mv)

    def slip(self, duration_s: float, rms_mv: float, power: float = 0.0, change_mv: float = 0.0) -> None:
        """A labelled slip that begins at the cursor; `duration_s` runs from onset to end."""
        rng = self.rng
        rise_s, curve, fall_s = rng.uniform(0.0, 0.02), rng.uniform(1.0, 2.5), rng.uniform(0.005, 0.03)
        onset_s = rise_s * 0.5 ** (1.0 / curve)
        end_s = onset_s + duration_s
        t_s = np.arange(samples(end_s + fall_s / 2.0)) / FINE_HZ
        envelope = np.minimum(t_s / max(rise_s, 1.0 / FINE_HZ), 1.0) ** curve
        envelope *= 0.5 + 0.5 * np.cos(np.pi * np.clip((t_s - end_s) / fall_s + 0.5, 0.0, 1.0))
        change = transition(rng, str(rng.choice(RAMP_KINDS)), onset_s + rng.uniform(0.01, 0.04))
        self.shift(self.now_s, change_mv, change)
        if power:
            envelope *= np.maximum(self.force_mv()[samples(self.now_s) :][: len(t_s)] / MV_PER_N, 0.01) ** power
        self.vibrate(self.now_s, rms_mv * envelope * slip_vibration(rng, len(t_s)))
        self.slips.append((self.now_s, self.now_s + onset_s, self.now_s + end_s))
        self.now_s += t_s[-1]

    def finish(self, row: str, board: str) -> Recording:
        """Add the sensor's noise, filter, sample, add the converter's noise and round."""
        rng, n = self.rng, samples(max(self.now_s, 4.0))
        scale, pink_share = 1.0, 0.0
        if row.startswith("quiet"):
            scale, pink_share = float(row.split("x")[1]), rng.choice([0.0, rng.uniform(0.3, 1.0)])
        sensor_v = 2e-6 * scale * shaped_noise(rng, n, np.ones_like, 1000.0)
        force_v = np.maximum(self.force_mv()[:n] + self.vibration_mv[:n], 0.0) / 1e3
        analogue_v = sensor_v + (0.3 + force_v if board == "S" else 3.0 - force_v)

        def with_noise(x_v: Array, rms_v: float) -> Array:
            pink = shaped_noise(rng, n, lambda f_hz: f_hz**-0.5, 1000.0)[::4] if pink_share else 0.0
            noise = np.sqrt(1.0 - pink_share) * rng.standard_normal(len(x_v)) + np.sqrt(pink_share) * pink
            return x_v + scale * rms_v * noise

        labels = (tuple(self.slips), tuple(self.events), self.quiet_from_s)
        tactile_v = with_noise(analogue_v[::4], 4e-4 if board == "A" else 5e-4)
        if board == "A":
            return Recording(row, board, np.round(tactile_v * 3276.8) / 3276.8, None, *labels)
        high_v, _ = signal.sosfilt(HIGH_PASS, analogue_v, zi=signal.sosfilt_zi(HIGH_PASS) * analogue_v[0])
        filtered_v = with_noise(np.clip(1.65 + 67.67 * high_v[::4], 0.0, 3.3), 5e-4)
        codes = [np.clip(np.round(x_v * 4095.0 / 3.3), 0.0, 4095.0) for x_v in (tactile_v, filtered_v)]
        return Recording(row, board, codes[0] * 3.3 / 4095.0, codes[1] * 3.3 / 4095.0, *labels)


def servo_bout(take: Take) -> None:
    rng, stop_s = take.rng, take.now_s + take.rng.uniform(5.0, 10.0)
    pattern, rate_hz, place_mv = str(rng.choice(["alternating", "random", "hunting"])), log_uniform(rng, 1.0, 10.0), 0.0
    size_mv, step_s = log_uniform(rng, 2.0, 30.0) * rng.choice([-1.0, 1.0]), log_uniform(rng, 0.003, 0.03)
    while take.now_s < stop_s:
        if pattern == "random":
            size_mv, step_s = log_uniform(rng, 2.0, 30.0) * rng.choice([-1.0, 1.0]), log_uniform(rng, 0.003, 0.03)
        limit_mv = {"alternating": 0.5 * abs(size_mv), "random": 60.0, "hunting": rng.uniform(0.5, 3.0) * abs(size_mv)}
        size_mv *= -1.0 if abs(place_mv + size_mv) > limit_mv[pattern] else 1.0
        place_mv += size_mv
        next_s = take.now_s + rng.uniform(0.9, 1.1) / rate_hz
        take.ramp(size_mv, step_s, STEP_KINDS)
        take.now_s = next_s


def take_motion(rng: Rng, row: str) -> Take:
    slips = 4 if row == "slip within tremor" else 0
    (low_hz, high_hz), rms_mv = MOTION_BANDS_HZ.get(row, (8.0, 12.0)), 5.0 if slips else log_uniform(rng, 1.0, 30.0)
    take = Take(rng, rng.uniform(130.0, 330.0) + 4.0 * rms_mv)
    n = samples(rng.uniform(12.0, 15.0) if slips else rng.uniform(20.0, 26.0))
    take.vibrate(take.now_s, rms_mv * hand_motion(rng, n, low_hz, high_hz, slips > 0), True)
    stop_s = take.now_s + n / FINE_HZ
    for _ in range(slips):
        take.wait(0.6, 1.5)
        take.slip(rng.uniform(0.3, 1.8), 5.0)
    take.now_s = stop_s + 0.5
    return take


def take_changes(rng: Rng, row: str) -> Take:
    """Rows made of changes of force, each followed by a slide or a pause."""
    step = "step" in row
    shape = {"slide after load": (2, 0.02, 0.2), "set-down": (3, 0.005, 0.02), "force ramp": (4, 0.02, 0.5)}
    count, shortest_s, longest_s = shape.get(row, (4, 0.003, 0.03))
    signs = [-1.0] * count if row == "set-down" else rng.choice([-1.0, 1.0], count)
    sizes_mv = [one * log_uniform(rng, *((2.0, 30.0) if step else (20.0, 200.0))) for one in signs]
    take = Take(rng, rng.uniform(100.0, 260.0) - min(0.0, np.cumsum(sizes_mv).min()))
    for size_mv in sizes_mv:
        take.now_s += step
        begin_s, duration_s = take.now_s, log_uniform(rng, shortest_s, longest_s)
        take.ramp(size_mv, duration_s, STEP_KINDS if step else RAMP_KINDS)
        if "gear" in row:
            n = samples(duration_s)
            phase = 2.0 * np.pi * (rng.uniform(60.0, 200.0) * np.arange(n) / FINE_HZ + rng.random())
            gear = np.sin(phase) * signal.windows.tukey(n, 0.2)
            take.vibrate(begin_s, gear * log_uniform(rng, 0.2, 1.0) / np.sqrt(np.mean(gear**2)))
        if row == "slide after load":
            take.wait(*((0.0, 0.05) if rng.random() < 0.7 else (-0.01, 0.0)))
            take.slip(rng.uniform(2.0, 8.0), rng.uniform(3.0, 10.0))
        take.wait(1.0, 2.0)
    return take


def take_lasting(rng: Rng, row: str) -> Take:
    """Hum, vibration with the grasp, and release."""
    grasp = row == "vibration with the grasp"
    take = Take(rng, contact=True if grasp else None)
    begin_s = take.contact_s
    if row == "hum that begins late":
        begin_s = max(rng.uniform(2.0, 4.0), take.quiet_from_s + 0.2)
        take.now_s = begin_s + 3.0
        take.slip(rng.uniform(0.5, 2.0), 5.0)
    else:
        take.wait(*((5.0, 8.0) if grasp else (1.0, 2.0)))
        take.ramp(-take.force_mv()[samples(take.now_s)], rng.uniform(0.03, 0.2))
    if row != "release":
        take.events.clear()
        take.vibrate(begin_s, lasting_wave_mv(rng, samples(take.now_s + (not grasp) - begin_s), row), True)
    take.now_s += rng.uniform(1.0, 1.5)
    return take


def take_slips(rng: Rng, row: str) -> Take:
    """Several slips with pauses; under a law the grip is drawn too, and the force changes at each onset."""
    _, law, change = row.split() if row.startswith("law") else ("", "", "none")
    pauses = row == "slip in pauses"
    take = Take(rng, MV_PER_N * log_uniform(rng, 0.5, 3.0) if law else None)
    load_mv = rng.uniform(1.0, 6.0) * (pauses and rng.random() < 0.4)
    for _ in range(6 if pauses else 3 if law else 4):
        duration_s = rng.uniform(0.1, 0.5) if pauses else 1.0 if row == "weak slip" else log_uniform(rng, 0.2, 2.0)
        rms_mv = 4.0 if law else 2.0 if row == "weak slip" else rng.uniform(3.0, 10.0)
        take.slip(duration_s, rms_mv, LAWS.get(law, 0.0), CHANGES[change] * rng.uniform(2.0, 15.0) - load_mv)
        pause_s = rng.uniform(0.2, 1.0) if pauses else rng.uniform(0.7, 1.5)
        take.shift(take.now_s, load_mv, transition(rng, "linear", pause_s))
        take.now_s += pause_s
    return take


def take_others(rng: Rng, row: str) -> Take:
    take = Take(rng)
    for _ in range(2 if row == "servo steps" else 5 if row in ("tap", "knock", "ring") else 0):
        if row == "servo steps":
            servo_bout(take)
        else:
            take.vibrate(take.now_s, impact_wave_mv(rng, row), True)
        take.wait(0.8, 1.5)
    take.now_s = 30.0 if row.startswith("quiet") else take.now_s
    return take


def builder(row: str) -> Callable[[Rng, str], Take]:
    if row in MOTION_BANDS_HZ or row == "slip within tremor":
        return take_motion
    if row in ("slide after load", "set-down", "force ramp") or row.startswith("isolated"):
        return take_changes
    if row in ("hum that begins late", "vibration with the grasp", "release"):
        return take_lasting
    return take_slips if row.startswith("law") or "slip" in row else take_others


def generate(row: str, board: str, seed: int, count: int) -> Iterator[Recording]:
    """Yield `count` recordings; each has its own generator, so a longer run begins with the same recordings."""
    for index in range(count):
        rng = np.random.default_rng([seed, crc32(f"{row}/{board}".encode()), index])
        yield builder(row)(rng, row).finish(row, board)


def default_count(row: str) -> int:
    return COUNTS[row]
