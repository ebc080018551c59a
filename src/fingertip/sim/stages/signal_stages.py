"""A scene's stages from the contact's force to voltages: sensor, cable, bridge, converter, filter board, comparator."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fingertip.sim.electronics import analog, comparator, fsr
from fingertip.sim.electronics.amplifiers import amplified
from fingertip.sim.electronics.anti_alias import Poles
from fingertip.sim.electronics.board_noise import input_noise_v
from fingertip.sim.electronics.converter import noise_v, sampled_v
from fingertip.sim.electronics.sensing import on_sensor_n, voltage_of
from fingertip.sim.scenes import disturbances
from fingertip.sim.stages.context import Context

Given = Mapping[str, Any]


def sense(c: Context, given: Given) -> dict[str, Any]:
    """Force as the sensor shows it."""
    sensed = given["contact_n"]
    if "grid_shear_m" in given:
        sensed = on_sensor_n(sensed, given["grid_shear_m"])
    shown = fsr.with_hysteresis(sensed[c.every])
    if c.scene.drift.share_per_decade:
        shown = disturbances.creep(c.scene.drift, shown, 1 / c.design.detector.sample_rate_hz)
    return {"shown_n": shown, "evaluations": len(shown)}


def touch_cable(c: Context, given: Given) -> dict[str, Any]:
    """What a touched cable adds, and its jumps, each taken to fall on a sample."""
    jumped, before = disturbances.cable_v(c.scene.cable, c.timeline.held_s, c.time_s[c.every])
    return {"cable_v": jumped, "cable_jump_v": jumped - before}


def bridge(c: Context, given: Given) -> dict[str, Any]:
    """Voltage of bridge and amplifier, without noise."""
    voltage = np.array([*map(voltage_of(c.design, c.scene.sensing.bridge), given["shown_n"].tolist())])
    if "cable_v" in given:
        voltage = voltage + given["cable_v"]
    if c.scene.drift.volt_per_s:
        voltage = voltage + c.scene.drift.volt_per_s * c.time_s[c.every]
    return {"bridge_v": voltage}


def convert(c: Context, given: Given) -> dict[str, Any]:
    """Sampled voltage."""
    jitter, voltage = c.scene.sensing.jitter_s, Poles.tactile(c.design).process(given["bridge_v"])
    if jitter:
        rng, time = c.stream("jitter"), c.time_s[c.every]
        # The voltage is taken a little early or late, on the straight line between samples.
        voltage = np.interp(time + [rng.gauss(0.0, jitter) for _ in range(len(time))], time, voltage)
    return {"voltage_v": sampled_v(c.design, voltage, c.stream("noise") if c.scene.sensing.noise else None)}


def add_noise(c: Context, given: Given) -> dict[str, Any]:
    """Voltage ahead of the filter board, with the noise of the board's amplifiers."""
    voltage = given["bridge_v"]
    if c.scene.sensing.noise:
        voltage = voltage + noise_v(c.stream("board noise"), input_noise_v(c.design), len(voltage))
    return {"tactile_v": voltage}


def filter_and_envelope(c: Context, given: Given) -> dict[str, Any]:
    """Outputs of the filter board; a jump of its input is an event."""
    after, board = given["tactile_v"], amplified(c.design, c.scene.sensing.amplifiers)
    before = after - given["cable_jump_v"] if "cable_jump_v" in given else after
    out = analog.respond(board, 1 / c.design.detector.sample_rate_hz, before, after_v=after)
    return {"filtered_v": out.filtered_v, "envelope_v": out.envelope_v, "evaluations": out.steps + out.rejected}


def sense_slip_pin(c: Context, given: Given) -> dict[str, Any]:
    """The ON/OFF pin."""
    step = 1 / c.design.detector.sample_rate_hz
    pin = comparator.pin_v(c.design, step, given["filtered_v"], given["envelope_v"])
    return {"slip_pin_v": pin, "evaluations": len(pin)}
