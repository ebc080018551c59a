"""Markdown page of a casting sheet. It holds no number that is not in the sheet's data."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from fingertip.casting.slicer import HOW_TO_INSTALL, describe_settings
from fingertip.casting.uses import Step, join
from fingertip.documents.casting.mold_steps import (
    list_filling_steps,
    list_opening_steps,
    list_patching_steps,
    list_seat_steps,
    list_trying_steps,
)
from fingertip.documents.casting.sensor_steps import (
    list_covering_steps,
    list_joint_steps,
    list_joint_trial_steps,
    list_mounting_steps,
    list_sealing_steps,
    open_air_vent,
)

# Tables in Markdown.


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Write a table with a head."""
    lines = [head, tuple("---" for _ in head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


# Table of the casting sheet that lists what to buy. It holds no number that is not in the sheet's data.


Data = Mapping[str, Any]


def render_bill(data: Data) -> str:
    """Render what to buy as a table: hardware, silicone, print material, consumables and tools."""
    rows = []
    for entry in data["bill"]:
        sizes = []
        if "type" in entry:
            sizes.append(entry["type"])
        if "thread_mm" in entry:
            sizes.append(f"M{entry['thread_mm']:g}" + (f" x {entry['length_mm']:g} mm" if "length_mm" in entry else ""))
        if "across_flats_mm" in entry:
            sizes.append(f"{entry['across_flats_mm']:g} mm across flats")
        if "crossed_mm" in entry:
            sizes.append(
                f"length = {entry['crossed_mm']:g} mm + what it crosses of the mating part"
                + (" + nut: see Mounting" if "cross bolt" in entry["item"] else " + nut")
            )
        if "diameter_mm" in entry:
            sizes.append(f"{entry['diameter_mm']:g} mm")
        if "length_mm" in entry and "thread_mm" not in entry:
            sizes.append(f"{entry['length_mm']:g} mm long")
        if "thickness_mm" in entry:
            sizes.append(f"{entry['thickness_mm']:g} mm thick")
        if "pair_thinner_than_mm" in entry:
            sizes.append(f"both together thinner than {entry['pair_thinner_than_mm']:g} mm")
        if "thinner_than_mm" in entry:
            sizes.append(f"thinner than {entry['thinner_than_mm']:g} mm")
        if "insulation_mm" in entry:
            sizes.append("{:g} to {:g} mm over the insulation".format(*entry["insulation_mm"]))
        if "conductor_awg" in entry:
            sizes.append("conductor of AWG {} to {}".format(*entry["conductor_awg"]))
        if "min_length_mm" in entry:
            sizes.append(f"at least {entry['min_length_mm']:g} mm each")
        if "or_lead" in entry:
            sizes.append(f"or leads with contacts for the plug: {entry['or_lead']}")
        if "note" in entry:
            sizes.append(entry["note"])
        if "mass_g" in entry:
            sizes.append(f"{entry['mass_g']:g} g")
        if "volume_ml" in entry:
            sizes.append(f"{entry['volume_ml']:g} ml, nozzle bore {entry['nozzle_bore_mm']:g} mm")
        rows.append((f"{entry['count']:g}", entry["item"], ", ".join(sizes)))
    batch = data["batch"]
    mixtures = batch["mixtures"]
    rows.append(
        (
            f"{batch['buy_g']} g",
            data["silicone"]["label"],
            f"{_describe_product(data['silicone'])}both components together; {mixtures} mixtures of "
            f"{batch['total_g']:g} g, for the test of the cure, the "
            f"skin{' and the patch' if mixtures == 3 else ''}; pot life at least "
            f"{data['filling']['pot_life_min']:g} min; kits hold much more",
        )
    )
    rows += _list_print_materials(data)
    rows += ((f"{supply['count'] or ''}", supply["item"], supply["size"]) for supply in data["supplies"])
    return table(("quantity", "item", "size"), rows)


def _list_print_materials(data: Data) -> list[tuple[str, str, str]]:
    """List the printing materials; the bone has a row of its own where filament is too weak for it."""
    size = f"the strength of the bone holds for {data['print_material']}"
    others = [
        *(["lid"] if data["sensor_tail"] == "folded" else []),
        *(["core"] if data["method"] == "sleeve" else []),
        "mold",
    ]
    if not data["filament_bone_breaks"]:
        return [
            ("", f"rigid printing material for {join(['bone', *others])}: resin or filament", f"see Printing; {size}")
        ]
    only = "filament, upright as on its plate, gives a bone for trying the fit only: see Warnings"
    return [
        ("", "rigid printing material for the bone", f"{size}, and for what is as strong; {only}"),
        ("", f"rigid printing material for {join(others)}: resin or filament", "see Printing"),
    ]


def _describe_product(silicone: Data) -> str:
    """Name a product of the catalogue for a kind of silicone."""
    example = silicone["example"]
    if example is None:
        return ""
    return f"such as {example['label']} (then build with silicone.product={example['name']}); "


def render_mounting(mounting: Data) -> str:
    """Render what the interface of the bone fits into."""
    parts = ["The design makes no mating part.", mounting["fit"]]
    if bolt := mounting["bolt"]:
        parts.append(
            f"The {bolt['item']} is as long as the bore of {bolt['crossed_mm']:g} mm, both walls of the mating part "
            f"and the nut of {bolt['nut_mm']:g} mm, or longer: with walls of {bolt['wall_mm']:g} mm that is "
            f"M{bolt['thread_mm']:g} x {bolt['length_mm']:g} mm."
            if bolt["walls"] == 2
            else f"The {bolt['item']} crosses the bone, {bolt['crossed_mm']:g} mm, and the mating part inside it, "
            f"and takes a nut of {bolt['nut_mm']:g} mm: M{bolt['thread_mm']:g} x {bolt['length_mm']:g} mm."
        )
        parts.append(
            f"The axis of its hole lies {bolt['from_mm']:g} mm from {bolt['from']}: drill that of the mating part as "
            "far from the face on which the bone stands."
        )
    return " ".join(parts)


_PROPERTY_LABELS = {
    "viscosity_pa_s": ("viscosity of the mixture", "Pa s"),
    "shore_a": ("hardness", "Shore A"),
    "shore_00": ("hardness", "Shore 00"),
    "modulus_mpa": ("Young's modulus", "MPa"),
    "density_g_cm3": ("density", "g/cm3"),
    "shrinkage_percent": ("linear shrinkage", "%"),
    "pot_life_min": ("pot life", "min"),
    "cure_h": ("cure at room temperature", "h"),
    "elongation_percent": ("elongation at break", "%"),
    "tensile_strength_mpa": ("tensile strength", "MPa"),
}


def render_sheet(data: Data, pictures: Sequence[str] = ()) -> str:
    """Render the data of `sheet.casting_sheet_data` as a Markdown page."""
    sections = [
        f"# Casting sheet: {data['design']}",
        _summary(data),
        "## What to buy",
        render_bill(data),
        "## Printing",
        _printing(data),
        "## Quantities",
        _quantities(data),
        "## Warnings",
        "\n".join(f"- {warning}" for warning in warnings(data)),
        "## Plan",
        _plan(data),
        "## Procedure",
        _procedure(data, pictures),
        *(["## Mounting", render_mounting(data["mounting"])] if data["mounting"] else []),
        "## Silicone data",
        _silicone(data),
    ]
    return "\n\n".join(sections) + "\n"


def warnings(data: Data) -> list[str]:
    """List at what load the finger would break, and what can spoil the casting or damage the sensor."""
    found, is_folded = [f"**Strength**: {text}" for text in data["check_warnings"]], data["sensor_tail"] == "folded"
    if data["silicone"]["cure"] == "addition":
        found.append(
            "Uncured resin inhibits the cure of platinum silicone. Wash and fully post-cure parts printed from resin, "
            "and test a drop of silicone on a spare print first. Sulfur, tin-cure silicone and latex gloves inhibit "
            "the cure too."
        )
    else:
        found.append(
            "Condensation-cure silicone gives off vapour and needs air to cure. Ventilate the room, and expect the "
            "middle of a closed mold to cure last."
        )
    found += _ratio_warnings(data["silicone"])
    filling = data["filling"]
    if filling["pot_life_min"] < filling["wanted_pot_life_min"]:
        found.append(
            f"The pot life of this silicone, {filling['pot_life_min']:g} min, leaves {filling['prepare_min']:g} min to "
            f"stir, degas and load. {filling['wanted_pot_life_min']:g} min of pot life are wanted: take a slower "
            "product (silicone.product)."
        )
    if not data["mold"]["made_for_this_silicone"]:
        shrinkage = data["silicone"]["properties"]["shrinkage_percent"]
        found.append(
            f"This mold compensates for a shrinkage of {data['mold']['made_for_shrinkage_percent']:g} %, but this "
            f"silicone shrinks by {_range(shrinkage)} %. Build the mold again with `--set "
            f"mold.silicone_shrinkage_percent={shrinkage['high']:g}`."
        )
    if texts := data["mold"]["not_engraved"]:
        found.append(
            f"There is no room to engrave {', '.join(texts)} in strokes of {data['mold']['min_stroke_mm']:g} mm. Mark "
            "the mold halves with a pen."
        )
    if data["skin_pull_off_n"] == 0.0:
        found.append(
            "Nothing but its own adhesion holds this skin on the bone. Degrease the bone, and pull the finger by its "
            "skin before you trust it. A groove (bone.groove_depth_mm) holds a skin where the finger is long enough."
        )
    else:
        found.append(
            f"{_capitalise(join(data['skin_held_by']))} {'hold' if len(data['skin_held_by']) > 1 else 'holds'} the "
            f"skin against a pull of some {data['skin_pull_off_n']:g} N, without adhesion, for the softest silicone of "
            "this kind."
        )
    found += [
        "Do not use cyanoacrylate on the sensor: it wicks into the sensor, and its vapour damages it. Use the adhesive "
        "film.",
        "Keep the air vent of the sensor open. The sensor breathes through the end of its tail, "
        + ("the passage around it and the window." if is_folded else "the solder relief and the cable channel."),
        "Do not bend the tail of the sensor sharply: it follows the round nose, and no film may cross a moving joint. "
        "Never bend it at the head."
        if is_folded
        else "Do not bend the tail of the sensor sharply. Never bend it at the head.",
    ]
    return found


def _plan(data: Data) -> str:
    """Render the stages of the work by days."""
    rows = [(f"{stage['day']}", stage["work"], stage["wait"]) for stage in data["plan"]]
    primed = (
        " All trials of the fit come before the primer, whose open time is short." if data["insert"] == "bone" else ""
    )
    return f"Days at the earliest.{primed}\n\n" + table(("day", "work", "then wait for"), rows)


def _capitalise(text: str) -> str:
    return text[0].upper() + text[1:]


def _procedure(data: Data, pictures: Sequence[str]) -> str:
    texts = [f"{number}. {step.text}" for number, step in enumerate(steps(data), 1)]
    if not pictures:
        return "\n".join(texts)
    pairs = zip(texts, pictures, strict=True)
    return "\n\n".join(f"{text}\n\n   ![step {i}]({picture})" for i, (text, picture) in enumerate(pairs, 1))


def steps(data: Data) -> list[Step]:
    """List the steps of the procedure, in order."""
    if data["method"] == "sleeve":
        return [
            *list_trying_steps(data),
            *list_joint_trial_steps(data),
            Step(
                "core_only",
                "Leave the bone and the sensor out of the mold. Only the core lies in it. The core has no pocket, "
                "slot or channel, so nothing needs to be sealed.",
            ),
            *list_seat_steps(data),
            *list_filling_steps(data, _weighing_step(data)),
            *list_opening_steps(data),
            Step("roll_off", "Roll the skin off the core."),
            *list_mounting_steps(data),
            *list_covering_steps(data),
            Step(
                "pull_on",
                "Moisten the inside of the skin with very little isopropanol, and keep it off the edges of the tape. "
                "Pull the skin over the bone from the dorsal side, until its edge sits on the collar. Let "
                f"both dry. Measure the sensor once more: above {data['sensor_limits']['open_mohm']:g} Mohm untouched.",
            ),
            *list_patching_steps(data),
            *list_joint_steps(data),
        ]
    return [
        *list_trying_steps(data),
        *list_joint_trial_steps(data),
        *list_mounting_steps(data),
        *list_sealing_steps(data),
        *list_seat_steps(data),
        *list_filling_steps(data, _weighing_step(data)),
        *list_opening_steps(data),
        open_air_vent(data),
        *list_patching_steps(data),
        *list_joint_steps(data),
    ]


def _ratio_warnings(silicone: Data) -> list[str]:
    """Warn of a mix ratio by volume, which this sheet states by weight."""
    ratio = silicone["ratio"]
    if ratio["stated_by"] != "volume":
        return []
    stated = f"The maker states the mix ratio by volume, {_ratio(ratio['parts'])}"
    if not ratio["assumed_by_weight"]:
        weight = _ratio(ratio["parts_by_weight"])
        return [f"{stated}. With the densities of both components this is {weight} by weight, as in this sheet."]
    return [
        f"{stated}. The densities of the components are not known, so this sheet takes the ratio by weight. If the "
        "container gives no ratio by weight, measure the components by volume instead."
    ]


def _weighing_step(data: Data) -> str:
    """Write the step that weighs and mixes the components. The ratio on the container comes before the sheet's."""
    silicone, batch = data["silicone"], data["batch"]
    filling = data["filling"]
    clock = (
        "Note the time: the pot life runs from the start of stirring. This sheet plans with "
        f"{filling['pot_life_min']:g} min: {filling['prepare_min']:g} min to stir, degas and load, and "
        f"{filling['limit_min']:g} min to fill. If the container states less, halve what it states."
    )
    first, second = silicone["components"]
    ratio = silicone["ratio"]
    unverified = "" if ratio["verified"] else " (unverified)"
    return (
        f"Use the mix ratio printed on the container. This sheet mixes {first} and {second} "
        f"{_ratio(ratio['parts_by_weight'])} by weight{unverified}; if the container says otherwise, the container is "
        f"right. Wear vinyl gloves. Weigh {batch['a_g']:g} g of {first} and add {batch['b_g']:g} g of {second}. "
        f"Stir slowly, and scrape the walls and the bottom of the cup. {clock}"
    )


def _ratio(parts: Sequence[float]) -> str:
    return f"{parts[0]:g} to {parts[1]:g}"


def _summary(data: Data) -> str:
    method = (
        "cast as a sleeve around a core and pulled over the bone" if data["method"] == "sleeve"
        else "overmolded (cast in place) around the bone with its sensor"
    )  # fmt: skip
    return f"{data['sensor']}, {method}. Silicone: {data['silicone']['label']}."


def _quantities(data: Data) -> str:
    volumes, batch = data["volumes_cm3"], data["batch"]
    first, second = data["silicone"]["components"]
    openings = "runner and vent" if data["filling"]["syringe"] else "gate, funnel and vent"
    openings += "s" if data["mold"]["vents"] > 1 else ""
    load = []
    if data["filling"]["syringe"]:
        load.append(("to load into the syringe", f"{data['filling']['load_cm3']:g} cm3, {batch['load_g']:g} g"))
    rows = [
        ("skin, with shrinkage allowance", f"{volumes['skin']:.2f} cm3"),
        (openings, f"{volumes['runners']:.2f} cm3"),
        ("flash around the base", f"{volumes['gap']:.2f} cm3"),
        ("**total in the mold**", f"**{volumes['total']:.2f} cm3, {batch['in_mold_g']:.2f} g**"),
        *load,
        (f"**{first}**", f"**{batch['a_g']:g} g**"),
        (f"**{second}**", f"**{batch['b_g']:g} g**"),
        ("total to mix", f"{batch['total_g']:g} g"),
    ]
    note = (
        f"{batch['with_waste_g']:g} g with {batch['waste_percent']:g} % waste, which stays on the cup and the stirrer"
        + (" and comes on top of what is loaded" if data["filling"]["syringe"] else "")
    )
    if batch["is_raised"]:
        note += (
            f"; raised to {batch['total_g']:g} g for at least {batch['min_component_g']:g} g of "
            f"{batch['lighter']}, which such a scale can weigh"
        )
    note += "."
    return table(("item", "quantity"), rows) + "\n\n" + note


def _printing(data: Data) -> str:
    printing = data["printing"]
    rows = [
        (
            part["part"], part["face_on_plate"], f"{part['rotate_x_deg']:g} degrees", part["supports_may_stand"],
            part["no_supports_on"],
        )
        for part in printing["parts"]
    ]  # fmt: skip
    remedies = ": some ask for epoxy, or for film as a shim" if data["chaplet"] else ""
    rows_of_settings = describe_settings(printing["settings"])
    if data["filament_bone_breaks"]:
        rows_of_settings.append(
            (
                "use of the bone",
                "for trying the fit only: it breaks in a grip (see Warnings)",
                f"for use, if the resin is as strong as {data['print_material']}",
            )
        )
    settings = table(("setting", "filament (FDM)", "resin (SLA)"), rows_of_settings)
    orientations = table(("part", "face on the plate", "rotation about x", "where supports may stand", "none on"), rows)
    page = (
        f"The folder `{printing['folder']}` holds each part as it lies on the bed, and plates of all parts for a "
        "filament and a resin printer. The skin is cast, so it is on no plate. PrusaSlicer takes the settings of the "
        "filament plate from its file, all but nozzle and first layer; in other slicers, set them by hand. "
        "Measure the prints with calipers: the drawings that `fingertip drawing` makes say what they must read, and "
        f"what to do about those that do not{remedies}.\n\n"
        "Before the parts, print, measure and try the fit coupon, as its page `coupon.md` says: its slice in the "
        f"material of the {data['insert']}, its frame in that of the mold. In the folder of a build, `fingertip coupon "
        "design.toml --out coupon` writes it. Keep it: the cure of the silicone is tested on it, or on any other spare "
        "piece of both materials. The finished finger is tested as `acceptance.md` says.\n\n"
        f"{settings}\n\n{orientations}\n\n"
        f"Ceilings of the mold halves are bridges of at most {printing['max_bridge_mm']:g} mm: the plates "
        "tell PrusaSlicer that the halves need no supports. In other slicers, and for the single parts, switch "
        "supports off for the halves: automatic ones would fill the nut traps."
    )
    if "minutes" in printing:
        plates = table(
            ("plate", "time", "filament volume"),
            (
                (plate["plate"], f"{plate['minutes']:g} min", f"{plate['filament_cm3']:.1f} cm3")
                for plate in printing["plates"]
            ),
        )
        return (
            f"{page}\n\n{plates}\n\nTotal: {printing['minutes']:g} min and {printing['filament_cm3']:.1f} cm3 with "
            "supports, estimated by PrusaSlicer for its default filament printer, with the settings above: layers of "
            f"{printing['layer_mm']:g} mm."
        )
    return (
        f"{page}\n\nFor a filament printer, run `fingertip sheet` with `--slicer` for print times and filament "
        f"volumes, estimated by PrusaSlicer ({HOW_TO_INSTALL}). A resin printer has a slicer of its own."
    )


def _silicone(data: Data) -> str:
    first, second = data["silicone"]["components"]
    basis = data["silicone"]["ratio"]["stated_by"]
    labels = _PROPERTY_LABELS | {
        "parts_a": (f"{first}, parts by {basis}", ""),
        "parts_b": (f"{second}, parts by {basis}", ""),
        "density_a_g_cm3": (f"density of {first}", "g/cm3"),
        "density_b_g_cm3": (f"density of {second}", "g/cm3"),
    }
    rows = [
        (
            labels[name][0],
            f"{_range(value)} {labels[name][1]}".rstrip() + ("" if value["verified"] else " (unverified)"),
            value["source"],
        )
        for name, value in data["silicone"]["properties"].items()
    ]
    return table(("property", "value", "source"), rows)


def _range(value: Data) -> str:
    return f"{value['low']:g}" if value["low"] == value["high"] else f"{value['low']:g} to {value['high']:g}"
