"""The article's six flat surfaces: friction per newton of normal force, and roughness.

Roughness of the three metals: article, section III.C. The cutoff wavelength that belongs to a roughness:
ISO 4288, table 1 (Ra above 0.1 to 2 um: 0.8 mm; above 2 to 10 um: 2.5 mm). Everything else is an
assumption: the article gives no friction coefficient and calls the other surfaces' roughness unknown. Only
their order follows it (section IV): wood is rougher than paper and plastic; the smoother a surface, the
smaller its friction.
"""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.sim.contact.tangential import Friction


@dataclass(frozen=True)
class Surface:
    """One test surface."""

    label: str
    roughness_um: float
    """Arithmetic mean deviation Ra of the profile [um]."""
    friction: Friction

    @property
    def cutoff_wavelength_m(self) -> float:
        """Longest wavelength that still counts as roughness [m] (ISO 4288, table 1); longer is waviness."""
        return 0.8e-3 if self.roughness_um <= 2.0 else 2.5e-3


SURFACES: dict[str, Surface] = {
    "smooth": Surface("metal, Ra 0.2 um", 0.2, Friction(0.50, 0.40)),
    "medium": Surface("metal, Ra 0.8 um", 0.8, Friction(0.60, 0.48)),
    "gross": Surface("metal, Ra 3.2 um", 3.2, Friction(0.75, 0.60)),
    "wood": Surface("wood", 5.0, Friction(0.70, 0.56)),
    "paper": Surface("book cover", 1.6, Friction(0.60, 0.48)),
    "plastic": Surface("smartphone cover (the article also says rubber)", 1.2, Friction(0.55, 0.44)),
}
