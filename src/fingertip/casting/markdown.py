"""The casting sheet as a page: figures in, Markdown out. It holds no figure that is not in the data."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from fingertip.casting.slicer import HOW_TO_INSTALL

Data = Mapping[str, Any]
_LABELS = {
    "shore_a": ("hardness", "Shore A"),
    "modulus_mpa": ("Young's modulus", "MPa"),
    "density_g_cm3": ("density", "g/cm3"),
    "parts_a": ("parts of A by weight", ""),
    "parts_b": ("parts of B by weight", ""),
    "shrinkage_percent": ("linear shrinkage", "%"),
    "pot_life_min": ("pot life", "min"),
    "cure_h": ("cure at room temperature", "h"),
    "elongation_percent": ("elongation at break", "%"),
}


def page(data: Data) -> str:
    """The casting sheet of `sheet.figures`' data."""
    sections = [
        f"# Casting sheet: {data['design']}",
        _summary(data),
        "## Weigh",
        _weigh(data),
        "## Mind",
        "\n".join(f"- {warning}" for warning in warnings(data)),
        "## Steps",
        "\n".join(f"{number}. {step}" for number, step in enumerate(steps(data), 1)),
        "## Print",
        _print(data),
        "## Buy",
        _bill(data),
        "## Silicone",
        _card(data),
    ]
    return "\n\n".join(sections) + "\n"


def warnings(data: Data) -> list[str]:
    """What spoils a casting."""
    found = []
    if data["silicone"]["cure"] == "addition":
        found.append(
            "Uncured resin stops a platinum silicone from setting: wash and post-cure prints of resin fully, and test "
            "a drop on a spare print first. Sulfur, tin silicones and latex gloves stop it too."
        )
    else:
        found.append(
            "A condensation silicone gives off vapour and needs air to set: ventilate, and expect the middle of a "
            "closed mold to take longest."
        )
    if not data["mold"]["made_for_this_silicone"]:
        shrinkage = data["silicone"]["figures"]["shrinkage_percent"]
        found.append(
            f"This mold was made for a shrinkage of {data['mold']['made_for_shrinkage_percent']:g} %, this silicone "
            f"shrinks by {_range(shrinkage)} %: build again with `--set "
            f"mold.silicone_shrinkage_percent={shrinkage['high']:g}`."
        )
    if texts := data["mold"]["not_engraved"]:
        found.append(
            f"No room to engrave {', '.join(texts)} in strokes of {data['mold']['min_stroke_mm']:g} mm: mark the "
            "halves with a pen."
        )
    found += [
        "No cyanoacrylate on the sensor: it creeps into it and its vapour spoils it. Use the adhesive film.",
        "Keep the sensor's air vent open: it breathes through the end of its tail, the relief and the cable channel.",
        "Do not bend the sensor's tail sharply, and never at its head.",
    ]
    return found


def steps(data: Data) -> list[str]:
    """What to do, in order."""
    figures, batch = data["silicone"]["figures"], data["batch"]
    sleeve = data["method"] == "sleeve"
    around = "core" if sleeve else "bone with its sensor"
    assemble = [
        "Lay the sensor's film and the sensor into the bone's pocket, tail in its slot. Solder the wires to the tabs "
        "in the relief, lead them through the channel and out of the back, and tie them down at the hole below it."
    ]
    keep_out = (
        "Nothing is let into the core, so no silicone can enter pocket, slot or channel: bone and sensor stay out of "
        "the mold."
        if sleeve
        else "Keep silicone out of pocket, slot and channel: the sensor lies flush and fills its pocket; close slot "
        "and relief with a strip of thin tape across the flat, edges pressed down, without filling them (the vent "
        "breathes there); plug the posterior hole around the wires with modelling clay free of sulfur."
    )
    passage = [
        "Fill the collar's passage around the tail with modelling clay free of sulfur or with silicone adhesive: it "
        "leads out of the mold. Leave the end of the tail open, where it breathes."
    ]
    cast = [
        keep_out,
        *(passage if data["mold"]["tail_passes_collar"] and not sleeve else []),
        f"Lay the {around} into the recess of the palmar half, put the dorsal half on: it closes one way only.",
        _centre(data["fit"], "core" if sleeve else "bone"),
        f"Tighten the {_bolts(data)['count']} bolts until the parting line shows no gap, no further.",
        f"Weigh {batch['a_g']:g} g of A, add {batch['b_g']:g} g of B, stir slowly and scrape walls and bottom; remove "
        "air under vacuum if you can.",
        f"Hold the mold upright, the {'core' if sleeve else 'bone'} down: over a cup, or in a vise that grips it by "
        "its two narrow sides, where no bolt stands out. Within "
        f"{figures['pot_life_min']['low']:g} min of the first stirring pour a thin stream into the funnel until "
        f"silicone stands in the {data['mold']['vents']} vents; tap the mold, and top up.",
        f"Leave it for {figures['cure_h']['high']:g} h at room temperature. Press a nail into what is left in the cup "
        "before you open the mold.",
        "Take the bolts out, turn a screwdriver in the pry slots on both sides in turn, lift the halves off straight, "
        "and cut sprue and vents flush.",
    ]
    if not sleeve:
        return [*assemble, *cast]
    return [
        *cast,
        "Roll the skin off the core.",
        *assemble,
        "Wet the bone with soapy water, pull the skin over it until its edge sits on the collar, and let it dry.",
    ]


def _centre(fit: Data, held: str) -> str:
    loose = f"leave {fit['thinnest_loose_mm']:g} mm" if fit["thinnest_loose_mm"] else "touch the mold"
    return (
        f"Pull the end of the {held} that stands out of the mold away from the funnel until its collar sits on its "
        "shelf all round, centre it with strips of paper between it and the mold on all four sides, and keep it there "
        f"with a rubber band: the thinnest place then has {fit['thinnest_held_mm']:g} mm of silicone at least. Loose, "
        f"with {fit['clearance_mm']:g} mm of play around it, the {held} could lean by {fit['loose_lean_deg']:g} "
        f"degrees and {loose}."
    )


def _summary(data: Data) -> str:
    method = (
        "cast as a sleeve around a dummy core and pulled over the bone" if data["method"] == "sleeve"
        else "cast over the bone with its sensor in place"
    )  # fmt: skip
    return f"{data['sensor']}, {method}. Silicone: {data['silicone']['label']}."


def _weigh(data: Data) -> str:
    volumes, batch = data["volumes_cm3"], data["batch"]
    rows = [
        ("skin", f"{volumes['skin']:.2f} cm3"),
        ("gate, funnel and vents", f"{volumes['runners']:.2f} cm3"),
        ("gap around the base, if it leaks", f"{volumes['gap']:.2f} cm3"),
        ("**in the mold**", f"**{volumes['total']:.2f} cm3, {batch['in_mold_g']:.2f} g**"),
        ("**part A**", f"**{batch['a_g']:g} g**"),
        ("**part B**", f"**{batch['b_g']:g} g**"),
        ("mixed in all", f"{batch['total_g']:g} g"),
    ]
    note = (
        f"{batch['waste_percent']:g} % more than the mold takes, for cup and stirrer; at least "
        f"{batch['min_part_g']:g} g of either part, so that a kitchen scale can weigh it."
    )
    return _table(("what", "how much"), rows) + "\n\n" + note


def _print(data: Data) -> str:
    printing = data["printing"]
    timed = "minutes" in printing
    head = ("part", "lies on", "turn about x", "supports") + (("time", "filament") if timed else ())
    rows = [
        (part["part"], part["on_the_plate"], f"{part['turn_x_deg']:g} degrees", "yes" if part["supports"] else "none")
        + ((f"{part['minutes']:g} min", f"{part['filament_cm3']:.1f} cm3") if timed else ())
        for part in printing["parts"]
    ]
    table = _table(head, rows)
    if timed:
        return (
            f"{table}\n\nIn all {printing['minutes']:g} min and {printing['filament_cm3']:.1f} cm3, by PrusaSlicer "
            f"with its own settings and layers of {printing['layer_mm']:g} mm."
        )
    return f"{table}\n\nTimes and material come with `--slicer`, from PrusaSlicer ({HOW_TO_INSTALL})."


def _bill(data: Data) -> str:
    rows = []
    for entry in data["bill"]:
        sizes = []
        if "type" in entry:
            sizes.append(entry["type"])
        if "thread_mm" in entry:
            sizes.append(f"M{entry['thread_mm']:g}" + (f" x {entry['length_mm']:g} mm" if "length_mm" in entry else ""))
        if "across_flats_mm" in entry:
            sizes.append(f"across flats {entry['across_flats_mm']:g} mm")
        if "longer_than_mm" in entry:
            sizes.append(f"longer than {entry['longer_than_mm']:g} mm by what else it passes and the nut")
        sizes += [f"{entry[key]:g} mm" for key in ("thickness_mm", "diameter_mm") if key in entry]
        rows.append((f"{entry['count']:g}", entry["item"], ", ".join(sizes)))
    batch = data["batch"]
    rows.append((f"{batch['total_g']:g} g", data["silicone"]["label"], "A and B together"))
    rows.append(("", "tape, paper, rubber band, modelling clay free of sulfur, cup, stirrer, vinyl gloves", ""))
    return _table(("count", "item", "size"), rows)


def _card(data: Data) -> str:
    rows = [
        (
            _LABELS[name][0],
            f"{_range(figure)} {_LABELS[name][1]}".rstrip() + ("" if figure["verified"] else " (unverified)"),
            figure["source"],
        )
        for name, figure in data["silicone"]["figures"].items()
    ]
    return _table(("figure", "value", "source"), rows)


def _bolts(data: Data) -> Data:
    bolts: Data = next(entry for entry in data["bill"] if entry["item"] == "bolt of the mold")
    return bolts


def _range(figure: Data) -> str:
    return f"{figure['low']:g}" if figure["low"] == figure["high"] else f"{figure['low']:g} to {figure['high']:g}"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, tuple("---" for _ in head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
