"""Frequency response of the filter, from its transfer function: poles, gain and cutoffs.

Cutoffs and gain are those of the amplifiers as built: with their bandwidth and input capacitance,
with C14, which costs a little gain at the lower end of the passband, and C20, which is a low-pass
above the vibrations. Poles and quality factor are those of ideal amplifiers, so that they can be
compared with the article's.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from fingertip.board.circuits.network import Value, build_network
from fingertip.board.circuits.transfer_function import Rational, Stage, find_stages, multiply
from fingertip.board.parts.circuit import Circuit
from fingertip.board.parts.nets import (
    ADC_ENVELOPE,
    ADC_FILTERED,
    ENVELOPE,
    FILTERED,
    RECT_OUT,
    TACTILE,
)
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from fingertip.design.formulas.filter import SECTION_QUALITY
from fingertip.design.parameters.board_and_detector import Board
from fingertip.foundation.numerics import Array, bisect, bisect_arrays, find_maximum_arrays

RECTIFYING_DIODE = "D1"
"""Diode that conducts while the filtered signal is positive."""
Rectifier = Literal["diode", "precision", "software"]
"""A diode that charges R_LP parallel to C_LP (article), amplifiers that rectify and follow with one
pole, or neither: then software computes the envelope, with the design's pole and a gain of 1.
"""


def find_rectifier(circuit: Circuit) -> Rectifier:
    nets = set(circuit.net_by_pin.values())
    if RECT_OUT in nets:
        return "precision"
    if ENVELOPE in nets:
        return "diode"

    return "software"


_STEPS_PER_DECADE = 6
_START_RATIO = 4.0
"""Ratio of the lower pole to the frequency at which the search starts; for many boards, of the
nominal cutoff, and of the frequency at which the search ends to that of the nominal maximum.
"""
_END_RATIO = 100.0
"""Ratio of the highest frequency at which the maximum is searched to the higher pole."""
_FINE_GOLDEN_STEPS = 29
"""Golden-section steps for one board: the peak is exact to 1e-6 in frequency, 1e-12 in gain."""
_GOLDEN_STEPS = 24
"""Golden-section steps for many boards: exact to 1e-5 in frequency, 1e-10 in gain."""
_HALVINGS = 36
"""Halvings of the step that contains the cutoff of many boards, which is then exact to 1e-11."""


@dataclass(frozen=True)
class FrequencyResponse:
    passband_gain: float
    """First maximum of the gain above the poles."""
    passband_gain_db: float
    first_pole_hz: float
    section_hz: float
    """f0 of the Sallen-Key section."""
    section_quality: float
    cutoff_hz: float
    upper_cutoff_hz: float
    """Lower and upper overall cutoff frequency (-3.0103 dB)."""
    envelope_pole_hz: float
    envelope_decay_s: float
    """Time constant of the envelope, tau = R_LP C_LP."""
    amplifier_bandwidth_hz: float
    """Closed-loop bandwidth GBW / G of the first stage's amplifier."""


@dataclass(frozen=True)
class Passband:
    """Passband from tactile voltage to rectifier: first maximum, and -3.0103 dB frequencies."""

    gain: float
    peak_hz: float
    low_hz: float
    high_hz: float


@dataclass(frozen=True)
class EnvelopeModel:
    """Transfer function of the envelope, with the network's quantities as symbols."""

    stage: Stage
    """First-order low-pass from the filtered voltage, or in variant article the diode's current."""

    def decay_s(self, values: Mapping[str, Value]) -> Value:
        constant, slope = self.stage.evaluate(values).denominator
        return slope / constant

    def gain(self, values: Mapping[str, Value]) -> Value:
        """Return the constant gain: a voltage ratio, or in variant article a resistance [ohm]."""
        response = self.stage.evaluate(values)
        return response.numerator[0] / response.denominator[0]


@dataclass(frozen=True)
class FilterModel:
    """Transfer functions of filter and envelope, with the network's quantities as symbols.

    The first stage of the article is in two: the pole of C1 and R1, and the amplifier. Last comes
    the Sallen-Key section.
    """

    ideal: tuple[Stage, ...]
    as_built: tuple[Stage, ...]
    """Stages with amplifiers of finite bandwidth and with input capacitance."""
    envelope: EnvelopeModel | None
    """None on a board without an envelope."""

    def transfer(self, values: Mapping[str, Value]) -> Rational:
        return multiply(stage.evaluate(values) for stage in self.as_built)

    def first_pole_hz(self, values: Mapping[str, Value]) -> Value:
        """Return the pole of C1 and R1 [Hz]."""
        constant, slope = self.ideal[0].evaluate(values).denominator
        return constant / slope / math.tau

    def section(self, values: Mapping[str, Value]) -> tuple[Value, Value]:
        """Return f0 [Hz] and Q of the Sallen-Key section s^2 + s omega_0 / Q + omega_0^2."""
        constant, linear, square = self.ideal[-1].evaluate(values).denominator
        return (constant / square) ** 0.5 / math.tau, (constant * square) ** 0.5 / linear

    def passband(self, values: Mapping[str, Value]) -> Passband:
        """Find the passband of one board, from well below to well above the high-pass poles."""
        poles = float(self.first_pole_hz(values)), float(self.section(values)[0])
        return find_passband(
            self.transfer(values), (min(poles) / _START_RATIO, max(poles) * _END_RATIO)
        )


def model_filter(circuit: Circuit) -> FilterModel:
    ideal, as_built = (
        find_stages(build_network(circuit, bandwidth).drive(TACTILE), TACTILE, FILTERED)
        for bandwidth in (None, 1.0)
    )
    return FilterModel(ideal, as_built, model_envelope(circuit))


def model_envelope(circuit: Circuit) -> EnvelopeModel | None:
    """Expand the transfer function of a circuit's envelope alone; None if it has none."""
    rectifier = find_rectifier(circuit)
    if rectifier == "software":
        return None

    if rectifier == "precision":
        network = build_network(circuit, conducting=[RECTIFYING_DIODE]).drive(FILTERED)
        return EnvelopeModel(*find_stages(network, FILTERED, ENVELOPE))

    # Voltage over the diode's current. The pole ahead of the ADC, which loads it by a hundredth, is
    # left out.
    terms = build_network(circuit.without("R7")).restrict(ENVELOPE).terms
    admittance = tuple(
        tuple(
            (term.factor, (term.quantity,))
            for term in terms
            if term.net == ENVELOPE and term.order == order
        )
        for order in (0, 1)
    )
    return EnvelopeModel(Stage((((1.0, ()),),), admittance))


def find_envelope_pin(circuit: Circuit) -> str:
    """Return the ADC pin of the envelope, or of the signal from which software computes it."""
    return ADC_FILTERED if find_rectifier(circuit) == "software" else ADC_ENVELOPE


def find_envelope_gain(
    model: FilterModel, circuit: Circuit, values: Mapping[str, Value]
) -> float | None:
    """Find the gain from positive half waves to the envelope; None for a diode with a dead zone."""
    if model.envelope is None:
        return 1.0

    return None if find_rectifier(circuit) == "diode" else float(model.envelope.gain(values))


def model_software_envelope(cutoff_hz: float) -> EnvelopeModel:
    """Model the envelope that software computes: gain 1 and one pole [Hz]."""
    pole: Stage = Stage((((1.0, ()),),), (((1.0, ()),), ((1.0 / (math.tau * cutoff_hz), ()),)))
    return EnvelopeModel(pole)


def find_passband(transfer: Rational, band_hz: tuple[float, float]) -> Passband:
    """Find the passband of a transfer function; `find_passbands` is its counterpart for arrays."""
    power_gain = transfer.power_gain()

    def log_power(x: float) -> float:
        return math.log(power_gain(math.exp(x)))

    # A grid over the logarithm of the angular frequency brackets the peak.
    first, step, count = _grid(band_hz)
    grid = [log_power(first), log_power(first + step)]
    while len(grid) <= count and grid[-1] >= grid[-2]:
        grid.append(log_power(first + len(grid) * step))

    peak = len(grid) - 2
    low, high = (np.array(first + (peak + side) * step) for side in (-1, 1))
    place, highest = find_maximum_arrays(
        lambda x: np.array(log_power(float(x))), low, high, _FINE_GOLDEN_STEPS
    )
    maximum = max(float(highest), grid[peak])
    level = maximum - math.log(2.0)

    def find_cutoff(i: int, direction: int) -> float:
        """Step from grid point i until the gain is below the level; find the crossing [Hz]."""
        while log_power(first + i * step) >= level:
            i += direction

        ends = sorted((first + (i - direction) * step, first + i * step))
        crossing = bisect(lambda x: (log_power(x) < level) == (direction < 0), *ends)[0]
        return math.exp(crossing) / math.tau

    peak_hz = math.exp(float(place)) / math.tau
    return Passband(math.exp(0.5 * maximum), peak_hz, find_cutoff(peak, -1), find_cutoff(peak, 1))


def find_passbands(transfer: Rational, nominal: Passband) -> tuple[Array, Array]:
    """Find maximum gain and lower cutoff [Hz] of many boards, as `find_passband` does for one."""
    power_gain = transfer.power_gain()

    def power(x: Array) -> Array:
        return np.asarray(power_gain(np.exp(x)))

    first, step, count = _grid((nominal.low_hz / _START_RATIO, nominal.peak_hz * _START_RATIO))
    grid = np.array([power(np.array(first + i * step)) for i in range(count + 1)])
    peak = np.clip(grid.argmax(axis=0), 1, count - 1)
    _, highest = find_maximum_arrays(
        power, first + (peak - 1) * step, first + (peak + 1) * step, _GOLDEN_STEPS
    )
    maximum = np.maximum(highest, grid.max(axis=0))

    # The last grid point before the peak that lies below half the maximum power brackets the
    # cutoff.
    index = np.arange(count + 1).reshape(-1, *(1,) * peak.ndim)
    low = first + step * np.where((grid < 0.5 * maximum) & (index < peak), index, 0).max(axis=0)
    _, cutoff = bisect_arrays(lambda x: power(x) < 0.5 * maximum, low, low + step, _HALVINGS)

    return np.sqrt(maximum), np.exp(cutoff) / math.tau


def decibel(ratio: complex) -> float:
    """Return 20 log10 |ratio| [dB]; minus infinity for 0."""
    return 20.0 * math.log10(abs(ratio)) if ratio else -math.inf


def _grid(band_hz: tuple[float, float]) -> tuple[float, float, int]:
    first, last = (math.log(math.tau * f_hz) for f_hz in band_hz)
    count = math.ceil((last - first) / math.log(10.0) * _STEPS_PER_DECADE)
    return first, (last - first) / count, count


def compute_response(
    model: FilterModel,
    values: Mapping[str, Value],
    gain_bandwidth_hz: float,
    envelope_cutoff_hz: float,
) -> FrequencyResponse:
    """Compute the response of a board.

    `envelope_cutoff_hz` is the pole in software of one without an envelope.
    """
    section_hz, quality = model.section(values)
    passband = model.passband(values)
    envelope = model.envelope or model_software_envelope(envelope_cutoff_hz)
    decay_s = float(envelope.decay_s(values))

    return FrequencyResponse(
        passband_gain=passband.gain,
        passband_gain_db=decibel(passband.gain),
        first_pole_hz=float(model.first_pole_hz(values)),
        section_hz=float(section_hz),
        section_quality=float(quality),
        cutoff_hz=passband.low_hz,
        upper_cutoff_hz=passband.high_hz,
        envelope_pole_hz=1.0 / (math.tau * decay_s),
        envelope_decay_s=decay_s,
        amplifier_bandwidth_hz=gain_bandwidth_hz / passband.gain,
    )


def target_response(board: Board) -> FrequencyResponse:
    """Return the response of the ideal values with ideal amplifiers."""
    bandwidth_hz = find_gain_bandwidth_hz(board) / board.passband_gain
    return FrequencyResponse(
        passband_gain=board.passband_gain,
        passband_gain_db=decibel(board.passband_gain),
        first_pole_hz=board.cutoff_hz,
        section_hz=board.cutoff_hz,
        section_quality=SECTION_QUALITY,
        cutoff_hz=board.cutoff_hz,
        upper_cutoff_hz=bandwidth_hz if board.variant == "article" else board.band_limit_hz,
        envelope_pole_hz=board.envelope_cutoff_hz,
        envelope_decay_s=1.0 / (math.tau * board.envelope_cutoff_hz),
        amplifier_bandwidth_hz=bandwidth_hz,
    )
