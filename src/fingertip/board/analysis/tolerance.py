"""Effect of component tolerances on the filter: Monte Carlo spread, worst case and sensitivities.

C1, C2 and C3 may differ, as purchased capacitors do. Gain, cutoff, poles and quality factor come from the transfer
function of the circuit, evaluated for thousands of boards at once.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np

from fingertip.board.analysis.response import FilterModel, find_passbands, model_filter
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.network import Value, build_network
from fingertip.board.components.values import select_components
from fingertip.board.parts.circuit import Circuit
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import find_gain_bandwidth_hz
from fingertip.design.parameters.electronics import Board
from fingertip.foundation.display import BLUE, ORANGE, RED, TEXT_COLOUR, new_figure, style_axes, to_png, to_svg
from fingertip.foundation.files import format_figure
from fingertip.foundation.numerics import Array, bisect_arrays

COMPONENTS = ("R1", "R2", "R3", "R4", "R5", "C1", "C2", "C3", "C14", "C20")
"""Components of the filter that have a tolerance. Variant article has neither C14 nor C20."""
CUTOFF_CAPACITORS = ("C1", "C2", "C3")
ARTICLE_CAPACITOR_PERCENT = 5.0
"""Tolerance [%] of the article's capacitors, with which others are compared."""
QUANTITIES = ("cutoff_hz", "section_quality", "passband_gain", "first_pole_hz", "section_hz")


@dataclass(frozen=True)
class TolerancedFilter:
    model: FilterModel
    values: Mapping[str, Value]
    """Nominal values of its network."""

    @property
    def names(self) -> tuple[str, ...]:
        """References of its components, in the order of every array of deviations."""
        return tuple(name for name in COMPONENTS if name in self.values)

    def deviate(self, deviations: Array) -> dict[str, Value]:
        """Values of the network for relative deviations of the components, (..., components)."""
        values = dict(self.values)
        for name, ratio in zip(self.names, np.moveaxis(1.0 + deviations, -1, 0), strict=True):
            # A network's quantity is the conductance of a resistor.
            values[name] = self.values[name] / ratio if name.startswith("R") else self.values[name] * ratio
        return values

    def quantities(self, deviations: Array) -> dict[str, Array]:
        """Compute `QUANTITIES` for relative deviations of the components, (..., components)."""
        values = self.deviate(deviations)
        gain, cutoff_hz = find_passbands(self.model.transfer(values), self.model.passband(self.values))
        section_hz, quality = self.model.section(values)
        found = (cutoff_hz, quality, gain, self.model.first_pole_hz(values), section_hz)
        return dict(zip(QUANTITIES, map(np.asarray, found), strict=True))


@dataclass(frozen=True)
class Spread:
    """Distribution of a quantity over many boards."""

    nominal: float
    mean: float
    deviation: float
    """Standard deviation."""
    low_95: float
    """Lower end of the central interval that contains 95 % of the boards."""
    high_95: float
    worst_low: float
    """Minimum over all corners of the tolerances."""
    worst_high: float


def monte_carlo(
    board: TolerancedFilter, tolerances: Mapping[str, float], boards: int = 10_000, seed: int = 1
) -> dict[str, Spread]:
    """Compute the spread of each quantity over boards with independent, uniform component values; `tolerances` [%]."""
    limits, count = _limits(board, tolerances), len(board.names)
    drawn = board.quantities(draw_deviations(board, tolerances, boards, seed))
    corners = board.quantities(limits * np.array(list(product((-1.0, 1.0), repeat=count))))
    exact = board.quantities(np.zeros(count))
    result = {}
    for name, values in drawn.items():
        ends, worst = _find_ends(values), corners[name]
        middle = float(exact[name]), float(values.mean()), float(values.std(ddof=1))
        result[name] = Spread(*middle, *ends, float(worst.min()), float(worst.max()))
    return result


def draw_deviations(board: TolerancedFilter, tolerances: Mapping[str, float], boards: int, seed: int) -> Array:
    """Draw relative deviations, (boards, components), independent and uniform within these tolerances [%]."""
    uniform = np.random.default_rng(seed).uniform(-1.0, 1.0, (boards, len(board.names)))
    deviations: Array = _limits(board, tolerances) * uniform
    return deviations


def _limits(board: TolerancedFilter, tolerances: Mapping[str, float]) -> Array:
    return np.array([tolerances[name] / 100.0 for name in board.names])


def component_tolerances(circuit: Circuit) -> dict[str, float]:
    """Tolerance [%] of each of `COMPONENTS` that a circuit has, as its parts are bought."""
    requirements = {component.reference: component.requirement for component in circuit.components}
    return {name: found.tolerance_percent for name in COMPONENTS if (found := requirements.get(name))}


YIELD_BOARDS, YIELD_RATIO, LEAST_YIELD = 4000, 0.1, 0.99
"""Boards that are drawn for a yield, deviation from the design within which a board counts, and share that must."""


def compute_yields(model: FilterModel, values: Mapping[str, Value], circuit: Circuit, board: Board) -> dict[str, float]:
    """Compute the share of boards within `YIELD_RATIO` of the design's cutoff, and of its gain."""
    toleranced = TolerancedFilter(model, values)
    deviations = draw_deviations(toleranced, component_tolerances(circuit), YIELD_BOARDS, seed=1)
    found = toleranced.quantities(deviations)
    wanted = {"cutoff_hz": board.cutoff_hz, "passband_gain": board.passband_gain}
    return {name: float(np.mean(np.abs(found[name] / v - 1.0) <= YIELD_RATIO)) for name, v in wanted.items()}


def compute_sensitivities(board: TolerancedFilter) -> dict[str, dict[str, float]]:
    """Compute d ln quantity / d ln component: the change in percent for a change of the component by one percent."""
    step = 1e-4
    up, down = (board.quantities(sign * step * np.eye(len(board.names))) for sign in (1.0, -1.0))
    width = math.log((1.0 + step) / (1.0 - step))
    return {
        quantity: {
            name: round(float(np.log(up[quantity][i] / down[quantity][i]) / width), 6) + 0.0
            for i, name in enumerate(board.names)
        }
        for quantity in QUANTITIES
    }


# Band of the filter's response: target, nominal board, and the central 95 % of boards as they are bought.

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
    low: Array
    """Lower end of the band at each frequency by itself."""
    high: Array
    target_cutoff_hz: float
    lower_hz: float
    lower_ends_hz: Ends
    """Ends of the band of lower cutoffs."""
    upper_hz: float
    upper_ends_hz: Ends
    percent: dict[str, float]


def compute_response_band(design: Design, boards: int = 10_000) -> ResponseBand:
    settings = design.board
    circuit = board_circuit(select_components(design))
    network = build_network(circuit, find_gain_bandwidth_hz(settings))
    toleranced = TolerancedFilter(model_filter(circuit), network.values)
    percent = component_tolerances(circuit)
    deviations = draw_deviations(toleranced, percent, boards, seed=1)

    exact = toleranced.model.transfer(network.values)
    passband = toleranced.model.passband(network.values)
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
    )


def _find_ends(values: Array) -> Ends:
    low, high = np.quantile(values, BAND_QUANTILES)
    return float(low), float(high)


# Plot of the filter's response: target, nominal board and the band of boards within their tolerances.

FORMATS = {".png": to_png, ".svg": to_svg}
_FLOOR_DB = -25.0
"""Lowest level of the axis relative to the maximum [dB]: three times below it, nothing tells boards apart."""
_HEADROOM_DB = 8.0


def draw_response(band: ResponseBand, title: str, suffix: str) -> bytes:
    """Plot a band as PNG or SVG, without date and version, so that the same band gives the same bytes."""
    figure = new_figure(9, 5.4)
    axes = figure.add_subplot()
    figure.suptitle(title, x=0.01, ha="left", fontweight="bold", fontsize=12)
    nominal_db = _decibel(band.nominal)
    maximum_db = float(nominal_db.max())
    groups: dict[float, list[str]] = {}
    for name, value in band.percent.items():
        groups.setdefault(value, []).append(name)
    tolerances = "; ".join(f"{', '.join(names)} {value:g} %" for value, names in sorted(groups.items()))
    axes.fill_between(
        band.f_hz, _decibel(band.low), _decibel(band.high), color=BLUE, alpha=0.22, linewidth=0,
        label=f"95 % of boards ({tolerances})",
    )  # fmt: skip
    axes.plot(band.f_hz, _decibel(band.target), color=ORANGE, linewidth=1.4, linestyle=(0, (5, 2)),
              label=f"target: Butterworth, third order, {format_figure(band.target_cutoff_hz)} Hz")  # fmt: skip
    axes.plot(band.f_hz, nominal_db, color=BLUE, linewidth=1.6, label="board with nominal values")
    level_db = maximum_db - 10.0 * np.log10(2.0)
    axes.axhline(level_db, color=TEXT_COLOUR, linewidth=0.7, linestyle=(0, (1, 2)))
    # Outside the passband and above the level, nothing else is drawn.
    for hz, ends_hz, side in ((band.lower_hz, band.lower_ends_hz, -1), (band.upper_hz, band.upper_ends_hz, 1)):
        axes.plot([hz], [level_db], marker="o", color=RED, markersize=5)
        axes.hlines(level_db, *ends_hz, color=RED, linewidth=2.5)
        ends = " to ".join(format_figure(end_hz, 3) for end_hz in ends_hz)
        axes.annotate(
            f"−3 dB at {format_figure(hz)} Hz\n95 %: {ends} Hz", (hz, level_db),
            (14 * side, 4), textcoords="offset points", ha="left" if side > 0 else "right", va="bottom",
            color=RED, fontsize=9,
        )  # fmt: skip
    axes.set_xscale("log")
    axes.set_xlim(band.f_hz[0], band.f_hz[-1])
    axes.set_ylim(maximum_db + _FLOOR_DB, maximum_db + _HEADROOM_DB)
    axes.set_xlabel("frequency [Hz]")
    axes.set_ylabel("gain, tactile voltage to rectifier [dB]")
    style_axes(axes, "both")
    axes.legend(loc="upper left", frameon=False, fontsize=9)
    return FORMATS[suffix](figure)


def _decibel(magnitude: Array) -> Array:
    result: Array = 20.0 * np.log10(magnitude)
    return result
