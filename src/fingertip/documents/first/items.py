"""Things to buy for a first finger: how much of each, its class of price, where it is common, and why it is ordered."""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.casting.consumables import AIDS
from fingertip.catalogues.silicones import Silicone, find_example
from fingertip.design import Design
from fingertip.design.interfaces import interface_of

CHEAP, USUAL, DEAR = "below 5", "5 to 20", "20 to 50"
"""Classes of price in US dollars of November 2026, estimated."""
_ELECTRONICS, _CRAFT, _HARDWARE, _HOME = "electronics shop", "craft shop", "hardware store", "home"
ORDER_NUMBERS = {"fsr400_short": "34-00004", "fsr402": "30-81794", "fsr402_short": "34-00015"}
"""Interlink's order numbers of sensors with solder tabs. Source of the first: bill of materials of the HANDi Hand, an
open design whose fingertips hold it; of the others: lists of parts in public repositories."""
_WIRE_CM = 40


@dataclass(frozen=True)
class Item:
    """Thing to buy, or to have at hand."""

    key: str
    """Name by which a step refers to it: `[the words of the step](#key)`."""
    amount: str
    label: str
    price_usd: str
    where: str
    reason: str = ""
    """Why it is ordered; empty for what an ordinary maker has in a drawer."""


def list_items(design: Design, silicone: Silicone, silicone_g: float, scale_g: float, printed_g: float) -> list[Item]:
    """List the things to buy, what is ordered first; masses in grams, `scale_g` is the step of the scale."""
    return [
        *_ordered(design, silicone, silicone_g, scale_g),
        Item("filament", f"{printed_g:.0f} g", "PETG filament", USUAL, "3D printing shop"),
        Item("controller", "1", "3.3 V controller such as a Raspberry Pi Pico, USB cable", USUAL, _ELECTRONICS),
        Item("resistor", "1", f"resistor of {design.board.divider_ohm / 1e3:g} kohm", CHEAP, _ELECTRONICS),
        Item("wire", "2", f"thin stranded wires, {_WIRE_CM} cm, red and black", CHEAP, _ELECTRONICS),
        *_bolts(design),
        Item("iron", "1", "soldering iron with solder", USUAL, _ELECTRONICS),
        Item("calipers", "1", "calipers", USUAL, _HARDWARE),
        Item("knife", "1", "sharp knife", CHEAP, _HOME),
        Item("bands", "2", "rubber bands", CHEAP, _HOME),
        Item("cup", "1", "paper cup", CHEAP, _HOME),
        Item("stick", "2", "wooden sticks, one with a narrow end", CHEAP, _HOME),
        Item("gloves", "1 pair", "vinyl or nitrile gloves, not latex", CHEAP, _HOME),
        Item("alcohol", "some drops", "isopropanol", CHEAP, "pharmacy"),
    ]


def _ordered(design: Design, silicone: Silicone, silicone_g: float, scale_g: float) -> list[Item]:
    sensor, number = design.dimensions.sensor, ORDER_NUMBERS.get(design.sensor.model)
    said = f"Interlink {sensor.label} with solder tabs{f', order number {number}' if number else ''}"
    example = find_example(silicone)
    kind = f"{silicone.label}, such as {example['label']}" if example else silicone.label
    return [
        Item("sensor", "1", said, USUAL, "Digi-Key, Mouser", "few shops keep force sensors of this size"),
        Item("silicone", f"{silicone_g:g} g", kind, DEAR, "mold-making shop", "sealants do not cure in a mold"),
        Item(
            "varnish", "1", f"clear acrylic varnish ({AIDS['lacquer']['label']}), and a small brush", USUAL, _CRAFT,
            "other varnishes may keep the silicone from curing",
        ),
        Item(
            "scale", "1", f"scale that reads {scale_g:g} g, up to 500 g or more", USUAL, "kitchen shop",
            f"most kitchen scales read 1 g, and {silicone.components[1]} is little",
        ),
    ]  # fmt: skip


def _bolts(design: Design) -> list[Item]:
    if (bolt := (interface_of(design).mounting(design) or {}).get("bolt")) is None:
        return []
    size = f"M{bolt['thread_mm']:g} x {bolt['length_mm']:g} mm"
    return [Item("bolt", "1", f"bolt {size} with its nut and key", CHEAP, _HARDWARE)]
