"""One finger, from the load on its pad to the samples of its voltages, chunk by chunk.

A scene drives one finger, a hand five. Every part carries its state, so the cuts between chunks
change no bit. Parts that no output needs do not exist: there is no vibration for slip alone, and no
board for the sampled voltage.
"""

from __future__ import annotations

import copy
import functools
import random
from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.board.parts.nets import ADC_FILTERED, ADC_TACTILE
from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.pad.response import Pad
from fingertip.sim.contact.friction import Friction
from fingertip.sim.contact.surface_files import SurfaceTable
from fingertip.sim.contact.surfaces import SurfaceProfile, generate_profile
from fingertip.sim.contact.vibration import ContactResonance, ProfileForce, transmit
from fingertip.sim.signal.analog_circuit import AnalogBoard
from fingertip.sim.signal.bridge import Bridge, ForceSensor, reads_whole_finger
from fingertip.sim.signal.converter import (
    AdcRange,
    AntiAliasFilter,
    Converter,
    EnvelopeSource,
    compute_input_noise_v,
)
from fingertip.sim.signal.filter_board import AnalogStream, SlipPin
from fingertip.sim.signal.grid import (
    CostMeter,
    Grid,
    Instants,
    SampleClock,
    Sampler,
    draw_noise,
    open_stream,
)
from fingertip.sim.signal.interference import InterferenceSource, RefinedNoise
from fingertip.sim.signal.parameters import FILTER_OUTPUTS, PathTables, Sensing

BOARD_TOLERANCE_V = 1e-4
"""Largest error of one step of the envelope on the base grid [V]."""
OF_BRIDGE = FILTER_OUTPUTS | {"voltage_v", "tactile_v"}
OF_CONTACT = OF_BRIDGE | {"force_n"}
"""Outputs that need the filter board, the bridge, and the contact force with all that shakes the
pad.
"""


@dataclass(frozen=True, eq=False)
class FingerDrive:
    """Loads and motion of one finger at the next points of the grid.

    A finger that does not slide has neither path nor motion. Where the contact is integrated in
    both directions, its force is given with the motion, and the pad's vibration is part of it.
    """

    load_n: Array
    """Quasi-static normal load [N]."""
    push_n: Array | None = None
    """Other forces that shake the pad while it touches [N]."""
    push_jump_n: Array | None = None
    """Jump of these forces right after the previous point [N]. None: they do not jump."""
    path_m: Array | None = None
    """Position of the pad over the surface [m]."""
    velocity_m_s: Array | None = None
    bristle_m: Array | None = None
    shear_m: Array | None = None
    contact_n: Array | None = None
    """Normal force of the contact, if it is known already [N]."""


@dataclass(frozen=True, eq=False)
class FingerSignals:
    """Signals of one finger at its converter's instants, named as the outputs.

    None where no output needs it.
    """

    time_s: Array
    voltage_v: Array | None = None
    force_n: Array | None = None
    slip: NDArray[np.bool_] | None = None
    velocity_m_s: Array | None = None
    shear_m: Array | None = None
    tactile_v: Array | None = None
    filtered_v: Array | None = None
    envelope_v: Array | None = None
    sampled_envelope_v: Array | None = None
    sampled_filtered_v: Array | None = None
    slip_pin_v: Array | None = None
    clips: NDArray[np.bool_] | None = None
    """True where the filter's output is at its limits.
    It is no output of a scene, and is there wherever a board is.
    """

    @classmethod
    def join(cls, chunks: list[FingerSignals]) -> FingerSignals:
        names = [field.name for field in fields(cls) if getattr(chunks[0], field.name) is not None]
        return cls(
            **{name: np.concatenate([getattr(chunk, name) for chunk in chunks]) for name in names}
        )


@dataclass(frozen=True)
class FingerSetup:
    """Everything that one finger is made of, before it moves."""

    design: Design
    pad: Pad
    held_n: float
    """Holding force, for which the resonance of the contact is computed [N]."""
    friction: Friction
    """Friction of the surface, which tells sliding from bending bristles."""
    open_random: Callable[[str], random.Random]
    """Function from a purpose to the random numbers of surfaces."""
    seed: tuple[int, str]
    """Seed of the noise, and the name of the finger; no two fingers share their noise."""
    surface: SurfaceTable | None = None
    """Surface on which the finger slides, complete. None: it does not slide."""
    profile_start_m: float = 0.0
    profile_length_m: float = 0.0
    towards_tip: int = 1
    """Direction in which it slides: 1 towards its tip, -1 towards its base, 0 across."""
    patch_average: bool = False
    """True if the pad averages the profile over its contact patch."""
    path: PathTables = field(default_factory=PathTables)
    event_origin_s: float = 0.0
    """Moment from which a touch of the cable is counted [s]."""

    def make_profile(self) -> SurfaceProfile:
        assert self.surface
        return generate_profile(
            self.open_random("surface"),
            surface=self.surface,
            start_m=self.profile_start_m,
            length_m=self.profile_length_m,
            patch_radius_m=self.pad.patch_radius_m(self.held_n) if self.patch_average else 0.0,
        )

    def make_profile_force(self, step_s: float) -> ProfileForce:
        assert self.surface
        return ProfileForce(
            self.pad, self.make_profile(), self.surface.load_law == "proportional", step_s
        )


class Finger:
    def __init__(
        self,
        setup: FingerSetup,
        grid: Grid,
        outputs: frozenset[str],
        meter: CostMeter,
        contact_is_given: bool = False,
    ) -> None:
        self._outputs = outputs
        self._meter = meter
        self._clock = SampleClock(grid, setup.design.detector.sample_rate_hz)
        self._motion = _MotionSampler(setup.friction, outputs)
        self._contact: _Contact | None = None
        if outputs & OF_CONTACT and not contact_is_given:
            self._contact = _Contact(setup, grid, meter)

        self._force = Sampler() if "force_n" in outputs else None
        self._bridge = _BridgeVoltage(setup, grid, meter) if outputs & OF_BRIDGE else None
        self._converter: Converter | None = None

        if "voltage_v" in outputs:
            with meter.stage("ADC"):
                self._converter = _build_converter(setup, grid, "noise", ADC_TACTILE)

        self._board: _BoardSignals | None = None
        if outputs & (FILTER_OUTPUTS | {"tactile_v"}):
            self._board = _BoardSignals(setup, grid, outputs, meter)

    def process(self, drive: FingerDrive) -> FingerSignals:
        """Follow the finger over the next points of the grid, and return its signals at the
        instants within them.
        """
        at = self._clock.advance(len(drive.load_n))
        signals: dict[str, Any] = {"time_s": at.time_s}
        signals |= self._motion.process(drive, at, self._meter)
        contact_n = drive.contact_n
        if self._contact and contact_n is None:
            contact_n = self._contact.process(drive)

        if self._force:
            assert contact_n is not None
            with self._meter.stage("force"):
                signals["force_n"] = self._force.process(contact_n, at)

        if self._bridge:
            assert contact_n is not None
            bridge_v, jumps, bend_v = self._bridge.process(drive, contact_n)
            if self._converter:
                with self._meter.stage("ADC"):
                    before_v = bridge_v if jumps is None else bridge_v - jumps
                    signals["voltage_v"] = self._converter.process(before_v, at, bridge_v)

            if self._board:
                signals |= self._board.process(bridge_v, jumps, bend_v, at)

        return FingerSignals(**signals)


class _MotionSampler:
    """True slip, velocity and shear at the samples."""

    def __init__(self, friction: Friction, outputs: frozenset[str]) -> None:
        self._friction = friction
        self._outputs = outputs
        self._samplers = [Sampler() for _ in range(4)]

    def process(
        self, drive: FingerDrive, at: Instants, meter: CostMeter
    ) -> dict[str, Array | NDArray[np.bool_]]:
        load, velocity, bristle, shear = self._samplers
        outputs = self._outputs & {"slip", "velocity_m_s", "shear_m"}
        signals: dict[str, Array | NDArray[np.bool_]] = {}
        if not outputs:
            return {}

        if drive.velocity_m_s is None or drive.bristle_m is None or drive.shear_m is None:
            with meter.stage("no motion"):
                zeros = np.zeros(len(at.index))
                return {name: zeros > 0.0 if name == "slip" else zeros for name in sorted(outputs)}

        if outputs & {"slip", "velocity_m_s"}:
            with meter.stage("slip"):
                speed_m_s = signals["velocity_m_s"] = velocity.process(drive.velocity_m_s, at)
                if "slip" in outputs:
                    bent = bristle.process(drive.bristle_m, at)
                    pressed = load.process(drive.load_n, at)
                    signals["slip"] = self._friction.is_gross_slip(speed_m_s, bent, pressed)

        if "shear_m" in outputs:
            with meter.stage("shear"):
                signals["shear_m"] = shear.process(drive.shear_m, at)

        return {name: signals[name] for name in outputs}


class _Contact:
    """Contact force: the load and all vibration, through the resonance of the pad."""

    def __init__(self, setup: FingerSetup, grid: Grid, meter: CostMeter) -> None:
        self._meter = meter
        self._profile: ProfileForce | None = None
        if setup.surface:
            with meter.stage("profile", 1):
                self._profile = setup.make_profile_force(grid.step_s)

        self._resonance = ContactResonance(
            grid.step_s, setup.pad.resonance_hz(setup.held_n), setup.pad.backing.damping_ratio
        )

    def process(self, drive: FingerDrive) -> Array:
        force = drive.load_n
        if self._profile:
            assert drive.path_m is not None
            with self._meter.stage("profile", 1, len(force)):
                force = force + self._profile.process(drive.load_n, drive.path_m)

        if drive.push_n is not None:
            force = force + transmit(drive.load_n) * drive.push_n

        with self._meter.stage("contact", 2, len(force)):
            jump_n = (
                None if drive.push_jump_n is None else transmit(drive.load_n) * drive.push_jump_n
            )
            return self._resonance.process(force, drive.load_n, jump_n)


class _BridgeVoltage:
    """Voltage of bridge and amplifier, with everything that is added to it but white noise."""

    def __init__(self, setup: FingerSetup, grid: Grid, meter: CostMeter) -> None:
        self._meter = meter
        self._sensor = ForceSensor(grid.step_s, setup.path.drift.share_per_decade)
        self._pad = setup.pad
        self._is_relative = reads_whole_finger(setup.design, setup.path.sensing.bridge)
        # A finger that moves towards its tip is held back by the surface, towards its base. Across,
        # the drag on both halves of the sensor cancels.
        self._shear_n_per_m = -setup.towards_tip * setup.pad.tangential_stiffness_n_per_m(
            setup.held_n
        )

        with meter.stage("bridge"):
            self._bridge = Bridge.select(setup.design, setup.path.sensing.bridge)
            self._last_v = np.zeros(1)

        self._interference = InterferenceSource(
            grid=grid,
            drift=setup.path.drift,
            cable=setup.path.cable,
            noise=setup.path.noise,
            held_s=setup.event_origin_s,
            open_stream=lambda purpose: open_stream(setup.seed[0], setup.seed[1], purpose),
        )

    def process(self, drive: FingerDrive, contact_n: Array) -> tuple[Array, Array | None, Array]:
        """Return the voltage [V], how it jumps at each point, and how it bends in the middle of the
        step before.
        """
        with self._meter.stage("sensor", 1, len(contact_n)):
            shear_n = None if drive.shear_m is None else self._shear_n_per_m * drive.shear_m
            shown_n, middle_n = self._sensor.process(
                self._pad.sensed_n(contact_n, shear_n, self._is_relative)
            )

        with self._meter.stage("bridge"):
            volts, bend_v = self._bridge.follow(shown_n, middle_n, self._last_v)

        if self._interference.is_silent:
            return volts, None, bend_v

        with self._meter.stage("interference"):
            added, jumps = self._interference.process(contact_n)

        return volts + added, jumps, bend_v


_ADC_STAGES = {"envelope": "ADC of the envelope", "filtered": "ADC of the filtered signal"}
"""Output of the board -> stage of the cost of its samples."""


class _BoardSignals:
    """Filter board, its comparator, and the sampled envelope."""

    def __init__(
        self,
        setup: FingerSetup,
        grid: Grid,
        outputs: frozenset[str],
        meter: CostMeter,
    ) -> None:
        self._outputs = outputs
        self._meter = meter
        self._samplers = {
            name: Sampler()
            for name in ("tactile_v", "filtered_v", "envelope_v", "slip_pin_v", "clips")
        }
        self._noise: RefinedNoise | None = None

        if setup.path.sensing.noise:
            with meter.stage("board noise"):
                deviation_v = compute_input_noise_v(setup.design)
                stream = open_stream(*setup.seed, "board noise")
                self._noise = RefinedNoise(
                    grid, lambda count: draw_noise(stream, deviation_v, count)
                )

        self._board: AnalogStream | None = None
        self._pin: SlipPin | None = None
        self._converters: dict[str, Converter] = {}
        self._sources: dict[str, str] = {}
        self._envelope = EnvelopeSource(setup.design)

        if outputs & FILTER_OUTPUTS:
            with meter.stage("filter board", 4):
                self._board = copy.copy(_prepare_board(setup.design, setup.path.sensing, grid))

        if "slip_pin_v" in outputs:
            with meter.stage("comparator", 1):
                self._pin = SlipPin(setup.design, grid.step_s)

        of_envelope = "filtered" if self._envelope.pin == ADC_FILTERED else "envelope"
        for name, source, pin in (
            ("sampled_envelope_v", of_envelope, self._envelope.pin),
            ("sampled_filtered_v", "filtered", ADC_FILTERED),
        ):
            if name in outputs:
                self._sources[name] = source
                with meter.stage(_ADC_STAGES[source]):
                    converter = _build_converter(
                        setup, grid, f"{source} noise", pin, from_signal_ground=True
                    )
                    self._converters[source] = converter

    def process(
        self,
        bridge_v: Array,
        jumps: Array | None,
        bend_v: Array,
        at: Instants,
    ) -> dict[str, Any]:
        count = len(bridge_v)
        found = dict[str, Any]()
        tactile_v = bridge_v

        if self._noise:
            with self._meter.stage("board noise"):
                tactile_v = bridge_v + self._noise.process(count)

        if "tactile_v" in self._outputs:
            found["tactile_v"] = self._samplers["tactile_v"].process(tactile_v, at)
        if not self._board:
            return found

        taken = self._board.steps
        with self._meter.stage("filter board", 4):
            before_v = tactile_v if jumps is None else tactile_v - jumps
            filtered, envelope = self._board.process(
                before_v, None if jumps is None else tactile_v, bend_v
            )

        self._meter.add("filter board", 4, self._board.steps - taken)
        found["clips"] = self._samplers["clips"].process(self._board.clips, at) > 0.0
        signals = {"filtered_v": filtered, "envelope_v": envelope}

        if self._pin:
            with self._meter.stage("comparator", 1, count):
                signals["slip_pin_v"] = self._pin.process(filtered, envelope)

        found |= {
            name: self._samplers[name].process(values, at)
            for name, values in signals.items()
            if name in self._outputs
        }
        sampled = {}
        for source, converter in self._converters.items():
            with self._meter.stage(_ADC_STAGES[source]):
                sampled[source] = converter.process(signals[f"{source}_v"], at)

        for name, source in self._sources.items():
            is_envelope = name == "sampled_envelope_v"
            found[name] = self._envelope.finish(sampled[source]) if is_envelope else sampled[source]

        return found


@functools.lru_cache(maxsize=64)
def _prepare_board(design: Design, sensing: Sensing, grid: Grid) -> AnalogStream:
    # The board's own error falls with the step as that of its input does.
    tolerance_v = BOARD_TOLERANCE_V / grid.refinement**2
    board = AnalogBoard.from_design(design, sensing.amplifiers, sensing.diode)
    return AnalogStream(board, grid.step_s, tolerance_v=tolerance_v)


def _build_converter(
    setup: FingerSetup,
    grid: Grid,
    purpose: str,
    pin: str,
    from_signal_ground: bool = False,
) -> Converter:
    sensing = setup.path.sensing
    design = setup.design
    noise = open_stream(*setup.seed, purpose) if sensing.noise else None
    jitter = (
        (open_stream(*setup.seed, f"jitter of {purpose}"), sensing.jitter_s)
        if sensing.jitter_s
        else None
    )
    own = setup.path.converter
    adc = AdcRange(own.bits, own.low_v, own.high_v) if own.bits else AdcRange.from_design(design)
    if from_signal_ground:
        adc = adc.above_signal_ground(design)

    return Converter(
        design=design,
        anti_alias=AntiAliasFilter.ahead_of(pin, design, grid.step_s),
        adc=adc,
        step_s=grid.step_s,
        noise=noise,
        jitter=jitter,
    )
