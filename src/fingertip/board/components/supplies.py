"""The supplies of a board: signal ground, negative rail of the amplifiers, supply of the bridge, and headroom of each.

On a split supply of plus and minus 5 V, signal ground is supply ground (0 V), as in the article. On a single supply of
5 V or 3.3 V it is VMID (buffered mid-supply, `fingertip.design.formulas.filter`). Bridge, filters, rectifier, envelope
and threshold refer to it, and the amplifiers need rail-to-rail inputs and outputs (`fingertip.catalogues.amplifiers`).

The board for 3.3 V is made for the controller of a hand: its outputs stay within the supply, its connectors are keyed
and lock, a reversed supply does no harm, and the bridge is fed from VREF, a buffered ratio of the supply without its
ripple.
"""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.board.parts.circuit import GND, VCC, VEE, VMID, VREF
from fingertip.design.formulas.filter import CONTROLLER_SUPPLIES, signal_ground_ratio


@dataclass(frozen=True)
class Supply:
    """One way of supplying the board."""

    name: str
    signal_ground: str
    """Net to which the signals refer."""
    negative_rail: str
    """Net of the amplifiers' negative supply pins."""
    description: str
    """Short description for titles."""
    nominal_v: float
    """Nominal supply voltage [V]."""
    bridge_supply: str
    """Net that feeds the bridge."""
    signal_ground_ratio: float
    """Voltage of the signal ground above ground, as a ratio of the supply voltage."""
    is_for_controller: bool
    """True for a board for a controller: protected, with the filtered signal at its output too."""

    def signal_ground_v(self, supply_v: float) -> float:
        """Voltage of the signal ground above ground [V]."""
        return self.signal_ground_ratio * supply_v

    def upper_headroom_v(self, supply_v: float) -> float:
        """Voltage from the signal ground to the upper rail [V]."""
        return supply_v * (1.0 - self.signal_ground_ratio)

    def lower_headroom_v(self, supply_v: float) -> float:
        """Voltage from the lower rail to the signal ground [V]."""
        return supply_v * self.signal_ground_ratio if self.signal_ground_ratio else supply_v


SUPPLIES = {
    name: Supply(name, *properties, signal_ground_ratio(name), name in CONTROLLER_SUPPLIES)
    for name, properties in {
        "split": (GND, VEE, "split supply", 5.0, VCC),
        "single": (VMID, GND, "single supply with buffered mid-supply", 5.0, VCC),
        "single_3v3": (VMID, GND, "3.3 V supply with buffered mid-supply", 3.3, VREF),
    }.items()
}
"""Supplies by name. A test compares the names with those that the design file accepts."""
