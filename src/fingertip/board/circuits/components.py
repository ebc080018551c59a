"""Constructors of the board's components by purpose: footprint and rating for purchase."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from fingertip.amplifiers import CATALOGUE
from fingertip.board.circuit import Component, Symbol, format_component_value
from fingertip.board.components.anti_aliasing import CLAMP, LOW_LEAKAGE_CLAMP, MAX_LOW_LEAKAGE_A
from fingertip.board.components.component_values import ComponentValues
from fingertip.board.components.filter import LARGE_CAPACITOR_PERCENT
from fingertip.board.kicad import symbols
from fingertip.design.filter_components import MAX_1206_F

Wiring = Mapping[Component, Mapping[str, str]]
"""Component -> pin number -> net name."""

PRECISION_TOLERANCE = "0.1 %"
_BRIDGE_RATING = f"{PRECISION_TOLERANCE}, 25 ppm/K, 0.1 W"
_LOCKING_RATING = "keyed and locking, with its plug and crimped wires"
_HEADER_RATING = "pin header 2.54 mm, one row; or solder the wires"
_SUPPLY_RATING = "X7R 25 V 10 %"
_LARGE_RATING = f"X5R or X7R, 6.3 V, {LARGE_CAPACITOR_PERCENT:g} %"
"""Rating of large capacitors without direct voltage across them that set no cutoff."""
_CLAMP_RATINGS = {
    CLAMP: symbols.BAT54S.description,
    LOW_LEAKAGE_CLAMP: f"Dual diode in series, SOT-23, leakage {1e9 * MAX_LOW_LEAKAGE_A:g} nA at most",
}
_MAX_C0G_F = {symbols.C_1206: 100e-9, symbols.C_0603: 10e-9}
"""Largest capacitance that each size is made with as C0G."""


def component(reference: str, value: str, symbol: Symbol, footprint: str, role: str) -> Component:
    """A component that is purchased by its name."""
    rating = symbol.description
    if reference.startswith("J"):
        rating = _LOCKING_RATING if footprint in symbols.LOCKING_CONNECTORS else _HEADER_RATING
    return Component(reference, value, symbol, footprint, role, rating)


def clamp(reference: str, name: str, role: str) -> Component:
    """A clamp of an output: two diodes in series by their name in `anti_aliasing`. All of them have the same pins."""
    return Component(reference, name, symbols.BAT54S, symbols.SOT_23, role, _CLAMP_RATINGS[name])


def amplifier(reference: str, name: str, role: str) -> Component:
    """A dual amplifier by its name in `CATALOGUE`. All of them have the same pins."""
    data, symbol = CATALOGUE[name], symbols.DUAL_AMPLIFIERS[name]
    rating = f"{symbol.description}, offset {1e3 * data.max_offset_v:g} mV at most"
    return Component(reference, data.order_name, symbol, symbols.SOIC_8, role, rating)


def precision_resistor(reference: str, ohm: float, role: str) -> Component:
    """A precision resistor, whose value determines a voltage."""
    return _resistor(reference, ohm, role, _BRIDGE_RATING)


@dataclass(frozen=True)
class SelectedComponents:
    """Constructor of the components whose values are selected for the design, by reference, with its tolerances."""

    values: ComponentValues

    def bridge_resistor(self, reference: str, role: str) -> Component:
        """A precision resistor of the bridge."""
        return precision_resistor(reference, self.values.by_reference[reference], role)

    def resistor(self, reference: str, role: str, ohm: float | None = None) -> Component:
        """A resistor of the signal path; a value is given where none is selected."""
        rating = f"{_format_tolerance(self.values.tolerance.resistor_percent)}, 0.1 W"
        return _resistor(reference, self.values.by_reference[reference] if ohm is None else ohm, role, rating)

    def capacitor(self, reference: str, role: str) -> Component:
        """A capacitor in size 1206; above what the size offers for 16 V, one that has no direct voltage across it."""
        farad = self.values.by_reference[reference]
        if farad > MAX_1206_F * (1 + 1e-9):
            return Component(
                reference, format_component_value(farad), symbols.CAPACITOR, symbols.C_1206, role, _LARGE_RATING
            )
        return self._capacitor(reference, role, symbols.C_1206)

    def small_capacitor(self, reference: str, role: str) -> Component:
        """A capacitor in size 0603."""
        return self._capacitor(reference, role, symbols.C_0603)

    def _capacitor(self, reference: str, role: str, footprint: str) -> Component:
        farad = self.values.by_reference[reference]
        dielectric = "C0G 25 V" if farad <= _MAX_C0G_F[footprint] * (1 + 1e-9) else "X7R 16 V"
        rating = f"{dielectric}, {_format_tolerance(self.values.tolerance.capacitor_percent)}"
        return Component(reference, format_component_value(farad), symbols.CAPACITOR, footprint, role, rating)


def _format_tolerance(percent: float) -> str:
    return f"{percent:g} % or better" if percent else "tightest available"


def supply_capacitor(reference: str, farad: float, role: str, footprint: str = symbols.C_0603) -> Component:
    """A decoupling capacitor between the rails."""
    return Component(reference, format_component_value(farad), symbols.CAPACITOR, footprint, role, _SUPPLY_RATING)


def _resistor(reference: str, ohm: float, role: str, rating: str) -> Component:
    return Component(reference, format_component_value(ohm), symbols.RESISTOR, symbols.R_0603, role, rating)
