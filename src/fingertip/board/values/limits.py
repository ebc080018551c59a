"""How far the board's voltages go before something stops them: what the converter sees, where signals are cut off."""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.board.supplies import Supply
from fingertip.board.values.bridge import MOST_FORCE_N, Bridge, sensor_conductance_s

DIODE_V = 0.6
"""What variant paper's diode takes off a large signal."""

# The AD623's insides (its data sheet, "input and output voltage range"): its input followers lift their inputs by a
# diode's drop and must stay clear of both rails, as must the output.
_LIFT_V = 0.59
_INNER_FROM_UPPER_V = 0.11
_OUTPUT_FROM_UPPER_V = 0.5
_OUTPUT_FROM_LOWER_V = 0.01


@dataclass(frozen=True)
class Limits:
    """Voltages [V] against ground, unless said otherwise."""

    rest_v: float
    """Where signals rest: ground, or the supply's middle."""
    tactile_least_v: float
    """At the sensor's greatest force (20 N)."""
    tactile_most_v: float
    """With the sensor open."""
    bridge_amplifier_margin_v: float
    """From what the bridge's amplifier carries, inside and out, to where it would stop; over all forces."""
    filter_peak_v: float
    """Largest peak of the filtered signal around its rest."""
    vibration_peak_v: float
    """The same ahead of the filter: a larger vibration of the tactile voltage is cut off."""
    envelope_most_v: float
    """Largest envelope above its rest."""
    clamp_low_v: float
    clamp_high_v: float
    """The converter's pins are held between these, and a Schottky diode's drop beyond."""
    converter_v: float
    """The converter takes plus and minus this."""

    @property
    def converter_misses_v(self) -> float:
        """By how much the pins go beyond what the converter takes; 0 if they do not."""
        return max(self.tactile_most_v, self.rest_v + self.envelope_most_v, self.converter_v) - self.converter_v


def limits(bridge: Bridge, supply: Supply, supply_v: float, gain: float, diode: bool, converter_v: float) -> Limits:
    """The limits of a board.

    Parameters
    ----------
    gain
        Of the first stage.
    diode
        Whether the envelope lies behind a diode (variant paper).
    converter_v
        What the converter takes, plus and minus.
    """
    g_most = sensor_conductance_s(MOST_FORCE_N)
    peak_v = supply.swing_v(supply_v)
    return Limits(
        rest_v=supply.zero_v(supply_v),
        tactile_least_v=bridge.tactile_v(g_most, supply_v),
        tactile_most_v=bridge.tactile_v(0.0, supply_v),
        bridge_amplifier_margin_v=min(_margin_v(bridge, g, supply, supply_v) for g in (0.0, g_most)),
        filter_peak_v=peak_v,
        vibration_peak_v=peak_v / gain,
        envelope_most_v=peak_v - DIODE_V if diode else peak_v,
        clamp_low_v=0.0,
        clamp_high_v=supply_v,
        converter_v=converter_v,
    )


def converter_line(v: Limits) -> str:
    """Whether the converter takes all the board gives."""
    if not v.converter_misses_v:
        return f"a converter for plus and minus {v.converter_v:g} V takes all of it"
    return (
        f"a converter for plus and minus {v.converter_v:g} V cuts the last {v.converter_misses_v:.2f} V off: divide "
        f"the signals ahead of it, or set detector.adc_range_v to {v.converter_v + v.converter_misses_v:.2f} at least"
    )


def _margin_v(bridge: Bridge, conductance_s: float, supply: Supply, supply_v: float) -> float:
    """Voltage is monotonic in the conductance, and so is every margin: the ends of its range are the worst."""
    lower_v = 0.0 if supply.zero_share else -supply_v
    reference_v, sensor_v = bridge.reference_v(supply_v), bridge.sensor_v(conductance_s, supply_v)
    output_v = bridge.tactile_v(conductance_s, supply_v)
    common_v, half_v = (reference_v + sensor_v) / 2.0, abs(bridge.gain * (sensor_v - reference_v)) / 2.0
    return min(
        supply_v - _INNER_FROM_UPPER_V - (common_v + _LIFT_V + half_v),
        common_v + _LIFT_V - half_v - lower_v,
        supply_v - _OUTPUT_FROM_UPPER_V - output_v,
        output_v - lower_v - _OUTPUT_FROM_LOWER_V,
    )
