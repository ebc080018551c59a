"""Steps at the mold: try the parts, hold bone or core, fill, open and trim. Each says how to see that it went well."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fingertip.casting.consumables import uses_adhesive, uses_primer
from fingertip.design.interfaces import INTERFACES
from fingertip.documents.casting.sheet import Step
from fingertip.page.html import join

Data = Mapping[str, Any]

_LEAST_ROLL_DEG = 3.0
"""Roll of the mold that is worth a word: a hand holds it no truer."""


def list_trying_steps(data: Data) -> list[Step]:
    """List the steps that try and prepare the printed mold, before anything is sealed or mixed."""
    fit, chaplet, insert = data["fit"], data["chaplet"], data["insert"]
    sanded = "the foot of its collar and its facet" if chaplet else "the foot of its collar"
    papers = "one strip of office paper" if fit["papers"] == 1 else f"{fit['papers']} strips of office paper"
    papers += f" ({fit['paper_mm']:g} mm each)" if fit["papers"] > 1 else f" ({fit['paper_mm']:g} mm)"
    steps = [
        Step("cure_test", _describe_cure_test(data)),
        Step("close_empty", "Close the empty mold. It closes only one way. No light may show along the parting line."),
        Step(
            "try_fit",
            f"Lay the {insert} in the recess of the palmar half and close the mold again. If a gap stays open, scrape "
            f"the recess where it shines, never the {insert}, of which only {sanded} may be sanded, if its drawing "
            "says "
            f"so. Sideways its base may have {fit['max_play_mm']:g} mm of "
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
    if data["filling"]["syringe"]:
        steps.append(Step("try_cone", _describe_trying_cone(data)))
    return [*steps, Step("release", _describe_release(data))]


def _describe_trying_cone(data: Data) -> str:
    """Write the step that tries and reams the Luer cone, while nothing is in the mold."""
    syringe = data["filling"]["syringe"]
    vents = "the vent" if data["mold"]["vents"] == 1 else "each vent"
    return (
        f"Put the nozzle of the empty {syringe['volume_ml']:g} ml syringe into the Luer cone of the closed, empty "
        f"mold. It must go in by some {syringe['nozzle_depth_mm']:g} mm and sit without rocking. If it does not, ream "
        "the cone: turn the nozzle in it with a strip of fine sandpaper around it, and wipe off the dust. Open the "
        f"mold and pass a {VENT_WIRE} through {vents} and the hole of the cone; drill out what has "
        "closed. Measure the bore of the nozzle with the shanks of drills: the times of filling hold for "
        f"{syringe['nozzle_bore_mm']:g} mm, and a nozzle of three quarters of that takes three times as long."
    )


def _describe_cure_test(data: Data) -> str:
    """Write the step that tests the cure on what the silicone touches: some of it must bond, some must not."""
    insert, peeling = data["insert"], ["bare print", "released print", "tape"]
    others = ["the tape"]
    if data["filling"]["syringe"]:
        others.append("the plunger of the syringe")
        peeling.append("plunger")
    bonding = []
    if uses_primer(data):
        others.append("a piece of print with primer")
        bonding.append("primer")
    if uses_adhesive(data):
        others.append("cured adhesive")
        bonding.append("adhesive")
    if insert == "bone" and data["sensor_tail"] == "folded":
        others.append("varnish")
    anew = (
        f" If it peels off {' or '.join(bonding)}, roughen the print with sandpaper, clean it and test once more, or "
        f"test another product, until it holds."
        if bonding
        else ""
    )
    bonds = f" On {join(bonding)} it must not peel off: it is meant to bond there." if bonding else ""
    return (
        "Test the cure ahead, when the plan says: mix a small quantity, and put drops on a spare piece of each print, "
        "washed and post-cured: the fit coupon, its frame in the mold's material and its slice in that of the "
        f"{insert}. Put one on the bare print and one on print with mold release, and more on {join(others)}. "
        "After the full cure every drop must be dry, underneath too. "
        f"On {join(peeling)} the silicone must peel off dry.{bonds} Replace what leaves it tacky; wash and post-cure "
        f"prints again, or coat them.{anew}"
    )


def _describe_release(data: Data) -> str:
    """Write the step that rubs the mold with release."""
    ways = "runner, " if data["filling"]["syringe"] else "gate, funnel, "
    vents = "vent" if data["mold"]["vents"] == 1 else "vents"
    bare, why = "the recess", "no tape holds on release"
    if data["chaplet"]:
        bare = "the face of the boss and the recess"
        why = "the patch has to stick to the facet that lies on the boss, and " + why
    return (
        f"Wipe a thin film of mold release for silicone on cavity, parting plane, {ways}{vents} and keys with a "
        f"lint-free cloth, and wipe it off until the surface looks dry. Leave only {bare} bare: {why}."
        + (" Treat the core alike." if data["insert"] == "core" else "")
    )


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
    facet = " and not on the facet, which sits on the boss" if data["chaplet"] else ""
    return [
        Step(
            "prime",
            "Hold the bone with its tip down, so that nothing runs under the tape or through the "
            f"{'window' if data['sensor_tail'] == 'folded' else 'cable channel'} to the sensor. Degrease it with a "
            "cloth that is damp with isopropanol, not wet, and with a nearly dry brush lay a thin coat of primer on "
            f"what the skin will cover, but not on the tape over the sensor{facet}. Let it dry as its maker says, "
            f"touch it no more, and cast within its open time. Without primer {_name_held(data)} the skin.",
        )
    ]


def _name_held(data: Data) -> str:
    """Write what holds the skin besides adhesion."""
    held = data["skin_held_by"]
    return f"nothing but {join(held)} holds" if held else "nothing holds"


def list_filling_steps(data: Data, weighing: str) -> list[Step]:
    """List the steps from the open mold to the cured silicone."""
    properties, out_mm = data["silicone"]["properties"], data["mold"]["bolts_stand_out_mm"]
    stands = (
        f" The bolts stand {out_mm:g} mm out of the palmar side: the mold no longer lies flat on it." if out_mm else ""
    )
    return [
        *list_priming_steps(data),
        Step("hold", _describe_holding(data)),
        Step(
            "bolt",
            f"Fit the palmar half and tighten the {data['mold']['bolts']} mold bolts by hand, crosswise, until the "
            f"parting line shows no gap. Do not tighten further.{stands} A strip of tape keeps the nuts in their "
            "traps.",
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
        "Lay the dorsal half down with its cavity up, its screw hole over the edge of a table, because the screw comes "
        f"from below. Cut a strip of office paper narrower than the boss of {chaplet['diameter_mm']:g} mm, and into "
        f"its end a slot wider than the screw's hole of {chaplet['hole_mm']:g} mm. Put the {insert} into the half, its "
        "facet on the boss, with the forked end between them, so that the screw passes the slot and pierces no "
        "paper; the other end stands out of the cavity beyond the tip. Drive the "
        f"{chaplet['thread']} x {chaplet['length_mm']:g} mm screw until the paper is held fast, pull the paper out by "
        "that end, and turn "
        f"on until the facet touches the boss. The {insert} must not move. If it sits as badly as this "
        f"allows, the skin is still {fit['min_skin_held_mm']:g} mm at its thinnest (design: "
        f"{fit['min_skin_design_mm']:g} mm)."
    )


def _testing_steps(data: Data) -> list[Step]:
    """List the last tests of the closed mold, while everything can still be opened."""
    syringe, steps = data["filling"]["syringe"], list[Step]()
    each = "the vent" if data["mold"]["vents"] == 1 else "each vent, with fingers on the others"
    closed = (
        "If it is closed, pass a wire through it."
        if data["mold"]["vents"] == 1
        else ("Pass a wire through a vent that is closed.")
    )
    if syringe:
        steps.append(
            Step(
                "try_syringe",
                f"Pull back the plunger of the empty {syringe['volume_ml']:g} ml syringe, push its nozzle into the "
                f"cone, and press. Air must leave through {each}. {closed}",
            )
        )
    if data["insert"] == "bone":
        steps.append(
            Step(
                "measure",
                f"Measure the untouched sensor once more: above {data['sensor_limits']['open_mohm']:g} Mohm. This is "
                "the last moment at which the mold can "
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
            f"in; the mold takes {filling['injected_cm3']:g} cm3. Put the plunger back with a {VENT_WIRE} beside it, "
            "which lets the air out, and push it in until it touches the silicone. Pull the wire out. Turn the nozzle "
            "up and wait a minute, so that the bubbles rise to it. Take the cap off, and only then press the air out, "
            "the nozzle still up, until silicone stands at its mouth.",
        ),
        Step(
            "fill",
            "Hold the mold in a vise or a stand, by the two sides with the pry slots: "
            f"{_describe_pose(data)} "
            "Hold the syringe in its cone with the other hand and press with a steady "
            f"thumb. Aim for {filling['push_s']:g} s at most, the longest that a thumb can push (the check "
            f"mold.syringe_force): {filling['min_force_n']:g} N would do it. At {syringe['thumb_n']:g} N silicone of "
            f"{filling['viscosity_pa_s']:g} Pa s fills the mold in some {filling['fill_s']:g} s; the plunger's "
            f"friction makes it longer. Go on until silicone without bubbles stands in {openings}, and then "
            f"stop{closing}. Pressing on would only load the {data['insert']}. If the mold is not full "
            f"{filling['limit_min']:g} min after the first push, half the pot life, give up: open it, wipe "
            "everything clean before the silicone sets, and begin anew with a fresh mixture.",
        ),
        Step(
            "leave",
            "Leave the syringe in its cone, propped up with wedges, until the silicone has set. If it sinks in "
            f"{'the vent' if vents == 1 else 'a vent'}, press gently once more.",
        ),
    ]


def _describe_pose(data: Data) -> str:
    """Describe how the mold is held so that its first vent is the highest point of the cavity."""
    filling = data["filling"]
    place = "above" if filling["tip_deg"] >= 0 else "below"
    face = "dorsal" if filling["dorsal_up"] else "palmar"
    text = f"its tip {abs(filling['tip_deg']):g} degrees {place} the horizontal, its {face} face up"
    if filling["roll_deg"] >= _LEAST_ROLL_DEG:
        level = "higher" if filling["runner_side_up"] else "lower"
        text += (
            f", and rolled by {filling['roll_deg']:g} degrees about its length, so that the side of the syringe is "
            f"{level}"
        )
    vent = "the vent" if data["mold"]["vents"] == 1 else "the vent near the tip"
    within = (
        f"; up to {filling['pose_tolerance_deg']:g} degrees out of it, less than {filling['max_air_mm3']:g} mm3 of air "
        "stays beside it"
        if filling["pose_tolerance_deg"]
        else ""
    )
    return (
        f"{text}. Set this pose with a protractor, and secure it with wedges. Then {vent} is the highest point, and "
        f"bubbles rise to it{within}."
    )


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
            f"until silicone rises in {'the vent' if vents == 1 else f'all {vents} vents'}. It takes some "
            f"{filling['fill_s']:g} s for "
            f"{filling['viscosity_pa_s']:g} Pa s. Tap the mold and top it up.",
        ),
    ]


def list_opening_steps(data: Data) -> list[Step]:
    """List the steps from the cured silicone to the trimmed skin."""
    opening = []
    runner = "runner at the side of the finger" if data["filling"]["syringe"] else "stub of the gate"
    stubs = "the vent stub" if data["mold"]["vents"] == 1 else "the vent stubs"
    if data["filling"]["syringe"]:
        opening.append("Twist the syringe out of its cone.")
    if data["chaplet"]:
        opening.append(f"Take out the screw of the {data['insert']}.")
    opening.append(
        "Take out the bolts. Twist a screwdriver in the pry slots, alternating between the two sides, and lift the "
        "halves straight off. "
        + _describe_pushing(data)
        + f" Cut the {runner} and {stubs} with a sharp knife, flush, and remove any flash around the base. None of "
        "them lies on the pad."
    )
    return [Step("open", " ".join(opening))]


def _describe_pushing(data: Data) -> str:
    """Write where to push finger or core out of the mold: where it is thick, not at its interface."""
    if data["insert"] == "core":
        return "Push the core with the skin on it out of the second half at its bare base, never at the skin."
    return (
        "Push the finger out of the second half: push on the thick base close to the mold, never on "
        f"{INTERFACES[data['interface']].weakest}, and never at the skin."
    )


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
