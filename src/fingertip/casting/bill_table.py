"""Table of the casting sheet that lists what to buy. It holds no number that is not in the sheet's data."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fingertip.casting.tables import table
from fingertip.casting.uses import join

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
