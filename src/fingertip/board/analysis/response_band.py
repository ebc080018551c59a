"""Band of the filter's response: target, nominal board, and the central 95 % of boards as they are bought."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.board.analysis.response import find_passband, model_filter, search_band_hz
from fingertip.board.analysis.tolerance import TolerancedFilter, component_tolerances, draw_deviations
from fingertip.board.board_values import board_values
from fingertip.board.circuits.signal_paths import board_circuit
from fingertip.board.network import build_network
from fingertip.design import Design
from fingertip.design.amplifier_choice import find_gain_bandwidth_hz
from fingertip.numerics import bisect_arrays

BAND_QUANTILES = (0.025, 0.975)
"""Quantiles of the boards between which the band lies."""
_ORDER = 3
"""Order of the Butterworth high-pass that the design asks for."""
_BELOW, _ABOVE = 15.0, 20.0
"""Ratios of the target's cutoff to the first frequency, and of the last one to the nominal upper cutoff."""
_PER_DECADE = 60
_SEARCH_RATIO = 30.0
"""Ratio of the highest frequency at which upper cutoffs are searched to the nominal one."""
_HALVINGS = 40

Ends = tuple[float, float]


@dataclass(frozen=True)
class ResponseBand:
    """Magnitudes from the tactile voltage to the rectifier, and -3.0103 dB frequencies [Hz]."""

    f_hz: Array
    target: Array
    """Third-order Butterworth high-pass of the design's gain and cutoff."""
    nominal: Array
    """Board with nominal values."""
    low: Array
    """Lower end of the band at each frequency by itself."""
    high: Array
    """Upper end of the band at each frequency by itself."""
    target_cutoff_hz: float
    lower_hz: float
    """Lower cutoff of the nominal board."""
    lower_ends_hz: Ends
    """Ends of the band of lower cutoffs."""
    upper_hz: float
    """Upper cutoff of the nominal board."""
    upper_ends_hz: Ends
    """Ends of the band of upper cutoffs."""
    percent: dict[str, float]
    """Tolerance of each component [%], as it is bought."""
    boards: int


def compute_response_band(design: Design, boards: int = 10_000, seed: int = 1) -> ResponseBand:
    """Compute the band of a design's board.

    Parameters
    ----------
    design
        Design of the board.
    boards, seed
        Number of boards and seed of the Monte Carlo analysis; the same as in `analyse` give the same boards.
    """
    settings = design.board
    circuit = board_circuit(board_values(design))
    network = build_network(circuit, find_gain_bandwidth_hz(settings))
    toleranced = TolerancedFilter(model_filter(circuit, settings.variant == "article"), network.values)
    percent = component_tolerances(circuit)
    deviations = draw_deviations(toleranced, percent, boards, seed)

    exact = toleranced.model.transfer(network.values)
    passband = find_passband(exact, search_band_hz(toleranced.model, network.values))
    first, last = math.log10(settings.cutoff_hz / _BELOW), math.log10(passband.high_hz * _ABOVE)
    f_hz = np.logspace(first, last, math.ceil((last - first) * _PER_DECADE) + 1)

    power = toleranced.model.transfer(toleranced.deviate(deviations)).power_gain()
    ends = np.array([np.quantile(power(math.tau * f), BAND_QUANTILES) for f in f_hz])
    found = toleranced.quantities(deviations)
    level = 0.5 * found["passband_gain"] ** 2
    peak, end = (np.full(boards, math.log(math.tau * f)) for f in (passband.peak_hz, _SEARCH_RATIO * passband.high_hz))
    upper, _ = bisect_arrays(lambda x: np.asarray(power(np.exp(x))) >= level, peak, end, _HALVINGS)
    return ResponseBand(
        f_hz=f_hz,
        target=settings.passband_gain / np.sqrt(1.0 + (settings.cutoff_hz / f_hz) ** (2 * _ORDER)),
        nominal=np.sqrt(np.asarray(exact.power_gain()(math.tau * f_hz))),
        low=np.sqrt(ends[:, 0]),
        high=np.sqrt(ends[:, 1]),
        target_cutoff_hz=settings.cutoff_hz,
        lower_hz=passband.low_hz,
        lower_ends_hz=_find_ends(found["cutoff_hz"]),
        upper_hz=passband.high_hz,
        upper_ends_hz=_find_ends(np.exp(upper) / math.tau),
        percent=percent,
        boards=boards,
    )


def _find_ends(values: Array) -> Ends:
    low, high = np.quantile(values, BAND_QUANTILES)
    return float(low), float(high)
