"""Requirement for purchase of a resistor or a capacitor, apart from its value and package."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ResistorRequirement:
    """Requirement for a resistor."""

    tolerance_percent: float
    """Largest tolerance [%]; 0 asks for the tightest that exists."""
    power_w: float
    """Smallest rated power [W]."""
    drift_ppm_per_k: float | None = None
    """Largest temperature coefficient [ppm/K]; None if any will do."""

    @property
    def rating(self) -> str:
        """Requirement in words, for bills of materials."""
        power = f"{self.power_w:g} W"
        if self.drift_ppm_per_k is None:
            return f"{_format_tolerance(self.tolerance_percent)}, {power}"
        return f"{self.tolerance_percent:g} %, {self.drift_ppm_per_k:g} ppm/K, {power}"


@dataclass(frozen=True)
class CapacitorRequirement:
    """Requirement for a capacitor."""

    dielectrics: tuple[str, ...]
    """Permitted dielectrics."""
    voltage_v: float
    """Smallest rated voltage [V]."""
    tolerance_percent: float
    """Largest tolerance [%]; 0 asks for the tightest that exists."""

    @property
    def rating(self) -> str:
        """Requirement in words, for bills of materials."""
        return f"{' or '.join(self.dielectrics)} {self.voltage_v:g} V, {_format_tolerance(self.tolerance_percent)}"


Requirement = ResistorRequirement | CapacitorRequirement


def _format_tolerance(percent: float) -> str:
    return f"{percent:g} % or better" if percent else "tightest available"
