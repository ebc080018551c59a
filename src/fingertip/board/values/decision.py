"""Values of variant `comparator`: the article's threshold on the windowed mean, in hardware.

The window of L samples becomes one pole of the same delay, tau = L / (2 fs). A trimmer sets the threshold between 0 and
twice the design's, and positive feedback lowers it by a quarter while the output says slip.
"""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.board.values.preferred import nearest

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

    def thresholds_v(self, supply_v: float, turn: float = 0.5, zero_share: float = 0.0) -> tuple[float, float]:
        """Mean of the envelope [V] at which slip is said, and at which it ends, with the trimmer at `turn` (0 to 1).

        Above the rest of the signals, a share of the supply. The output rests at the supply (less what the pull-up
        drops, a thousandth) and goes to ground for slip.
        """
        upper_v, lower_v = (1.0 - zero_share) * supply_v, -zero_share * supply_v
        low, high = turn * TRIMMER_OHM, (1.0 - turn) * TRIMMER_OHM + self.top_ohm
        conductance = 1.0 / high + 1.0 / self.hysteresis_ohm + (1.0 / low if low else float("inf"))
        fixed = upper_v / high
        return (
            (fixed + upper_v / self.hysteresis_ohm) / conductance,
            (fixed + lower_v / self.hysteresis_ohm) / conductance,
        )


def fit_decision(
    threshold_v: float, window_s: float, supply_v: float, series: str, zero_share: float = 0.0
) -> Decision:
    """The preferred values for a threshold [V], a window [s] and a supply [V] at a share of which signals rest."""
    # Where the output swings below the signals' rest, the feedback pulls there; the trimmer gives more by as much.
    trimmed_v = threshold_v * (1.0 + HYSTERESIS * zero_share)
    top_ohm = TRIMMER_OHM * ((1.0 - zero_share) * supply_v / (2.0 * trimmed_v) - 1.0)
    # What the feedback sees of trimmer and supply, the trimmer in its middle.
    source_ohm = 1.0 / (2.0 / TRIMMER_OHM + 1.0 / (TRIMMER_OHM / 2.0 + top_ohm))
    hysteresis_ohm = source_ohm * (supply_v / (HYSTERESIS * threshold_v) - 1.0)
    return Decision(
        mean_ohm=nearest(window_s / 2.0 / MEAN_F, series),
        top_ohm=nearest(top_ohm, series),
        hysteresis_ohm=nearest(hysteresis_ohm, series),
    )
