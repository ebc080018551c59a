"""How far the board's voltages go before something stops them: what the converter sees, where signals are cut off."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from fingertip.board.supplies import Supply
from fingertip.board.values.amplifiers import Amplifier
from fingertip.board.values.bridge import MAX_FORCE_N, Bridge, sensor_conductance_s

DIODE_V = 0.6
"""What variant article's diode takes off a large signal."""

# The AD623's insides (its data sheet, "input and output voltage range"): its input followers lift their inputs by a
# diode's drop and must stay clear of both rails, as must the output.
_LIFT_V = 0.59
_INNER_FROM_UPPER_V = 0.11
_OUTPUT_FROM_UPPER_V = 0.5
_OUTPUT_FROM_LOWER_V = 0.01


@dataclass(frozen=True)
class Swing:
    """How far a follower of the filter goes around its rest [V]: its output upwards, the nearer of both downwards."""

    up_v: float
    down_v: float
    """Where its input or its output ends, typically."""
    sure_down_v: float
    """The same, as far as the data sheet is sure."""
    reverses: bool
    """Whether its output jumps to the other end below."""


def swing_of(amplifier: Amplifier, supply: Supply, supply_v: float) -> Swing:
    """The swing of an amplifier on a supply; the filter's second stage is such a follower."""
    up_v = supply.reach_v(supply_v) - amplifier.output_from_rail_v
    typical, sure = (
        supply.lower_reach_v(supply_v) - max(inside, amplifier.output_from_rail_v)
        for inside in amplifier.input_from_lower_v
    )
    return Swing(up_v, typical, sure, typical < up_v)


@dataclass(frozen=True)
class Limits:
    """Voltages [V] against ground, unless said otherwise."""

    rest_v: float
    """Where signals rest: ground, or the supply's middle."""
    min_tactile_v: float
    """At the sensor's greatest force (20 N)."""
    max_tactile_v: float
    """With the sensor open."""
    bridge_amplifier_margin_v: float
    """From what the bridge's amplifier carries, inside and out, to where it would stop; over all forces."""
    filter_peak_v: float
    """Largest peak of the filtered signal above its rest."""
    filter_trough_v: float
    """Its largest peak below its rest: where the second stage's output or, on a TL082, its input ends, typically."""
    filter_sure_trough_v: float
    """The same, as far as the amplifier's data sheet is sure."""
    reverses_below: bool
    """Whether the output jumps up where the signal goes further down: a TL082's does."""
    vibration_peak_v: float
    """The smaller of both peaks ahead of the filter: a larger vibration of the tactile voltage is cut off."""
    max_envelope_v: float
    """Largest envelope above its rest."""
    clamp_low_v: float
    clamp_high_v: float
    """The converter's pins are held between these, and a Schottky diode's drop beyond."""
    converter_v: float
    """The converter takes plus and minus this."""

    @property
    def converter_misses_v(self) -> float:
        """By how much the pins go beyond what the converter takes; 0 if they do not."""
        return max(self.max_tactile_v, self.rest_v + self.max_envelope_v, self.converter_v) - self.converter_v


def limits(
    bridge: Bridge, supply: Supply, supply_v: float, swing: Swing, gain: float, diode: bool, converter_v: float
) -> Limits:
    """The limits of a board.

    Parameters
    ----------
    swing
        Of the filter's second stage.
    gain
        The filter's largest.
    diode
        Whether the envelope lies behind a diode (variant article).
    converter_v
        What the converter takes, plus and minus.
    """
    max_g = sensor_conductance_s(MAX_FORCE_N)
    return Limits(
        rest_v=supply.zero_v(supply_v),
        min_tactile_v=bridge.tactile_v(max_g, supply_v),
        max_tactile_v=bridge.tactile_v(0.0, supply_v),
        bridge_amplifier_margin_v=min(_margin_v(bridge, g, supply, supply_v) for g in (0.0, max_g)),
        filter_peak_v=swing.up_v,
        filter_trough_v=swing.down_v,
        filter_sure_trough_v=swing.sure_down_v,
        reverses_below=swing.reverses,
        vibration_peak_v=min(swing.up_v, swing.down_v) / gain,
        max_envelope_v=swing.up_v - DIODE_V if diode else swing.up_v,
        clamp_low_v=0.0,
        clamp_high_v=supply_v,
        converter_v=converter_v,
    )


def swing_line(v: Limits) -> str:
    """How far the filter's signals go."""
    if not v.reverses_below:
        return f"the filter's go {v.filter_peak_v:.1f} V up and {v.filter_trough_v:.1f} V down"
    return (
        f"the filter's go {v.filter_peak_v:.1f} V up and {v.filter_trough_v:.1f} V down (typically; "
        f"{v.filter_sure_trough_v:.1f} V to be sure), and below the TL082's output jumps up"
    )


def converter_line(v: Limits) -> str:
    """Whether the converter takes all the board gives."""
    if not v.converter_misses_v:
        return f"a converter for plus and minus {v.converter_v:g} V takes all of it"
    return (
        f"a converter for plus and minus {v.converter_v:g} V cuts the last {v.converter_misses_v:.2f} V off: divide "
        f"the signals ahead of it, or set detector.adc_range_v to {v.converter_v + v.converter_misses_v:.2f} at least"
    )


def converter_remarks(v: Limits) -> Iterator[str]:
    """A converter that clips the tactile voltage, as which slip does not show."""
    if v.max_tactile_v > v.converter_v:
        yield f"the tactile voltage, up to {v.max_tactile_v:.2f} V, is clipped: {converter_line(v)}."


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
