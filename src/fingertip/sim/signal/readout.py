"""Readout of fingers step by step, for a simulator that knows forces: sensor, bridge, board and
converter.

A step gives what `finger.Finger` gives for a whole recording: the same functions run on the same
grid, over which a force is linear between two samples. Vibration of the contact must be in the
forces. One compiled loop follows all fingers, because a call takes longer than what it computes.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from fingertip.board.parts.nets import ADC_ENVELOPE, ADC_FILTERED, ADC_TACTILE
from fingertip.design import Design
from fingertip.design.parameters.board_and_detector import Board
from fingertip.foundation.errors import Issue, TraceError, checked
from fingertip.foundation.jit import compile_for_process
from fingertip.foundation.numerics import Array
from fingertip.pad.response import FORCES_N, Pad
from fingertip.sim.signal import bridge, envelope_loop
from fingertip.sim.signal.analog_circuit import AnalogBoard
from fingertip.sim.signal.converter import (
    AdcRange,
    AntiAliasFilter,
    compute_input_noise_v,
    run_poles,
)
from fingertip.sim.signal.filter_board import AnalogStream
from fingertip.sim.signal.grid import Grid, draw_noise, open_stream
from fingertip.sim.signal.interference import RefinedNoise
from fingertip.sim.signal.simulated_finger import BOARD_TOLERANCE_V

_BLOCK = 2048
"""Steps for which noise is drawn at a time."""
_MAX_REFINEMENT = 4
_WHOLE = (1.0, *(0.0,) * 7)
"""Polynomials of the shares of a force that is already that on the sensor."""
_LOOPS = bridge.indicate, bridge.convert, run_poles, envelope_loop.run
_INDICATE, _CONVERT, _PASS, _FILTER = (loop.plain for loop in _LOOPS)


class ReadoutSample(NamedTuple):
    """Signals at one sample, one value for each finger; those of the board are above the signal
    ground.

    Of a divider, those of the board are NaN.
    """

    tactile_v: Array
    filtered_v: Array
    envelope_v: Array
    """Envelope; that of the rectifier in software on boards without one."""
    sampled_tactile_v: Array
    sampled_output_v: Array
    """Samples of the filtered signal, or of the envelope on boards that give no other."""
    tactile_code: Array
    output_code: Array


_OF_BOARD = ("filtered_v", "envelope_v", "sampled_output_v", "output_code")


@checked
class Readout:
    """Readout of several fingers with the board of one design. Raises TraceError.

    Each finger has its pad in a pose, and steps take the forces of its contact with the object;
    without a pad, they take the forces on the sensor itself. Without a seed neither board nor
    converter has noise. The names separate the noise of the fingers; a single one is called
    "finger", as in the simulation of a scene.
    """

    def __init__(
        self,
        design: Design,
        pads: Sequence[Pad | None],
        seed: int | None = None,
        names: Sequence[str] = (),
    ) -> None:
        rate_hz = design.detector.sample_rate_hz
        count = len(pads)
        names = names or (["finger"] if count == 1 else [f"finger {i + 1}" for i in range(count)])

        if not count or len(names) != count:
            raise TraceError(
                Issue(
                    "pads", f"names {count} fingers; give one pad, or None, and one name for each."
                )
            )

        grids = [Grid(refinement) for refinement in range(1, _MAX_REFINEMENT + 1)]
        grid = next((grid for grid in grids if grid.rate_hz % rate_hz == 0.0), None)
        if grid is None:
            message = (
                f"{rate_hz:g} Hz does not divide the grid of the simulation; choose 2000, "
                "2500 or 5000 Hz."
            )
            raise TraceError(Issue("detector.sample_rate_hz", message))

        self.has_filtered = design.board.is_for_controller
        """True if the converter samples the filtered signal beside the tactile voltage, else the
        envelope; a divider gives neither.
        """
        pins = ADC_TACTILE, ADC_FILTERED if self.has_filtered else ADC_ENVELOPE
        self._has_board = design.board.has_filter
        sensor = bridge.Bridge.of_board(design)
        adc = AdcRange.from_design(design)
        # The loop follows a board in any case; what it gives for a divider is left out.
        boarded = design if self._has_board else design.model_copy(update={"board": Board()})
        curve = sensor.curve
        response = sensor.response
        ranges = [
            (converter.low_v, converter.step_v, 2.0**converter.bits - 1)
            for converter in (adc, adc.above_signal_ground(boarded))
        ]
        tolerance_v = BOARD_TOLERANCE_V / grid.refinement**2
        board = AnalogStream(
            AnalogBoard.from_design(boarded), grid.step_s, tolerance_v=tolerance_v
        ).integrator
        self._numbers = (
            (
                1 + bridge.HYSTERESIS / bridge.PLAY_FRACTION,
                grid.step_s,
                FORCES_N[0],
                FORCES_N[-1],
                board.gain(0),
            ),
            (curve.turn_on_n, curve.scale, curve.exponent, bridge.TURN_ON_WIDTH_N),
            (response.open_v, response.sensor_v, response.source_ohm, response.transfer_ohm),
            tuple(AntiAliasFilter.ahead_of(pin, design, grid.step_s).matrix for pin in pins),
            tuple(ranges),
            self.has_filtered,
            board.constants(0),
        )
        # A curve that was measured on a finger is read at a force on the whole of it.
        is_relative = bridge.reads_whole_finger(design, "board")
        scale = Pad.from_design(design).reference_share if is_relative else 1.0
        rests = [0.0 if is_relative or pad is None else pad.rest_n for pad in pads]
        parts = [(*pad.share, *pad.shear_share) if pad else _WHOLE for pad in pads]
        shares = np.array([(*part, scale, rest) for part, rest in zip(parts, rests, strict=True)])
        self._points = round(grid.rate_hz / rate_hz)
        self._is_new = True
        self._forces = np.zeros((4, count))
        carried, z = board.steady_state(0, 1.0)
        states = (2, count, 3), (count, len(carried)), (count, len(z)), (count,), (count, 1)
        rows = np.zeros((11, max(4, self._points + 1)))
        self._arrays = (
            board.matrices(0),
            (*board.make_scratch(), z[: board.state_count], rows),
            (
                shares,
                self._forces,
                np.tile(bridge.NEW, (count, 1)),
                *(np.zeros(shape) for shape in states),
            ),
        )
        purposes = (
            "board noise",
            "noise",
            "filtered noise" if self.has_filtered else "envelope noise",
        )
        self._draws = [
            [
                _open_noise(
                    design,
                    grid=grid,
                    seed=seed,
                    name=name,
                    purpose=purpose,
                )
                for name in names
            ]
            for purpose in purposes
        ]
        self._noise = self._draw_noise()
        self._left = _BLOCK
        self._loop = _compile()

    def step(self, force_n: Array, shear_n: Array | None = None) -> ReadoutSample:
        """Return the signals at the next sample from the forces there: normal, and along the
        surface to the tip [N].
        """
        forces = self._forces
        points = 1 if self._is_new else self._points
        forces[:2] = forces[2:]
        forces[2] = force_n
        forces[3] = 0.0 if shear_n is None else shear_n

        if not self._left:
            self._noise = self._draw_noise()
            self._left = _BLOCK

        out = np.zeros((len(ReadoutSample._fields), forces.shape[1]))
        self._loop(
            points,
            self._is_new,
            _BLOCK - self._left,
            *self._numbers,
            *self._arrays,
            *self._noise,
            out,
        )
        self._is_new = False
        self._left = self._left - 1
        sample = ReadoutSample(*out)

        return (
            sample
            if self._has_board
            else sample._replace(**dict.fromkeys(_OF_BOARD, np.full(out.shape[1], np.nan)))
        )

    def _draw_noise(self) -> list[Array]:
        """Draw noise for a block of steps: of the board at the points of the grid, of both inputs
        at the samples.
        """
        counts = (_BLOCK - self._is_new) * self._points + self._is_new, _BLOCK, _BLOCK
        return [
            np.stack([draw(size) for draw in functions], axis=1)
            for functions, size in zip(self._draws, counts, strict=True)
        ]


def _open_noise(
    design: Design,
    grid: Grid,
    seed: int | None,
    name: str,
    purpose: str,
) -> Callable[[int], Array]:
    """Open one noise of one finger, from the same stream as in the simulation of a scene."""
    if seed is None:
        return np.zeros

    of_board = purpose == "board noise"
    deviation_v = compute_input_noise_v(design) if of_board else design.detector.noise_v
    draw = functools.partial(draw_noise, open_stream(seed, name, purpose), deviation_v)
    return RefinedNoise(grid, draw).process if of_board else draw


@functools.cache
def _compile() -> Callable[..., None]:
    return compile_for_process(_readout_loop, *_LOOPS)


def _readout_loop(
    points: int,
    is_new: bool,
    at: int,
    numbers: Any,
    curve: Any,
    response: Any,
    poles: Any,
    ranges: Any,
    has_filtered: bool,
    board: Any,
    matrices: Any,
    scratch: Any,
    fingers: Any,
    board_noise: Array,
    tactile_noise: Array,
    output_noise: Array,
    out: Array,
) -> None:
    """Follow each finger from the sample before to the next one.

    A new one is in the steady state of its first.
    """
    play_ratio, step_s, min_n, max_n, gain = numbers
    step_columns, output_rows, watched_rows = matrices
    z_next, tables, steady, rows = scratch
    shares, forces, play, pole_states, carried, z, last_v, last_bridge_v = fingers
    force_n = rows[0]
    shown_n = rows[1]
    bridge_v = rows[2]
    pin_v = rows[3]
    statistics = rows[7]
    middle_n = rows[8]
    bend_v = rows[9]
    states = len(steady)
    # The interval before a chunk's first point begins at the last one before.
    first = 1 if is_new else 0
    end = points + 1
    board_v = rows[4, first:end]
    filtered_v = rows[5, first:end]
    envelope_v = rows[6, first:end]
    begin = 0 if is_new else len(board_noise) - (len(output_noise) - at) * points

    for f in range(len(last_v)):
        share = shares[f]
        for i in range(points):
            part = (i + 1) / points
            contact = forces[0, f] + (forces[2, f] - forces[0, f]) * part
            shear = forces[1, f] + (forces[3, f] - forces[1, f]) * part
            root = math.sqrt(math.sqrt(min(max(contact, min_n), max_n)))
            along = ((share[3] * root + share[2]) * root + share[1]) * root + share[0]
            across = ((share[7] * root + share[6]) * root + share[5]) * root + share[4]
            force_n[i] = max((contact * along + shear * across) / share[8] + share[9], 0.0)

        _INDICATE(play_ratio, 0.0, step_s, force_n[:points], play[f], shown_n, middle_n)
        _CONVERT(
            curve, response, shown_n[:points], middle_n, last_bridge_v[f], bridge_v, bend_v[1:]
        )
        rows[4, 0] = last_v[f]
        for i in range(points):
            rows[4, i + 1] = bridge_v[i] + board_noise[begin + i, f]

        last_v[f] = rows[4, points]
        if is_new:
            pole_states[0, f, :] = bridge_v[0]
            for i in range(len(steady)):
                z[f, i] = steady[i] * last_v[f]

            z[f, states] = last_v[f]

        _FILTER(
            board,
            board_v,
            board_v,
            bend_v[first:end],
            step_columns,
            output_rows,
            watched_rows,
            carried[f],
            z[f],
            z_next,
            tables,
            filtered_v,
            envelope_v,
            rows[10, first:end],
            statistics,
        )
        _PASS(poles[0], bridge_v[:points], bridge_v[:points], pole_states[0, f], pin_v)
        low_v, code_v, most = ranges[0]
        code = min(
            max(math.floor((pin_v[points - 1] + tactile_noise[at, f] - low_v) / code_v + 0.5), 0.0),
            most,
        )
        out[0, f] = rows[4, points]
        out[1, f] = rows[5, points]
        out[2, f] = rows[6, points] * gain
        out[3, f] = code * code_v + low_v
        out[5, f] = code

        if not has_filtered:
            for i in range(end):
                rows[5, i] = rows[6, i] * gain

        if is_new:
            pole_states[1, f, :] = rows[5, 1]

        _PASS(poles[1], rows[5, 1:end], rows[5, 1:end], pole_states[1, f], pin_v)
        low_v, code_v, most = ranges[1]
        code = min(
            max(math.floor((pin_v[points - 1] + output_noise[at, f] - low_v) / code_v + 0.5), 0.0),
            most,
        )
        out[4, f] = code * code_v + low_v
        out[6, f] = code
