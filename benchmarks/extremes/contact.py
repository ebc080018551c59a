"""Contact with fixed steps and with error control: refined steps, tolerances, and bristles within breakaway."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.extremes.draw import Draw, Range
from fingertip.foundation.numerics import Array
from fingertip.sim.contact import coupled
from fingertip.sim.contact.friction import ELASTO_PLASTIC, Friction
from fingertip.sim.contact.tangential import DraggedPad, Mount, admissible_step_s
from fingertip.sim.runs.timeline import TrapezoidalMove
from fingertip.sim.signal.grid import BASE_HZ

STEPS, PARTS = 1000, 16
FIXED_ERROR = 0.1, 0.25
"""Bound of the error with fixed steps, inside the bounds and beyond, as a share of the largest load and pull.

A contact that hardly damps, under a carriage that starts at once, rings with half a radian per step: 0.13 remain."""
CONTROLLED_ERROR, BOUNCING_ERROR = 100.0, 0.1
"""Bound of the error with error control, in tolerances; where the pad leaves the surface, also a share of the load, as
every impact multiplies the errors before it."""


def draw_contact(draw: Draw, sigma0_per_m: Range, least: float = 1e-6) -> tuple[Friction, Mount]:
    """Draw a pad and its friction; `least` is that of the coefficient, and that of the Stribeck velocity [m/s]."""
    mu_c = draw.log("mu_c", (0.01, 2.3), (least, 10.0))
    stribeck = draw.log("Stribeck velocity [m/s]", (1e-3, 1.0), (least, 10.0))
    sigma0 = draw.log("sigma0 [1/m]", (25e3, 25.001e3), sigma0_per_m)
    sigma1 = draw.log("sigma1 [s/m]", (2.0, 2.0001), (1e-3, 10.0))
    sigma2 = draw.log("sigma2 [s/m]", (0.6, 0.60001), (1e-3, 10.0))
    # Friction only takes energy up to a drop of mu_s - mu_c = mu_c sigma2 / sigma1.
    drop = draw.log("drop / largest passive drop", (0.01, 0.95), (1e-6, 0.999)) * mu_c * sigma2 / sigma1
    mass = draw.log("mass [kg]", (1e-4, 2.0), (1e-6, 10.0))
    stiffness = draw.log("stiffness [N/m]", (10.0, 1e5), (1e-2, 1e6))
    zeta = draw.log("damping ratio", (0.05, 0.8), (0.02, 3.0))
    friction = Friction(mu_c + drop, mu_c, stribeck, sigma0, sigma1, sigma2)
    return friction, Mount(mass, stiffness, 2 * zeta * math.sqrt(stiffness * mass))


def _drag(draw: Draw, time_s: Array, load_n: float) -> tuple[Array, Array, Array]:
    """Draw the motion of the carriage and the load over a time."""
    span = float(time_s[-1])
    speed = draw.log("speed [m/s]", (1e-3, 0.2), (1e-4, 3.0))
    load = draw.choose("load is", ("constant", "gone at once", "half waves", "a ramp"))
    starts = draw.choose("carriage starts", ("slowly",) if draw.is_inside else ("slowly", "at once"))
    if starts == "slowly":
        move = TrapezoidalMove.with_speed(0.1 * span, 0.6 * speed * span, speed, 20 * speed / span)
        at, velocity = move.position_m(time_s), move.velocity_m_s(time_s)
    else:
        at, velocity = speed * time_s, np.full_like(time_s, speed)
    share = {
        "constant": np.ones_like(time_s),
        "gone at once": np.interp(time_s / span, (0.5, 0.501), (1.0, 0.0)),
        "half waves": np.maximum(np.sin(10 * math.pi * time_s / span), 0.0),
        "a ramp": np.clip(2 * time_s / span, 0.0, 1.0),
    }[load]
    return at, velocity, load_n * share


def fixed_steps(draw: Draw) -> float:
    """Compare with steps 16 times as short, at the step that the program chooses."""
    friction, mount = draw_contact(draw, (1.0, 1e9))
    load = draw.log("load [N]", (1e-3, 70.0), (1e-4, 1e3))
    step = min(1 / BASE_HZ, admissible_step_s(friction, mount, load))
    time = np.asarray(np.arange(STEPS * PARTS + 1) * (step / PARTS), dtype=np.float64)
    columns = _drag(draw, time, load)
    coarse = [column[::PARTS] for column in columns]
    fine_load = np.interp(time, time[::PARTS], coarse[2])
    motion = DraggedPad(friction, mount, step).process(*coarse)
    finer = DraggedPad(friction, mount, step / PARTS).process(*columns[:2], fine_load)
    at, velocity, bristle = (values[::PARTS] for values in vars(finer).values())
    pull = mount.stiffness_n_per_m * (coarse[0] - at) + mount.damping_n_s_per_m * (coarse[1] - velocity)
    largest = load + float(np.abs(pull).max())
    grip = friction.sigma0 * coarse[2] * np.abs(motion.bristle_m - bristle)
    spring = mount.stiffness_n_per_m * np.abs(motion.position_m - at)
    return float(np.maximum(grip, spring).max()) / largest / FIXED_ERROR[not draw.is_inside]


def error_control(draw: Draw) -> float:
    """Compare with a hundredth of the tolerance."""
    friction, mount = draw_contact(draw, (1.0, 1e8))
    load = draw.log("load [N]", (1e-3, 70.0), (1e-4, 1e2))
    elastic = draw.choose("elastic", (0.0, ELASTO_PLASTIC))
    normal = coupled.NormalContact(
        draw.log("resonance [Hz]", (20.0, 500.0), (1.0, 1e4)), draw.log("its damping ratio", (0.05, 0.8), (0.01, 3.0))
    )
    step = draw.log("sample time [s]", (1e-4, 1e-3), (1e-5, 1e-2))
    time = np.asarray(np.arange(101) * step, dtype=np.float64)
    columns = _drag(draw, time, load)
    friction = Friction(**{**vars(friction), "elastic": elastic})
    tolerance = 1e-5 * max(load, 1e-2)
    motion, finer = (
        coupled.integrate(friction, mount, normal, step, *columns, tolerance / parts) for parts in (1.0, 100.0)
    )
    spring = mount.stiffness_n_per_m * np.abs(motion.position_m - finer.position_m)
    error = np.maximum(spring, np.abs(motion.force_n - finer.force_n))
    bouncing = BOUNCING_ERROR * load if (finer.force_n == 0.0).any() else 0.0
    return float(error.max()) / (tolerance * CONTROLLED_ERROR + bouncing)
