"""Hands whose joints are known: the files of `params/hands/`, each with a `[hand]` section and its source."""

from __future__ import annotations

from pathlib import Path

from fingertip.bundled import PARAMS
from fingertip.design.issues import suggest_name
from fingertip.errors import Issue, TomlFileError
from fingertip.toml_files import DESIGN, read_toml


def list_hands() -> dict[str, Path]:
    """List the bundled hands by name."""
    return {path.stem: path for path in sorted((PARAMS / "hands").glob("*.toml"))}


def find_hand(given: str | Path) -> Path:
    """Find the file of a hand by path or by the name of a bundled one, and require that it holds only `[hand]`.

    Raises
    ------
    TomlFileError
        If there is no such file, or if it is no hand file.
    """
    hands, path = list_hands(), Path(given)
    if path.name == str(given) and not path.suffix and not path.exists():
        if path.name not in hands:
            raise TomlFileError(
                Issue(
                    path.name,
                    f"is neither a file nor the name of a bundled hand; {suggest_name(path.name, list(hands))}",
                )
            )
        path = hands[path.name]
    others = [name for name in read_toml(path, DESIGN) if name != "hand"]
    if others:
        message = (
            f"holds {others[0]} besides [hand]; a hand file has the table [hand] alone, as {next(iter(hands))} has."
        )
        raise TomlFileError(Issue(str(given), message))
    return path
