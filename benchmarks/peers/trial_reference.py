"""Independent reference of a whole trial: its equations, solved by scipy in a window around the
start of the slide.

Before the slide the pad rests under its holding force, so every state is known there. The chain is
written out once more: odeint for pad and resonance with the drive as functions of time, a loop for
the play of the sensor, arrays for the bridge, lsim for the filter and the poles ahead of the ADC,
odeint for the envelope.
"""

from __future__ import annotations

import importlib
import math
from dataclasses import dataclass

import numpy as np

from fingertip.design import Design
from fingertip.foundation.jit import compile_for_process
from fingertip.foundation.numerics import Array
from fingertip.sim.contact.friction import LOAD_SCALE_N
from fingertip.sim.runs.scene import SceneRun
from fingertip.sim.runs.timeline import mount_pad
from fingertip.sim.signal.analog_circuit import AnalogBoard, compute_state_space
from fingertip.sim.signal.bridge import HYSTERESIS, TURN_ON_WIDTH_N, Bridge

RATE_HZ = 480_000.0
"""Rate at which the parts of the chain are joined [Hz]."""
BEFORE_S = 0.02
AFTER_S = 0.3
"""Time before and after the start of the slide [s]."""


@dataclass(frozen=True, eq=False)
class TrialReference:
    """Signals of a trial in the window, at `RATE_HZ`."""

    time_s: Array
    force_n: Array
    tactile_v: Array
    envelope_v: Array


def solve_with_scipy(
    design: Design, run: SceneRun, earlier_n: Array, tolerance: float = 1e-11
) -> TrialReference:
    """Solve a trial without noise; its slide must last longer than the window."""
    slide = run.timeline.slide
    assert slide
    time_s = (
        slide.start_s - BEFORE_S + np.arange(round((BEFORE_S + AFTER_S) * RATE_HZ) + 1) / RATE_HZ
    )
    shear_m, force_n = _solve_contact(run, time_s, tolerance)
    shear_n = -run.pad.tangential_stiffness_n_per_m(run.force_n) * shear_m
    tactile_v = _convert(design, run.pad.sensed_n(earlier_n), run.pad.sensed_n(force_n, shear_n))

    return TrialReference(
        time_s,
        force_n,
        tactile_v,
        _solve_board(AnalogBoard.from_design(design), tactile_v, tolerance),
    )


def _solve_contact(run: SceneRun, time_s: Array, tolerance: float) -> tuple[Array, Array]:
    """Shear of the pad [m] and contact force [N]."""
    f = run.friction
    load = run.force_n
    pad = run.pad
    mount = mount_pad(pad, load)
    (slide,) = run.timeline.moves
    m = mount.mass_kg
    k = mount.stiffness_n_per_m
    c = mount.damping_n_s_per_m
    drop = f.mu_s - f.mu_c
    mu_c = f.mu_c
    vs = f.stribeck_m_s
    s0 = f.sigma0
    s1 = f.sigma1
    s2 = f.sigma2
    begin = slide.start_s
    peak = slide.peak_m_s
    a = slide.acceleration_m_s2
    omega = 2 * math.pi * pad.resonance_hz(load)
    zeta = pad.backing.damping_ratio
    follow = 2 * math.pi * pad.backing.resonance_hz
    share = pad.follow_share
    grown_n = (
        load if run.surface.load_law == "proportional" else load / (load + LOAD_SCALE_N) ** (2 / 3)
    )
    stiffness = pad.normal_stiffness_n_per_m(1.0) * grown_n
    scale = 1 / math.sqrt(load + LOAD_SCALE_N)
    profile = run.make_profile()
    heights = profile.heights_m
    slopes = profile.slopes
    start = profile.start_m
    spacing = profile.spacing_m
    begun = float(profile.height_m(np.zeros(1))[0])

    def rates(t: float, u: Array) -> Array:
        x, v, s, hand, y, w = u
        since = max(t - begin, 0.0)
        V = min(a * since, peak)
        X = a * since * since / 2 if a * since < peak else peak * since - peak * peak / (2 * a)
        g = mu_c + drop / (1 + (v / vs) ** 2)
        z = scale * s
        bending = v - s0 * abs(v) * z / g
        at = (x - start) / spacing
        height = heights[0]

        if at > 0.0:
            j = int(at)
            q = at - j
            height = (
                heights[j] * (1 + 2 * q) * (1 - q) ** 2
                + heights[j + 1] * q * q * (3 - 2 * q)
                + spacing * (slopes[j] * q * (1 - q) ** 2 - slopes[j + 1] * q * q * (1 - q))
            )

        drive = load + stiffness * (height - begun - share * (hand - begun))
        out = np.empty(6)
        out[0] = v
        out[1] = (
            k * (X - x)
            + c * (V - v)
            - load * (s0 * z + s1 * load * scale * scale * bending + s2 * v)
        ) / m
        out[2] = load * scale * bending
        out[3] = follow * (height - hand)
        out[4] = w
        out[5] = omega * (omega * (drive - y) - 2 * zeta * w)

        return out

    integrate = importlib.import_module("scipy.integrate")
    resting = np.array([0.0, 0.0, 0.0, begun, load, 0.0])
    # Errors of each state as forces: through the stiffness of the mount, of the bristles and of the
    # contact.
    absolute = tolerance * np.array([1 / k, 1e-3, 1 / s0, 1 / stiffness, 1.0, omega])
    corners = np.array([begin, begin + peak / a])
    found = integrate.odeint(
        compile_for_process(rates),
        resting,
        time_s,
        tfirst=True,
        rtol=tolerance,
        atol=absolute,
        tcrit=corners,
        mxstep=100_000,
    )
    since = np.maximum(time_s - begin, 0.0)
    carriage = np.where(a * since < peak, a * since**2 / 2, peak * since - peak**2 / (2 * a))

    return carriage - found[:, 0], found[:, 4]


def _convert(design: Design, earlier_n: Array, force_n: Array) -> Array:
    """Tactile voltage [V] of the force on the sensor [N]."""
    play = 0.0
    shown = []
    share = 0.2
    for force in earlier_n.tolist():
        play = min(max(play, force), force * (1 + HYSTERESIS / share))

    for force in force_n.tolist():
        play = min(max(play, force), force * (1 + HYSTERESIS / share))
        shown.append(force + share * (play - force))

    bridge = Bridge.of_board(design)
    excess = np.array(shown) - bridge.curve.turn_on_n
    assert excess.min() > TURN_ON_WIDTH_N  # beyond the turn-on the curve is a power law
    conductance = bridge.curve.scale * excess**bridge.curve.exponent
    r = bridge.response

    return np.asarray(
        r.open_v - r.transfer_ohm * r.sensor_v * conductance / (1 + r.source_ohm * conductance)
    )


def _solve_board(board: AnalogBoard, tactile_v: Array, tolerance: float) -> Array:
    """Envelope [V] of a board that has seen the first voltage for long."""
    signal = importlib.import_module("scipy.signal")
    integrate = importlib.import_module("scipy.integrate")
    omega = importlib.import_module("scipy.special").wrightomega
    linear = compute_state_space(board)
    n = linear.A.shape[-1]
    row = linear.rows["FILTERED"][0]
    time_s = np.arange(len(tactile_v)) / RATE_HZ
    system = signal.StateSpace(
        linear.A[0], linear.b[0][:, None], row[None, :n], row[None, n : n + 1]
    )
    resting = np.linalg.solve(linear.A[0], -linear.b[0] * tactile_v[0])
    filtered = signal.lsim(system, tactile_v, time_s, X0=resting)[1]
    resistance, capacitance = (float(value) for value in board.load)
    d = board.diode
    gain = float(board.envelope_gain)

    def precise(t: float, v: Array) -> Array:
        u = np.interp(t, time_s, filtered)
        return np.asarray((max(u, 0.0) - v) / (resistance * capacitance))

    nvt = float(d.emission * d.thermal_v)
    saturation = float(d.saturation_a)
    series = float(d.series_ohm)
    rho = series / nvt
    shift = math.log(rho * saturation) + rho * saturation

    def diode(t: float, v: Array) -> Array:
        u = np.interp(t, time_s, filtered)
        current = omega(shift + (u - v) / nvt) / rho - saturation
        return np.asarray((current - v / resistance) / capacitance)

    found = integrate.odeint(
        diode if board.rectifier == "diode" else precise,
        [0.0],
        time_s,
        tfirst=True,
        rtol=tolerance * 100,
        atol=tolerance,
        hmax=2 / RATE_HZ,
        mxstep=100_000,
    )
    return np.asarray(gain * found[:, 0])
