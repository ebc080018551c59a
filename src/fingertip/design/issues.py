"""The sentences for single parameters: what pydantic found wrong, said with value, bound and remedy."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from typing import Any

from pydantic import BaseModel, ValidationError

from fingertip.errors import Issue


def issues_from_pydantic(error: ValidationError, model: type[BaseModel]) -> list[Issue]:
    """One issue for each thing pydantic refused in a `model`."""
    return [_issue(detail, model) for detail in error.errors(include_url=False)]


def suggest_name(word: str, known: Sequence[str]) -> str:
    """The remedy for an unknown name: the nearest valid one, else all of them."""
    close = difflib.get_close_matches(word, known, n=1, cutoff=0.5)
    return f"did you mean {close[0]}?" if close else f"known here: {', '.join(known)}."


def _issue(detail: Any, model: type[BaseModel]) -> Issue:
    location = [str(step) for step in detail["loc"]]
    field = ".".join(location)
    value, kind, context = detail["input"], detail["type"], detail.get("ctx", {})
    if kind == "extra_forbidden":
        return Issue(field, f"there is no such parameter; {_nearest_path(location, model)}")
    unit = _unit(location, model)
    match kind:
        case "greater_than_equal":
            return Issue(field, f"{value!r}{unit} is too small; at least {context['ge']:g}{unit}.")
        case "greater_than":
            return Issue(field, f"{value!r}{unit} is too small; it must be above {context['gt']:g}{unit}.")
        case "less_than_equal":
            return Issue(field, f"{value!r}{unit} is too large; at most {context['le']:g}{unit}.")
        case "finite_number":
            return Issue(field, f"{value!r} is not a finite number; give one in{unit or ' plain numbers'}.")
        case "literal_error":
            return Issue(field, f"{value!r} is not known; choose {context['expected']}.")
        case "float_type" | "int_type":
            whole = "a whole number" if kind == "int_type" else "a number"
            return Issue(field, f"{value!r} is not {whole}; write {whole}{unit and ' in' + unit}, without quotes.")
        case "model_type":
            return Issue(field, f"{value!r} is not a table; write [{field}] and its parameters below it.")
        case "string_pattern_mismatch":
            return Issue(field, f"{value!r} cannot name a folder; use up to 40 letters, digits, - and _.")
    return Issue(field, f"{value!r} is refused: {detail['msg']}.")


def _section(location: Sequence[str], model: type[BaseModel]) -> type[BaseModel]:
    for step in location[:-1]:
        info = model.model_fields.get(step)
        if info and isinstance(info.annotation, type) and issubclass(info.annotation, BaseModel):
            model = info.annotation
    return model


def _nearest_path(location: Sequence[str], model: type[BaseModel]) -> str:
    """Nearest valid name in the same table; a name of another table is found too, if it stands there exactly."""
    known = list(_section(location, model).model_fields)
    word = location[-1]
    if not difflib.get_close_matches(word, known, n=1, cutoff=0.5):
        for table, info in model.model_fields.items():
            if word in getattr(info.annotation, "model_fields", {}):
                return f"did you mean {table}.{word}?"
    return suggest_name(word, known)


def _unit(location: Sequence[str], model: type[BaseModel]) -> str:
    info = _section(location, model).model_fields.get(location[-1])
    extra = info.json_schema_extra if info else None
    unit = extra.get("unit", "") if isinstance(extra, dict) else ""
    return f" {unit}" if unit else ""
