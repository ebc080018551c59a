"""Steps at the mold: try the parts, hold bone or core, fill, open and trim. Each says how to see that it went well."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fingertip.casting.step import Step
from fingertip.casting.supplies import VENT_WIRE

Data = Mapping[str, Any]

_LEAST_TURN_DEG = 10.0
"""Sideways turn of the mold that is worth a word."""


def list_trying_steps(data: Data) -> list[Step]:
    """List the steps that try and prepare the printed mold, before anything is sealed or mixed."""
    fit, chaplet, insert = data["fit"], data["chaplet"], data["insert"]
    papers = "one strip of office paper" if fit["papers"] == 1 else f"{fit['papers']} strips of office paper"
    papers += f" ({fit['paper_mm']:g} mm each)" if fit["papers"] > 1 else f" ({fit['paper_mm']:g} mm)"
    plunger = " and the plunger of the syringe" if data["filling"]["syringe"] else ""
    steps = [
        Step(
            "cure_test",
            "Test the cure a day ahead: mix a small quantity, and put a drop on a spare piece of each print, washed "
            "and post-cured, and on everything else that silicone will touch: tape, adhesive, varnish, "
            f"primer{plunger}. After the full cure each must peel off dry. Replace what leaves it tacky; wash and "
            "post-cure prints again, or coat them.",
        ),
        Step("close_empty", "Close the empty mold. It closes only one way. No light may show along the parting line."),
        Step(
            "try_fit",
            f"Lay the {insert} in the recess of the palmar half and close the mold again. If a gap stays open, scrape "
            f"the recess where it shines, never the {insert}. Sideways its base may have {fit['max_play_mm']:g} mm of "
            f"play in all: {papers} beside it must jam or not go in.",
        ),
    ]
    if chaplet:
        sensor_below = ", because the sensor lies below" if insert == "bone" else ""
        steps.append(
            Step(
                "drill",
                f"Drill the hole in the boss of the dorsal half to {chaplet['hole_mm']:g} mm, and that in the "
                f"{insert} to {chaplet['pilot_mm']:g} mm, no deeper than {chaplet['pilot_depth_mm']:g} mm: mark the "
                f"drill with tape{sensor_below}. Drive the {chaplet['thread']} screw once into the "
                f"{insert} and out again, so that it cuts its thread. It must bite after two turns.",
            )
        )
    steps.append(
        Step(
            "release",
            "Wipe a thin film of mold release for silicone on cavity and parting plane with a lint-free cloth, and "
            "wipe it off until the surface looks dry. Leave boss and recess bare: the patch has to stick where the "
            "boss stood, and no tape holds on release." + (" Treat the core alike." if insert == "core" else ""),
        )
    )
    return steps


def list_seat_steps(data: Data) -> list[Step]:
    """List the step that seals the seat of bone or core; none without a tape."""
    tape, insert = data["fit"]["seat_tape"], data["insert"]
    if tape is None:
        return []
    where = f"from {tape['from_mm']:g} to at most {tape['to_mm']:g} mm below the edge of the skin"
    covered = over_tail = ""
    joint = ", on the side away from the runner: the last air beside the collar leaves there"
    joint = joint if data["filling"]["syringe"] else ""
    if insert == "bone" and data["sensor_tail"] == "straight" and data["mold"]["tail_passes_collar"]:
        over_tail = (
            f"Lay a strip of baking paper on the bare film there first, so that the tape does not lift it: narrower "
            f"than the slot of {data['fit']['slot_mm']:g} mm, lying inside it, never on the flat. "
        )
    if insert == "bone" and data["sensor_tail"] == "folded":
        wires = "between the cheeks" if data["wires_between_cheeks"] else "in their groove"
        covered = f", over both openings of the window and over the wires {wires}"
    return [
        Step(
            "seat_tape",
            f"Wind one turn of polyimide tape around the {insert}, {where}{covered}. Use tape of "
            f"{tape['thickness_mm']:g} mm with its adhesive. Let its ends meet, without overlapping{joint}. The tape "
            f"fills the gap between the {insert} and its recess, and silicone stops there. {over_tail}Close the mold "
            "once more: it must close by hand, or the tape is creased or one turn too many. Now no strip of office "
            f"paper ({data['fit']['paper_mm']:g} mm) may go in beside the {insert}; if one does, wind one more turn. "
            "This tape is temporary.",
        )
    ]


def list_priming_steps(data: Data) -> list[Step]:
    """List the step that makes the silicone stick to the bone, just before it is cast; none for a core."""
    if data["insert"] == "core":
        return []
    return [
        Step(
            "prime",
            "Degrease the bone with isopropanol, and brush a primer for silicone on what the skin will cover, but not "
            "on the tape over the sensor. Let it dry as its maker says, touch it no more, and cast within its open "
            "time. Without primer nothing but a groove holds the skin.",
        )
    ]


def list_filling_steps(data: Data, weighing: str) -> list[Step]:
    """List the steps from the open mold to the cured silicone."""
    properties = data["silicone"]["properties"]
    return [
        *list_priming_steps(data),
        Step("hold", _describe_holding(data)),
        Step(
            "bolt",
            f"Fit the palmar half and tighten the {data['mold']['bolts']} mold bolts by hand, crosswise, until the "
            "parting line shows no gap. Do not tighten further. A strip of tape keeps the nuts in their traps.",
        ),
        *_testing_steps(data),
        Step("weigh", weighing),
        *(_syringe_steps(data) if data["filling"]["syringe"] else _gravity_steps(data)),
        Step(
            "cure",
            f"Let it cure for {properties['cure_h']['high']:g} h at room temperature in the same pose. Before you "
            "open the mold, test the leftover silicone in the cup with a fingernail: no mark may stay.",
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
    each = "the vent" if data["mold"]["vents"] == 1 else "each vent, with fingers on the others"
    if syringe:
        steps.append(
            Step(
                "try_syringe",
                f"Push the nozzle of the empty {syringe['volume_ml']:g} ml syringe into the cone and press. It must "
                f"sit without rocking, and air must leave through {each}. Pass a wire through a vent that is closed. "
                f"Measure the bore of its nozzle with the shanks of drills: the times below hold for "
                f"{syringe['nozzle_bore_mm']:g} mm, and a nozzle of three quarters of that takes three times as long.",
            )
        )
    if data["insert"] == "bone":
        steps.append(
            Step(
                "measure",
                "Measure the untouched sensor once more: above 1 Mohm. This is the last moment at which the mold can "
                "be opened again.",
            )
        )
    return steps


def _syringe_steps(data: Data) -> list[Step]:
    """List the steps that fill the mold from below."""
    filling, vents = data["filling"], data["mold"]["vents"]
    syringe = filling["syringe"]
    openings = "the vent" if vents == 1 else f"all {vents} vents"
    closing = "" if vents == 1 else "; close each with a finger as soon as it is full"
    return [
        Step(
            "degas",
            "Degas the mixture under vacuum until it has risen and fallen again. Without vacuum, let a thin stream run "
            "from high above into a second cup, tap the cup, and wait some minutes.",
        ),
        Step(
            "load_syringe",
            "Pull the plunger out, cap the nozzle, and let "
            f"{filling['load_cm3']:g} cm3 of the mixture run down the wall of the tilted barrel, without folding air "
            f"in; the mold takes {filling['injected_cm3']:g} cm3. Put the plunger back beside a {VENT_WIRE}, "
            "which lets the air out. Hold the nozzle up for a minute, and press the rest of the air out.",
        ),
        Step(
            "fill",
            f"Hold the mold tip up in a vise or a stand, by the two sides with the pry slots. {_describe_pose(data)} "
            "Hold the syringe in its cone with the other hand and press with a steady "
            f"thumb. At {syringe['thumb_n']:g} N silicone of {filling['viscosity_pa_s']:g} Pa s fills the mold in some "
            f"{filling['fill_s']:g} s; the plunger's friction makes it longer. It may take "
            f"{filling['limit_min']:g} min, half the pot life, and no more. Go on until silicone without bubbles "
            f"stands in {openings}, and then stop{closing}. Pressing on would only load the {data['insert']}.",
        ),
        Step(
            "leave",
            "Leave the syringe in its cone, propped up, until the silicone has set. If it sinks in a vent, press "
            "gently once more.",
        ),
    ]


def _describe_pose(data: Data) -> str:
    """Describe how the mold leans so that its first vent is the highest point of the cavity."""
    filling = data["filling"]
    text = f"Lean it back by {filling['lean_deg']:g} degrees, dorsal side up"
    if filling["turn_deg"] >= _LEAST_TURN_DEG:
        side = "with" if filling["runner_side_up"] else "away from"
        text += f", and turn it by {filling['turn_deg']:g} degrees, the side {side} the runner up"
    return f"{text}: the vent near the tip is its highest point then, and bubbles rise to it."


def _gravity_steps(data: Data) -> list[Step]:
    """List the steps that pour the silicone."""
    filling, vents, insert = data["filling"], data["mold"]["vents"], data["insert"]
    return [
        Step(
            "stand",
            f"Stand the mold funnel up, with the exposed end of the {insert} pointing down, over a cup that catches "
            "drips. A vise may hold it by the two sides with the pry slots, where no bolt protrudes.",
        ),
        Step(
            "pour",
            f"Within {filling['pot_life_min']:g} min of the start of stirring, pour a thin stream into the funnel "
            f"until silicone rises in the {vents} mold vents. It takes some {filling['fill_s']:g} s for "
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
            f"A round hole of {chaplet['diameter_mm']:g} mm is left on the dorsal side, where a nail would be. "
            "Degrease it twice with isopropanol, prime its floor, and fill it with a second small mixture: first the "
            "hole of the screw, from its bottom up with a blunt needle, which anchors the patch, and then the rest, "
            "level with the skin. No object is touched with it. Let it cure.",
        )
    ]
