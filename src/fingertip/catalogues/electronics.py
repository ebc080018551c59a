"""Catalogues of force-sensing resistors (FSR), operational amplifiers and controllers.

They are read from `sensors.csv`, `amplifiers.csv` and `controllers.csv`, with the source of every
figure. Of sensors, [D] is Interlink Electronics' one-page data sheet of the model. Dimensions
listed in `unverified` were not found in a document of the maker, or differ between its editions.
Measure your own sensor before you print.

Figures of an amplifier listed in `unverified` were recalled from the data sheet, assumed, or
derived; no document of the maker was read for them. Read the data sheet of the part you buy. The
article's TL082 has a common-mode input range that ends 3 V above the negative rail (typical; the
data sheet guarantees 4 V), and below that its output reverses its phase and jumps up. All others
have rail-to-rail inputs and outputs and the same pins.
"""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, Literal

from fingertip.foundation.tables import load_table, read_rows

PART_TO_PART = (2.0, 8.0)
"""Factors by which the readings of real sensors of one model differ at the same force, from usual
to bad. Source: three sensors under 2.6 N in a divider with a converter of 10 bits gave 341 to 373
counts, and 45 to 54.
"""

HYSTERESIS = 0.10
"""Largest relative error by which a sensor's force reads high after a higher one (article, III.B:
at most 10 %).
"""
FILM_G_CM3 = 1.4
"""Density of a sensor, taken for that of its polyester films. (unverified)"""


@dataclass(frozen=True)
class ForceSensor:
    """Flat force-sensing resistor as bought: round head, and tail with two solder tabs."""

    model: str
    label: str
    active_diameter_mm: float
    head_diameter_mm: float
    thickness_mm: float
    length_mm: float
    """Length from the far edge of the head to the end of the tail [mm]."""
    tail_width_mm: float
    tab_pitch_mm: float
    source: str
    unverified: tuple[str, ...]
    """Names of the dimensions that no document of the maker confirms."""
    bundled_design: str = "fsr400"
    changes: tuple[str, ...] = ()
    """Changes of that design which the sensor needs."""
    short: str = ""
    """Model with a shorter tail."""
    maker: str = ""
    order_number: str = ""
    names: tuple[str, ...] = ()
    """Other names, as `plain_name` writes them."""
    fits: Literal["yes", "custom", "never"] = "yes"
    reason: str = ""
    """Reason why it does not fit, and what to do."""


def plain_name(text: str) -> str:
    """Reduce a name to its letters and digits, without the maker: "FSR-402" becomes "fsr402"."""
    name = re.sub("[^a-z0-9]", "", text.lower())
    return re.sub("^(arduino|raspberrypi|stm32|interlink)", "", name)


_ROWS = tuple(read_rows(Path(__file__).with_name("sensors.csv")))


def _index_by_name() -> dict[str, dict[str, str]]:
    """Index the rows of `sensors.csv` by every name that people give a sensor."""
    rows = {}
    for row in _ROWS:
        for name in (row["model"], row["label"], *row["names"].split()):
            rows[plain_name(name)] = row

    return rows


_BY_NAME = _index_by_name()
SENSORS = {
    sensor.model: sensor
    for sensor in load_table(ForceSensor, (row for row in _ROWS if row["fits"] == "yes"))
}


def spell_sensor(word: str) -> str:
    """Spell the name of a sensor as the catalogue does: "FSR-402" becomes "fsr402".

    Other words stay as they are.
    """
    model = _BY_NAME.get(plain_name(word), {}).get("model", word)
    return model if model in SENSORS else word


def explain_sensor(word: str) -> str:
    """Explain why a sensor that people know is not in the catalogue.

    Returns an empty text for a sensor of the catalogue, and for a word that names none.
    """
    row = _BY_NAME.get(plain_name(word))
    if row is None or row["fits"] == "yes":
        return ""

    how = "fits as custom" if row["fits"] == "custom" else "never fits"
    return f"the {row['label']} {how}: {row['reason']}"


@dataclass(frozen=True)
class Amplifier:
    """Dual operational amplifier, with the figures of its data sheet."""

    name: str
    symbol: str
    """Symbol in KiCad's library: its own, or one whose pins are drawn at the same places."""
    order_name: str
    """Name to order, with the grade."""
    bandwidth_hz: float
    """Gain-bandwidth product, typical [Hz]."""
    phase_margin_deg: float
    """Phase margin of a follower, typical [degree]. It places the second pole."""
    slew_v_per_s: float
    """Largest rate of the output, typical [V/s]."""
    noise_v: float
    """White noise density at the input [V/sqrt(Hz)]."""
    noise_corner_hz: float
    """Frequency at which 1/f noise equals it [Hz]."""
    offset_v: float
    max_offset_v: float
    """Maximum input offset voltage at 25 degrees Celsius [V], for the grade in `order_name`."""
    drift_v_per_k: float
    """Drift of the offset with the temperature [V/K].
    The maximum where the data sheet states one.
    """
    output_from_rail_v: float
    """Distance from the rails at which the output stops [V], typical, into a light load (10 kohm).
    """
    output_current_a: float
    """Peak output current that it may be asked for [A].
    Half of the short-circuit current where only that is stated.
    """
    min_supply_v: float
    max_supply_v: float
    """Range of the voltage between both supply pins [V]."""
    supply_current_a: float
    """Supply current of each unit [A], typical; the maximum where only that is stated."""
    input_f: float
    """Capacitance of each input to ground [F]: common-mode and differential together."""
    unverified: tuple[str, ...]
    """Names of the figures that no document read confirms."""
    input_from_lower_v: tuple[float, float]
    """Distance from the lower rail that the inputs must keep [V]: typical and guaranteed."""
    preference: int
    """Place in the order in which a remedy offers them, from 1."""
    source: str
    """Documents of the other figures."""
    units: ClassVar[Mapping[str, tuple[str, str, str]]] = {
        "a": ("3", "2", "1"),
        "b": ("5", "6", "7"),
    }
    """Unit letter -> pins of non-inverting input, inverting input and output."""

    @functools.cached_property
    def second_pole_hz(self) -> float:
        """Frequency f2 of the second pole [Hz], whose lag at unity gain is 90 degrees less the
        phase margin.
        """
        lag = math.tan(math.radians(90.0 - self.phase_margin_deg))
        return self.bandwidth_hz / (lag * math.hypot(1.0, lag))

    def open_loop_gain(self, f_hz: float) -> complex:
        """Open-loop gain with two poles at a frequency [Hz]."""
        return 1.0 / (
            (1.0 / OPEN_LOOP_GAIN + 1j * f_hz / self.bandwidth_hz)
            * (1.0 + 1j * f_hz / self.second_pole_hz)
        )


OPEN_LOOP_GAIN = 2e5
"""Open-loop gain A0 of the TL082 (typical, its data sheet): 106 dB.
More, as the others have, changes no result.
"""

AMPLIFIER_CATALOGUE: dict[str, Amplifier] = {
    amplifier.name: amplifier
    for amplifier in load_table(Amplifier, read_rows(Path(__file__).with_name("amplifiers.csv")))
}
"""Dual amplifiers by the name that `board.amplifier` gives them."""

AUTO = "auto"
ARTICLE_AMPLIFIER = "TL082"
RAIL_TO_RAIL_AMPLIFIER = "MCP6022"
LOW_OFFSET_AMPLIFIER = "OPA2376"
LOW_POWER_AMPLIFIER = "TLV2372"


def list_dual_amplifiers() -> tuple[Amplifier, ...]:
    """List the amplifiers that board.amplifier can name, the preferred ones first."""
    return tuple(sorted(AMPLIFIER_CATALOGUE.values(), key=lambda amplifier: amplifier.preference))


NAMES = ("thumb", "index", "middle", "ring", "little")
"""Fingers that one controller reads, in the order of its inputs and of a board's channels."""


def split_finger(name: str) -> tuple[str, str]:
    """Split "fingers.thumb.skin.width_mm" into finger and parameter.

    The finger is empty for a parameter that holds for all of them.
    """
    words = name.split(".", 2)
    return (words[1], words[2]) if words[0] == "fingers" and len(words) == 3 else ("", name)


@dataclass(frozen=True)
class ControllerBoard:
    """Controller's board that can be bought, with its Arduino core where the examples need one."""

    key: str
    """Name for the command line."""
    name: str
    processor: str
    clock_mhz: float
    """Clock, of the slowest board of the row."""
    has_floats: bool
    """True if the processor computes floats itself."""
    adc_bits: int
    """Resolution with which the library reads the analog inputs."""
    adc_hardware_bits: int
    """Resolution of the converter itself."""
    adc_from_v: float
    adc_to_v: float
    """Range of the analog inputs [V]."""
    timer: Literal["yes", "no", "in the sketch", "too slow"]
    """Place of its timer: in `slip_timer.h`, nowhere, or in the sketch for dividers alone.
    "too slow" marks a controller that cannot run the library.
    """
    note: str
    inputs: tuple[str, ...]
    """Analog inputs that are free, as its core names them."""
    ram_kb: int
    convert_us: float
    """Time in which one input is converted [us]: by `analogRead`, or in a scan by DMA."""
    has_scan: bool
    """True if the converter scans all inputs by itself, and the interrupt waits for none."""
    names: tuple[str, ...] = ()
    """Other names, as `plain_name` writes them."""

    @property
    def converter(self) -> str:
        """Resolution and range of the analog inputs, such as "12 bits, 0 to 3.3 V"."""
        bits = f"{self.adc_bits}"
        if self.adc_hardware_bits != self.adc_bits:
            bits = f"{bits} of {self.adc_hardware_bits}"

        return f"{bits} bits, {self.adc_from_v:g} to {self.adc_to_v:g} V"

    @property
    def core(self) -> str:
        """Processor, its clock, and whether it computes floats itself."""
        floats = "with floats" if self.has_floats else "floats in software"
        return f"{self.processor} at {self.clock_mhz:g} MHz, {floats}"


@functools.cache
def load_controllers() -> tuple[ControllerBoard, ...]:
    return load_table(ControllerBoard, read_rows(Path(__file__).with_name("controllers.csv")))


def list_keys() -> tuple[str, ...]:
    """List the controllers that run the library, by their names for the command line."""
    return tuple(board.key for board in load_controllers() if board.timer != "too slow")
