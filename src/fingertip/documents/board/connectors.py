"""Tables of the connectors, in the README of a board."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable

from fingertip.board.analysis.board_values import BoardValues
from fingertip.board.components.supplies import SUPPLIES
from fingertip.design import Design


def connector_table(values: BoardValues, design: Design) -> str:
    """Table of connectors and their pins, in Markdown."""
    supply_v, is_single = design.board.supply_v, has_mid_supply(values)
    if SUPPLIES[values.supply].is_for_controller:
        return _controller_connector_table(values, supply_v)
    slip = (
        f"S: slip output, low (asserted) while slip is detected, else +{supply_v:g} V"
        if values.comparator_levels
        else "0 (ground)"
    )
    rows = [
        ("connector", "pin 1 (square)", "pin 2", "pin 3", "pin 4", "pin 5"),
        ("---",) * 6,
        ("J1, sensor", "FSR", f"FSR, {'signal ground' if is_single else 'ground'}", "", "", ""),
        ("J2, supply", f"+{supply_v:g} V", "0 (ground)", "" if is_single else f"-{supply_v:g} V", "", ""),
        ("J3, to the ADC", "T: tactile voltage", "E: envelope", "0 (ground)", slip, "M: VMID (signal ground)"),
    ]
    # Only boards with a single supply have a fifth pin.
    return "\n".join("| " + " | ".join(row if is_single else row[:-1]) + " |" for row in rows)


def _controller_connector_table(values: BoardValues, supply_v: float) -> str:
    slip = (
        f"SLIP: low (asserted) while slip is detected, else +{supply_v:g} V" if values.comparator_levels else "ground"
    )
    rows = [
        ("connector", "type", "pins"),
        ("---",) * 3,
        ("J1, sensor", "JST SH, 2 pins", "1, 2: FSR. Pin 2 is at signal ground."),
        ("J2, supply", "JST PH, 2 pins", f"1: +{supply_v:g} V; 2: 0 (ground)"),
        (
            "J3, to the controller",
            "JST SH, 10 pins",
            "1, T: tactile voltage; 3, S: filtered signal; 5, E: envelope; 7, M: VMID, the reference of all signals; "
            f"9, {slip}; 2, 4, 6, 8, 10: ground",
        ),
    ]
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def has_mid_supply(values: BoardValues) -> bool:
    """Return whether the signals swing around VMID, on a single supply."""
    return bool(SUPPLIES[values.supply].signal_ground_ratio)


def slip_pin(values: BoardValues) -> str:
    """Name of the slip output. On a board for a controller S is the filtered signal."""
    return "SLIP" if SUPPLIES[values.supply].is_for_controller else "S"


# Layout of the README's text: paragraphs, bullets, capitals.


def paragraph(text: str, first_indent: str = "", indent: str = "") -> str:
    """Wrap a text to lines of 120 characters."""
    return textwrap.fill(text, 120, initial_indent=first_indent, subsequent_indent=indent, break_on_hyphens=False)


def capitalize(text: str) -> str:
    """Begin a text with a capital letter, and leave the rest as it is."""
    return text[:1].upper() + text[1:]


def bullet_list(notes: Iterable[str]) -> str:
    """Bullet list in Markdown, an item for each note."""
    return "\n".join(paragraph(note, "- ", "  ") for note in notes)
