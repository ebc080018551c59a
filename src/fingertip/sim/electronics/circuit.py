"""The board's filter as a linear system: from component values to x' = A x + b u + k, one for each state of the rails.

States: the voltages across C1, C2, C3 and whatever capacitors a variant adds [V]; with a finite gain-bandwidth product
also both amplifiers' outputs. Signals rest at 0, which on a single supply is the supply's middle. Kept batched: every
value may be an array over many boards.

The gain-bandwidth product is that of the filter's amplifiers. A precision rectifier's amplifier also has to cross two
diode drops, 1.2 V, at each zero of its input, which at a slope s takes sqrt(2 * 1.2 V / (2 pi GBW s)): 0.11 ms for the
TLV2372 and 10 V/s, the slope of a slip, in which some 1 mV is lost. Left out: ngspice on the whole netlist, diodes and
amplifiers of 3 MHz, differs by 0.1 mV in 0.18 V (tests/sim/test_comparator.py).
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
from fingertip.sim.electronics.state_space import GROUND, Amplifier, Part, assemble
from fingertip.sim.validation import not_negative, positive, refuse

Values = float | Array


@dataclass(frozen=True)
class Diode:
    """Shockley's diode with a series resistance: ``i = Is (exp((v - i Rs) / (n Vt)) - 1)``.

    Default: the 1N4148 of common SPICE libraries, at SPICE's 27 degree Celsius.
    """

    saturation_a: Values = 2.52e-9
    emission: Values = 1.752
    series_ohm: Values = 0.568
    thermal_v: Values = 0.025864951


@dataclass(frozen=True)
class Analog:
    """The article's board (figure 3) as it runs: values [ohm, F], diode, amplifiers.

    Raises
    ------
    TraceError
        With one sentence for each value that is not above 0.
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
    """Both amplifiers' outputs stop at plus and minus this [V]; None: they never do."""
    gain_bandwidth_hz: float | None = None
    """Of both amplifiers [Hz]; None: infinite."""
    rectifier: Literal["diode", "precision"] = "diode"
    """A diode that charges R_LP parallel to C_LP (article), or amplifiers that rectify and follow with one pole."""
    blocking_capacitor: Values | None = None
    """In series with R4 [F], so that the first stage amplifies no offset; None: R4 goes to ground."""
    limiting_capacitor: Values | None = None
    """Across R5 [F], so that the first stage's gain ends above the vibrations; None: none."""

    def __post_init__(self) -> None:
        issues = []
        for name, unit, example in (
            *((f.name, "ohm", "1000") for f in fields(self) if f.name.endswith("_ohm")),
            *((f.name, "F", "1e-6") for f in fields(self) if f.name.endswith("_f")),
        ):
            issues.extend(positive(f"board.{name}", float(np.min(getattr(self, name))), unit, example))
        d = self.diode
        issues.extend(positive("diode.saturation_a", float(np.min(d.saturation_a)), "A", "2.52e-9"))
        issues.extend(positive("diode.emission", float(np.min(d.emission)), "", "1.752"))
        issues.extend(not_negative("diode.series_ohm", float(np.min(d.series_ohm)), "ohm"))
        issues.extend(positive("diode.thermal_v", float(np.min(d.thermal_v)), "V", "0.0259"))
        for name, unit, example in (
            ("rail_v", "V", "3.5"),
            ("gain_bandwidth_hz", "Hz", "3e6"),
            ("blocking_capacitor", "F", "66e-6"),
            ("limiting_capacitor", "F", "1.5e-9"),
        ):
            if getattr(self, name) is not None:
                issues.extend(positive(f"board.{name}", float(np.min(getattr(self, name))), unit, example))
        if self.rail_v is not None and self.gain_bandwidth_hz is not None:
            # At a rail a slow amplifier's input stage saturates, and how it comes back is in no data sheet.
            words = "stands beside gain_bandwidth_hz, and both together are not modelled; leave one out."
            issues.append(Issue("board.rail_v", f"{self.rail_v:g} V {words}"))
        refuse(issues)

    @classmethod
    def of(cls, design: Design) -> Analog:
        """The board of a design with the values that are fitted."""
        values = board_values(design)
        c, extra = values.preferred, values.first_stage
        resistors = (c.r1_ohm, c.r2_ohm, c.r3_ohm, c.r4_ohm, c.r5_ohm, c.r_lp_ohm)
        article = cls(*resistors, c.c_f, c.c_f, c.c_f, c.c_lp_f)
        if extra is None:
            return article
        return article.changed(
            rectifier="precision", blocking_capacitor=extra.series_f, limiting_capacitor=extra.limit_f
        )

    def changed(self, **values: object) -> Analog:
        """The same board with other values."""
        return replace(self, **values)  # type: ignore[arg-type]

    @property
    def value_names(self) -> tuple[str, ...]:
        """Names of all resistors and capacitors that this board has."""
        extra = ("blocking_capacitor", "limiting_capacitor")
        fitted = (name for name in extra if getattr(self, name) is not None)
        return (*(f.name for f in fields(self) if f.name.endswith(("_f", "_ohm"))), *fitted)

    @property
    def gain(self) -> Values:
        """G = 1 + R5/R4."""
        return 1 + self.r5_ohm / self.r4_ohm


def system(board: Analog, mode: int = 0) -> tuple[Array, Array, Array, Array, Array]:
    """A (B, n, n), b and k (B, n), and rows (B, n + 3) over (x, u, slope, 1): the output, and the first amplifier's
    output as it would be without rails.

    Parameters
    ----------
    board
        Its values give the batch's length B (1 for plain numbers).
    mode
        3 times the first amplifier's state plus the second's; each 0 free, 1 at the upper rail, 2 at the lower.
    """
    parts = [Part(name, a, b, getattr(board, name)) for name, a, b in topology(board)]
    resistors = [part for part in parts if part.name.endswith("_ohm")]
    capacitors = [part for part in parts if not part.name.endswith("_ohm")]
    batch = max(np.size(part.value) for part in parts)
    rail = board.rail_v or 0.0
    held = [(None, rail, -rail)[state] for state in divmod(mode, 3)]
    first, second = (
        Amplifier(*pins, board.gain_bandwidth_hz, at)
        for pins, at in zip((("p", "f", "o1"), ("n", "o2", "o2")), held, strict=True)
    )
    found = assemble(resistors, capacitors, (first, second), "in", batch)
    free = assemble(resistors, capacitors, (replace(first, rail_v=None), second), "in", batch) if held[0] else found
    return found.A, found.b, found.k, found.nodes["o2"], free.nodes["o1"]


def topology(board: Analog) -> Iterator[tuple[str, str, str]]:
    """Name of a value, and the nodes it lies between: C1, C2, C3 are the first states, as the loop expects."""
    yield from (("c1_f", "in", "p"), ("c2_f", "o1", "m"), ("c3_f", "m", "n"))
    yield from (("r1_ohm", "p", GROUND), ("r2_ohm", "m", "o2"), ("r3_ohm", "n", GROUND), ("r5_ohm", "f", "o1"))
    yield "r4_ohm", "f", GROUND if board.blocking_capacitor is None else "s"
    if board.blocking_capacitor is not None:
        yield "blocking_capacitor", "s", GROUND
    if board.limiting_capacitor is not None:
        yield "limiting_capacitor", "f", "o1"
