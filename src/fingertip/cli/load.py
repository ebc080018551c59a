"""A design as a command was given it; a file of another kind is answered with what it is, and who takes it."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fingertip.design import Design


def load_design(file: Path | None, changes: Sequence[str] | None) -> tuple[Design, dict[str, Any]]:
    """The design of a file (of the defaults, without one) with changes; and what file and changes say, without what
    they leave to the defaults.

    Raises
    ------
    DesignError
        If the file is missing or no valid TOML, the design is refused, or the file is none of a design.
    """
    from fingertip.design import Design
    from fingertip.design.load import load_tables
    from fingertip.errors import DesignError

    tables = load_tables([file] if file else [], changes or ())
    try:
        return Design(**tables), tables
    except DesignError:
        refuse_other(file)
        raise


def refuse_other(file: Path | None, wanted: str = "a design") -> None:
    """Refuse a file that says it is of another kind than is wanted: its names would all be called unknown.

    Raises
    ------
    DesignError
        With what it is, and which command takes it.
    """
    from fingertip.errors import DesignError, Issue

    if file is not None and (what := kind(file)) and what != wanted:
        raise DesignError(Issue(str(file), f"is {what}, no {wanted.split()[1]}; {_taker(what, file)}."))


def refuse_sweep(file: Path | None) -> None:
    """Refuse a sweep where a design or a scene is wanted. Raises DesignError."""
    if file is not None and kind(file) == "a sweep":
        refuse_other(file)


def kind(file: Path) -> str:
    """`a design`, `a sweep`, `a scene` or `a manipulation` by the names at the file's top level; "" if they do not
    tell, or cannot be read."""
    from fingertip.design import Design
    from fingertip.sim import ManipulationFile, SceneFile

    try:
        names = set(tomllib.loads(file.read_text(encoding="utf-8-sig")))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
        return ""
    if "axes" in names:
        return "a sweep"
    of_design, of_scene, of_manipulation = (set(c.model_fields) for c in (Design, SceneFile, ManipulationFile))
    if names & (of_manipulation - of_scene - of_design):
        return "a manipulation"
    if names & (of_scene - of_design):
        return "a scene"
    return "a design" if names & of_design else ""


def _taker(what: str, file: Path) -> str:
    if what == "a sweep":
        return f"fingertip sweep {file} takes it"
    if what == "a design":
        return f'name it in a sweep, design = "{file.name}"'
    return f"fingertip simulate {file} takes it, and a design beside it with --design"
