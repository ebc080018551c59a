"""Acceptance sheet: what to measure on a finished finger, the limits, and what each
failure means.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fingertip.board.analysis.tactile_response import IDLE_TOLERANCE_V, PRELOAD
from fingertip.board.components.front_end import MAX_FORCE_N, sensor_conductance_s
from fingertip.design import Design
from fingertip.documents.template import render_page
from fingertip.models.making import making_of
from fingertip.pad.response import Pad
from fingertip.sim.signal.bridge import Bridge, reads_whole_finger

WEIGHTS_G = (100.0, 500.0)
"""Readings of a scale that the pad is pressed on [g]."""
SPREAD = 4.0
"""Factor by which the conductance of a good sensor may differ from the data sheet's curve, up or
down, since single sensors differ by a factor of 2 to 8 at the same force.
"""
_GRAVITY = 9.81


@dataclass(frozen=True)
class WeightReading:
    mass_g: float
    sensor_ohm: float
    tactile_v: float
    limits_v: tuple[float, float]
    """Lowest and highest voltage of a good finger."""


def expect_open_v(design: Design) -> float:
    return Bridge.of_board(design).response.open_v


def expect_readings(design: Design) -> tuple[WeightReading, ...]:
    """Expect the readings of `WEIGHTS_G`.

    A calibrated curve is as uncertain as its calibration, in the range of its forces; else the
    factor is `SPREAD`. No limit is beyond the voltage at `MAX_FORCE_N`, far more than any weight of
    the sheet, so that a short circuit fails.
    """
    bridge = Bridge.of_board(design)
    curve = design.force_curve
    readings = []

    def expect_v(conductance_s: float) -> float:
        """Voltage within the supply of a board for a controller [V]."""
        volts = bridge.response.tactile_v(conductance_s)
        return (
            min(max(volts, 0.0), design.board.supply_v) if design.board.is_for_controller else volts
        )

    # The data sheet's sensor gives it, as the README of the board states, or the calibrated one if
    # that conducts more.
    pressed_v = expect_v(
        max(sensor_conductance_s(MAX_FORCE_N), bridge.curve.conductance_s(MAX_FORCE_N))
    )
    lowest_v, highest_v = sorted((bridge.response.open_v, pressed_v))
    forces_n = np.array(WEIGHTS_G) / 1000.0 * _GRAVITY
    sensed_n = Pad.from_design(design).sensed_n(forces_n, None, reads_whole_finger(design, "board"))

    for mass, force_n, on_sensor_n in zip(
        WEIGHTS_G, forces_n.tolist(), sensed_n.tolist(), strict=True
    ):
        is_calibrated = (
            curve.curve == "calibrated" and curve.min_force_n <= force_n <= curve.max_force_n
        )
        spread = min(curve.interval_factor, SPREAD) if is_calibrated else SPREAD
        conductance = bridge.curve.conductance_s(on_sensor_n)
        low, high = sorted((expect_v(conductance * spread), expect_v(conductance / spread)))
        limits_v = max(lowest_v, low), min(highest_v, high)
        readings.append(
            WeightReading(mass, 1.0 / conductance, bridge.response.tactile_v(conductance), limits_v)
        )

    return tuple(readings)


def expect_change_ratio(design: Design) -> float:
    """Expect the change of the voltage under the heaviest weight over that under the lightest.

    Sensors that differ by a factor at every force have nearly the same ratio.
    """
    open_v = expect_open_v(design)
    (light, *_, heavy) = expect_readings(design)
    return abs(open_v - heavy.tactile_v) / abs(open_v - light.tactile_v)


_HOLDERS = {"post": "stand", "clevis": "stub"}


@dataclass(frozen=True)
class Idle:
    """Voltage of an untouched finger."""

    tactile_v: float
    tolerance_v: float


@dataclass(frozen=True)
class WeightLimits:
    mass_g: float
    tactile_v: float | None
    limits_v: tuple[float, ...]


@dataclass(frozen=True)
class AcceptanceSheet:
    """Fields of `acceptance.md`, rounded as a person reads a voltage."""

    design: str
    board: str
    holder: str
    """Part that holds the finger."""
    supply_v: float
    idle: Idle
    rises: bool
    """True if a force raises the voltage."""
    weights: tuple[WeightLimits, ...]
    doubt: list[str]
    """Reasons why the voltages under the weights are not known."""
    is_bonded: bool
    """True if the skin is cast around the bone, so that nobody can pull it on again."""


def acceptance_sheet(design: Design) -> AcceptanceSheet:
    doubt = design.force_curve.find_doubt(design.sensor.model)
    weights = (
        WeightLimits(each.mass_g, None, ())
        if doubt
        else WeightLimits(
            each.mass_g, round(each.tactile_v, 2), tuple(round(limit, 2) for limit in each.limits_v)
        )
        for each in expect_readings(design)
    )
    return AcceptanceSheet(
        design=design.name,
        board=design.board.variant,
        holder=_HOLDERS.get(design.bone.interface, "hand"),
        supply_v=design.board.supply_v,
        idle=Idle(round(expect_open_v(design), 2), IDLE_TOLERANCE_V),
        rises=Bridge.of_board(design).response.rises,
        weights=tuple(weights),
        doubt=doubt,
        is_bonded=making_of(design).is_bonded,
    )


def render_acceptance(sheet: AcceptanceSheet) -> str:
    return render_page("acceptance.md", preload=PRELOAD, **vars(sheet))
