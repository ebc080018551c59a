"""The two ways a board is supplied: what its signals rest at, what its amplifiers hang between, and which these are.

On plus and minus 5 V signals rest at ground, as in the article. On 5 V alone they rest at a buffered half of it, to
which bridge, filters, rectifier, envelope and threshold return; and the amplifiers must reach both rails, which the
TL082 does not (its outputs stop 1.5 V before, its inputs earlier still).
"""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.board.circuit import Symbol
from fingertip.board.kicad import symbols
from fingertip.board.nets import GND, VEE, VMID


@dataclass(frozen=True)
class Supply:
    """One way of supplying the board."""

    name: str
    zero: str
    """Net at which signals rest and to which they return."""
    minus: str
    """Net of the amplifiers' negative supply pins."""
    amplifier: Symbol
    """Dual amplifier of filters and rectifier."""
    zero_share: float
    """Voltage of `zero` above ground, as a share of the supply."""
    from_rail_v: float
    """How far from its rails the amplifier's output stops [V], typical, into 2 to 10 kohm."""
    words: str

    def zero_v(self, supply_v: float) -> float:
        """Voltage [V] above ground at which signals rest."""
        return self.zero_share * supply_v

    def reach_v(self, supply_v: float) -> float:
        """From rest to the upper rail, and from the lower one to rest [V]."""
        return supply_v * (1.0 - self.zero_share)

    def swing_v(self, supply_v: float) -> float:
        """Largest peak [V] around its rest that an amplifier gives."""
        return self.reach_v(supply_v) - self.from_rail_v


SUPPLIES = {
    supply.name: supply
    for supply in (
        Supply("split", GND, VEE, symbols.TL082, 0.0, 1.5, "split supply"),
        Supply("single", VMID, GND, symbols.TLV2372, 0.5, 0.1, "single supply with buffered middle"),
    )
}
"""By name; a test holds the names against those the design file takes."""
