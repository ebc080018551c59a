"""Filter board as a linear system: x' = A x + b u from the equations of its circuit, and where its
amplifiers end.

The equations are those of `board.circuits.network`: a component that changes there changes here.
The output of an amplifier as built is a state. At a rail, or where it cannot follow, its rate is
given and all other equations hold. Voltages are relative to the signal ground, which on a single
supply is the middle of the supply. Equations are batched: every value may be an array over many
boards.

The bandwidth is that of the filter's amplifiers. A precision rectifier's amplifier also has to
cross two diode drops, 1.2 V, at each zero of its input. At a slope s that takes sqrt(2 * 1.2 V / (2
pi GBW s)): 0.11 ms for the TLV2372 and 10 V/s, the slope of a slip, in which some 1 mV is lost.
This is not modelled: ngspice on the whole netlist, with diodes and amplifiers of 3 MHz, differs by
0.1 mV in 0.18 V (tests/sim/test_analog.py).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from fingertip.board.analysis.limits import FilterSwing
from fingertip.board.analysis.response import (
    EnvelopeModel,
    find_rectifier,
    model_envelope,
    model_software_envelope,
)
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.network import Network, Value, build_network
from fingertip.board.components.front_end import EMISSION, SATURATION_A, SERIES_OHM, THERMAL_V
from fingertip.board.components.values import SUPPLIES, select_components
from fingertip.board.parts.nets import FILTERED, STAGE1_OUT, STAGE2_IN, TACTILE, VMID
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import choose_amplifier
from fingertip.foundation.numerics import Array
from fingertip.sim.signal.envelope_loop import ABSCISSAE, BLOCK, LEVELS

# Exact steps of linear state equations.
#
# The steps are exact for x' = A x + b u + K c with constants c and an input u that is linear over
# the step, or a parabola. The state is carried as z = (x, u, slope of u, c, rate of the slope), so
# one matrix exponential of that larger system holds everything (C. Van Loan, IEEE Trans. Automatic
# Control 23(3), 1978, doi:10.1109/TAC.1978.1101743). The shortest step's exponential is a Taylor
# series; each longer one is the square of the one before (scaling and squaring).

_TERMS = 10  # of the Taylor series, for a norm of at most 1/16: the next term is below 1e-20


def augment(A: Array, b: Array, K: Array | None = None, is_curved: bool = False) -> Array:
    """Matrix of z' = M z; leading dimensions are a batch.

    A: (..., n, n), b: (..., n), K: (..., n, constants).
    """
    n = A.shape[-1]
    jump_count = 0 if K is None else K.shape[-1]
    M = np.zeros((*A.shape[:-2], n + 2 + jump_count + is_curved, n + 2 + jump_count + is_curved))
    M[..., n + 1, -1] = float(is_curved)
    M[..., :n, :n] = A
    M[..., :n, n] = b
    M[..., n, n + 1] = 1.0
    if K is not None:
        M[..., :n, n + 2 : n + 2 + jump_count] = K

    return M


def exponentials(M: Array, step_s: float, levels: int) -> Array:
    """Matrix exponentials exp(M step / 2^l) for l = 0 .. levels - 1, in a new axis before the last
    two.
    """
    shortest = M * (step_s * 2.0 ** (1 - levels))
    norm = float(np.abs(shortest).sum(axis=-1).max())
    squarings = max(0, math.ceil(math.log2(norm * 16.0))) if norm > 0.0 else 0
    X = shortest * 2.0**-squarings
    # D = exp - 1 is squared as 2 D + D^2: so many squarings of exp itself would lose eight digits
    # to the 1 in it.
    D = term = X

    for i in range(2, _TERMS + 1):
        term = term @ X / i
        D = D + term

    for _ in range(squarings):
        D = 2 * D + D @ D

    powers = [D]
    for _ in range(levels - 1):
        D = 2 * D + D @ D
        powers.append(D)

    return np.stack(powers[::-1], axis=-3) + np.eye(M.shape[-1])


COMPONENTS = (
    "R1",
    "R2",
    "R3",
    "R4",
    "R5",
    "R6",
    "C1",
    "C2",
    "C3",
    "C4",
    "C14",
    "C20",
    "R15",
    "R16",
    "R17",
)
"""References of the components between the tactile voltage and the envelope. Variant article has
those up to C4, precision none of the envelope's.
"""


@dataclass(frozen=True)
class Diode:
    """Shockley diode ``i = Is (exp((v - i Rs) / (n Vt)) - 1)``.

    By default the 1N4148 of SPICE at 27 degrees.
    """

    saturation_a: Value = SATURATION_A
    emission: Value = EMISSION
    series_ohm: Value = SERIES_OHM
    thermal_v: Value = THERMAL_V


DIODES = {"1N4148": Diode(), "BAT54": Diode(1e-7, 1.0, 0.28), "1N34A": Diode(2e-7, 1.3, 7.0)}
"""Silicon, Schottky and germanium diode by name; the article names none. Values of SPICE models,
recalled, unverified. The board has the first one.
"""


@dataclass(frozen=True)
class Amplifiers:
    """Limits of the filter's two amplifiers; voltages against the signal ground."""

    bandwidth_hz: float
    slew_v_per_s: float
    """Largest rate of an output, of either sign [V/s]."""
    peak_v: float
    trough_v: float
    """Limits of an output above and below the signal ground, both positive [V]."""
    reversal_v: float | None = None
    """Voltage below the signal ground under which the second stage's input reverses its output,
    which jumps up, as a positive number [V]; None: never. The first stage's input does not come so
    far down.
    """

    @classmethod
    def from_design(cls, design: Design) -> Amplifiers:
        amplifier = choose_amplifier(design.board)
        swing = FilterSwing.find(amplifier, SUPPLIES[design.board.variant], design.board.supply_v)
        reverses = swing.has_phase_reversal

        return cls(
            bandwidth_hz=amplifier.bandwidth_hz,
            slew_v_per_s=amplifier.slew_v_per_s,
            peak_v=swing.peak_v,
            trough_v=swing.peak_v if reverses else swing.trough_v,
            reversal_v=swing.trough_v if reverses else None,
        )


@dataclass(frozen=True)
class AnalogBoard:
    """Filter, rectifier and envelope of a board, with models of its diode and its amplifiers."""

    network: Network
    """Equations of the filter, driven at its input."""
    envelope: EnvelopeModel
    """Gain and time constant of rectifier and envelope."""
    rectifier: Literal["diode", "precision"] = "diode"
    """A diode that charges R_LP parallel to C_LP (article), or what rectifies exactly and follows
    with one pole: amplifiers, or software behind a board without an envelope.
    """
    diode: Diode = Diode()
    amplifiers: Amplifiers | None = None
    """Amplifiers of the filter, whose bandwidth the network has; None: ideal ones."""

    @classmethod
    def from_design(
        cls,
        design: Design,
        amplifiers: Amplifiers | Literal["real", "ideal"] = "real",
        diode: str = "1N4148",
    ) -> AnalogBoard:
        """Board of a design, with the values of the components that are fitted and the amplifiers
        of the design.
        """
        if isinstance(amplifiers, str):
            fitted = Amplifiers.from_design(design) if amplifiers == "real" else None
        else:
            fitted = amplifiers

        circuit = board_circuit(select_components(design))
        network = build_network(circuit, fitted.bandwidth_hz if fitted else None).drive(TACTILE)
        quiet = {VMID, *network.inputs} - {TACTILE}
        return cls(
            network=network.ground(*quiet).restrict(FILTERED),
            envelope=model_envelope(circuit)
            or model_software_envelope(design.board.envelope_cutoff_hz),
            rectifier="diode" if find_rectifier(circuit) == "diode" else "precision",
            diode=DIODES[diode],
            amplifiers=fitted,
        )

    @property
    def components(self) -> dict[str, Value]:
        """Value of each of `COMPONENTS` that the board has [ohm, F], by reference."""
        values = self.network.values
        return {
            name: 1 / values[name] if name.startswith("R") else values[name]
            for name in COMPONENTS
            if name in values
        }

    def with_components(self, **values: Value) -> AnalogBoard:
        """Copy of the board with other values of some of its components [ohm, F], by reference."""
        quantities = {
            name: 1 / value if name.startswith("R") else value for name, value in values.items()
        }
        return replace(self, network=self.network.with_values(quantities))

    @property
    def load(self) -> tuple[Value, Value]:
        """Resistance and capacitance that the diode charges [ohm, F].

        Of a precision rectifier their product counts.
        """
        decay_s = self.envelope_decay_s
        ohm = self.envelope.gain(self.network.values) if self.rectifier == "diode" else 1e3
        return ohm, decay_s / ohm

    @property
    def is_curved(self) -> bool:
        """True if the input is a parabola between two points: where an output jumps, its moment
        counts.
        """
        return self.amplifiers is not None and self.amplifiers.reversal_v is not None

    @property
    def envelope_decay_s(self) -> Value:
        return self.envelope.decay_s(self.network.values)

    @property
    def envelope_gain(self) -> Value:
        """Gain from the positive half waves of the filtered voltage to the envelope.

        1 for a bare diode.
        """
        return 1.0 if self.rectifier == "diode" else self.envelope.gain(self.network.values)


@dataclass(frozen=True, eq=False)
class LinearBoard:
    """State equations x' = A x + b u of a board, batched; voltages are rows over (x, u)."""

    A: Array
    b: Array
    rows: dict[str, Array]
    outputs: tuple[int, ...]
    """Places of both amplifiers' outputs among the states; none if the amplifiers are ideal."""


def compute_state_space(board: AnalogBoard) -> LinearBoard:
    system = board.network.state_space
    n = system.A.shape[-1]
    rows = {name: row.reshape(-1, n + 1) for name, row in system.rows.items()}
    A = system.A.reshape(-1, n, n)
    b = system.B.reshape(-1, n)
    if board.amplifiers is None:
        return LinearBoard(A, b, rows, ())

    outputs = tuple(int(np.argmax(rows[net][0] == 1.0)) for net in (STAGE1_OUT, FILTERED))
    return LinearBoard(A, b, rows, outputs)


def compute_step_matrices(
    board: AnalogBoard, step_s: float
) -> tuple[int, int, Array, Array, Array]:
    """Compute the board's exact steps in the layout of `envelope_loop`: one flat array for each
    board.

    With amplifiers as built there are matrices for each set of outputs that are held, and rows of
    what an end of the linear range shows: the rates that both amplifiers would have, and the input
    of the second one.
    """
    system = compute_state_space(board)
    count, n = system.A.shape[:2]
    jump_places = (
        [()] if not system.outputs else [(), system.outputs[1:], system.outputs[:1], system.outputs]
    )
    width = n + 2 + len(system.outputs) + board.is_curved

    def widen(rows: Array) -> Array:
        return np.concatenate((rows, np.zeros((count, width - rows.shape[-1]))), axis=1)

    watched = [
        widen(np.concatenate((system.A[:, at], system.b[:, at, None]), axis=1))
        for at in system.outputs
    ]
    watched += [widen(system.rows[STAGE2_IN])] if system.outputs else []
    rows = -(-(n + len(ABSCISSAE) + len(watched)) // BLOCK) * BLOCK
    output = widen(system.rows[FILTERED])
    step_columns = []

    for places in jump_places:
        A = system.A.copy()
        b = system.b.copy()
        rates = np.zeros((count, n, len(system.outputs)))

        for at in places:
            A[:, at] = 0.0
            b[:, at] = 0.0
            rates[:, at, system.outputs.index(at)] = 1.0

        M = augment(A, b, rates, board.is_curved)
        # Two levels more than the loop uses give the quarters and halves of the shortest step.
        powers = exponentials(np.stack((M, 0.55 * M)), step_s, LEVELS + 2)
        quarter = powers[0, :, 2:]
        half = powers[0, :, 1:-1]
        full = powers[0, :, :-2]
        odd = powers[1, :, :-2]
        transition = {
            0.25: quarter,
            0.5: half,
            0.75: quarter @ half,
            0.55: odd,
            1.0: full,
        }
        matrix = np.zeros((count, LEVELS, width, rows))
        matrix[..., :n] = full[:, :, :n].swapaxes(2, 3)
        for place, c in enumerate(ABSCISSAE, n):
            matrix[..., place] = (output[:, None, None, :] @ transition[c]).squeeze(2)

        for place, row in enumerate(watched, n + len(ABSCISSAE)):
            matrix[..., place] = (row[:, None, None, :] @ full).squeeze(2)

        step_columns.append(matrix)

    watched_rows = np.stack(watched, axis=1) if watched else np.zeros((count, 1))
    columns = np.stack(step_columns, axis=1)
    return n, rows, columns.reshape(count, -1), output, watched_rows.reshape(count, -1)
