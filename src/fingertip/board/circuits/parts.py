"""Parts of a board by what they are for: footprint and what to look for when buying."""

from __future__ import annotations

from collections.abc import Mapping

from fingertip.board.circuit import Part, Symbol, engineering
from fingertip.board.kicad import symbols
from fingertip.board.values.amplifiers import AMPLIFIERS

Wiring = Mapping[Part, Mapping[str, str]]
"""Each part's pins -> nets."""

FINE = "0.1 %"
_FILTER_RATING = "1 % or better, 0.1 W"
_BRIDGE_RATING = f"{FINE}, 25 ppm/K, 0.1 W"
_SIGNAL_RATING = "film or C0G where the size allows, else X7R 16 V 10 % or better"
_HEADER_RATING = "pin header 2.54 mm, one row; or solder the wires"
_SUPPLY_RATING = "X7R 25 V 10 %"
_SMALL_RATING = "C0G 5 %, 25 V"


def part(reference: str, value: str, symbol: Symbol, footprint: str, role: str) -> Part:
    """A part bought by its name."""
    rating = _HEADER_RATING if reference.startswith("J") else symbol.description
    return Part(reference, value, symbol, footprint, role, rating)


def amplifier(reference: str, name: str, role: str) -> Part:
    """A dual amplifier by its name in `AMPLIFIERS`; all that are used have the same pins."""
    data, symbol = AMPLIFIERS[name], symbols.DUAL_AMPLIFIERS[name]
    rating = f"{symbol.description}, offset {1e3 * data.most_offset_v:g} mV at most"
    return Part(reference, data.buy, symbol, symbols.SOIC_8, role, rating)


def filter_resistor(reference: str, ohm: float, role: str) -> Part:
    """A resistor of the signal path."""
    return _resistor(reference, ohm, role, _FILTER_RATING)


def bridge_resistor(reference: str, ohm: float, role: str) -> Part:
    """A resistor whose value sets a voltage."""
    return _resistor(reference, ohm, role, _BRIDGE_RATING)


def signal_capacitor(reference: str, farad: float, role: str) -> Part:
    """A capacitor of the signal path."""
    return Part(reference, engineering(farad), symbols.CAPACITOR, symbols.C_1206, role, _SIGNAL_RATING)


def small_capacitor(reference: str, farad: float, role: str) -> Part:
    """A small capacitor of the signal path."""
    rating = _SMALL_RATING if farad <= 10e-9 else _SIGNAL_RATING
    return Part(reference, engineering(farad), symbols.CAPACITOR, symbols.C_0603, role, rating)


def supply_capacitor(reference: str, farad: float, role: str, footprint: str = symbols.C_0603) -> Part:
    """A capacitor between rails."""
    return Part(reference, engineering(farad), symbols.CAPACITOR, footprint, role, _SUPPLY_RATING)


def _resistor(reference: str, ohm: float, role: str, rating: str) -> Part:
    return Part(reference, engineering(ohm), symbols.RESISTOR, symbols.R_0603, role, rating)
