"""Component values of variant `comparator`: the article's threshold on the windowed mean, in hardware.

The window of L samples becomes an RC low-pass of the same delay, tau = L / (2 fs). A trimmer sets the threshold between
0 and about twice the design's threshold, which corresponds to its midpoint. The output reports slip while the averaged
envelope exceeds the threshold. Positive feedback lowers the threshold by a quarter while the output reports slip.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

from fingertip.board.components.capacitor_choice import nearest_capacitance
from fingertip.board.components.preferred_values import nearest_value, neighbouring_values
from fingertip.design.comparator_data import AVERAGING_OHM, MAX_AVERAGING_F

TRIMMER_OHM = 10e3
PULL_UP_OHM = 4.7e3
HYSTERESIS_RATIO = 0.25
"""Hysteresis as a ratio of the threshold."""
_MIN_AVERAGING_F = 1e-9


@dataclass(frozen=True)
class ComparatorStage:
    """Preferred resistances [ohm] and capacitance [F] around the comparator."""

    averaging_ohm: float
    """Resistance of the averaging low-pass."""
    averaging_f: float
    """Capacitance of the averaging low-pass."""
    trimmer_top_ohm: float
    """Resistance from the supply to the trimmer."""
    hysteresis_ohm: float
    """Resistance from the output back to the threshold."""

    def by_reference(self) -> dict[str, float]:
        """Value of each component [ohm, F] by its reference designator."""
        return {
            "R18": self.averaging_ohm, "C17": self.averaging_f, "R19": self.trimmer_top_ohm,
            "R20": self.hysteresis_ohm, "R21": PULL_UP_OHM, "RV1": TRIMMER_OHM,
        }  # fmt: skip


def compute_threshold_v(
    trimmer_top_ohm: float, hysteresis_ohm: float, supply_v: float, signal_ground_ratio: float = 0.0
) -> float:
    """Compute the ON threshold [V] above the signal ground, with the trimmer at its midpoint.

    Until slip is detected, the pull-up connects the output's end of the hysteresis resistor to the supply.
    """
    upper_v, low_ohm = (1.0 - signal_ground_ratio) * supply_v, TRIMMER_OHM / 2.0
    pull = 1.0 / (TRIMMER_OHM / 2.0 + trimmer_top_ohm) + 1.0 / (hysteresis_ohm + PULL_UP_OHM)
    return upper_v * pull / (pull + 1.0 / low_ohm)


def size_comparator(
    threshold_v: float,
    window_s: float,
    supply_v: float,
    series: str,
    signal_ground_ratio: float = 0.0,
    capacitor_series: str = "given",
) -> ComparatorStage:
    """Size the comparator stage for a threshold [V], a window [s] and a supply [V].

    Parameters
    ----------
    threshold_v
        Threshold above the signal ground.
    window_s
        Length of the window whose delay the averaging low-pass reproduces.
    supply_v
        Positive supply.
    series
        Series of the resistors.
    signal_ground_ratio
        Voltage of the signal ground as a ratio of the supply.
    capacitor_series
        Series of the averaging capacitor.
    """
    upper_v, low_ohm = (1.0 - signal_ground_ratio) * supply_v, TRIMMER_OHM / 2.0
    # Supply and output together pull the threshold up by x = 1 / high and y = 1 / (hysteresis + pull-up), where
    # x + y = T / low / (U - T). When the output falls by the whole supply, the threshold falls by about
    # supply y / (x + y + 1 / low).
    pull = threshold_v / low_ohm / (upper_v - threshold_v)
    feedback = HYSTERESIS_RATIO * threshold_v / supply_v * (pull + 1.0 / low_ohm)

    def error(pair: tuple[float, float]) -> float:
        on_v = compute_threshold_v(*pair, supply_v, signal_ground_ratio)
        return round(abs(math.log(on_v / threshold_v)), 12)

    tops = neighbouring_values(1.0 / (pull - 1.0 / (1.0 / feedback + PULL_UP_OHM)) - low_ohm, series)
    feedbacks = neighbouring_values(1.0 / feedback, series)
    trimmer_top_ohm, hysteresis_ohm = min(itertools.product(tops, feedbacks), key=error)
    averaging_f = min(
        max(nearest_capacitance(window_s / 2.0 / AVERAGING_OHM, capacitor_series), _MIN_AVERAGING_F), MAX_AVERAGING_F
    )
    averaging_ohm = nearest_value(window_s / 2.0 / averaging_f, series)
    return ComparatorStage(averaging_ohm, averaging_f, trimmer_top_ohm, hysteresis_ohm)
