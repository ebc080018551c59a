"""The two ways a board is supplied: what its signals rest at, what its amplifiers hang between, and which these are.

On plus and minus 5 V signals rest at ground, as in the article. On 5 V alone they rest at a buffered half of it, to
which bridge, filters, rectifier, envelope and threshold return; and the amplifiers must reach both rails
(`fingertip.board.values.amplifiers`).
"""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.board.nets import GND, VEE, VMID


@dataclass(frozen=True)
class Supply:
    """One way of supplying the board."""

    name: str
    zero: str
    """Net at which signals rest and to which they return."""
    minus: str
    """Net of the amplifiers' negative supply pins."""
    zero_share: float
    """Voltage of `zero` above ground, as a share of the supply."""
    words: str

    def zero_v(self, supply_v: float) -> float:
        """Voltage [V] above ground at which signals rest."""
        return self.zero_share * supply_v

    def reach_v(self, supply_v: float) -> float:
        """From rest to the upper rail [V]."""
        return supply_v * (1.0 - self.zero_share)

    def lower_reach_v(self, supply_v: float) -> float:
        """From the lower rail to rest [V]."""
        return supply_v * self.zero_share if self.zero_share else supply_v


SUPPLIES = {
    supply.name: supply
    for supply in (
        Supply("split", GND, VEE, 0.0, "split supply"),
        Supply("single", VMID, GND, 0.5, "single supply with buffered middle"),
    )
}
"""By name; a test holds the names against those the design file takes."""
