"""Object in a hand, on a pin that hits or carries it: refined steps."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.extremes.contact import FIXED_ERROR, PARTS, draw_contact
from benchmarks.extremes.draw import Draw
from fingertip.foundation.numerics import Array
from fingertip.sim.runs.grasp_loop import Grasp, GraspMotion, HeldObject, Pin
from fingertip.sim.runs.motion import GRAVITY_M_S2
from fingertip.sim.signal.grid import BASE_HZ

POINTS = 800
"""Steps at which forces are compared: 80 ms, or less where they are divided."""
LENGTH_M = 1e3
"""Length of the object: none leaves the fingers."""


def _draw_object(draw: Draw) -> tuple[HeldObject, float]:
    """Draw an object, its pads and pin, and the load of the thumb."""
    friction, mount = draw_contact(draw, (1e3, 1e6), 1e-4)
    load = draw.log("load of the thumb [N]", (0.001, 100.0), (1e-4, 1e3))
    object_kg = draw.log("object [kg]", (0.005, 5.0), (1e-5, 100.0))
    pin = Pin(
        draw.log("pin [N/m]", (50.0, 1e5), (1.0, 1e7)),
        draw.log("damping of the pin [s/m]", (0.01, 20.0), (1e-3, 1e3)),
        draw.choose("attached", (False, True)),
        draw.log("speed [m/s]", (1e-3, 0.2), (1e-4, 3.0)),
    )
    return HeldObject(friction, (mount,) * draw.choose("fingers", (2, 3, 5)), object_kg, LENGTH_M, pin), load


def _move(held: HeldObject, load_n: float, shape: str, parts: int, divide: int) -> GraspMotion:
    """Move the object with parts that are divided further."""
    count, pin, step = len(held.mounts) - 1, held.pin, 1 / BASE_HZ / parts
    at = np.arange(POINTS + 1) / POINTS
    loads: dict[str, Array] = {
        "constant": np.ones_like(at),
        "a ramp": np.clip(2 * at, 0.0, 1.0),
        "half waves": 0.55 + 0.45 * np.sin(6 * math.pi * at),
        "gone in 8 steps": np.interp(at, (0.5, 0.51), (1.0, 0.0)),
    }
    fine = np.arange(POINTS * divide + 1) / (POINTS * divide)
    hangs = np.clip(fine / 0.3, 0.0, 1.0)
    weight = 0.0 if pin.is_attached else held.mass_kg * GRAVITY_M_S2
    speed = pin.speed_m_s * np.interp(fine, (0.35, 0.4, 0.85, 0.9), (0.0, 1.0, 1.0, 0.0))
    way = np.concatenate(([0.0], np.cumsum((speed[1:] + speed[:-1]) / 2))) * step / divide
    start = 0.0 if pin.is_attached else -0.1 * pin.speed_m_s * POINTS * step
    load = load_n * np.array([1.0, *[1 / count] * count])[:, None] * loads[shape]
    return Grasp(held, step, divide).advance(load, weight * hangs**2 * (3 - 2 * hangs), start + way, speed)


def grasp(draw: Draw) -> float:
    """Compare forces of bristles, mounts and pin, and the way of the object, with parts 16 times as short."""
    held, load = _draw_object(draw)
    shapes = "constant", "a ramp", "half waves", "gone in 8 steps"
    shape = draw.choose("load is", shapes[:3] if draw.is_inside else shapes)
    parts = held.count_parts(load, 1 / BASE_HZ)
    draw.values["parts"] = parts
    found, finer = (_move(held, load, shape, parts, divide) for divide in (1, PARTS))
    weight = 0.0 if held.pin.is_attached else held.mass_kg * GRAVITY_M_S2
    largest = load + weight + float(np.abs(finer.pin_n).max())
    grip = held.friction.sigma0 * finer.load_n * np.abs(found.bristle_m - finer.bristle_m)
    spring = held.mounts[0].stiffness_n_per_m * np.abs(found.position_m - finer.position_m)
    pin = np.abs(found.pin_n - finer.pin_n)
    way = np.abs(found.object_m - finer.object_m).max() / (np.abs(finer.object_m).max() + 1e-6)
    return (
        max(float(max(error.max() for error in (grip, spring, pin)) / largest), float(way))
        / FIXED_ERROR[not draw.is_inside]
    )
