"""Sizes of a hand's joint: their files, how to measure them, and guesses for those not measured."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from fingertip.catalogues.file_kinds import PARAMS
from fingertip.design.parameters import Tables
from fingertip.design.parameters.bone_and_mold import Hand
from fingertip.design.parameters.declaration import parse_tables, suggest_name
from fingertip.foundation.errors import DesignError, Issue, TomlFileError, join_words
from fingertip.foundation.tables import read_rows, read_toml

SIZES = {row["name"]: row for row in read_rows(Path(__file__).with_name("hand_sizes.csv"))}
"""Number of [hand] -> its letter, and the place of the calipers."""
_STATED = ("knuckle", "width_mm", "pin_diameter_mm")
_AROUND_PIN_MM = 1.5
"""Least clearance radius beyond the pin."""


def list_hands() -> dict[str, Path]:
    return {path.stem: path for path in sorted((PARAMS / "hands").glob("*.toml"))}


def find_hand(source: str | Path) -> Path:
    """Find the file of a hand by path or by the name of a bundled one. Raises TomlFileError."""
    hands = list_hands()
    path = Path(source)
    is_bare_name = path.name == str(source) and not path.suffix

    # A file of this name comes first, a folder does not.
    if is_bare_name and path.name in hands and not path.is_file():
        path = hands[path.name]
    elif is_bare_name and not path.exists():
        remedy = suggest_name(path.name, list(hands))
        raise TomlFileError(
            Issue(path.name, f"is neither a file nor the name of a bundled hand; {remedy}")
        )

    example = f"the bundled hand {next(iter(hands))}"
    if path.is_dir():
        raise TomlFileError(
            Issue(str(source), f"is a folder; give the path of a hand file, such as {example}.")
        )

    other_names = [name for name in read_toml(path) if name != "hand"]
    if other_names:
        message = (
            f"holds {other_names[0]} besides [hand]; a hand file has the table [hand] alone, as "
            f"{example} has."
        )
        raise TomlFileError(Issue(str(source), message))

    return path


def complete_hand(
    measured: Mapping[str, Any], base: Hand
) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Complete the table [hand], of which a part was measured.

    Returns the table, and the names of the parameters that are guesses. Clearance radius and axis
    height are in the proportion of the `base`, and all else is as there. A tendon lies no nearer to
    the palm than there. It passes palmar of a fork, which is smaller by two tendons. Without room
    for it there is none.

    Raises DesignError if values are not valid, or if a size is missing that does not follow from
    the others.
    """
    hand = parse_tables(Tables, {"hand": dict(measured)}).hand
    values = dict(measured)
    missing = [name for name in _STATED if name not in measured]

    if missing:
        remedy = "`fingertip new --help` tells where to put the calipers"
        raise DesignError(Issue("hand", f"lacks {join_words(missing)}; {remedy}."))

    def guess(name: str, value: float) -> float:
        return float(values.setdefault(name, round(value, 2)))

    line_mm = 0.0
    if measured.get("tendon_distance_mm") != 0:
        line_mm = guess("tendon_diameter_mm", base.tendon_diameter_mm)

    palmar_mm = 2 * line_mm if hand.knuckle == "fork" else 0.0
    share = base.clearance_radius_mm / base.axis_height_mm
    to_palm_mm = base.axis_height_mm - base.tendon_distance_mm
    by_radius_mm = measured.get("clearance_radius_mm", 0.0) / share + palmar_mm
    by_tendon_mm = measured.get("tendon_distance_mm", 0.0) + to_palm_mm
    height_mm = guess("axis_height_mm", max(base.axis_height_mm, by_radius_mm, by_tendon_mm))
    min_mm = hand.pin_diameter_mm / 2 + _AROUND_PIN_MM
    radius_mm = guess("clearance_radius_mm", max(share * (height_mm - palmar_mm), min_mm))
    distance_mm = max(
        min(base.tendon_distance_mm, height_mm - to_palm_mm),
        radius_mm + line_mm if palmar_mm else 0.0,
    )
    guess("tendon_distance_mm", distance_mm if distance_mm < height_mm else 0.0)
    guess("travel_deg", base.travel_deg)

    return values, tuple(
        f"hand.{name}" for name in SIZES if name in values.keys() - measured.keys()
    )


def describe_guesses(provisional: Iterable[str]) -> str:
    """Describe which sizes of the hand are guesses; empty if there are none."""
    names = [
        f"{name} (0: no tendon)" if name == "hand.tendon_distance_mm" else name
        for name in provisional
        if name.startswith("hand.")
    ]
    if not names:
        return ""

    return f"guessed sizes of the hand: {join_words(names)}; measure them before you print"
