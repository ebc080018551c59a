"""The article's six flat surfaces: friction per newton of normal force, and roughness.

The roughness of the three metals is the article's (section III.C). The cutoff wavelength for a roughness is that of
ISO 4288, table 1 (Ra above 0.1 to 2 um: 0.8 mm; above 2 to 10 um: 2.5 mm). All other values are assumptions: the
article gives no friction coefficient and calls the roughness of the other surfaces unknown. Their order follows the
article (section IV): wood is rougher than paper and plastic, and smoother surfaces have less friction.
"""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.sim.contact.friction import Friction


@dataclass(frozen=True)
class Surface:
    """One test surface."""

    label: str
    """Name for reports."""
    roughness_um: float
    """Arithmetic mean deviation Ra of the profile [um]."""
    friction: Friction
    """Friction between the pad and this surface."""

    @property
    def cutoff_wavelength_m(self) -> float:
        """Longest wavelength that counts as roughness [m] (ISO 4288, table 1). Longer ones count as waviness."""
        return 0.8e-3 if self.roughness_um <= 2.0 else 2.5e-3


SURFACES: dict[str, Surface] = {
    "smooth": Surface("metal, Ra 0.2 um", 0.2, Friction(0.50, 0.40)),
    "medium": Surface("metal, Ra 0.8 um", 0.8, Friction(0.60, 0.48)),
    # "gross" is the article's word for its coarse metal; it has nothing to do with gross slip.
    "gross": Surface("metal, Ra 3.2 um", 3.2, Friction(0.75, 0.60)),
    "wood": Surface("wood", 5.0, Friction(0.70, 0.56)),
    "paper": Surface("book cover", 1.6, Friction(0.60, 0.48)),
    "plastic": Surface("smartphone cover, in the article also called rubber", 1.2, Friction(0.55, 0.44)),
}
