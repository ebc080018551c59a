"""Models for the SPICE deck: amplifiers with their bandwidth and noise, comparator, diodes."""

from __future__ import annotations

import math
from collections.abc import Iterator

from fingertip.board.circuit import Circuit
from fingertip.board.values.amplifiers import (
    AD623_BANDWIDTH_HZ,
    AD623_NOISE_V,
    AD623_OUTPUT_NOISE_V,
    AMPLIFIERS,
    BOLTZMANN_J_PER_K,
    TEMPERATURE_K,
    bridge_gain,
)
from fingertip.board.values.bridge import GAIN_CONSTANT_OHM
from fingertip.board.values.built import OPEN_LOOP_GAIN
from fingertip.board.values.converter import CLAMP_A

_AMPLIFIER = """\
* {name}: one pole, {gain:g} open loop and {bandwidth:.10g} Hz gain-bandwidth, noise {noise:g} V/sqrt(Hz);
* no rails, no offset.
.subckt {name} plus minus out
RN n 0 {noise_ohm:.10g}
EN p plus n 0 1
G1 0 pole p minus {gain:.10g}
R1 pole 0 1
C1 pole 0 {pole:.12g}
E1 out 0 pole 0 1
.ends"""

_MODELS = """\
* AD623: gain 1 + 100k/Rg, Rg from the current between its pins; one pole at its bandwidth over the gain of this board;
* noise of input and output.
.subckt instrumentation minus plus rga rgb ref out
RN n 0 {input_ohm:.10g}
EN p plus n 0 1
E1 rga m p 0 1
V1 0 m 0
E2 rgb 0 minus 0 1
E3 x 0 p minus 1
H1 y x V1 {constant:.10g}
RO z 0 {output_ohm:.10g}
EO w y z 0 1
G1 0 pole w 0 1
G2 0 pole ref 0 1
R1 pole 0 1
C1 pole 0 {inner_pole:.12g}
E4 out 0 pole 0 1
.ends
* LMV331: no offset, no delay; 10 uV of its own hysteresis for the solver's sake.
.model open_collector SW(Vt=0 Vh=5u Ron=50 Roff=1G)
* 1N4148: forward 0.62 V at 1 mA, 4 pF; figures of a common model, not measured.
.model D1N4148 D(Is=2.52n Rs=0.568 N=1.752 Cjo=4p M=0.4 tt=20n)
* BAT54: Schottky, forward 0.24 V at 0.1 mA, 10 pF; figures of a common model, not measured.
.model DBAT54 D(Is={clamp_a:.10g} Rs=2 N=1.1 Cjo=12p M=0.4)"""


def models(circuit: Circuit, gain_bandwidth_hz: float) -> Iterator[str]:
    """Of each type of amplifier the circuit has, then the others."""
    for name in sorted({part.symbol.name for part in circuit.parts} & set(AMPLIFIERS)):
        yield _amplifier_model(name, gain_bandwidth_hz)
    yield _MODELS.format(
        constant=GAIN_CONSTANT_OHM,
        input_ohm=_noisy_ohm(AD623_NOISE_V),
        output_ohm=_noisy_ohm(AD623_OUTPUT_NOISE_V),
        inner_pole=bridge_gain(circuit) / (math.tau * AD623_BANDWIDTH_HZ),
        clamp_a=CLAMP_A,
    )


def _amplifier_model(name: str, gain_bandwidth_hz: float) -> str:
    data = AMPLIFIERS[name]
    bandwidth_hz = data.bandwidth_hz or gain_bandwidth_hz
    return _AMPLIFIER.format(
        name=name.lower(),
        gain=OPEN_LOOP_GAIN,
        bandwidth=bandwidth_hz,
        noise=data.noise_v,
        noise_ohm=_noisy_ohm(data.noise_v),
        # Into 1 ohm, so that the pole lies at GBW / A0.
        pole=OPEN_LOOP_GAIN / (math.tau * bandwidth_hz),
    )


def _noisy_ohm(density_v: float) -> float:
    """The resistor whose own noise at SPICE's temperature is this [V/sqrt(Hz)]."""
    return density_v**2 / (4.0 * BOLTZMANN_J_PER_K * TEMPERATURE_K)
