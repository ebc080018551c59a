"""Finger of a file `parameters.py`, for the scripts beside this folder.

Its parameters are compared with their bounds, and what follows from them is that of the program.
What the program knows stands in `catalogue.json`, which `fingertip build --formats cq` writes to
this folder: bounds and choices, sensors, strengths of materials, and outlines of letters.
"""

from __future__ import annotations

import difflib
import json
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from runpy import run_path
from types import SimpleNamespace
from typing import Any

from .dimensions import Dimensions
from .mold_layout import MoldLayout

_CATALOGUE = Path(__file__).with_name("catalogue.json")


class ParameterError(ValueError):
    """Parameters that are misspelled, missing or out of their bounds, a sentence for each."""


class Table(SimpleNamespace):
    """Table of parameters, such as `Table(width_mm=17.0)`."""


class Finger:
    """Parameters of one finger by table, and what follows from them.

    Raises ParameterError.
    """

    def __init__(self, name: str, **tables: Table) -> None:
        catalogue = json.loads(_CATALOGUE.read_text(encoding="utf-8"))
        self.letters = catalogue["letters"]
        problems = [*_check_name(name, self.letters), *_check_tables(tables, catalogue)]
        if problems:
            raise ParameterError("\n".join(problems))

        self.name = name
        self.skin = tables["skin"]
        self.sensor = tables["sensor"]
        self.bone = tables["bone"]
        self.hand = tables["hand"]
        self.mold = tables["mold"]
        self.printer = tables["printer"]
        self.strength = tables["strength"]
        sensors = {model: Table(**sizes) for model, sizes in catalogue["sensors"].items()}
        self.force_sensor = (sensors | {"custom": tables["custom_sensor"]})[self.sensor.model]
        strengths_mpa = catalogue["strengths_mpa"] | {"own": self.strength.own_strength_mpa}
        self.layer_strength_mpa = strengths_mpa[self.strength.print_material]

    @cached_property
    def dimensions(self) -> Dimensions:
        return Dimensions(self)  # type: ignore[arg-type]  # it has what a design has

    @cached_property
    def mold_layout(self) -> MoldLayout:
        return MoldLayout(self, self.dimensions)  # type: ignore[arg-type]


def read_finger(folder: Path, script: str) -> Finger:
    """Read `parameters.py` of a folder, for a script with this `__name__`.

    Run by itself, it ends with what is wrong in sentences; elsewhere they are raised as
    ParameterError.
    """
    try:
        finger: Finger = run_path(str(folder / "parameters.py"))["finger"]
    except ParameterError as error:
        if script == "__main__":
            raise SystemExit(str(error)) from None

        raise

    return finger


def _check_name(name: str, letters: Mapping[str, Any]) -> Iterator[str]:
    if not 0 < len(name) <= 40 or any(letter not in letters for letter in name.upper()):
        yield f"name = {name!r} needs 1 to 40 letters, digits, - and _."


def _check_tables(tables: Mapping[str, Table], catalogue: Mapping[str, Any]) -> Iterator[str]:
    bounds = catalogue["bounds"]
    choices = catalogue["choices"]
    known = [*bounds, *choices]
    stated = {
        f"{table}.{key}": v for table, keys in tables.items() for key, v in vars(keys).items()
    }

    for path in stated:
        if path not in known:
            similar = difflib.get_close_matches(path, known, 1)
            hint = f"did you mean {similar[0]}?" if similar else "remove it."
            yield f"there is no parameter {path}; {hint}"

    for path in known:
        if path not in stated:
            yield f"{path} is missing."
        elif path in choices and stated[path] not in choices[path]:
            yield f"{path} = {stated[path]!r} is none of {', '.join(map(repr, choices[path]))}."
        elif path in bounds and not _is_within(stated[path], *bounds[path]):
            low, high = bounds[path]
            yield f"{path} = {stated[path]!r} is no number within {low:g} to {high:g}."


def _is_within(value: Any, low: float, high: float) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and low <= value <= high
