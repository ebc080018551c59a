"""Values of variant `comparator`: the article's threshold on the windowed mean, in hardware.

The window of L samples becomes one pole of the same delay, tau = L / (2 fs). A trimmer sets the threshold between 0 and
twice the design's, and positive feedback lowers it by a quarter while the output says slip.
"""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.board.preferred import nearest

MEAN_F = 100e-9
TRIMMER_OHM = 10e3
PULL_UP_OHM = 4.7e3
HYSTERESIS = 0.25
"""Of the threshold."""


@dataclass(frozen=True)
class Decision:
    """Resistances [ohm] around the comparator, preferred values."""

    mean_ohm: float
    top_ohm: float
    """From the supply to the trimmer."""
    hysteresis_ohm: float
    """From the output back to the threshold."""

    @property
    def mean_s(self) -> float:
        """Time constant of the mean."""
        return self.mean_ohm * MEAN_F

    def thresholds_v(self, supply_v: float, turn: float = 0.5) -> tuple[float, float]:
        """Mean of the envelope [V] at which slip is said, and at which it ends, with the trimmer at `turn` (0 to 1).

        The output rests at the supply (less what the pull-up drops, a thousandth) and goes to ground for slip.
        """
        low, high = turn * TRIMMER_OHM, (1.0 - turn) * TRIMMER_OHM + self.top_ohm
        conductance = 1.0 / high + 1.0 / self.hysteresis_ohm + (1.0 / low if low else float("inf"))
        up = supply_v * (1.0 / high + 1.0 / self.hysteresis_ohm) / conductance
        return up, supply_v / high / conductance


def fit_decision(threshold_v: float, window_s: float, supply_v: float, series: str) -> Decision:
    """The preferred values for a threshold [V], a window [s] and a supply [V]."""
    top_ohm = TRIMMER_OHM * (supply_v / (2.0 * threshold_v) - 1.0)
    # What the feedback sees of trimmer and supply, the trimmer in its middle.
    source_ohm = 1.0 / (2.0 / TRIMMER_OHM + 1.0 / (TRIMMER_OHM / 2.0 + top_ohm))
    hysteresis_ohm = source_ohm * (supply_v / (HYSTERESIS * threshold_v) - 1.0)
    return Decision(
        mean_ohm=nearest(window_s / 2.0 / MEAN_F, series),
        top_ohm=nearest(top_ohm, series),
        hysteresis_ohm=nearest(hysteresis_ohm, series),
    )
