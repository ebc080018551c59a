"""Response of a board's filter over frequency, with the band that the tolerances of its components leave."""

from __future__ import annotations

import math

import numpy as np

from fingertip.arrays import Array
from fingertip.board.analysis.response import model_filter
from fingertip.board.analysis.tolerance import Spread, TolerancedFilter, component_tolerances, monte_carlo
from fingertip.board.board_values import board_values
from fingertip.board.circuits.signal_paths import board_circuit
from fingertip.board.network import build_network
from fingertip.design import Design
from fingertip.design.amplifier_choice import find_gain_bandwidth_hz
from fingertip.page.html import Markup, figure
from fingertip.page.svg_plot import Axis, Frame, figure_svg, legend

BOARDS = 1000
"""Number of boards that the band is drawn from."""
_SEED = 1
_LOW_HZ, _HIGH_HZ, _PER_DECADE = 10.0, 1e5, 40
_WIDTH, _HEIGHT = 760.0, 380.0


def draw_response(design: Design) -> Markup:
    """Draw the gain from the tactile voltage to the rectifier, as a figure with a caption."""
    circuit = board_circuit(board_values(design))
    network = build_network(circuit, find_gain_bandwidth_hz(design.board))
    board = TolerancedFilter(model_filter(circuit, design.board.variant == "article"), network.values)
    tolerances = component_tolerances(circuit)
    spread = monte_carlo(board, tolerances, BOARDS, _SEED)
    steps = round(_PER_DECADE * math.log10(_HIGH_HZ / _LOW_HZ))
    f_hz = [_LOW_HZ * 10.0 ** (i / _PER_DECADE) for i in range(steps + 1)]
    nominal, low, high = _compute_gains(board, tolerances, f_hz)
    bottom = 10.0 * math.floor(min(low) / 10.0)
    top = 10.0 * math.ceil((max(high) + 3.0) / 10.0)
    frame = Frame(
        Axis(_LOW_HZ, _HIGH_HZ, "frequency [Hz]", True), Axis(bottom, top, "gain [dB]"), 58.0, 46.0,
        _WIDTH - 80.0, _HEIGHT - 100.0,
    )  # fmt: skip
    cutoff, gain = spread["cutoff_hz"], spread["passband_gain"]
    svg = figure_svg(
        _WIDTH, _HEIGHT, f"Gain of the filter over frequency, with the band of {BOARDS} boards",
        frame.axes(),
        frame.band([*zip(f_hz, high, strict=True)], [*zip(f_hz, low, strict=True)], "var(--band)"),
        frame.line(zip(f_hz, nominal, strict=True), "var(--series-1)", 2),
        frame.mark(cutoff.nominal, "var(--series-2)"),
        legend(210.0, 22.0, (
            ("var(--series-1)", "", "nominal values"), ("var(--band)", "band", "95 % of boards"),
            ("var(--series-2)", "4 3", "-3 dB"),
        )),
    )  # fmt: skip
    caption = (
        f"Computed, not measured. Nominal -3 dB frequency {cutoff.nominal:.1f} Hz, passband gain {gain.nominal:.1f}. "
        f"Of {BOARDS} boards with components anywhere within the tolerances that are bought, 95 % have "
        f"{_range(cutoff, 1)} Hz and a gain of {_range(gain, 1)}."
    )
    return figure(svg, caption, "response of the filter", "wide")


def _range(spread: Spread, decimals: int) -> str:
    return f"{spread.low_95:.{decimals}f} to {spread.high_95:.{decimals}f}"


def _compute_gains(
    board: TolerancedFilter, tolerances: dict[str, float], f_hz: list[float]
) -> tuple[list[float], list[float], list[float]]:
    """Compute the nominal gain at each frequency, and the ends of the interval with 95 % of the boards [dB]."""
    limits = np.array([tolerances[name] / 100.0 for name in board.names])
    deviations = limits * np.random.default_rng(_SEED).uniform(-1.0, 1.0, (BOARDS, len(board.names)))
    values = dict(board.values)
    for name, ratio in zip(board.names, 1.0 + deviations.T, strict=True):
        # A network's quantity is the conductance of a resistor.
        values[name] = board.values[name] / ratio if name.startswith("R") else board.values[name] * ratio
    exact, drawn = board.model.transfer(board.values).power_gain(), board.model.transfer(values).power_gain()
    nominal, low, high = [], [], []
    for hz in f_hz:
        omega = math.tau * hz
        nominal.append(10.0 * math.log10(float(exact(omega))))
        powers: Array = np.asarray(drawn(omega))
        lower, upper = np.quantile(powers, (0.025, 0.975))
        low.append(10.0 * math.log10(float(lower)))
        high.append(10.0 * math.log10(float(upper)))
    return nominal, low, high
