"""Stages of a scene from contact force to voltages: sensor, cable, bridge, ADC, filter board, comparator."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fingertip.sim.signal import comparator, filter_board
from fingertip.sim.signal.converter import AntiAliasFilter, draw_noise_v, sample_v
from fingertip.sim.signal.analog_circuit import board_with_amplifiers
from fingertip.sim.signal.board_noise import compute_input_noise_v
from fingertip.sim.signal.fsr import apply_hysteresis, compute_sensor_force_n, select_voltage_function
from fingertip.sim.scene import disturbances
from fingertip.sim.stages.context import SceneContext

Inputs = Mapping[str, Any]


def compute_sensor_force(context: SceneContext, inputs: Inputs) -> dict[str, Any]:
    """Compute the force that the sensor shows, with shear, hysteresis and creep."""
    force = inputs["contact_n"]
    if "grid_shear_m" in inputs:
        force = compute_sensor_force_n(force, inputs["grid_shear_m"])
    sensor_n = apply_hysteresis(force[context.samples])
    if context.scene.drift.share_per_decade:
        sensor_n = disturbances.apply_creep(context.scene.drift, sensor_n, 1 / context.design.detector.sample_rate_hz)
    return {"sensor_n": sensor_n, "evaluations": len(sensor_n)}


def compute_cable_voltage(context: SceneContext, inputs: Inputs) -> dict[str, Any]:
    """Compute the voltage that a touched cable adds, and its jumps, each assumed to happen at a sample."""
    time = context.time_s[context.samples]
    voltage, before = disturbances.cable_voltage_v(context.scene.cable, context.timeline.held_s, time)
    return {"cable_v": voltage, "cable_jump_v": voltage - before}


def compute_bridge_voltage(context: SceneContext, inputs: Inputs) -> dict[str, Any]:
    """Compute the voltage of bridge and amplifier, without noise."""
    voltage = np.array(
        [*map(select_voltage_function(context.design, context.scene.sensing.bridge), inputs["sensor_n"].tolist())]
    )
    if "cable_v" in inputs:
        voltage = voltage + inputs["cable_v"]
    if context.scene.drift.volt_per_s:
        voltage = voltage + context.scene.drift.volt_per_s * context.time_s[context.samples]
    return {"bridge_v": voltage}


def sample_voltage(context: SceneContext, inputs: Inputs) -> dict[str, Any]:
    """Sample the voltage with the ADC: anti-alias poles, jitter, noise and quantisation."""
    design, sensing = context.design, context.scene.sensing
    voltage = AntiAliasFilter.for_tactile(design).process(inputs["bridge_v"])
    if sensing.jitter_s:
        rng, time = context.random_stream("jitter"), context.time_s[context.samples]
        # The ADC samples a little early or late, on the straight line between samples.
        voltage = np.interp(time + [rng.gauss(0.0, sensing.jitter_s) for _ in range(len(time))], time, voltage)
    return {"voltage_v": sample_v(design, voltage, context.random_stream("noise") if sensing.noise else None)}


def add_board_noise(context: SceneContext, inputs: Inputs) -> dict[str, Any]:
    """Compute the voltage ahead of the filter board, with the noise of the board's amplifiers."""
    voltage = inputs["bridge_v"]
    if context.scene.sensing.noise:
        rng = context.random_stream("board noise")
        voltage = voltage + draw_noise_v(rng, compute_input_noise_v(context.design), len(voltage))
    return {"tactile_v": voltage}


def filter_on_board(context: SceneContext, inputs: Inputs) -> dict[str, Any]:
    """Compute the outputs of the filter board. A jump of its input restarts the integration."""
    after, board = inputs["tactile_v"], board_with_amplifiers(context.design, context.scene.sensing.amplifiers)
    before = after - inputs["cable_jump_v"] if "cable_jump_v" in inputs else after
    out = analog.simulate_board(board, 1 / context.design.detector.sample_rate_hz, before, after_v=after)
    return {"filtered_v": out.filtered_v, "envelope_v": out.envelope_v, "evaluations": out.steps + out.rejected}


def compute_slip_pin(context: SceneContext, inputs: Inputs) -> dict[str, Any]:
    """Compute the voltage of the comparator's ON/OFF output."""
    step = 1 / context.design.detector.sample_rate_hz
    pin = comparator.simulate_pin_v(context.design, step, inputs["filtered_v"], inputs["envelope_v"])
    return {"slip_pin_v": pin, "evaluations": len(pin)}
