"""Catalogue of operational amplifiers for the board, read from `amplifiers.csv` with the source of every figure.

Figures listed in `unverified` were recalled from the data sheet, assumed, or derived; no document of the maker was read
for them. Read the data sheet of the part you buy.

The article's TL082 has a common-mode input range that ends 3 V above the negative rail (typical; the data sheet
guarantees 4 V), and below that its output reverses its phase and jumps up. All others have rail-to-rail inputs and
outputs and the same pins.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from fingertip.foundation.tables import load_table, read_rows


@dataclass(frozen=True)
class Amplifier:
    name: str
    symbol: str
    """Name of its symbol in KiCad's library: its own, or a dual amplifier's whose pins are drawn at the same places."""
    order_name: str
    """Name to order, with the grade."""
    bandwidth_hz: float
    """Gain-bandwidth product, typical [Hz]."""
    phase_margin_deg: float
    """Phase margin of a follower, typical [degree]. It places the second pole."""
    noise_v: float
    """White noise density at the input [V/sqrt(Hz)]."""
    offset_v: float
    max_offset_v: float
    """Maximum input offset voltage at 25 degrees Celsius [V], for the grade in `order_name`."""
    drift_v_per_k: float
    """Drift of the offset with the temperature [V/K]; the maximum where the data sheet states one."""
    output_from_rail_v: float
    """Distance from the rails at which the output stops [V], typical, into a light load (10 kohm)."""
    output_current_a: float
    """Peak output current that it may be asked for [A]; half of the short-circuit current where only that is stated."""
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
    units: ClassVar[Mapping[str, tuple[str, str, str]]] = {"a": ("3", "2", "1"), "b": ("5", "6", "7")}
    """Unit letter -> pins of non-inverting input, inverting input and output."""

    @functools.cached_property
    def second_pole_hz(self) -> float:
        """Frequency f2 of the second pole [Hz]: at unity gain it lags by 90 degrees less the phase margin."""
        lag = math.tan(math.radians(90.0 - self.phase_margin_deg))
        return self.bandwidth_hz / (lag * math.hypot(1.0, lag))

    def open_loop_gain(self, f_hz: float) -> complex:
        """Open-loop gain with two poles at a frequency [Hz]."""
        return 1.0 / ((1.0 / OPEN_LOOP_GAIN + 1j * f_hz / self.bandwidth_hz) * (1.0 + 1j * f_hz / self.second_pole_hz))


OPEN_LOOP_GAIN = 2e5
"""Open-loop gain A0 of the TL082 (typical, its data sheet): 106 dB. More, as the others have, changes no result."""

CATALOGUE: dict[str, Amplifier] = {
    amplifier.name: amplifier
    for amplifier in load_table(Amplifier, read_rows(Path(__file__).with_name("amplifiers.csv")))
}
"""Dual amplifiers by the name that `board.amplifier` gives them."""

AUTO = "auto"
ARTICLE_AMPLIFIER, RAIL_TO_RAIL_AMPLIFIER, LOW_OFFSET_AMPLIFIER = "TL082", "MCP6022", "OPA2376"
LOW_POWER_AMPLIFIER = "TLV2372"


def list_dual_amplifiers() -> tuple[Amplifier, ...]:
    """List the amplifiers that board.amplifier can name, the preferred ones first."""
    return tuple(sorted(CATALOGUE.values(), key=lambda amplifier: amplifier.preference))
