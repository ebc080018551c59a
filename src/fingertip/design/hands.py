"""Hands whose joints are known: the files of `params/hands/`, each with a `[hand]` section and its source."""

from __future__ import annotations

from pathlib import Path

from fingertip.bundled import PARAMS
from fingertip.design.issues import suggest_name
from fingertip.design.parameters import Hand
from fingertip.errors import Issue, TomlFileError
from fingertip.toml_files import read_toml

_OPTIONAL = ("length_limit_mm", "tendon_diameter_mm")


def list_hands() -> dict[str, Path]:
    """List the bundled hands by name."""
    return {path.stem: path for path in sorted((PARAMS / "hands").glob("*.toml"))}


def find_hand(given: str | Path) -> Path:
    """Find the file of a hand by path or by the name of a bundled one.

    Raises
    ------
    TomlFileError
        If there is no such file, if it holds more than `[hand]`, or if a size is missing there.
    """
    hands, path = list_hands(), Path(given)
    if path.name == str(given) and not path.suffix and not path.exists():
        if path.name not in hands:
            remedy = suggest_name(path.name, list(hands))
            raise TomlFileError(Issue(path.name, f"is neither a file nor the name of a bundled hand; {remedy}"))
        path = hands[path.name]
    if message := _find_fault(path, f"the bundled hand {next(iter(hands))}"):
        raise TomlFileError(Issue(str(given), message))
    return path


def _find_fault(path: Path, example: str) -> str:
    """Describe what is wrong with a hand file; nothing if it is complete."""
    if path.is_dir():
        return f"is a folder; give the path of a hand file, such as {example}."
    tables = read_toml(path)
    others, hand = [name for name in tables if name != "hand"], tables.get("hand", {})
    if others:
        return f"holds {others[0]} besides [hand]; a hand file has the table [hand] alone, as {example} has."
    missing = [name for name in Hand.model_fields if name not in hand and name not in _OPTIONAL]
    if missing:
        return f"lacks {', '.join(missing)} in [hand]; measure your hand, or start from {example}."
    return ""
