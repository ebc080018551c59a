"""Component values of variant `comparator`: the article's threshold on the windowed mean, in hardware.

The window of L samples becomes an RC low-pass of the same delay, tau = L / (2 fs). A trimmer sets the threshold between
0 and about twice the design's threshold, which corresponds to its midpoint. The output reports slip while the averaged
envelope exceeds the threshold. Positive feedback lowers the threshold by a quarter while the output reports slip.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

from fingertip.board.values.preferred_values import nearest_value, neighbouring_values
from fingertip.design.comparator_data import (
    AVERAGING_OHM,
    BIAS_A,
    COMPARATOR_OFFSET_V,
    MAX_AVERAGING_F,
    MAX_BIAS_A,
    MAX_COMPARATOR_OFFSET_V,
)

TRIMMER_OHM = 10e3
PULL_UP_OHM = 4.7e3
HYSTERESIS_RATIO = 0.25
"""Hysteresis as a ratio of the threshold."""
_MIN_AVERAGING_F = 1e-9


@dataclass(frozen=True)
class ComparatorStage:
    """Preferred resistances [ohm] and capacitance [F] around the comparator, and the resulting thresholds."""

    averaging_ohm: float
    """Resistance of the averaging low-pass."""
    averaging_f: float
    """Capacitance of the averaging low-pass."""
    trimmer_top_ohm: float
    """Resistance from the supply to the trimmer."""
    hysteresis_ohm: float
    """Resistance from the output back to the threshold."""
    on_v: float
    """Averaged envelope [V] above the signal ground at which the output turns ON, with the trimmer at its midpoint."""
    off_v: float
    """Averaged envelope [V] above the signal ground at which the output turns OFF again."""
    max_on_v: float
    """ON threshold [V] with the trimmer at its end."""
    bias_v: float
    """Typical increase of the mean [V] by the comparator's input bias current."""
    max_bias_v: float
    """Maximum increase of the mean [V] by the comparator's input bias current."""

    @property
    def averaging_tau_s(self) -> float:
        """Time constant of the averaging low-pass [s]."""
        return self.averaging_ohm * self.averaging_f


def compute_thresholds_v(
    trimmer_top_ohm: float,
    hysteresis_ohm: float,
    supply_v: float,
    signal_ground_ratio: float = 0.0,
    trimmer_ratio: float = 0.5,
) -> tuple[float, float]:
    """Compute the ON and OFF thresholds of the averaged envelope [V] above the signal ground.

    The output is at the supply (less the drop across the pull-up, a thousandth) without slip, and at ground for slip.

    Parameters
    ----------
    trimmer_top_ohm
        Resistance from the supply to the trimmer.
    hysteresis_ohm
        Resistance from the output to the threshold.
    supply_v
        Positive supply.
    signal_ground_ratio
        Voltage of the signal ground as a ratio of the supply.
    trimmer_ratio
        Position of the trimmer's wiper, from 0 to 1.
    """
    upper_v, lower_v = (1.0 - signal_ground_ratio) * supply_v, -signal_ground_ratio * supply_v
    low, high = trimmer_ratio * TRIMMER_OHM, (1.0 - trimmer_ratio) * TRIMMER_OHM + trimmer_top_ohm
    conductance = 1.0 / high + 1.0 / hysteresis_ohm + (1.0 / low if low else math.inf)
    return (
        (upper_v / high + upper_v / hysteresis_ohm) / conductance,
        (upper_v / high + lower_v / hysteresis_ohm) / conductance,
    )


def size_comparator(
    threshold_v: float, window_s: float, supply_v: float, series: str, signal_ground_ratio: float = 0.0
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
    """
    upper_v, low_ohm = (1.0 - signal_ground_ratio) * supply_v, TRIMMER_OHM / 2.0
    # Supply and output together pull the threshold up by x = 1 / high and y = 1 / hysteresis, where
    # x + y = T / low / (U - T). When the output falls by the whole supply, the threshold falls by
    # supply y / (x + y + 1 / low).
    pull = threshold_v / low_ohm / (upper_v - threshold_v)
    feedback = HYSTERESIS_RATIO * threshold_v / supply_v * (pull + 1.0 / low_ohm)

    def error(pair: tuple[float, float]) -> float:
        on_v, _ = compute_thresholds_v(*pair, supply_v, signal_ground_ratio)
        return round(abs(math.log(on_v / threshold_v)), 12)

    tops = neighbouring_values(1.0 / (pull - feedback) - low_ohm, series)
    feedbacks = neighbouring_values(1.0 / feedback, series)
    trimmer_top_ohm, hysteresis_ohm = min(itertools.product(tops, feedbacks), key=error)
    averaging_f = min(
        max(nearest_value(window_s / 2.0 / AVERAGING_OHM, "E6", 1e-12, 1e-3), _MIN_AVERAGING_F), MAX_AVERAGING_F
    )
    averaging_ohm = nearest_value(window_s / 2.0 / averaging_f, series)
    on_v, off_v = compute_thresholds_v(trimmer_top_ohm, hysteresis_ohm, supply_v, signal_ground_ratio)
    max_on_v, _ = compute_thresholds_v(
        trimmer_top_ohm, hysteresis_ohm, supply_v, signal_ground_ratio, trimmer_ratio=1.0
    )
    return ComparatorStage(
        averaging_ohm,
        averaging_f,
        trimmer_top_ohm,
        hysteresis_ohm,
        on_v,
        off_v,
        max_on_v,
        BIAS_A * averaging_ohm,
        MAX_BIAS_A * averaging_ohm,
    )


def describe_comparator_stage(stage: ComparatorStage) -> list[str]:
    """Describe thresholds and errors of the comparator stage, as sentences."""
    return [
        f"slip is ON above {1e3 * stage.on_v:.1f} mV and OFF below {1e3 * stage.off_v:.1f} mV with the trimmer at its "
        f"midpoint; the trimmer reaches {1e3 * stage.max_on_v:.1f} mV",
        f"the comparator's input bias current raises the mean by {1e3 * stage.bias_v:.2f} mV (at most "
        f"{1e3 * stage.max_bias_v:.2f} mV) in R18; its offset is {1e3 * COMPARATOR_OFFSET_V:g} mV (at most "
        f"{1e3 * MAX_COMPARATOR_OFFSET_V:g} mV)",
    ]
