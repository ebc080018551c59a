"""Filter board as a linear system: x' = A x + b u + k from the equations of its circuit, for each saturation.

The equations are those of `board.circuits.network`: a component that changes there changes here. An amplifier that is
saturated is a source at its output. Voltages are relative to the signal ground, which on a single supply is the middle
of the supply. Equations are batched: every value may be an array over many boards.

The gain-bandwidth product is that of the filter's amplifiers. A precision rectifier's amplifier also has to cross two
diode drops, 1.2 V, at each zero of its input. At a slope s that takes sqrt(2 * 1.2 V / (2 pi GBW s)): 0.11 ms for the
TLV2372 and 10 V/s, the slope of a slip, in which some 1 mV is lost. This is not modelled: ngspice on the whole netlist,
with diodes and amplifiers of 3 MHz, differs by 0.1 mV in 0.18 V (tests/sim/test_analog.py).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from fingertip.board import board_circuit, board_values
from fingertip.board.analysis.response import EnvelopeModel, find_rectifier, model_envelope, model_software_envelope
from fingertip.board.circuits.network import Network, Value, build_network
from fingertip.board.components.front_end import EMISSION, SATURATION_A, SERIES_OHM, THERMAL_V
from fingertip.board.components.values import select_components
from fingertip.board.parts.nets import FILTERED, STAGE1_OUT, TACTILE, VMID
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from fingertip.foundation.errors import Issue, TraceError, raise_issues
from fingertip.foundation.numerics import Array
from fingertip.foundation.validation import find_negative, find_not_positive
from fingertip.sim.signal.envelope_loop import ABSCISSAE, BLOCK, LEVELS

# Exact steps of linear state equations.
#
# The steps are exact for x' = A x + b u + k with an input u that is linear in time over the step. The state is carried
# as z = (x, u, slope of u, 1), so one matrix exponential of that larger system holds everything (C. Van Loan, IEEE
# Trans. Automatic Control 23(3), 1978, doi:10.1109/TAC.1978.1101743). The shortest step's exponential is a Taylor
# series; each longer one is the square of the one before (scaling and squaring).

_TERMS = 10  # of the Taylor series, for a norm of at most 1/16: the next term is below 1e-20


def augment(A: Array, b: Array, k: Array) -> Array:
    """Matrix of z' = M z; leading dimensions are a batch. A: (..., n, n), b and k: (..., n)."""
    n = A.shape[-1]
    M = np.zeros((*A.shape[:-2], n + 3, n + 3))
    M[..., :n, :n] = A
    M[..., :n, n] = b
    M[..., :n, n + 2] = k
    M[..., n, n + 1] = 1.0
    return M


def exponentials(M: Array, step_s: float, levels: int) -> Array:
    """Matrix exponentials exp(M step / 2^l) for l = 0 .. levels - 1, in a new axis before the last two."""
    shortest = M * (step_s * 2.0 ** (1 - levels))
    norm = float(np.abs(shortest).sum(axis=-1).max())
    squarings = max(0, math.ceil(math.log2(norm * 16.0))) if norm > 0.0 else 0
    X = shortest * 2.0**-squarings
    # D = exp - 1 is squared as 2 D + D^2: so many squarings of exp itself would lose eight digits to the 1 in it.
    D = term = X
    for i in range(2, _TERMS + 1):
        term = term @ X / i
        D = D + term
    for _ in range(squarings):
        D = 2 * D + D @ D
    found = [D]
    for _ in range(levels - 1):
        D = 2 * D + D @ D
        found.append(D)
    return np.stack(found[::-1], axis=-3) + np.eye(M.shape[-1])


COMPONENTS = (
    "R1", "R2", "R3", "R4", "R5", "R6", "C1", "C2", "C3", "C4", "C14", "C20", "R15", "R16", "R17",
)  # fmt: skip
"""References of the components between the tactile voltage and the envelope. Variant article has those up to C4,
precision none of the envelope's."""


@dataclass(frozen=True)
class Diode:
    """Shockley diode ``i = Is (exp((v - i Rs) / (n Vt)) - 1)``; by default the 1N4148 of SPICE at 27 degrees."""

    saturation_a: Value = SATURATION_A
    emission: Value = EMISSION
    series_ohm: Value = SERIES_OHM
    thermal_v: Value = THERMAL_V


@dataclass(frozen=True)
class AnalogBoard:
    """Filter, rectifier and envelope of a board, with models of its diode and its amplifiers. Raises TraceError."""

    network: Network
    """Equations of the filter, driven at its input."""
    envelope: EnvelopeModel
    """Gain and time constant of rectifier and envelope."""
    rectifier: Literal["diode", "precision"] = "diode"
    """A diode that charges R_LP parallel to C_LP (article), or what rectifies exactly and follows with one pole:
    amplifiers, or software behind a board without an envelope."""
    diode: Diode = Diode()
    rail_v: float | None = None
    """Voltage at which both amplifiers' outputs saturate, of either sign [V]; None: they never do."""

    def __post_init__(self) -> None:
        issues = _find_component_issues(self.components)
        d = self.diode
        issues.extend(find_not_positive("diode.saturation_a", d.saturation_a, "A", f"{SATURATION_A:g}"))
        issues.extend(find_not_positive("diode.emission", d.emission, "", f"{EMISSION:g}"))
        issues.extend(find_negative("diode.series_ohm", d.series_ohm, "ohm"))
        issues.extend(find_not_positive("diode.thermal_v", d.thermal_v, "V", "0.0259"))
        if self.rail_v is not None:
            issues.extend(find_not_positive("board.rail_v", self.rail_v, "V", "3.5"))
            if any(term.equation == term.net == FILTERED for term in self.network.terms if term.order):
                # The input stage of a slow amplifier saturates at a rail, and no data sheet says how it recovers.
                problem = f"{self.rail_v:g} V cannot be combined with a gain-bandwidth product"
                issues.append(Issue("board.rail_v", f"{problem}; both together are not modelled; leave one out."))
        raise_issues(TraceError, issues)

    @classmethod
    def from_design(cls, design: Design, gain_bandwidth_hz: float | None = None) -> AnalogBoard:
        """Board of a design, with the values of the components that are fitted and ideal or slow amplifiers."""
        circuit = board_circuit(select_components(design))
        network = build_network(circuit, gain_bandwidth_hz).drive(TACTILE)
        quiet = {VMID, *network.inputs} - {TACTILE}
        return cls(
            network.ground(*quiet).restrict(FILTERED),
            model_envelope(circuit) or model_software_envelope(design.board.envelope_cutoff_hz),
            "diode" if find_rectifier(circuit) == "diode" else "precision",
        )

    @property
    def components(self) -> dict[str, Value]:
        """Value of each of `COMPONENTS` that the board has [ohm, F], by reference."""
        values = self.network.values
        return {
            name: 1 / values[name] if name.startswith("R") else values[name] for name in COMPONENTS if name in values
        }

    def with_components(self, **values: Value) -> AnalogBoard:
        """Copy of the board with other values of some of its components [ohm, F], by reference. Raises TraceError."""
        known = self.components
        issues = [
            Issue(f"board.{name}", f"is no component of this board; choose from {', '.join(known)}.")
            for name in values
            if name not in known
        ]
        raise_issues(TraceError, [*issues, *_find_component_issues(values)])
        quantities = {name: 1 / value if name.startswith("R") else value for name, value in values.items()}
        return replace(self, network=self.network.with_values(quantities))

    @property
    def load(self) -> tuple[Value, Value]:
        """Resistance and capacitance that the diode charges [ohm, F]; of a precision rectifier their product counts."""
        decay_s = self.envelope_decay_s
        ohm = self.envelope.gain(self.network.values) if self.rectifier == "diode" else 1e3
        return ohm, decay_s / ohm

    @property
    def envelope_decay_s(self) -> Value:
        return self.envelope.decay_s(self.network.values)

    @property
    def envelope_gain(self) -> Value:
        """Gain from the positive half waves of the filtered voltage to the envelope; 1 for a bare diode."""
        return 1.0 if self.rectifier == "diode" else self.envelope.gain(self.network.values)


def _find_component_issues(values: Mapping[str, Value]) -> list[Issue]:
    examples = {name: ("ohm", "1000") if name.startswith("R") else ("F", "1e-6") for name in values}
    return [issue for name in values for issue in find_not_positive(f"board.{name}", values[name], *examples[name])]


def board_with_amplifiers(design: Design, amplifiers: str) -> AnalogBoard:
    """Board of a design with one of three models of its amplifiers.

    The rails are taken as far below the signal ground as above it. A TL082's inputs leave their common-mode range
    sooner, and its output then jumps up. This is not simulated: `VoltageLimits.filter_trough_v` says how far down the
    board of variant article may be driven.
    """
    if amplifiers == "gain_bandwidth":
        return AnalogBoard.from_design(design, find_gain_bandwidth_hz(design.board))
    board = AnalogBoard.from_design(design)
    return replace(board, rail_v=board_values(design).voltage_limits.filter_peak_v) if amplifiers == "rails" else board


@dataclass(frozen=True, eq=False)
class LinearBoard:
    """State equations x' = A x + b u + k of a board, batched; voltages are rows over (x, u, slope of u, 1)."""

    A: Array
    b: Array
    k: Array
    rows: dict[str, Array]


def compute_state_space(board: AnalogBoard, mode: int = 0) -> LinearBoard:
    rail = board.rail_v or 0.0
    states = zip((STAGE1_OUT, FILTERED), divmod(mode, 3), strict=True)
    saturated = {net: (rail, -rail)[state - 1] for net, state in states if state}
    network = board.network.drive(*saturated) if saturated else board.network
    system = network.state_space
    n = system.A.shape[-1]
    A, B = (matrix.reshape(-1, *matrix.shape[-2:]) for matrix in (system.A, system.B))
    # The inputs are the voltage u, which comes first, and the saturated outputs, which are constant.
    constants = np.array([saturated[name] for name in network.inputs[1:]])

    def row(voltage: Array) -> Array:
        voltage = voltage.reshape(-1, voltage.shape[-1])
        constant = voltage[:, n + 1 :] @ constants
        return np.concatenate((voltage[:, : n + 1], np.zeros((len(voltage), 1)), constant[:, None]), axis=1)

    rows = {name: row(system.rows[name]) for name in network.nets}
    for name, volts in saturated.items():
        rows[name] = np.concatenate((np.zeros((len(A), n + 2)), np.full((len(A), 1), volts)), axis=1)
    return LinearBoard(A, B[:, :, 0], B[:, :, 1:] @ constants, rows)


def compute_step_matrices(board: AnalogBoard, step_s: float) -> tuple[int, int, Array, Array, Array]:
    """Compute the board's exact steps in the layout of `envelope_loop`: one flat array for each board."""
    step_columns, output_rows = [], []
    amplifier1_row = np.zeros(0)
    n = rows = 0
    for mode in range(9 if board.rail_v else 1):
        system = compute_state_space(board, mode)
        count, n = system.A.shape[:2]
        rows = -(-(n + len(ABSCISSAE)) // BLOCK) * BLOCK
        if mode % 3 == 0:
            output_rows.append(system.rows[FILTERED])
        if mode == 0:
            amplifier1_row = system.rows[STAGE1_OUT]
        M = augment(system.A, system.b, system.k)
        # Two levels more than the loop uses give the quarters and halves of the shortest step.
        powers = exponentials(np.stack((M, 0.55 * M)), step_s, LEVELS + 2)
        quarter, half, full, odd = powers[0, :, 2:], powers[0, :, 1:-1], powers[0, :, :-2], powers[1, :, :-2]
        transition = {0.25: quarter, 0.5: half, 0.75: quarter @ half, 0.55: odd, 1.0: full}
        output = system.rows[FILTERED][:, None, None, :]
        matrix = np.zeros((count, LEVELS, n + 3, rows))
        matrix[..., :n] = full[:, :, :n].swapaxes(2, 3)
        for place, c in enumerate(ABSCISSAE, n):
            matrix[..., place] = (output @ transition[c])[:, :, 0]
        step_columns.append(matrix)
    count = len(amplifier1_row)
    columns, outputs = (np.stack(found, axis=1).reshape(count, -1) for found in (step_columns, output_rows))
    return n, rows, columns, outputs, amplifier1_row
