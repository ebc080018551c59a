"""Steps at the mold: try the parts, hold bone or core, fill, open and trim. Each says how to see that it went well."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

Data = Mapping[str, Any]


def list_trying_steps(data: Data) -> list[str]:
    """List the steps that try and prepare the printed mold, before anything is sealed or mixed."""
    fit, chaplet, insert = data["fit"], data["chaplet"], data["insert"]
    steps = [
        "Close the empty mold. It closes only one way. No light may show along the parting line.",
        f"Lay the {insert} in the recess of the palmar half and close the mold again. If a gap stays open, scrape the "
        f"recess where it shines, never the {insert}. If the {insert} rocks, print it again: its base may have no more "
        f"play than {fit['clearance_mm']:g} mm on each side, and {fit['surface_error_mm']:g} mm of error on each "
        "surface.",
    ]
    if chaplet:
        steps.append(
            f"Drill the hole in the boss of the dorsal half to {chaplet['hole_mm']:g} mm and that in the {insert} to "
            f"{chaplet['pilot_mm']:g} mm. Drive the {chaplet['thread']} screw once into the {insert} and out again, so "
            "that it cuts its thread. It must bite after two turns."
        )
    syringe = data["filling"]["syringe"]
    if syringe:
        steps.append(
            f"Push the nozzle of the {syringe['volume_ml']:g} ml syringe into the cone of the dorsal half and blow "
            "air through it. It must sit without rocking, and air must leave through every vent."
        )
    steps.append(
        "Wipe a thin film of mold release (for silicone, or petroleum jelly) on cavity, parting plane and recess. "
        + ("Treat the core alike." if insert == "core" else "Keep it off the bone, to which the skin shall stick.")
    )
    return steps


def list_filling_steps(data: Data, weighing: str) -> list[str]:
    """List the steps from the closed mold to the cured silicone."""
    filling, chaplet, insert = data["filling"], data["chaplet"], data["insert"]
    fit, properties = data["fit"], data["silicone"]["properties"]
    held = (
        [
            f"Put the {insert} into the dorsal half, its facet on the boss. Drive the {chaplet['thread']} x "
            f"{chaplet['length_mm']:g} mm screw from outside until the facet touches the boss, and no further. Pull at "
            f"the {insert}: it must not move. So held it can lie off until {fit['retained_over_sensor_percent']:g} % "
            f"of the skin are left over the sensor, {fit['retained_elsewhere_percent']:g} % elsewhere and "
            f"{fit['min_skin_held_mm']:g} mm at the thinnest place (design: {fit['min_skin_design_mm']:g} mm)."
        ]
        if chaplet
        else [
            f"Lay the {insert} in the recess of the palmar half. Nothing holds its tip: it can lie off until "
            f"{fit['min_skin_held_mm']:g} mm of silicone are left (design: {fit['min_skin_design_mm']:g} mm)."
        ]
    )
    return [
        *held,
        f"Fit the palmar half and tighten the {data['mold']['bolts']} mold bolts by hand, crosswise, until the parting "
        "line shows no gap. Do not tighten further.",
        weighing,
        *(_syringe_steps(data) if filling["syringe"] else _gravity_steps(data)),
        f"Let it cure for {properties['cure_h']['high']:g} h at room temperature, tip up. Before you open the mold, "
        "test the leftover silicone in the cup with a fingernail: no mark may stay.",
    ]


def _syringe_steps(data: Data) -> list[str]:
    """List the steps that fill the mold from below."""
    filling = data["filling"]
    syringe, vents = filling["syringe"], data["mold"]["vents"]
    openings = "the vent" if vents == 1 else f"all {vents} vents"
    return [
        "Degas the mixture under vacuum until it has risen and fallen again. Without vacuum, let a thin stream run "
        "from high above into a second cup, tap the cup, and wait some minutes.",
        f"Pull the plunger out, pour at least {filling['injected_cm3']:g} cm3 into the barrel, put the plunger back, "
        "hold the nozzle up and press the air out.",
        f"Stand the mold tip up. Push the nozzle into its cone and press with a steady thumb. At some "
        f"{syringe['thumb_n']:g} N silicone of {filling['viscosity_pa_s']:g} Pa s fills the mold in "
        f"{filling['fill_s']:g} s, and it must be full within half the pot life, {filling['allowed_s']:g} s. Go on "
        f"until silicone stands in {openings}, then stop: the mold is full, and pressing on would only load the bone.",
        "Leave the syringe in its cone until the silicone has set. If it sinks in a vent, press gently once more.",
    ]


def _gravity_steps(data: Data) -> list[str]:
    """List the steps that pour the silicone."""
    filling, vents, insert = data["filling"], data["mold"]["vents"], data["insert"]
    pot_life = data["silicone"]["properties"]["pot_life_min"]
    return [
        f"Stand the mold funnel up, with the exposed end of the {insert} pointing down, over a cup that catches drips. "
        "A vise may hold it by the two sides with the pry slots, where no bolt protrudes.",
        f"Within {pot_life['low']:g} min of the start of stirring, pour a thin stream into the funnel until silicone "
        f"rises in the {vents} mold vents. It takes some {filling['fill_s']:g} s for {filling['viscosity_pa_s']:g} "
        "Pa s. Tap the mold and top it up.",
    ]


def list_opening_steps(data: Data) -> list[str]:
    """List the steps from the cured silicone to the trimmed skin."""
    chaplet, insert = data["chaplet"], data["insert"]
    first = f"Take out the screw of the {insert} first, then the mold bolts. " if chaplet else "Take out the bolts. "
    steps = [
        first + "Twist a screwdriver in the pry slots, alternating between the two sides, and lift the halves straight "
        "off. Cut the runner at the side of the finger and the vent stubs with a sharp knife, flush, and remove any "
        "flash around the base. None of them lies on the pad.",
    ]
    if chaplet and insert == "core":
        steps.append(
            f"A round hole of {chaplet['diameter_mm']:g} mm is left on the dorsal side. Fill it when the skin sits on "
            "the bone, with a fresh mixture, level with the skin."
        )
    elif chaplet:
        steps.append(
            f"A round hole of {chaplet['diameter_mm']:g} mm is left on the dorsal side, where a nail would be. Press a "
            "plug of wax into the screw's hole in the bone, and fill the hole in the skin with a fresh mixture, level "
            "with the skin. No object is touched with it."
        )
    return steps
