"""Values of variant `comparator`: the article's threshold on the windowed mean, in hardware.

The window of L samples becomes one pole of the same delay, tau = L / (2 fs). A trimmer sets the threshold between 0 and
about twice the design's, which it is in the trimmer's middle: slip is said where the mean goes above it. Positive
feedback lowers it by a quarter while the output says slip.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

from fingertip.board.values.preferred import nearest, neighbours
from fingertip.design.comparator_parts import (
    BIAS_A,
    COMPARATOR_OFFSET_V,
    MAX_BIAS_A,
    MAX_COMPARATOR_OFFSET_V,
    MAX_MEAN_F,
    MEAN_OHM,
)

TRIMMER_OHM = 10e3
PULL_UP_OHM = 4.7e3
HYSTERESIS = 0.25
"""Of the threshold."""
_MIN_MEAN_F = 1e-9


@dataclass(frozen=True)
class Decision:
    """Resistances [ohm] and the capacitance [F] around the comparator, preferred values, and what they come to."""

    mean_ohm: float
    mean_f: float
    top_ohm: float
    """From the supply to the trimmer."""
    hysteresis_ohm: float
    """From the output back to the threshold."""
    on_v: float
    """Mean of the envelope above where signals rest [V] at which slip is said, the trimmer in its middle."""
    off_v: float
    """And at which it ends."""
    max_on_v: float
    """The first, with the trimmer at its end."""
    bias_v: float
    """By how much the comparator's input current lifts the mean [V], typically."""
    max_bias_v: float
    """The same, at most."""

    @property
    def mean_s(self) -> float:
        """Time constant of the mean."""
        return self.mean_ohm * self.mean_f


def thresholds_v(
    top_ohm: float, hysteresis_ohm: float, supply_v: float, zero_share: float = 0.0, turn: float = 0.5
) -> tuple[float, float]:
    """Mean of the envelope [V] at which slip is said, and at which it ends, with the trimmer at `turn` (0 to 1).

    Above the rest of the signals, a share of the supply. The output rests at the supply (less what the pull-up drops, a
    thousandth) and goes to ground for slip.
    """
    upper_v, lower_v = (1.0 - zero_share) * supply_v, -zero_share * supply_v
    low, high = turn * TRIMMER_OHM, (1.0 - turn) * TRIMMER_OHM + top_ohm
    conductance = 1.0 / high + 1.0 / hysteresis_ohm + (1.0 / low if low else math.inf)
    return (
        (upper_v / high + upper_v / hysteresis_ohm) / conductance,
        (upper_v / high + lower_v / hysteresis_ohm) / conductance,
    )


def fit_decision(
    threshold_v: float, window_s: float, supply_v: float, series: str, zero_share: float = 0.0
) -> Decision:
    """The preferred values for a threshold [V], a window [s] and a supply [V] at a share of which signals rest."""
    upper_v, low_ohm = (1.0 - zero_share) * supply_v, TRIMMER_OHM / 2.0
    # Supply and resting output pull together by x = 1 / high and y = 1 / hysteresis: x + y = T / low / (U - T). The
    # output's fall by the whole supply lowers the threshold by supply y / (x + y + 1 / low).
    pull = threshold_v / low_ohm / (upper_v - threshold_v)
    feedback = HYSTERESIS * threshold_v / supply_v * (pull + 1.0 / low_ohm)

    def error(pair: tuple[float, float]) -> float:
        on_v, _ = thresholds_v(*pair, supply_v, zero_share)
        return round(abs(math.log(on_v / threshold_v)), 12)

    tops, backs = neighbours(1.0 / (pull - feedback) - low_ohm, series), neighbours(1.0 / feedback, series)
    top_ohm, hysteresis_ohm = min(itertools.product(tops, backs), key=error)
    mean_f = min(max(nearest(window_s / 2.0 / MEAN_OHM, "E6", 1e-12, 1e-3), _MIN_MEAN_F), MAX_MEAN_F)
    mean_ohm = nearest(window_s / 2.0 / mean_f, series)
    on_v, off_v = thresholds_v(top_ohm, hysteresis_ohm, supply_v, zero_share)
    max_on_v, _ = thresholds_v(top_ohm, hysteresis_ohm, supply_v, zero_share, turn=1.0)
    return Decision(
        mean_ohm, mean_f, top_ohm, hysteresis_ohm, on_v, off_v, max_on_v, BIAS_A * mean_ohm, MAX_BIAS_A * mean_ohm
    )


def decision_lines(d: Decision) -> list[str]:
    """Where slip is said, and by how much the comparator errs, as sentences."""
    return [
        f"slip is ON above {1e3 * d.on_v:.1f} mV and OFF below {1e3 * d.off_v:.1f} mV in the trimmer's middle; the "
        f"trimmer reaches {1e3 * d.max_on_v:.1f} mV",
        f"the comparator's input current lifts the mean by {1e3 * d.bias_v:.2f} mV ({1e3 * d.max_bias_v:.2f} mV at "
        f"most) in R18, its offset is {1e3 * COMPARATOR_OFFSET_V:g} mV ({1e3 * MAX_COMPARATOR_OFFSET_V:g} mV at most)",
    ]
