"""The two supplies of a board: signal ground, negative rail of the amplifiers, and headroom of each.

On a split supply of plus and minus 5 V, signal ground is supply ground (0 V), as in the article. On a single supply of
5 V it is VMID (buffered mid-supply). Bridge, filters, rectifier, envelope and threshold refer to it, and the amplifiers
need rail-to-rail inputs and outputs (`fingertip.amplifiers`).
"""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.board.nets import GND, VEE, VMID


@dataclass(frozen=True)
class Supply:
    """One way of supplying the board."""

    name: str
    signal_ground: str
    """Net to which the signals refer."""
    negative_rail: str
    """Net of the amplifiers' negative supply pins."""
    signal_ground_ratio: float
    """Voltage of the signal ground above ground, as a ratio of the supply voltage."""
    description: str
    """Short description for titles."""

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
    supply.name: supply
    for supply in (
        Supply("split", GND, VEE, 0.0, "split supply"),
        Supply("single", VMID, GND, 0.5, "single supply with buffered mid-supply"),
    )
}
"""Supplies by name. A test compares the names with those that the design file accepts."""
