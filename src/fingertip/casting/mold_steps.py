"""Steps at the mold: try the parts, hold bone or core, fill, open and trim. Each says how to see that it went well."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fingertip.casting.step import Step

Data = Mapping[str, Any]


def list_trying_steps(data: Data) -> list[Step]:
    """List the steps that try and prepare the printed mold, before anything is sealed or mixed."""
    fit, chaplet, insert = data["fit"], data["chaplet"], data["insert"]
    steps = [
        Step(
            "cure_test",
            "Test the cure: put a drop of the mixed silicone on a spare piece of each print, washed and post-cured, "
            "and on the tape. After the full cure it must peel off dry. If it is tacky, wash and post-cure again, or "
            "coat the prints.",
        ),
        Step("close_empty", "Close the empty mold. It closes only one way. No light may show along the parting line."),
        Step(
            "try_fit",
            f"Lay the {insert} in the recess of the palmar half and close the mold again. If a gap stays open, scrape "
            f"the recess where it shines, never the {insert}. Its base may have {fit['clearance_mm']:g} mm of play on "
            f"each side, and {fit['surface_error_mm']:g} mm of error on each surface: a strip of office paper beside "
            "the base must keep the mold from closing.",
        ),
    ]
    if chaplet:
        steps.append(
            Step(
                "drill",
                f"Drill the hole in the boss of the dorsal half to {chaplet['hole_mm']:g} mm, and that in the "
                f"{insert} to {chaplet['pilot_mm']:g} mm, no deeper than {chaplet['pilot_depth_mm']:g} mm: mark the "
                f"drill with tape, because the sensor lies below. Drive the {chaplet['thread']} screw once into the "
                f"{insert} and out again, so that it cuts its thread. It must bite after two turns.",
            )
        )
    steps.append(
        Step(
            "release",
            "Wipe a thin film of mold release for silicone on cavity and parting plane, and wipe it off until the "
            "surface looks dry. Leave the end of the boss and the recess bare: air leaves through the gap beside the "
            "collar. "
            + (
                "Treat the core alike."
                if insert == "core"
                else "Clean the bone with isopropanol, and brush a primer for silicone on what the skin covers, but "
                "not on the sensor. Without primer nothing but a groove holds the skin."
            ),
        )
    )
    return steps


def list_seat_steps(data: Data) -> list[Step]:
    """List the step that seals the seat of bone or core; none without a tape."""
    tape, insert = data["fit"]["seat_tape"], data["insert"]
    if tape is None:
        return []
    where = f"from {tape['from_mm']:g} to {tape['to_mm']:g} mm below the edge of the skin"
    covered = ""
    if insert == "bone" and data["sensor_tail"] == "folded":
        wires = "between the cheeks" if data["wires_between_cheeks"] else "in their groove"
        covered = f", over both openings of the window and over the wires {wires}"
    return [
        Step(
            "seat_tape",
            f"Wind one turn of polyimide tape around the {insert}, {where}{covered}. Use tape of "
            f"{tape['thickness_mm']:g} mm with its adhesive, and let the ends meet without overlapping. It fills the "
            f"gap between the {insert} and its recess, and silicone stops there. Close the mold once more: if it no "
            "longer closes by hand, the tape is creased or doubled. This tape is temporary.",
        )
    ]


def list_filling_steps(data: Data, weighing: str) -> list[Step]:
    """List the steps from the open mold to the cured silicone."""
    properties = data["silicone"]["properties"]
    return [
        Step("hold", _describe_holding(data)),
        Step(
            "bolt",
            f"Fit the palmar half and tighten the {data['mold']['bolts']} mold bolts by hand, crosswise, until the "
            "parting line shows no gap. Do not tighten further.",
        ),
        *_testing_steps(data),
        Step("weigh", weighing),
        *(_syringe_steps(data) if data["filling"]["syringe"] else _gravity_steps(data)),
        Step(
            "cure",
            f"Let it cure for {properties['cure_h']['high']:g} h at room temperature, tip up. Before you open the "
            "mold, test the leftover silicone in the cup with a fingernail: no mark may stay.",
        ),
    ]


def _describe_holding(data: Data) -> str:
    """Write the step that places bone or core in the mold."""
    fit, chaplet, insert = data["fit"], data["chaplet"], data["insert"]
    if chaplet is None:
        return (
            f"Lay the {insert} in the recess of the palmar half. Nothing holds its tip: it can lie off until "
            f"{fit['min_skin_held_mm']:g} mm of silicone are left (design: {fit['min_skin_design_mm']:g} mm)."
        )
    return (
        f"Put the {insert} into the dorsal half, its facet on the boss, with a strip of paper between them. Drive the "
        f"{chaplet['thread']} x {chaplet['length_mm']:g} mm screw from outside until the paper is held fast, pull it "
        f"out, and turn on until the facet touches the boss. The {insert} must not move. So held it can lie off until "
        f"{fit['retained_over_sensor_percent']:g} % of the skin are left over the sensor, "
        f"{fit['retained_elsewhere_percent']:g} % elsewhere and some {fit['min_skin_held_mm']:g} mm at the thinnest "
        f"place (design: {fit['min_skin_design_mm']:g} mm)."
    )


def _testing_steps(data: Data) -> list[Step]:
    """List the last tests of the closed mold, while everything can still be opened."""
    syringe, steps = data["filling"]["syringe"], list[Step]()
    if syringe:
        steps.append(
            Step(
                "try_syringe",
                f"Push the nozzle of the empty {syringe['volume_ml']:g} ml syringe into the cone and press. It must "
                "sit without rocking. With fingers on the other vents, air must leave through each one. Pass a wire "
                "through a vent that is closed.",
            )
        )
    if data["insert"] == "bone":
        steps.append(
            Step(
                "measure",
                "Measure the sensor once more. This is the last moment at which the mold can be opened again.",
            )
        )
    return steps


def _syringe_steps(data: Data) -> list[Step]:
    """List the steps that fill the mold from below."""
    filling, vents = data["filling"], data["mold"]["vents"]
    syringe = filling["syringe"]
    openings = "the vent" if vents == 1 else f"all {vents} vents"
    return [
        Step(
            "degas",
            "Degas the mixture under vacuum until it has risen and fallen again. Without vacuum, let a thin stream run "
            "from high above into a second cup, tap the cup, and wait some minutes.",
        ),
        Step(
            "load_syringe",
            f"Pull the plunger out, close the nozzle with a finger, and pour {filling['load_cm3']:g} cm3 into the "
            f"barrel; the mold takes {filling['injected_cm3']:g} cm3. Put the plunger back beside a thin wire, which "
            "lets the air out. Hold the nozzle up for a minute, and press the rest of the air out.",
        ),
        Step(
            "fill",
            "Hold the mold tip up in a vise or a stand, by the two sides with the pry slots, leaning back until the "
            "vent near the tip is its highest point. Hold the syringe in its cone with the other hand and press with "
            f"a steady thumb. At {syringe['thumb_n']:g} N silicone of {filling['viscosity_pa_s']:g} Pa s fills the "
            f"mold in some {filling['fill_s']:g} s; the plunger's friction makes it longer. It may take half the pot "
            f"life, {filling['allowed_s']:g} s, and no more, because stirring and degassing take the rest: choose a "
            f"slow silicone. Go on until silicone stands in {openings}, then stop. Pressing on would only load the "
            "bone.",
        ),
        Step(
            "leave",
            "Leave the syringe in its cone until the silicone has set. If it sinks in a vent, press gently once more.",
        ),
    ]


def _gravity_steps(data: Data) -> list[Step]:
    """List the steps that pour the silicone."""
    filling, vents, insert = data["filling"], data["mold"]["vents"], data["insert"]
    pot_life = data["silicone"]["properties"]["pot_life_min"]
    return [
        Step(
            "stand",
            f"Stand the mold funnel up, with the exposed end of the {insert} pointing down, over a cup that catches "
            "drips. A vise may hold it by the two sides with the pry slots, where no bolt protrudes.",
        ),
        Step(
            "pour",
            f"Within {pot_life['low']:g} min of the start of stirring, pour a thin stream into the funnel until "
            f"silicone rises in the {vents} mold vents. It takes some {filling['fill_s']:g} s for "
            f"{filling['viscosity_pa_s']:g} Pa s. Tap the mold and top it up.",
        ),
    ]


def list_opening_steps(data: Data) -> list[Step]:
    """List the steps from the cured silicone to the trimmed skin."""
    opening = []
    if data["filling"]["syringe"]:
        opening.append("Twist the syringe out of its cone.")
    if data["chaplet"]:
        opening.append(f"Take out the screw of the {data['insert']}.")
    opening.append(
        "Take out the bolts. Twist a screwdriver in the pry slots, alternating between the two sides, and lift the "
        "halves straight off. Push the finger out of the second half at its exposed end, never at the skin. Cut the "
        "runner at the side of the finger and the vent stubs with a sharp knife, flush, and remove any flash around "
        "the base. None of them lies on the pad."
    )
    return [Step("open", " ".join(opening))]


def list_patching_steps(data: Data) -> list[Step]:
    """List the step that closes the hole of the chaplet, on the finished finger."""
    chaplet = data["chaplet"]
    if chaplet is None:
        return []
    return [
        Step(
            "patch",
            f"A round hole of {chaplet['diameter_mm']:g} mm is left on the dorsal side, where a nail would be. Wipe "
            "it and the facet with isopropanol, and fill it with a second small mixture, level with the skin. It "
            "fills the hole of the screw too, which anchors it. No object is touched with it. Let it cure.",
        )
    ]
