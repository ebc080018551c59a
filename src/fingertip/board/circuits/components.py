"""Constructors of the board's components by purpose: footprint and rating for purchase."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from fingertip.amplifiers import CATALOGUE
from fingertip.board.circuit import Component, Symbol, format_component_value
from fingertip.board.components.anti_aliasing import CLAMP, LOW_LEAKAGE_CLAMP, MAX_LOW_LEAKAGE_A
from fingertip.board.components.component_values import ComponentValues
from fingertip.board.kicad import symbols
from fingertip.board.parts.capacitors import BULK_CAPACITOR, SUPPLY_CAPACITOR, require_capacitor
from fingertip.board.parts.requirement import CapacitorRequirement, ResistorRequirement
from fingertip.board.parts.select_part import find_package

Wiring = Mapping[Component, Mapping[str, str]]
"""Component -> pin number -> net name."""

_PRECISION = ResistorRequirement(0.1, 0.1, 25.0)
_POWER_W = 0.1
_LOCKING_RATING = "keyed and locking, with its plug and crimped wires"
_HEADER_RATING = "pin header 2.54 mm, one row; or solder the wires"
_CLAMP_RATINGS = {
    CLAMP: symbols.BAT54S.description,
    LOW_LEAKAGE_CLAMP: f"Dual diode in series, SOT-23, leakage {1e9 * MAX_LOW_LEAKAGE_A:g} nA at most",
}


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
    return _resistor(reference, ohm, role, _PRECISION)


@dataclass(frozen=True)
class SelectedComponents:
    """Constructor of the components whose values are selected for the design, by reference, with its tolerances."""

    values: ComponentValues

    def bridge_resistor(self, reference: str, role: str) -> Component:
        """A precision resistor of the bridge."""
        return precision_resistor(reference, self.values.by_reference[reference], role)

    def resistor(self, reference: str, role: str, ohm: float | None = None) -> Component:
        """A resistor of the signal path; a value is given where none is selected."""
        requirement = ResistorRequirement(self.values.tolerance.resistor_percent, _POWER_W)
        return _resistor(reference, self.values.by_reference[reference] if ohm is None else ohm, role, requirement)

    def capacitor(self, reference: str, role: str) -> Component:
        """A capacitor in size 1206; above what the size offers for 16 V, one that has no direct voltage across it."""
        return self._capacitor(reference, role, symbols.C_1206)

    def small_capacitor(self, reference: str, role: str) -> Component:
        """A capacitor in size 0603."""
        return self._capacitor(reference, role, symbols.C_0603)

    def _capacitor(self, reference: str, role: str, footprint: str) -> Component:
        farad, stated_percent = self.values.by_reference[reference], self.values.tolerance.capacitor_percent
        requirement = require_capacitor(farad, find_package(footprint), stated_percent)
        return _chip_capacitor(reference, farad, role, footprint, requirement)


def supply_capacitor(reference: str, farad: float, role: str, footprint: str = symbols.C_0603) -> Component:
    """A decoupling capacitor between the rails, or in a larger size one that stores charge."""
    requirement = SUPPLY_CAPACITOR if footprint == symbols.C_0603 else BULK_CAPACITOR
    return _chip_capacitor(reference, farad, role, footprint, requirement)


def _resistor(reference: str, ohm: float, role: str, requirement: ResistorRequirement) -> Component:
    value = format_component_value(ohm)
    return Component(reference, value, symbols.RESISTOR, symbols.R_0603, role, requirement.rating, requirement)


def _chip_capacitor(
    reference: str, farad: float, role: str, footprint: str, requirement: CapacitorRequirement
) -> Component:
    value = format_component_value(farad)
    return Component(reference, value, symbols.CAPACITOR, footprint, role, requirement.rating, requirement)
