"""Consumables and tools that the steps of the casting sheet use, one entry each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from fingertip.casting.uses import describe_range, join, uses_adhesive, uses_primer
from fingertip.documents.casting.sensor_steps import ADHESIVE

Data = Mapping[str, Any]

VENT_WIRE = "wire of 0.2 to 0.3 mm"
"""Wire that lets air past the plunger, and opens a closed vent. A thicker one jams beside a plunger without rubber."""


@dataclass(frozen=True)
class Supply:
    """Consumable or tool."""

    item: str
    word: str
    """Words by which a step, the acceptance sheet or the section on printing names its use."""
    size: str = ""
    count: int | None = None
    """None for what is bought by the roll or the bottle, or is at hand."""


def supplies_data(data: Data) -> list[dict[str, Any]]:
    """List consumables and tools as plain data, from the other data of the sheet."""
    return [asdict(supply) for supply in (*_list_consumables(data), *_list_tools(data))]


def _list_consumables(data: Data) -> Iterator[Supply]:
    mixtures, seat = data["batch"]["mixtures"], data["fit"]["seat_tape"]
    is_folded = data["sensor_tail"] == "folded"
    yield Supply("solder", "older")
    yield Supply("cups", "cup", "for each mixture, and one to pour into", mixtures + 1)
    yield Supply("stirrers", "Stir", "", mixtures)
    yield Supply("vinyl gloves", "vinyl gloves", "no latex")
    yield Supply("isopropanol", "isopropanol")
    yield Supply("lint-free cloth", "lint-free cloth")
    yield Supply("means to wash and post-cure prints of resin, as its maker says", "post-cure")
    yield Supply("office paper (to try the fit, and for the slide test)", "paper")
    yield Supply("cork or felt (a disc under the weights)", "cork or felt")
    if uses_primer(data):
        yield Supply("primer, with a brush", "primer", _name_primer(data))
    yield Supply(
        "polyimide tape over the sensor (no masking tape)", "strip of polyimide tape", _size_cover(data["fit"])
    )
    if seat:
        size = f"{_size_seat(seat)}, {seat['thickness_mm']:g} mm thick"
        yield Supply("polyimide tape for the seat", "turn of polyimide tape", size)
    if uses_adhesive(data):
        yield Supply(ADHESIVE, ADHESIVE, "alkoxy; none that smells of vinegar, none with tin")
    if is_folded:
        yield Supply("insulating varnish", "thin varnish")
        yield Supply("syringe for washing", "with a syringe", "", 1)
        yield Supply("plastic film, such as of a bag", "plastic film", "a strip as wide as the sensor's tail")
    elif uses_adhesive(data) and seat:
        yield Supply("baking paper", "baking paper", f"a strip narrower than {data['fit']['slot_mm']:g} mm")
    uses = [
        *(["a hole of the screw that a drawing finds too wide"] if data["chaplet"] else []),
        *(["the pins"] if data["joint"] else []),
    ]
    if uses:
        yield Supply("epoxy", "epoxy", f"for {join(uses)}")
    if data["chaplet"]:
        yield Supply("film to shim", "as a shim", f"only if a drawing asks for it between {data['insert']} and boss")
    if data["filling"]["syringe"]:
        yield Supply("Luer cap for the syringe", "cap the nozzle", "", 1)
        yield Supply(VENT_WIRE, VENT_WIRE)
    if data["chaplet"]:
        yield Supply("syringe of 1 ml with a blunt needle, for the patch", "blunt needle", _size_needle(data), 1)


def _name_primer(data: Data) -> str:
    """Write what the primer must be made for: the cure of the silicone, and the material that it sticks to."""
    on = "acrylic resin" if data["print_process"] == "sla" else data["print_material"]
    return f"for {data['silicone']['cure']}-cure silicone on {on}"


def _size_needle(data: Data) -> str:
    """Write the size of a needle that enters the hole of the screw."""
    needle, hole = data["chaplet"]["needle"], data["chaplet"]["pilot_mm"]
    if needle is None:
        return f"thinner than the hole of {hole:g} mm"
    return f"gauge {needle['gauge']:g}, {needle['outer_mm']:g} mm outside: it enters the hole of {hole:g} mm"


def _size_cover(fit: Data) -> str:
    """Write the size of the tape over the sensor."""
    tape = fit["cover_tape"]
    is_cut = tape["stock_mm"] and tape["stock_mm"] > tape["width_mm"][1]
    cut = f" (cut from {tape['stock_mm']:g} mm)" if is_cut else ""
    return f"{describe_range(tape['width_mm'])} mm wide{cut}, {describe_range(tape['length_mm'])} mm long"


def _size_seat(seat: Data) -> str:
    """Write the width of the tape around the seat: a width that is sold, or one to cut."""
    stock, width = seat["stock_mm"], seat["width_mm"]
    if stock is None:
        return f"cut to {width:g} mm wide"
    return f"{width:g} mm wide" if stock == width else f"{stock:g} mm wide, or cut to {width:g} mm"


def _list_tools(data: Data) -> Iterator[Supply]:
    yield Supply("soldering iron with a fine tip", "older")
    yield Supply(f"scale that reads {data['batch']['scale_g']:g} g or better", "Weigh")
    yield Supply("hexagon keys or screwdriver for bolts and screws", "bolts")
    yield Supply("thin flat screwdriver to pry", "screwdriver in the pry slots")
    yield Supply("sharp knife", "sharp knife")
    yield Supply("scraper, file and sandpaper", "scrape")
    yield Supply("calipers", "calipers")
    yield Supply("ohmmeter", "ohmmeter")
    yield Supply("vise or stand", "vise")
    if data["filling"]["syringe"]:
        yield Supply("wedges or blocks (to prop mold and syringe)", "wedges", "no modelling clay: it may hold sulfur")
        yield Supply("protractor, or the level of a telephone", "protractor")
    if data["filling"]["syringe"]:  # a mold for pouring takes thin silicones alone, which lose their air by themselves
        yield Supply("vacuum chamber, which helps and can be done without", "vacuum")
    if chaplet := data["chaplet"]:
        yield Supply("pin vise for the drills", "Drill the hole", "", 1)
        for size in (chaplet["hole_mm"], chaplet["pilot_mm"]):
            yield Supply("drill bit", "Drill the hole", f"{size:g} mm", 1)
    yield Supply("drill bit for bolt holes that print narrow", "bolts", f"{data['mold']['bolt_hole_mm']:g} mm", 1)
    yield Supply("drill bit for vents that print narrow", "vent", f"{data['mold']['vent_mm']:g} mm", 1)
    if joint := data["joint"]:
        yield Supply("reamer", "Ream the bore", f"{joint['pin_mm']:g} mm", 1)
