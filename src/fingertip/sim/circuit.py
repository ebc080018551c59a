"""The board's filter as a linear system: from component values to x' = A x + b u + k, one for each state of the rails.

States: the voltages across C1, C2, C3 [V]; with a finite gain-bandwidth product also both amplifiers' outputs. Kept
batched: every value may be an array over many boards.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fingertip.board import board_values
from fingertip.board.filters import pole_hz
from fingertip.design import Design
from fingertip.design.filter_components import series_capacitor_f
from fingertip.errors import Fault
from fingertip.sim.inputs import not_negative, positive, refuse

Array = NDArray[np.float64]
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
    blocking_capacitor: float | None = None
    """In series with R4 [F], so that the first stage amplifies no offset; None: R4 goes to ground."""

    def __post_init__(self) -> None:
        faults = []
        for name, unit, example in (
            *((f.name, "ohm", "1000") for f in fields(self) if f.name.endswith("_ohm")),
            *((f.name, "F", "1e-6") for f in fields(self) if f.name.endswith("_f")),
        ):
            faults.extend(positive(f"board.{name}", float(np.min(getattr(self, name))), unit, example))
        d = self.diode
        faults.extend(positive("diode.saturation_a", float(np.min(d.saturation_a)), "A", "2.52e-9"))
        faults.extend(positive("diode.emission", float(np.min(d.emission)), "", "1.752"))
        faults.extend(not_negative("diode.series_ohm", float(np.min(d.series_ohm)), "ohm"))
        faults.extend(positive("diode.thermal_v", float(np.min(d.thermal_v)), "V", "0.0259"))
        if self.rail_v is not None:
            faults.extend(positive("board.rail_v", self.rail_v, "V", "3.5"))
        if self.gain_bandwidth_hz is not None:
            faults.extend(positive("board.gain_bandwidth_hz", self.gain_bandwidth_hz, "Hz", "3e6"))
            if self.rail_v is not None:
                words = "stands beside gain_bandwidth_hz, and both together are not modelled; leave one out."
                faults.append(Fault("board.rail_v", f"{self.rail_v:g} V {words}"))
        if self.blocking_capacitor is not None:
            faults.extend(positive("board.blocking_capacitor", self.blocking_capacitor, "F", "66e-6"))
            if self.gain_bandwidth_hz is not None:
                words = "stands beside blocking_capacitor, and both together are not modelled; leave one out."
                faults.append(Fault("board.gain_bandwidth_hz", f"{self.gain_bandwidth_hz:g} Hz {words}"))
        refuse(faults)

    @classmethod
    def of(cls, design: Design) -> Analog:
        """The board of a design with the values that are fitted."""
        c = board_values(design).preferred
        resistors = (c.r1_ohm, c.r2_ohm, c.r3_ohm, c.r4_ohm, c.r5_ohm, c.r_lp_ohm)
        paper = cls(*resistors, c.c_f, c.c_f, c.c_f, c.c_lp_f)
        if design.board.variant == "paper":
            return paper
        blocking = series_capacitor_f(c.r4_ohm, pole_hz(c.r1_ohm, c.c_f))
        return paper.changed(rectifier="precision", blocking_capacitor=blocking)

    def changed(self, **values: object) -> Analog:
        """The same board with other values."""
        return replace(self, **values)  # type: ignore[arg-type]

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
    columns = {f.name: np.atleast_1d(getattr(board, f.name)) for f in fields(board) if f.name[-2:] in ("_f", "hm")}
    R1, R2, R3, C1, C2, C3, G = np.broadcast_arrays(
        *(columns[name] for name in ("r1_ohm", "r2_ohm", "r3_ohm", "c1_f", "c2_f", "c3_f")), np.atleast_1d(board.gain)
    )
    finite = board.gain_bandwidth_hz is not None
    blocked = board.blocking_capacitor is not None
    n = 5 if finite else 4 if blocked else 3
    # Every voltage is a row over (x, u, slope, 1), one for each board.
    unit = np.broadcast_to(np.eye(n + 3)[:, None, :], (n + 3, len(R1), n + 3))
    u, one = unit[n], unit[n + 2]
    p = u - unit[0]
    rails = [0.0, board.rail_v or 0.0, -(board.rail_v or 0.0)]
    first, second = divmod(mode, 3)
    free = G[:, None] * p - ((G - 1)[:, None] * unit[3] if blocked else 0.0)
    o1 = unit[3] if finite else one * rails[first] if first else free
    behind = o1 - unit[1] - unit[2]  # behind C3: the second amplifier's input
    o2 = unit[4] if finite else one * rails[second] if second else behind
    rates = [
        p / (R1 * C1)[:, None],
        (behind / R3[:, None] + (behind + unit[2] - o2) / R2[:, None]) / C2[:, None],
        behind / (R3 * C3)[:, None],
    ]
    if finite:
        w = 2 * np.pi * float(board.gain_bandwidth_hz or 0.0)
        rates += [w * (p - o1 / G[:, None]), w * (behind - o2)]
    if blocked:
        R4, R5 = (np.broadcast_to(columns[name], R1.shape) for name in ("r4_ohm", "r5_ohm"))
        rates.append((o1 - unit[3]) / ((R4 + R5) * float(board.blocking_capacitor or 0.0))[:, None])
    M = np.stack(rates, axis=1)
    return M[:, :, :n], M[:, :, n], M[:, :, n + 2], o2, free
