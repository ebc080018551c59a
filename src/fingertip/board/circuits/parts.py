"""Parts of a board by what they are for: footprint and what to look for when buying."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from fingertip.board.circuit import Part, Symbol, engineering
from fingertip.board.kicad import symbols
from fingertip.board.values.amplifiers import AMPLIFIERS
from fingertip.board.values.board_values import Tolerance
from fingertip.board.values.built import LARGE_PERCENT
from fingertip.design.filter_components import MAX_FOOTPRINT_F

Wiring = Mapping[Part, Mapping[str, str]]
"""Each part's pins -> nets."""

FINE = "0.1 %"
_BRIDGE_RATING = f"{FINE}, 25 ppm/K, 0.1 W"
_HEADER_RATING = "pin header 2.54 mm, one row; or solder the wires"
_SUPPLY_RATING = "X7R 25 V 10 %"
_LARGE_RATING = f"X5R or X7R, 6.3 V, {LARGE_PERCENT:g} %"
"""Of what stands across no direct voltage and sets no cutoff."""
_C0G_F = {symbols.C_1206: 100e-9, symbols.C_0603: 10e-9}
"""Up to these capacitances a size is made as C0G."""


def part(reference: str, value: str, symbol: Symbol, footprint: str, role: str) -> Part:
    """A part bought by its name."""
    rating = _HEADER_RATING if reference.startswith("J") else symbol.description
    return Part(reference, value, symbol, footprint, role, rating)


def amplifier(reference: str, name: str, role: str) -> Part:
    """A dual amplifier by its name in `AMPLIFIERS`; all that are used have the same pins."""
    data, symbol = AMPLIFIERS[name], symbols.DUAL_AMPLIFIERS[name]
    rating = f"{symbol.description}, offset {1e3 * data.max_offset_v:g} mV at most"
    return Part(reference, data.buy, symbol, symbols.SOIC_8, role, rating)


def bridge_resistor(reference: str, ohm: float, role: str) -> Part:
    """A resistor whose value sets a voltage."""
    return _resistor(reference, ohm, role, _BRIDGE_RATING)


@dataclass(frozen=True)
class Rated:
    """Makes the parts of the signal path, bought within the design's own tolerances."""

    tolerance: Tolerance

    def resistor(self, reference: str, ohm: float, role: str) -> Part:
        """A resistor."""
        return _resistor(reference, ohm, role, f"{_within(self.tolerance.resistor_percent)}, 0.1 W")

    def capacitor(self, reference: str, farad: float, role: str) -> Part:
        """A capacitor; above what carries a voltage in its size, one across which there is none."""
        if farad > MAX_FOOTPRINT_F * (1 + 1e-9):
            return Part(reference, engineering(farad), symbols.CAPACITOR, symbols.C_1206, role, _LARGE_RATING)
        return self._capacitor(reference, farad, role, symbols.C_1206)

    def small_capacitor(self, reference: str, farad: float, role: str) -> Part:
        """A small capacitor."""
        return self._capacitor(reference, farad, role, symbols.C_0603)

    def _capacitor(self, reference: str, farad: float, role: str, footprint: str) -> Part:
        kind = "C0G 25 V" if farad <= _C0G_F[footprint] * (1 + 1e-9) else "X7R 16 V"
        rating = f"{kind}, {_within(self.tolerance.capacitor_percent)}"
        return Part(reference, engineering(farad), symbols.CAPACITOR, footprint, role, rating)


def _within(percent: float) -> str:
    return f"{percent:g} % or better" if percent else "as fine as there is"


def supply_capacitor(reference: str, farad: float, role: str, footprint: str = symbols.C_0603) -> Part:
    """A capacitor between rails."""
    return Part(reference, engineering(farad), symbols.CAPACITOR, footprint, role, _SUPPLY_RATING)


def _resistor(reference: str, ohm: float, role: str, rating: str) -> Part:
    return Part(reference, engineering(ohm), symbols.RESISTOR, symbols.R_0603, role, rating)
