"""Steps that mount the sensor in the bone and keep silicone away from it, for a straight and for a folded tail."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fingertip.casting.uses import Step, describe_range

ADHESIVE = "neutral-cure silicone adhesive"
"""Adhesive that touches sensor and silicone: acetic acid attacks the sensor, and tin stops the cure."""


def _state_reading(data: Mapping[str, Any]) -> str:
    """Write what the sensor must read, untouched and pressed."""
    limits = data["sensor_limits"]
    return (
        f"above {limits['open_mohm']:g} Mohm untouched; below {limits['pressed_kohm']:g} kohm, and steady, while you "
        "press its head with a finger."
    )


def _measure(data: Mapping[str, Any]) -> str:
    return f"Measure the sensor again: {_state_reading(data)}"


def list_mounting_steps(data: Mapping[str, Any]) -> list[Step]:
    """List the steps from the sensor as bought to the wired bone."""
    if data["sensor_tail"] == "straight":
        return [
            Step("place_sensor", _describe_placing(data)),
            Step(
                "wires",
                "Thread both wires through the cable channel first, from its opening on the dorsal side of the base "
                "into the solder relief, until a finger's width of each stands out there. Strip their ends as far as "
                "the tabs are long, and tin wires and tabs. Solder them in the solder relief with a fine tip, two "
                "seconds at most each: film and print soften. Let them cool, and pull the slack back through the "
                "channel, gently, until the joints lie in the relief without a pull on the tabs. Tie the wires down "
                "at the hole proximal to the channel opening. " + _measure(data),
            ),
        ]
    fit = data["fit"]
    return [
        Step(
            "try_fold",
            "Wash resin out of the trough and the passage in the collar with a syringe, and try the fold with a "
            "strip of plastic film first.",
        ),
        Step(
            "solder_tabs",
            f"Solder a wire of at most {fit['wire_mm']:g} mm to each tab, straight out beyond the tabs. Tabs, crimps "
            f"and solder may stand at most {fit['crimp_mm']:g} mm above the film. Insulate the joints with a thin "
            f"varnish. Measure the sensor: {_state_reading(data)}",
        ),
        Step(
            "thread",
            "Thread the wires, then the tabs and the tail, from the pocket through the passage in the collar. Pull "
            "them out below the base. The head is wider than the window and comes last.",
        ),
        Step(
            "fold",
            "Lead the wires and the tabs around the round nose, up through the window. Pull until the film "
            "lies around the nose, without a crease, and lay its end into the trough.",
        ),
        Step(
            "stick_head",
            f"Lay the head into its pocket, still without adhesive. At least {fit['end_room_mm'] / 2:g} mm must be "
            "free between the tabs and the end of the trough. Then stick the head down with the adhesive film.",
        ),
        Step(
            "bend_wires",
            "Bend the wires back over the tail in a loop, without pulling at the joints. "
            + (
                "Lead them side by side out between the cheeks on the dorsal side. Fix them at the mouth of the trough "
                "with a "
                if data["wires_between_cheeks"]
                else "Lay them side by side through the window into the groove of the base. Fix them there with a "
            )
            + f"drop of {ADHESIVE}, and let it cure. "
            + _measure(data),
        ),
        Step(
            "stick_lid",
            "Stick the lid into the trough with a thin bead of the same adhesive along its edges, and wipe off what is "
            "squeezed out. It stands on its feet beside the tabs and ends flush with bone and collar.",
        ),
    ]


def _describe_placing(data: Mapping[str, Any]) -> str:
    """Write the step that lays a straight tail into its slot."""
    fit = data["fit"]
    cut = (
        f"Cut the sensor's tabs to {fit['tab_room_mm']:g} mm: the solder relief takes no more. "
        if fit["tabs_too_long"]
        else ""
    )
    if data["mold"]["tail_passes_collar"]:
        return (
            f"{cut}Thread the tail of the sensor from the pocket through the passage in the collar, until the head "
            "lies over its pocket. Only then stick the head into the pocket with the adhesive film."
        )
    return f"{cut}Stick the sensor into the bone's pocket with the adhesive film, its tail in the slot."


def list_sealing_steps(data: Mapping[str, Any]) -> list[Step]:
    """List the steps that keep silicone out of the sensor's pocket while the skin is cast around the bone."""
    gap = f"{data['fit']['sensor_clearance_mm']:g} mm"
    keep_out = (
        f"Keep silicone out of the pocket, the slot and the channel. The sensor sits flush, with a {gap} gap around it."
    )
    covered = (
        f"and the sensor's head with one strip of polyimide tape on the flat, from the collar on, {_size_tape(data)}, "
        "press its edges down, but do not fill"
    )
    if data["sensor_tail"] == "folded":
        return [
            Step(
                "seal_passage",
                f"Seal the passage through the collar around the tail, flush with the face of the collar, with "
                f"{ADHESIVE}, wipe the flat clean, because tape has to stick there, and let it cure. This seal is "
                "permanent. Do not fill the window: the sensor breathes there.",
            ),
            Step(
                "cover_sensor",
                f"{keep_out} Cover the slot {covered} it, and let the tape overlap the seal. This tape is permanent.",
            ),
        ]
    relief = "" if data["mold"]["tail_passes_collar"] else ", the solder relief"
    steps = [
        Step(
            "cover_sensor",
            f"{keep_out} Cover the slot{relief} {covered} them: the sensor breathes there. This tape is permanent. "
            "Leave the channel opening on the dorsal side of the base open; it lies outside the mold. "
            + _measure(data),
        ),
    ]
    if data["mold"]["tail_passes_collar"]:
        seal = Step(
            "seal_passage",
            f"Fill the passage through the collar around the tail with {ADHESIVE}, flush with the face of the collar, "
            "because the passage leads out of the mold, wipe the flat clean, because tape has to stick there, and let "
            "it cure. This seal is permanent. Leave the end of the tail open: the sensor breathes there.",
        )
        steps.insert(0, seal)
    return steps


def _size_tape(data: Mapping[str, Any]) -> str:
    """Write width, length and overlap of the tape over the sensor, and where to trim it."""
    tape = data["fit"]["cover_tape"]
    trim = f", and trim it where the groove narrows the flat to {tape['flat_mm']:g} mm" if tape["trim"] else ""
    return (
        f"{describe_range(tape['width_mm'])} mm wide and {describe_range(tape['length_mm'])} mm long: at least "
        f"{tape['overlap_mm']:g} mm past the pocket on each side and at the tip, ending on the flat, which runs to "
        f"{tape['flat_end_mm']:g} mm from the collar (round its corners at the tip{trim})"
    )


def list_covering_steps(data: Mapping[str, Any]) -> list[Step]:
    """List the step that covers the sensor before a sleeve is pulled over it."""
    joints = "" if data["sensor_tail"] == "folded" else ", solder joints"  # a lid covers those of a folded tail
    return [
        Step(
            "cover_for_sleeve",
            f"Cover slot{joints} and head with one strip of polyimide tape on the flat, {_size_tape(data)}, its edges "
            "pressed down, so that the skin cannot catch the film and no alcohol creeps under it. Do not fill them: "
            "the "
            "sensor breathes there.",
        )
    ]


def open_air_vent(data: Mapping[str, Any]) -> Step:
    """Write the step that opens the sensor's air vent after casting."""
    peel = "Peel the tape off the seat, across the finger. " if data["fit"]["seat_tape"] else ""
    if data["sensor_tail"] == "folded":
        return Step(
            "peel_tape",
            f"{peel}See that the air vent of the sensor is open at the window of the base. Never pull the wires. The "
            "tape under the skin and the seal in the collar stay in place. "
            + ("" if data["wires_between_cheeks"] else "Tie the wires down at the hole in the base. ")
            + _measure(data),
        )
    stays = ", and so does the seal in the collar." if data["mold"]["tail_passes_collar"] else "."
    return Step(
        "peel_tape",
        f"{peel}See that the channel opening on the dorsal side of the base is open: the sensor breathes there. The "
        f"tape under the skin stays in place{stays} {_measure(data)}",
    )


def list_joint_trial_steps(data: Mapping[str, Any]) -> list[Step]:
    """List the steps that try the joint while bone and hand can still be worked on; none without a clevis."""
    joint = data["joint"]
    if joint is None:
        return []
    steps = [
        Step(
            "pin",
            f"Ream the bore of the joint to {joint['pin_mm']:g} mm and push the pin through bone and hand. The finger "
            "must fall by its own weight, without shaking sideways.",
        )
    ]
    if joint["travel_deg"]:
        steps.append(
            Step(
                "bend",
                "Bend the finger. It must stop when it is straight, and again at "
                f"{joint['travel_deg']:g} degrees. File the flat that stops too early.",
            )
        )
    if joint["tendon_distance_mm"]:
        steps.append(
            Step("try_anchor", "Push the anchor pin through the collar, below the joint, and take it out again.")
        )
    return steps


def list_joint_steps(data: Mapping[str, Any]) -> list[Step]:
    """List the steps that mount a finger with a clevis on its hand."""
    joint = data["joint"]
    if joint is None:
        return []
    steps = []
    if joint["tendon_distance_mm"]:
        steps.append(
            Step(
                "anchor",
                "Push the anchor pin through the collar again, and knot the tendon around it in the middle of the "
                "finger. Fix the pin with a drop of epoxy at each end.",
            )
        )
    return [
        *steps,
        Step(
            "wire_loop",
            "Mount the finger on the hand, and fix both ends of the joint's pin with a drop of epoxy. Lead the wires "
            "over the dorsal side of the joint in a loop that stays loose when the finger is bent. Tie them to the "
            "hand.",
        ),
    ]
