"""Tables of scene and manipulation files that describe the path from force to samples."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal

from pydantic import Field

from fingertip.design.parameters import ParameterTable, choice, quantity
from fingertip.foundation.errors import Issue

MIN_BITS = 8
"""Smallest resolution of a converter."""
MIN_RANGE_V = 0.01
"""Smallest range of a converter [V]."""


class Drift(ParameterTable):
    """Slow changes of sensor and amplifier."""

    share_per_decade: float = quantity(
        0.0, "", "Creep: relative increase per decade of time (data sheet: below 0.05).", minimum=0, maximum=0.2
    )
    volt_per_s: float = quantity(
        0.0, "V/s", "Drift of the amplifier with temperature. Assumption.", minimum=-0.1, maximum=0.1
    )


class Cable(ParameterTable):
    """Touch of the cable; 0 V means none."""

    step_v: float = quantity(0.0, "V", "Jump when the touch begins, and back when it ends.", minimum=-1, maximum=1)
    decay_s: float = quantity(0.05, "s", "Decay time of the jump. Assumption.", minimum=0.001, maximum=10)
    hum_v: float = quantity(0.0, "V", "Amplitude of the mains hum during the touch.", minimum=0, maximum=1)
    hum_hz: float = quantity(50.0, "Hz", "Mains frequency.", minimum=16, maximum=60)
    at_s: float = quantity(1.0, "s", "Start, after the holding force is reached. Assumption.", minimum=0, maximum=600)
    duration_s: float = quantity(0.5, "s", "Duration. Assumption.", minimum=0.01, maximum=600)


class Noise(ParameterTable):
    """Noise that is not white, added to the tactile voltage for the whole recording; 0 V means none."""

    pink_v: float = quantity(
        0.0,
        "V",
        "RMS pink noise per decade of frequency, of sensor and amplifier; 1e-4 is a noisy film.",
        minimum=0,
        maximum=0.1,
        verified=False,
    )
    hand_v: float = quantity(
        0.0,
        "V",
        "RMS vibration of a hand from 30 to 90 Hz while it touches; 1e-4 to 5e-4 in hands.",
        minimum=0,
        maximum=0.1,
        verified=False,
    )
    hum_v: float = quantity(0.0, "V", "Amplitude of the mains hum's fundamental.", minimum=0, maximum=1)
    hum_hz: float = quantity(50.0, "Hz", "Mains frequency.", minimum=16, maximum=60)
    hum_third: float = quantity(
        0.3, "", "Amplitude of the third harmonic, relative to the fundamental.", minimum=0, maximum=1, verified=False
    )
    hum_fifth: float = quantity(
        0.15, "", "Amplitude of the fifth harmonic, relative to the fundamental.", minimum=0, maximum=1, verified=False
    )


class Sensing(ParameterTable):
    """Conversion of force to voltage."""

    bridge: Literal["board", "article"] = choice(
        "board", "The design's bridge and amplifier; or, for comparison, a curve through the article's voltages."
    )
    amplifiers: Literal["ideal", "rails", "gain_bandwidth"] = choice(
        "ideal", "Amplifiers of the filter: ideal, limited at their rails, or with the design's gain-bandwidth product."
    )
    noise: bool = Field(True, description="Whether the board's amplifiers and the ADC add white noise.")
    jitter_s: float = quantity(
        0.0,
        "s",
        "RMS sampling jitter of the ADC; 0: none (assumption: a data acquisition card's).",
        minimum=0,
        maximum=1e-4,
    )


class ConverterInput(ParameterTable):
    """Converter that samples in place of the design's ADC; 0 bits mean the design's."""

    bits: int = Field(0, ge=0, le=24, description="Resolution: 10 or 12 in most microcontrollers; 0: the design's ADC.")
    low_v: float = quantity(0.0, "V", "Lower end of its range.", minimum=-100, maximum=100 - MIN_RANGE_V)
    high_v: float = quantity(
        5.0, "V", "Upper end of its range: 3.3 or 5 in most microcontrollers.", minimum=-100 + MIN_RANGE_V, maximum=100
    )


def find_converter_issues(converter: ConverterInput) -> Iterator[tuple[Issue, set[str]]]:
    """Yield each broken rule of a converter, with the names of the parameters it reads."""
    fields = {"converter.bits", "converter.low_v", "converter.high_v"}
    min_v = round(converter.low_v + MIN_RANGE_V, 6)
    if converter.bits and converter.high_v < min_v:
        message = f"{converter.high_v:g} V leaves no range above converter.low_v; at least {min_v:.9g} V."
        yield Issue("converter.high_v", message), fields
    if 0 < converter.bits < MIN_BITS:
        yield Issue("converter.bits", f"{converter.bits} is too small; choose {MIN_BITS} to 24, or 0."), fields
    unused = ConverterInput()
    if not converter.bits and (converter.low_v, converter.high_v) != (unused.low_v, unused.high_v):
        message = "0 leaves the design's ADC in place, so the range has no effect; choose 12, or leave the range out."
        yield Issue("converter.bits", message), fields


def find_converter_warnings(converter: ConverterInput, min_v: float, max_v: float) -> Iterator[str]:
    """Yield a warning if a converter clips a voltage that lies between two limits [V]."""
    if converter.low_v <= min_v and max_v <= converter.high_v:
        return
    cut = "all of it" if max_v <= converter.low_v or min_v >= converter.high_v else "what lies outside"
    yield (
        f"the tactile voltage lies between {min_v:.2f} V (20 N) and {max_v:.2f} V (no force), and a converter from "
        f"{converter.low_v:g} to {converter.high_v:g} V clips {cut}: divide the voltage ahead of the converter, which "
        f"divides slip too, or choose a range up to converter.high_v={math.ceil(10 * max_v) / 10:g}."
    )
