"""Filter board as a linear system: from component values to x' = A x + b u + k, one for each saturation of amplifiers.

The states are the voltages across C1, C2, C3 and the capacitors that a variant adds [V]; with a finite gain-bandwidth
product also both amplifiers' outputs. Voltages are relative to the signal ground, which on a single supply is the
middle of the supply. Equations are batched: every value may be an array over many boards.

The gain-bandwidth product is that of the filter's amplifiers. A precision rectifier's amplifier also has to cross two
diode drops, 1.2 V, at each zero of its input. At a slope s that takes sqrt(2 * 1.2 V / (2 pi GBW s)): 0.11 ms for the
TLV2372 and 10 V/s, the slope of a slip, in which some 1 mV is lost. This is not modelled: ngspice on the whole netlist,
with diodes and amplifiers of 3 MHz, differs by 0.1 mV in 0.18 V (tests/sim/test_comparator.py).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from typing import Literal

import numpy as np

from fingertip.arrays import Array
from fingertip.board import board_values
from fingertip.design import Design
from fingertip.errors import Issue
from fingertip.sim.electronics.envelope_loop import ABSCISSAE, LEVELS, WIDTH
from fingertip.sim.electronics.state_space import (
    GROUND,
    Amplifier,
    PassiveComponent,
    assemble,
    augment,
    exponentials,
)
from fingertip.sim.validation import find_negative, find_not_positive, raise_issues

Values = float | Array
"""One value, or one for each of many boards."""


@dataclass(frozen=True)
class Diode:
    """Shockley diode with a series resistance: ``i = Is (exp((v - i Rs) / (n Vt)) - 1)``.

    The defaults are the 1N4148 of common SPICE libraries at SPICE's nominal 27 degrees Celsius.
    """

    saturation_a: Values = 2.52e-9
    emission: Values = 1.752
    series_ohm: Values = 0.568
    thermal_v: Values = 0.025864951


@dataclass(frozen=True)
class AnalogBoard:
    """Values [ohm, F], diode and amplifiers of the article's board (figure 3) or one of its variants.

    Raises
    ------
    TraceError
        With one issue for each value that is not above 0.
    """

    r1_ohm: Values
    r2_ohm: Values
    r3_ohm: Values
    r4_ohm: Values
    r5_ohm: Values
    r_lp_ohm: Values
    c1_f: Values
    c2_f: Values
    c3_f: Values
    c_lp_f: Values
    diode: Diode = Diode()
    rail_v: float | None = None
    """Voltage at which both amplifiers' outputs saturate, of either sign [V]; None: they never do."""
    gain_bandwidth_hz: float | None = None
    """Gain-bandwidth product of both amplifiers [Hz]; None: infinite."""
    rectifier: Literal["diode", "precision"] = "diode"
    """A diode that charges R_LP parallel to C_LP (article), or amplifiers that rectify and follow with one pole."""
    series_capacitor_f: Values | None = None
    """Capacitor in series with R4 [F], so that the first stage amplifies no offset; None: R4 goes to ground."""
    limiting_capacitor_f: Values | None = None
    """Capacitor across R5 [F], so that the first stage's gain ends above the vibrations; None: there is none."""

    def __post_init__(self) -> None:
        issues = []
        for name, unit, example in (
            *((f.name, "ohm", "1000") for f in fields(self) if f.name.endswith("_ohm")),
            *(
                (f.name, "F", "1e-6")
                for f in fields(self)
                if f.name.endswith("_f") and getattr(self, f.name) is not None
            ),
        ):
            issues.extend(find_not_positive(f"board.{name}", float(np.min(getattr(self, name))), unit, example))
        d = self.diode
        issues.extend(find_not_positive("diode.saturation_a", float(np.min(d.saturation_a)), "A", "2.52e-9"))
        issues.extend(find_not_positive("diode.emission", float(np.min(d.emission)), "", "1.752"))
        issues.extend(find_negative("diode.series_ohm", float(np.min(d.series_ohm)), "ohm"))
        issues.extend(find_not_positive("diode.thermal_v", float(np.min(d.thermal_v)), "V", "0.0259"))
        for name, unit, example in (
            ("rail_v", "V", "3.5"),
            ("gain_bandwidth_hz", "Hz", "3e6"),
        ):
            if getattr(self, name) is not None:
                issues.extend(find_not_positive(f"board.{name}", float(np.min(getattr(self, name))), unit, example))
        if self.rail_v is not None and self.gain_bandwidth_hz is not None:
            # The input stage of a slow amplifier saturates at a rail, and no data sheet says how it recovers.
            message = "cannot be combined with gain_bandwidth_hz; both together are not modelled; leave one out."
            issues.append(Issue("board.rail_v", f"{self.rail_v:g} V {message}"))
        raise_issues(issues)

    @classmethod
    def from_design(cls, design: Design) -> AnalogBoard:
        """Board of a design, with the values of the components that are fitted."""
        values = board_values(design)
        c, extra = values.preferred, values.first_stage_capacitors
        resistors = (c.r1_ohm, c.r2_ohm, c.r3_ohm, c.r4_ohm, c.r5_ohm, c.r_lp_ohm)
        article = cls(*resistors, c.c_f, c.c_f, c.c_f, c.c_lp_f)
        if extra is None:
            return article
        return article.with_values(
            rectifier="precision",
            series_capacitor_f=extra.series_capacitor_f,
            limiting_capacitor_f=extra.limiting_capacitor_f,
        )

    def with_values(self, **values: object) -> AnalogBoard:
        """Copy of the board with other values."""
        return replace(self, **values)  # type: ignore[arg-type]

    @property
    def value_names(self) -> tuple[str, ...]:
        """Names of all resistors and capacitors of this board."""
        names = (f.name for f in fields(self) if f.name.endswith(("_f", "_ohm")))
        return tuple(name for name in names if getattr(self, name) is not None)

    @property
    def gain(self) -> Values:
        """Gain of the first stage in the passband: G = 1 + R5/R4."""
        return 1 + self.r5_ohm / self.r4_ohm


def board_with_amplifiers(design: Design, amplifiers: str) -> AnalogBoard:
    """Board of a design with one of three models of its amplifiers.

    The rails are taken as far below the signal ground as above it. A TL082's inputs leave their common-mode range
    sooner, and its output then jumps up. This is not simulated: `VoltageLimits.filter_trough_v` says how far down the
    board of variant article may be driven.

    Parameters
    ----------
    design
        Its board.
    amplifiers
        "ideal", "rails" (outputs saturate) or "gain_bandwidth" (the design's gain-bandwidth product).
    """
    board = AnalogBoard.from_design(design)
    if amplifiers == "rails":
        return board.with_values(rail_v=board_values(design).voltage_limits.filter_peak_v)
    if amplifiers == "gain_bandwidth":
        return board.with_values(gain_bandwidth_hz=design.board.gain_bandwidth_hz)
    return board


def compute_state_space(board: AnalogBoard, mode: int = 0) -> tuple[Array, Array, Array, Array, Array]:
    """Compute the board's state equations.

    Parameters
    ----------
    board
        Its values give the batch's length B (1 for plain numbers).
    mode
        3 times the first amplifier's state plus the second's; each is 0 (linear), 1 (saturated at the upper rail) or 2
        (at the lower rail).

    Returns
    -------
    A, b, k
        Matrices of shapes (B, n, n), (B, n), (B, n).
    output_row, amplifier1_row
        Rows of shape (B, n + 3) over (x, u, slope of u, 1): the filter's output, and the first amplifier's output as it
        would be without rails.
    """
    components = [PassiveComponent(name, a, b, getattr(board, name)) for name, a, b in topology(board)]
    resistors = [component for component in components if component.name.endswith("_ohm")]
    capacitors = [component for component in components if not component.name.endswith("_ohm")]
    batch = max(np.size(component.value) for component in components)
    rail = board.rail_v or 0.0
    saturated = [(None, rail, -rail)[state] for state in divmod(mode, 3)]
    first, second = (
        Amplifier(*pins, board.gain_bandwidth_hz, voltage)
        for pins, voltage in zip((("p", "f", "o1"), ("n", "o2", "o2")), saturated, strict=True)
    )
    found = assemble(resistors, capacitors, (first, second), "in", batch)
    linear = found
    if saturated[0]:
        linear = assemble(resistors, capacitors, (replace(first, saturated_v=None), second), "in", batch)
    return found.A, found.b, found.k, found.nodes["o2"], linear.nodes["o1"]


def topology(board: AnalogBoard) -> Iterator[tuple[str, str, str]]:
    """Name of each value and the nodes it lies between; C1, C2, C3 are the first states, as the loop expects."""
    yield from (("c1_f", "in", "p"), ("c2_f", "o1", "m"), ("c3_f", "m", "n"))
    yield from (("r1_ohm", "p", GROUND), ("r2_ohm", "m", "o2"), ("r3_ohm", "n", GROUND), ("r5_ohm", "f", "o1"))
    yield "r4_ohm", "f", GROUND if board.series_capacitor_f is None else "s"
    if board.series_capacitor_f is not None:
        yield "series_capacitor_f", "s", GROUND
    if board.limiting_capacitor_f is not None:
        yield "limiting_capacitor_f", "f", "o1"


def compute_step_matrices(board: AnalogBoard, step_s: float) -> tuple[int, Array, Array, Array, Array]:
    """Compute the board's exact steps in the layout of `envelope_loop`: one flat array for each board.

    Returns
    -------
    states
        Number of states.
    step_rows, rk_rows
        Rows of the state at the end of a step, and of the output at `ABSCISSAE` within it, where the Runge-Kutta method
        needs it; by mode of the rails and level of the step.
    output_row, amplifier1_row
        Rows of the output, and of the first amplifier's output without rails, at one moment.
    """
    step_rows, rk_rows = [], []
    output_row = amplifier1_row = np.zeros(0)
    n = 0
    for mode in range(9 if board.rail_v else 1):
        A, b, k, output, amplifier1 = compute_state_space(board, mode)
        n = A.shape[-1]
        padding = max(0, WIDTH - n - 3)
        if mode == 0:
            output_row, amplifier1_row = (np.pad(row, ((0, 0), (0, padding))) for row in (output, amplifier1))
        M = augment(A, b, k)
        # Two levels more than the loop uses give the quarters and halves of the shortest step.
        powers = exponentials(M, step_s, LEVELS + 2)
        odd = exponentials(M, step_s * 0.55, LEVELS)
        quarter, half, full = powers[:, 2:], powers[:, 1:-1], powers[:, :-2]
        transition = {0.25: quarter, 0.5: half, 0.75: quarter @ half, 0.55: odd, 1.0: full}
        row = np.stack([(output[:, None, None, :] @ transition[c])[:, :, 0] for c in ABSCISSAE], axis=2)
        pad = ((0, 0), (0, 0), (0, 0), (0, padding))
        step_rows.append(np.pad(full[:, :, :n], pad))
        rk_rows.append(np.pad(row, pad))
    count = len(output_row)
    flat_step_rows, flat_rk_rows = (np.stack(arrays, axis=1).reshape(count, -1) for arrays in (step_rows, rk_rows))
    return n, flat_step_rows, flat_rk_rows, output_row, amplifier1_row
