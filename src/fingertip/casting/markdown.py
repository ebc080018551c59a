"""Markdown page of a casting sheet. It holds no number that is not in the sheet's data."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from fingertip.casting.slicer import HOW_TO_INSTALL

Data = Mapping[str, Any]
_PROPERTY_LABELS = {
    "shore_a": ("hardness", "Shore A"),
    "modulus_mpa": ("Young's modulus", "MPa"),
    "density_g_cm3": ("density", "g/cm3"),
    "parts_a": ("part A, parts by weight", ""),
    "parts_b": ("part B, parts by weight", ""),
    "shrinkage_percent": ("linear shrinkage", "%"),
    "pot_life_min": ("pot life", "min"),
    "cure_h": ("cure at room temperature", "h"),
    "elongation_percent": ("elongation at break", "%"),
}
_CONSUMABLES = "tape, paper, rubber band, sulfur-free modeling clay, cup, stirrer, vinyl gloves"


def render_sheet(data: Data) -> str:
    """Render the data of `sheet.casting_sheet_data` as a Markdown page."""
    sections = [
        f"# Casting sheet: {data['design']}",
        _summary(data),
        "## Quantities",
        _quantities(data),
        "## Warnings",
        "\n".join(f"- {warning}" for warning in warnings(data)),
        "## Procedure",
        "\n".join(f"{number}. {step}" for number, step in enumerate(steps(data), 1)),
        "## Printing",
        _printing(data),
        "## Bill of materials",
        _bill(data),
        "## Silicone data",
        _silicone(data),
    ]
    return "\n\n".join(sections) + "\n"


def warnings(data: Data) -> list[str]:
    """List what can spoil the casting or damage the sensor."""
    found = []
    if data["silicone"]["cure"] == "addition":
        found.append(
            "Uncured resin inhibits the cure of platinum silicone. Wash and fully post-cure resin prints, and test a "
            "drop of silicone on a spare print first. Sulfur, tin-cure silicone and latex gloves inhibit the cure too."
        )
    else:
        found.append(
            "Condensation-cure silicone gives off vapor and needs air to cure. Ventilate the room, and expect the "
            "middle of a closed mold to cure last."
        )
    if not data["mold"]["made_for_this_silicone"]:
        shrinkage = data["silicone"]["properties"]["shrinkage_percent"]
        found.append(
            f"This mold compensates a shrinkage of {data['mold']['made_for_shrinkage_percent']:g} %, but this silicone "
            f"shrinks by {_range(shrinkage)} %. Build the mold again with `--set "
            f"mold.silicone_shrinkage_percent={shrinkage['high']:g}`."
        )
    if texts := data["mold"]["not_engraved"]:
        found.append(
            f"There is no room to engrave {', '.join(texts)} in strokes of {data['mold']['min_stroke_mm']:g} mm. Mark "
            "the mold halves with a pen."
        )
    found += [
        "Do not use cyanoacrylate on the sensor: it wicks into the sensor, and its vapor damages it. Use the adhesive "
        "film.",
        "Keep the sensor's air vent open. The sensor breathes through the end of its tail, the relief and the cable "
        "channel.",
        "Do not bend the sensor's tail sharply. Never bend it at the head.",
    ]
    return found


def steps(data: Data) -> list[str]:
    """List the steps of the procedure, in order."""
    properties, batch = data["silicone"]["properties"], data["batch"]
    is_sleeve = data["method"] == "sleeve"
    insert = "core" if is_sleeve else "bone"
    assemble_sensor = [
        "Place the adhesive film and the sensor in the bone's pocket, with the tail in its slot.",
        "Solder the wires to the sensor's tabs in the relief. Route them through the channel and out of the back, and "
        "tie them down at the hole below the channel.",
    ]
    if is_sleeve:
        seal = [
            "Leave the bone and the sensor out of the mold. The core has no pocket, slot or channel, so nothing needs "
            "to be sealed."
        ]
    else:
        seal = [
            "Keep silicone out of the pocket, the slot and the channel. The sensor sits flush and fills its pocket. "
            "Cover the slot and the relief with a strip of thin tape across the flat and press its edges down, but do "
            "not fill them: the vent breathes there. Plug the hole in the posterior end around the wires with "
            "sulfur-free modeling clay.",
        ]
        if data["mold"]["tail_passes_collar"]:
            seal.append(
                "Fill the collar's passage around the tail with sulfur-free modeling clay or silicone adhesive: the "
                "passage leads out of the mold. Leave the end of the tail open: the sensor breathes there."
            )
    cast = [
        *seal,
        f"Lay the {insert if is_sleeve else 'bone with its sensor'} in the recess of the palmar half and fit the "
        "dorsal half. The mold closes only one way.",
        _centering_step(data["fit"], insert),
        f"Tighten the {_mold_bolt(data)['count']} bolts until the parting line shows no gap. Do not tighten further.",
        f"Weigh {batch['a_g']:g} g of part A and add {batch['b_g']:g} g of part B. Stir slowly, and scrape the walls "
        "and the bottom of the cup. Degas the mixture under vacuum if you can.",
        f"Hold the mold upright over a cup, with the {insert} at the bottom. A vise may hold it by its two narrow "
        "sides, where no bolt protrudes.",
        f"Within {properties['pot_life_min']['low']:g} min of the start of stirring, pour a thin stream into the "
        f"funnel until silicone rises in the {data['mold']['vents']} vents. Tap the mold and top it up.",
        f"Let it cure for {properties['cure_h']['high']:g} h at room temperature. Before you open the mold, test the "
        "leftover silicone in the cup with a fingernail.",
        "Remove the bolts. Twist a screwdriver in the pry slots, alternating between the two sides, and lift the "
        "halves straight off. Trim the sprue and the vents flush.",
    ]
    if not is_sleeve:
        return [*assemble_sensor, *cast]
    return [
        *cast,
        "Roll the skin off the core.",
        *assemble_sensor,
        "Wet the bone with soapy water. Pull the skin over it until the edge of the skin sits on the collar, and let "
        "it dry.",
    ]


def _centering_step(fit: Data, insert: str) -> str:
    """Step that centers the bone or core in the mold, with what a loose fit would cost."""
    loose = f"leave only {fit['min_skin_loose_mm']:g} mm of silicone" if fit["min_skin_loose_mm"] else "touch the mold"
    return (
        f"Pull the exposed end of the {insert} away from the funnel until its collar sits on its shelf all round. "
        f"Center the {insert} with strips of paper between it and the mold on all four sides, and hold it there with a "
        f"rubber band. The skin is then at least {fit['min_skin_held_mm']:g} mm thick everywhere. A loose {insert}, "
        f"with {fit['clearance_mm']:g} mm of clearance around it, can tilt by {fit['max_loose_tilt_deg']:g} degrees "
        f"and {loose}."
    )


def _summary(data: Data) -> str:
    method = (
        "cast as a sleeve around a dummy core and pulled over the bone" if data["method"] == "sleeve"
        else "cast over the bone with its sensor in place"
    )  # fmt: skip
    return f"{data['sensor']}, {method}. Silicone: {data['silicone']['label']}."


def _quantities(data: Data) -> str:
    volumes, batch = data["volumes_cm3"], data["batch"]
    rows = [
        ("skin", f"{volumes['skin']:.2f} cm3"),
        ("gate, funnel and vents", f"{volumes['runners']:.2f} cm3"),
        ("gap around the base, in case the fit leaks", f"{volumes['gap']:.2f} cm3"),
        ("**total in the mold**", f"**{volumes['total']:.2f} cm3, {batch['in_mold_g']:.2f} g**"),
        ("**part A**", f"**{batch['a_g']:g} g**"),
        ("**part B**", f"**{batch['b_g']:g} g**"),
        ("total to mix", f"{batch['total_g']:g} g"),
    ]
    note = (
        f"The batch allows {batch['waste_percent']:g} % for silicone that stays on the cup and the stirrer. It holds "
        f"at least {batch['min_part_g']:g} g of each part, so that a kitchen scale can weigh it."
    )
    return _table(("item", "quantity"), rows) + "\n\n" + note


def _printing(data: Data) -> str:
    printing = data["printing"]
    is_sliced = "minutes" in printing
    head = ("part", "face on the plate", "rotation about x", "supports") + (("time", "filament") if is_sliced else ())
    rows = [
        (
            part["part"], part["face_on_plate"], f"{part['rotate_x_deg']:g} degrees",
            "yes" if part["needs_supports"] else "none",
        )
        + ((f"{part['minutes']:g} min", f"{part['filament_cm3']:.1f} cm3") if is_sliced else ())
        for part in printing["parts"]
    ]  # fmt: skip
    table = _table(head, rows)
    if is_sliced:
        return (
            f"{table}\n\nTotal: {printing['minutes']:g} min and {printing['filament_cm3']:.1f} cm3, estimated by "
            f"PrusaSlicer with its default settings and layers of {printing['layer_mm']:g} mm."
        )
    return (
        f"{table}\n\nRun `fingertip sheet` with `--slicer` for print times and filament volumes, estimated by "
        f"PrusaSlicer ({HOW_TO_INSTALL})."
    )


def _bill(data: Data) -> str:
    rows = []
    for entry in data["bill"]:
        sizes = []
        if "type" in entry:
            sizes.append(entry["type"])
        if "thread_mm" in entry:
            sizes.append(f"M{entry['thread_mm']:g}" + (f" x {entry['length_mm']:g} mm" if "length_mm" in entry else ""))
        if "across_flats_mm" in entry:
            sizes.append(f"{entry['across_flats_mm']:g} mm across flats")
        if "longer_than_mm" in entry:
            sizes.append(f"{entry['longer_than_mm']:g} mm long, plus the mating part and the nut")
        if "thickness_mm" in entry:
            sizes.append(f"{entry['thickness_mm']:g} mm thick")
        if "pair_thinner_than_mm" in entry:
            sizes.append(f"both together thinner than {entry['pair_thinner_than_mm']:g} mm")
        if "thinner_than_mm" in entry:
            sizes.append(f"thinner than {entry['thinner_than_mm']:g} mm")
        rows.append((f"{entry['count']:g}", entry["item"], ", ".join(sizes)))
    batch = data["batch"]
    rows.append((f"{batch['total_g']:g} g", data["silicone"]["label"], "parts A and B together"))
    rows.append(("", _CONSUMABLES, ""))
    return _table(("quantity", "item", "size"), rows)


def _silicone(data: Data) -> str:
    rows = [
        (
            _PROPERTY_LABELS[name][0],
            f"{_range(value)} {_PROPERTY_LABELS[name][1]}".rstrip() + ("" if value["verified"] else " (unverified)"),
            value["source"],
        )
        for name, value in data["silicone"]["properties"].items()
    ]
    return _table(("property", "value", "source"), rows)


def _mold_bolt(data: Data) -> Data:
    entry: Data = next(entry for entry in data["bill"] if entry["item"] == "mold bolt")
    return entry


def _range(value: Data) -> str:
    return f"{value['low']:g}" if value["low"] == value["high"] else f"{value['low']:g} to {value['high']:g}"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, tuple("---" for _ in head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
