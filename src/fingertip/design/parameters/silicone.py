"""Parameters of the silicone that the skin is cast from."""

from __future__ import annotations

from typing import Literal

from fingertip.design.parameters.declaration import ParameterTable, choice, quantity, text
from fingertip.silicones import SiliconeName


class ChosenSilicone(ParameterTable):
    """Silicone of the skin. All figures below product are used only if it is "own"; copy them from your data sheet."""

    product: Literal[SiliconeName, "own"] = choice(
        "addition_40a", "Silicone from the catalogue, or own: the figures below then describe it."
    )
    label: str = text(
        "own silicone",
        "Name of the product, for the casting sheet.",
        pattern=r"^[^\s|`<>][^\r\n|`<>]{0,59}$",
        allowed="write up to 60 characters, without | ` < >",
    )
    cure: Literal["addition", "condensation"] = choice(
        "addition", "Cure system: addition (platinum; inhibited by uncured resin) or condensation (tin)."
    )
    ratio_by: Literal["weight", "volume"] = choice(
        "weight", "Whether the container states the mix ratio by weight or by volume."
    )
    parts_a: float = quantity(
        10.0, "", "Parts of part A, or base, in the mix ratio on the container.", minimum=0.1, maximum=1000
    )
    parts_b: float = quantity(
        1.0, "", "Parts of part B, catalyst or curing agent, in the same ratio.", minimum=0.1, maximum=1000
    )
    viscosity_pa_s: float = quantity(
        25.0, "Pa s", "Viscosity of the mixture; 1000 cps or mPa s are 1 Pa s.", minimum=0.05, maximum=500
    )
    density_g_cm3: float = quantity(
        1.08, "g/cm3", "Density of the mixture, or specific gravity.", minimum=0.8, maximum=2.5
    )
    pot_life_min: float = quantity(
        30.0, "min", "Pot life at room temperature, from the start of stirring.", minimum=1, maximum=1440
    )
    cure_h: float = quantity(
        24.0, "h", "Time at room temperature until the skin can be demolded.", minimum=0.1, maximum=336
    )
    shore_a: float = quantity(40.0, "", "Hardness of the cured silicone, Shore A.", minimum=1, maximum=95)
    modulus_mpa: float = quantity(
        1.0,
        "MPa",
        "Young's modulus at small strain; without one, the stress at 100 % strain (145 psi are 1 MPa).",
        minimum=0.01,
        maximum=50,
    )
    elongation_percent: float = quantity(300.0, "%", "Elongation at break.", minimum=10, maximum=2000)
    shrinkage_percent: float = quantity(0.2, "%", "Linear shrinkage; 0.001 in/in are 0.1 %.", minimum=0, maximum=5)
