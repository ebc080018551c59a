"""Parameters of the finger: sensor with its force curve, skin with its silicone. Defaults are the FSR 400 finger's."""

from __future__ import annotations

from typing import Literal

from fingertip.catalogues.sensors import PART_TO_PART, SensorName
from fingertip.catalogues.silicones import SILICONES, MaterialProperty, Silicone, SiliconeName
from fingertip.design.parameters.declaration import ParameterTable, choice, quantity, text


class Sensor(ParameterTable):
    """Force-sensing resistor, and its pocket in the bone."""

    model: Literal[SensorName, "custom"] = choice(
        "fsr400", "Force-sensing resistor from the catalogue, or custom: [custom_sensor] then holds its outline."
    )
    distance_from_tip_mm: float = quantity(
        11.5, "mm", "Distance from the tip of the skin to the centre of the active area.", minimum=3, maximum=60
    )
    tail: Literal["straight", "folded"] = choice(
        "straight",
        "straight: out through the base; folded: once around the bone, its end in a trough under a lid.",
    )
    fold_radius_mm: float = quantity(
        2.5, "mm", "Radius at which a folded tail bends; Interlink allows no less than 2.5.", minimum=0.8, maximum=6
    )
    tab_length_mm: float = quantity(
        4.3, "mm", "Length by which the crimped tabs stick out of the film.", minimum=0, maximum=15, verified=False
    )
    crimp_height_mm: float = quantity(
        0.6,
        "mm",
        "Height of crimps and solder above the film, for the space of a folded tail.",
        minimum=0.2,
        maximum=5,
        verified=False,
    )
    wire_diameter_mm: float = quantity(
        0.5, "mm", "Outer diameter of the wires on the tabs of a folded tail.", minimum=0.1, maximum=3
    )
    clearance_mm: float = quantity(0.15, "mm", "Gap around the sensor in its pocket and slot.", minimum=0.02, maximum=1)
    adhesive_thickness_mm: float = quantity(
        0.13,
        "mm",
        "Thickness of the adhesive film under the sensor; it deepens the pocket.",
        minimum=0,
        maximum=0.5,
        verified=False,
    )


class CustomSensor(ParameterTable):
    """Outline of a sensor that is not in the catalogue; used only if sensor.model is "custom"."""

    active_diameter_mm: float = quantity(5.08, "mm", "Diameter of the active area.", minimum=1, maximum=40)
    head_diameter_mm: float = quantity(7.62, "mm", "Diameter of the round head.", minimum=2, maximum=50)
    thickness_mm: float = quantity(0.3, "mm", "Thickness of head and tail.", minimum=0.05, maximum=3)
    length_mm: float = quantity(
        38.0, "mm", "Length from the far edge of the head to the end of the tail.", minimum=5, maximum=150
    )
    tail_width_mm: float = quantity(6.4, "mm", "Width of the tail.", minimum=1, maximum=30)


class Skin(ParameterTable):
    """Outer shape of the silicone skin, and its thickness over the bone."""

    width_mm: float = quantity(17.0, "mm", "Full width at the proximal end.", minimum=6, maximum=60)
    semi_axis_palmar_mm: float = quantity(
        6.0, "mm", "Height of the pad, measured from the parting plane.", minimum=2, maximum=40
    )
    semi_axis_dorsal_mm: float = quantity(
        7.0, "mm", "Height of the dorsal side, measured from the parting plane.", minimum=2, maximum=40
    )
    length_mm: float = quantity(34.0, "mm", "Length from the proximal end to the tip.", minimum=8, maximum=120)
    tip_length_mm: float = quantity(10.0, "mm", "Length of the rounded tip, part of the length.", minimum=2, maximum=60)
    taper_ratio: float = quantity(
        0.94,
        "",
        "Size of the cross-section where the tip begins, relative to the proximal end.",
        minimum=0.4,
        maximum=1,
    )
    pulp_fullness: float = quantity(
        0.8845,
        "",
        "Width of the pulp at half its height, relative to the full width (0.5: triangle, 0.866: ellipse, 1: box).",
        minimum=0.77,
        maximum=0.9925,
    )
    nail_fullness: float = quantity(
        0.875,
        "",
        "Width of the nail side at half its height, relative to the full width.",
        minimum=0.77,
        maximum=0.9925,
    )
    tip_fullness: float = quantity(
        0.875,
        "",
        "Size of the cross-section halfway along the rounded tip, relative to where the tip begins.",
        minimum=0.77,
        maximum=0.9925,
    )
    thickness_side_mm: float = quantity(2.0, "mm", "Skin thickness at the sides.", minimum=0.4, maximum=15)
    thickness_palmar_mm: float = quantity(
        3.0,
        "mm",
        "Skin thickness over the centre of the sensor, from the bone's flat to the pad's surface.",
        minimum=0.4,
        maximum=20,
    )
    thickness_dorsal_mm: float = quantity(1.5, "mm", "Skin thickness on the dorsal side.", minimum=0.4, maximum=15)
    thickness_tip_mm: float = quantity(
        2.5, "mm", "Skin thickness at the tip, distal to the bone.", minimum=0.4, maximum=20
    )
    min_thickness_mm: float = quantity(
        0.8, "mm", "Minimum skin thickness anywhere, measured from bone to surface.", minimum=0.2, maximum=10
    )


OWN = "own"
"""Name that stands for the user's own silicone."""
_COMPONENTS = {"addition": ("part A", "part B"), "condensation": ("base", "catalyst")}
"""Names of the components of a silicone of one's own, by its cure system."""
_STATED = (
    "parts_a", "parts_b", "viscosity_pa_s", "density_g_cm3", "shore_a", "modulus_mpa", "shrinkage_percent",
    "pot_life_min", "cure_h", "elongation_percent",
)  # fmt: skip
"""Properties of a silicone of one's own, which the table states by the same names."""


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

    @property
    def material(self) -> Silicone:
        """Silicone of the catalogue, or the one that the user's own figures describe."""
        if self.product != OWN:
            return SILICONES[self.product]
        stated = {name: MaterialProperty(value := getattr(self, name), value, "design") for name in _STATED}
        return Silicone(OWN, self.label, self.cure, _COMPONENTS[self.cure], self.ratio_by, **stated)


TURN_ON_N = 0.2
"""Force [N] below which a typical sensor is open: 20 gram force (Interlink; light contact in the article)."""


class ForceCurve(ParameterTable):
    """Conductance of the sensor over force; the figures are used only if curve is "calibrated"."""

    curve: Literal["typical", "calibrated"] = choice(
        "typical",
        "typical: Interlink's curve, from which real sensors differ by factors; calibrated: the figures below, which "
        "`fingertip calibrate sensor` finds.",
    )
    turn_on_n: float = quantity(TURN_ON_N, "N", "Force at which the sensor begins to conduct.", minimum=0, maximum=5)
    conductance_us: float = quantity(
        190.0, "uS", "Conductance at a force of 1 N above turn_on_n.", above=0, maximum=1e5
    )
    exponent: float = quantity(
        0.52, "", "Exponent of the conductance over the force above turn_on_n.", minimum=0.1, maximum=3
    )
    min_force_n: float = quantity(0.5, "N", "Smallest force of the calibration.", above=0, maximum=100)
    max_force_n: float = quantity(10.0, "N", "Largest force of the calibration.", above=0, maximum=1000)
    interval_factor: float = quantity(
        8.0,
        "",
        "Factor within which a force read off the curve lies with 95 % probability, between these two forces.",
        minimum=1,
        maximum=1000,
    )

    def describe(self) -> str:
        """Describe in a sentence how far forces can be trusted, for wherever a force is shown."""
        if self.curve == "calibrated":
            return (
                f"forces hold for the calibrated sensor, within a factor of {self.interval_factor:.3g} (95 %) between "
                f"{self.min_force_n:g} and {self.max_force_n:g} N"
            )
        usual, bad = PART_TO_PART
        return (
            f"forces hold for a typical sensor; the readings of real ones differ by a factor of {usual:g} to {bad:g} "
            "at the same force, so calibrate yours: fingertip calibrate sensor"
        )
