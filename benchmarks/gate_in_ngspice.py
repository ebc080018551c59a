"""Oracle: the conditions of a board's gate in ngspice, with two-pole
amplifiers that have their maximum offset.
"""

from __future__ import annotations

import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fingertip.board.analysis.board_values import BoardValues, board_values
from fingertip.board.analysis.gate import OFFSET
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.spice import spice_deck
from fingertip.board.components.front_end import AMPLIFIERS
from fingertip.board.components.values import SUPPLIES
from fingertip.board.parts.circuit import Circuit
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import (
    BAND_CUTOFFS,
    MID_RAIL_RATIO,
    choose_amplifier,
    find_gain_bandwidth_hz,
    input_swing_v,
    loaded_swing_v,
)
from fingertip.foundation.numerics import Array

MAX_PEAKING_DB = 1.0
SETTLED_CYCLES = 5
CYCLES = 8
"""Cycles after which the filter has forgotten the start of the vibration, and cycles in all."""
STEPS_PER_CYCLE = 400
OUTPUTS = {
    "U1a": "stage1_out",
    "U1b": "filtered",
    "U3b": "envelope",
    "U2a": "tactile",
    "U2b": "vmid",
}
"""Amplifiers whose outputs must stay in their range, by SPICE node.
U3a stands a diode beyond the signal.
"""


@dataclass(frozen=True)
class GateInNgspice:
    """What ngspice finds for one board."""

    peaking_db: float
    """Largest gain at any frequency over the passband's gain."""
    currents_a: dict[str, float]
    """Peak output current of each amplifier."""
    current_limits_a: dict[str, float]
    margins_v: dict[str, float]
    """Smallest distance of each output from the end of its range."""

    @property
    def failures(self) -> list[str]:
        """Conditions that do not hold."""
        found = [f"peaking {self.peaking_db:.2f} dB"] if self.peaking_db > MAX_PEAKING_DB else []
        found += [
            f"{n} {1e3 * i:.2f} mA"
            for n, i in self.currents_a.items()
            if i > self.current_limits_a[n]
        ]
        return found + [
            f"{n} {v:.3f} V beyond its range" for n, v in self.margins_v.items() if v < 0.0
        ]


def check_gate_in_ngspice(program: str, folder: Path, design: Design) -> GateInNgspice:
    """Run one board: its response to 100 MHz, and the largest vibration at both ends of
    the band.
    """
    values = board_values(design)
    circuit = board_circuit(values)
    deck = spice_deck(
        circuit, find_gain_bandwidth_hz(design.board), design.board.supply_v, worst_case=True
    ).decode()
    body = deck.partition("\n.ac ")[0]
    response = _run(
        program,
        folder=folder,
        body=body,
        analysis="ac dec 40 1 100meg",
        vectors=["vm(filtered)/vm(tactile)", "vm(tactile)"],
    )
    f = response[:, 0]
    gains = response[:, 1]
    tactile = response[:, 2]
    names = _list_catalogue_amplifiers(circuit)
    amplifier = choose_amplifier(design.board)
    board = design.board
    # What the gate promises: no nearer to a rail than currents are stated, and within what the
    # offset leaves.
    offset_ratio = max(c.value for c in values.gate if c.name == OFFSET)
    scale = min(
        loaded_swing_v(board, amplifier) / input_swing_v(board, amplifier), 1.0 - offset_ratio
    )
    vibration_v = scale * values.voltage_limits.vibration_peak_v
    currents = dict.fromkeys(names, 0.0)
    margins = dict[str, float]()
    outputs = {name: net for name, net in OUTPUTS.items() if name in names}

    for f_hz in (board.cutoff_hz, BAND_CUTOFFS * board.cutoff_hz):
        amplitude_a = vibration_v / (float(np.interp(f_hz, f, tactile)) / 1e-6)
        driven = re.sub(
            r"(?m)^(IJ1 \S+ \S+) .*$", rf"\1 dc 0 sin(0 {amplitude_a:.9g} {f_hz:.9g})", body
        )
        step_s = 1.0 / f_hz / STEPS_PER_CYCLE
        vectors = [f"e.x{name.lower()}.e1#branch" for name in names] + [
            f"v({net})" for net in outputs.values()
        ]
        command = f"tran {step_s:.6g} {CYCLES / f_hz:.6g} 0 {step_s:.6g}"
        data = _run(
            program,
            folder=folder,
            body=driven,
            analysis=command,
            vectors=vectors,
        )
        data = data[data[:, 0] > SETTLED_CYCLES / f_hz]
        for name, column in zip(names, data.T[1:], strict=False):
            currents[name] = max(currents[name], float(np.abs(column).max()))

        for name, column in zip(outputs, data.T[1 + len(names) :], strict=True):
            margins[name] = min(
                margins.get(name, np.inf),
                _range_margin_v(
                    design,
                    values=values,
                    circuit=circuit,
                    name=name,
                    volts=column,
                ),
            )

    limits = {name: _current_limit_a(circuit, name) for name in names}
    peaking_db = float(20 * np.log10(gains.max() / values.achieved_response.passband_gain))
    return GateInNgspice(peaking_db, currents, limits, margins)


def _list_catalogue_amplifiers(circuit: Circuit) -> list[str]:
    return [
        f"{component.reference}{unit}"
        for component in circuit.components
        if component.symbol.name in AMPLIFIERS
        for unit in AMPLIFIERS[component.symbol.name].units
    ]


def _current_limit_a(circuit: Circuit, name: str) -> float:
    data = AMPLIFIERS[circuit.component(name[:2]).symbol.name]
    return data.output_current_a * (MID_RAIL_RATIO if name == "U2b" else 1.0)


def _range_margin_v(
    design: Design,
    values: BoardValues,
    circuit: Circuit,
    name: str,
    volts: Array,
) -> float:
    """Distance of an output's voltages from the ends that its data sheet states."""
    from_rail_v = AMPLIFIERS[circuit.component(name[:2]).symbol.name].output_from_rail_v
    supply = SUPPLIES[values.variant]
    low_v = supply.signal_ground_v(design.board.supply_v) - supply.lower_headroom_v(
        design.board.supply_v
    )

    return float(min(volts.min() - low_v, design.board.supply_v - volts.max())) - from_rail_v


def _run(
    program: str,
    folder: Path,
    body: str,
    analysis: str,
    vectors: list[str],
) -> Array:
    """Run one analysis and return its scale and vectors as columns."""
    out = folder / "out"
    out.unlink(missing_ok=True)
    commands = f"set wr_singlescale\n{analysis}\nwrdata out {' '.join(vectors)}"
    (folder / "run.cir").write_text(
        f"{body}\n.control\n{commands}\n.endc\n.end\n", encoding="utf-8"
    )
    process = subprocess.run(
        [program, "-b", "run.cir"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    if not out.exists():
        raise RuntimeError(process.stdout + process.stderr)

    return np.loadtxt(out)
