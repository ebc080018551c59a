"""Declaration of a parameter in one line of its table, and messages about invalid values."""

from __future__ import annotations

import difflib
import functools
import inspect
import itertools
import json
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple, TypeVar, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core.core_schema import CoreSchema, literal_schema

from fingertip.foundation.errors import (
    MAX_VALUE_LENGTH,
    DesignError,
    Issue,
    join_words,
    quote_value,
    shorten,
)
from fingertip.foundation.tables import read_rows

Model = TypeVar("Model", bound=BaseModel)


class Frozen(BaseModel):
    """Parameters that stay as they were loaded."""

    def __setattr__(self, name: str, value: Any) -> None:
        if name in self.__private_attributes__:
            super().__setattr__(name, value)
            return

        # The name of a class is that of its table, such as CustomSensor of [custom_sensor].
        words = re.sub("(?<=[a-z])(?=[A-Z])", "_", type(self).__name__)
        table = words.lower().removeprefix("chosen_")
        path = f"{table}.{name}" if isinstance(self, ParameterTable) else name
        message = (
            f"stays as it was loaded; load it again with changes={{{json.dumps(path)}: "
            f"{quote_value(value)}}}."
        )
        raise DesignError(Issue(path, message))


class ParameterTable(Frozen):
    """A table of a TOML file. It is frozen, and strict about the types and names it accepts."""

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        allow_inf_nan=False,
    )


@dataclass(frozen=True)
class Bounds:
    """Bounds of a numeric parameter, in its unit; None for a bound that it does not have."""

    minimum: float | None = None
    above: float | None = None
    """Exclusive lower bound."""
    maximum: float | None = None

    def contain(self, value: float) -> bool:
        return (
            (self.minimum is None or value >= self.minimum)
            and (self.above is None or value > self.above)
            and (self.maximum is None or value <= self.maximum)
        )


class Above(NamedTuple):
    """Lower bound that is not valid itself."""

    bound: float


class Follows(NamedTuple):
    """Range within which a fit may move a parameter that follows from others."""

    low: float
    high: float


def quantity(
    default: float,
    unit: str,
    bounds: tuple[float | Above, float],
    description: str,
    *,
    follows: tuple[float, float] | None = None,
) -> Any:
    """Declare a number with a unit and its lower and upper bound.

    A number that follows from others, unless it is stated, has the range within which a fit may
    move it.
    """
    low, high = bounds
    ge, gt = (None, low.bound) if isinstance(low, Above) else (low, None)
    field: Any = Field(
        default,
        ge=ge,
        gt=gt,
        le=high,
        description=description,
        json_schema_extra={"unit": unit},
    )
    if follows:
        field.metadata.append(Follows(*follows))

    return field


class OneOf:
    """Annotation of a text that is one of some names, as a `Literal` of them would be."""

    def __init__(self, *names: str, explain: Callable[[str], str] = lambda word: "") -> None:
        self.names = names
        self.explain = explain
        """Function that explains why a word is none of the names, and what to do."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        return literal_schema([*self.names])


def choice(default: str | bool, description: str) -> Any:
    """Declare one of several words, or a flag."""
    return Field(default, description=description)


OWN = "own"
"""Name that stands for a silicone or a printing material of the user's own."""
_MARKUP = (
    r"|`<>\[\]$\\\u0000-\u001f\u007f-\u009f\u00ad\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff"
)
"""Characters with a meaning in a file: marks of Markdown and of formulas, and control
characters.
"""
_LABEL = rf"^[^\s=+@\-{_MARKUP}][^{_MARKUP}]{{0,59}}$"
_ALLOWED = (
    "write up to 60 printable characters without | ` < > [ ] $ or a backslash, and none of "
    "= + - @ first"
)


def text(default: str, description: str, *, pattern: str = _LABEL, allowed: str = _ALLOWED) -> Any:
    """Declare a text that sheets print."""
    return Field(
        default, pattern=pattern, description=description, json_schema_extra={"allowed": allowed}
    )


def find_extra(field: FieldInfo, key: str) -> str:
    """Return what the declaration of a field states under a key such as "unit", or ""."""
    extra = field.json_schema_extra
    return str(extra.get(key, "")) if isinstance(extra, dict) else ""


def find_unit(field: FieldInfo) -> str:
    return find_extra(field, "unit")


def find_bounds(field: FieldInfo) -> Bounds:
    bounds: dict[str, float] = {}
    for constraint in field.metadata:
        for key, name in (("ge", "minimum"), ("gt", "above"), ("le", "maximum")):
            bound = getattr(constraint, key, None)
            if bound is not None:
                bounds[name] = bound

    return Bounds(**bounds)


def find_follows(field: FieldInfo) -> Follows | None:
    """Return the range in which a fit may move a derived parameter; None for any other."""
    return next((note for note in field.metadata if isinstance(note, Follows)), None)


def describe_table(model: Any) -> str:
    """Return the docstring of a table in one line, as files and schemas state it."""
    return " ".join((inspect.getdoc(model) or "").split())


def list_choices(field: FieldInfo) -> tuple[str, ...]:
    """Return the words that a parameter accepts; none for a number or free text."""
    if get_origin(field.annotation) is Literal:
        return get_args(field.annotation)

    return next((note.names for note in field.metadata if isinstance(note, OneOf)), ())


def format_unit(unit: str) -> str:
    """Return a unit as it follows a number in a sentence, with the space before it."""
    return f" {_PLURALS.get(unit, unit)}" if unit else ""


_PLURALS = {"degree": "degrees", "bit": "bits"}

_MIN_SIMILARITY = 0.65
"""Ratio of `difflib.SequenceMatcher` from which a known name is suggested for an unknown one."""

_MAX_DESCRIBED = 300
"""Maximum number of problems that are described. A design has fewer parameters."""
_MAX_LISTED = 100
"""Maximum number of known names that are listed. A sweep of a design has more outputs, a table
fewer parameters.
"""
_MAX_COMPARED_LENGTH = 60
"""Maximum length of a word that known names are compared with [characters]."""

_FEW = 2
"""Largest number of groups of retired names that are soon mended by hand."""


@functools.cache
def load_retired() -> Mapping[str, str]:
    """Load the remedies for retired parameters, and retired outputs of a sweep, by name."""
    remedies: dict[str, str] = {}
    for row in read_rows(Path(__file__).with_name("retired.csv")):
        remedies |= dict.fromkeys(row["names"].split(), row["instead"])

    return remedies


def describe_retired(names: Iterable[str]) -> list[Issue]:
    """Return an issue for each group of retired names, and for many groups a command."""
    groups: dict[str, list[str]] = {}
    for name in names:
        groups.setdefault(load_retired()[name], []).append(name)

    issues = [Issue(", ".join(group), remedy) for remedy, group in groups.items()]
    if len(groups) > _FEW:
        command = "`fingertip new NAME --from FILE`"
        issues.append(Issue("design", f"{command} writes such a design anew, with its sizes."))

    return issues


def issues_from_pydantic(error: ValidationError, model: type[BaseModel]) -> list[Issue]:
    """Return one issue for each problem of a `model`.

    Only the first problems are described: thousands would take hours.
    """
    problems = {
        ".".join(map(str, details["loc"])): details
        for details in error.errors(include_url=False, include_context=True)
    }
    retired = [
        name
        for name, details in problems.items()
        if details["type"] == "extra_forbidden" and name in load_retired()
    ]
    issues = describe_retired(retired)
    others = [name for name in problems if name not in retired]
    issues += [_describe(problems[name], model) for name in others[:_MAX_DESCRIBED]]
    rest = "is not valid either; correct what is listed above first."
    return issues + [Issue(name, rest) for name in others[_MAX_DESCRIBED:]]


def parse_tables(model: type[Model], tables: Mapping[str, Any]) -> Model:
    """Make a model of the tables of a file. Raises DesignError."""
    try:
        return model(**tables)
    except ValidationError as error:
        raise DesignError(issues_from_pydantic(error, model)) from None


def suggest_name(word: str, known: Sequence[str]) -> str:
    """Return the remedy for an unknown name: the most similar known one, or a list of them."""
    similar = find_similar_name(word, known)
    if similar:
        return f"did you mean {similar}?"

    rest = f" and {len(known) - _MAX_LISTED} more" if len(known) > _MAX_LISTED else ""
    return f"known names: {', '.join(known[:_MAX_LISTED])}{rest}."


def find_similar_name(word: str, known: Sequence[str]) -> str | None:
    """Find the known name most similar to a word, with or without units; None without one."""

    def similarity(name: str) -> float:
        pairs = itertools.product(_with_and_without_unit(word), _with_and_without_unit(name))
        return max(difflib.SequenceMatcher(None, *pair).ratio() for pair in pairs)

    word = word[:_MAX_COMPARED_LENGTH]
    best = max(known, key=similarity, default=None)
    return best if best is not None and similarity(best) >= _MIN_SIMILARITY else None


def _describe(details: Any, model: type[BaseModel]) -> Issue:
    """Describe one problem.

    The types and their context are pydantic's, see its "Validation Errors".
    """
    location = [str(step) for step in details["loc"]]
    field = ".".join(location)
    value = details["input"]
    kind = details["type"]
    context = details.get("ctx", {})
    shown = quote_value(value)
    if kind == "extra_forbidden":
        return Issue(field, f"there is no such parameter; {_suggest_parameter(location, model)}")

    info = _find_table(location, model).model_fields.get(location[-1])
    unit = format_unit(find_unit(info)) if isinstance(info, FieldInfo) else ""
    match kind:
        case "greater_than_equal":
            return Issue(field, f"{shown}{unit} is too small; at least {context['ge']:g}{unit}.")
        case "greater_than":
            example = f", such as {info.default:g}{unit}" if isinstance(info, FieldInfo) else ""
            return Issue(
                field,
                f"{shown}{unit} is too small; it must be above {context['gt']:g}{unit}{example}.",
            )
        case "less_than_equal":
            return Issue(field, f"{shown}{unit} is too large; at most {context['le']:g}{unit}.")
        case "finite_number":
            return Issue(field, f"{shown} is not a finite number; give one{unit and ' in' + unit}.")
        case "literal_error" if reason := _explain_choice(info, str(value)):
            return Issue(field, f"{shown} is not in the catalogue; {reason}.")
        case "literal_error":
            similar = (
                find_similar_name(str(value), list_choices(info))
                if isinstance(info, FieldInfo)
                else None
            )
            suggestion = f" Did you mean {similar}?" if similar else ""
            names = (
                ".".join([*location[:-1], name])
                for name in _find_table(location, model).model_fields
            )
            own = [name for name in names if ".own_" in name and OWN in list_choices(info)]  # type: ignore[arg-type]
            state = f" With {OWN}, state {join_words(own)}." if own else ""
            return Issue(
                field, f"{shown} is not known; choose {context['expected']}.{suggestion}{state}"
            )
        case "float_type" | "int_type" if isinstance(value, str) and "=" in value:
            return Issue(field, f"{shown} holds several changes; give --set once for each of them.")
        case "float_type" | "int_type" if isinstance(value, str) and re.match(
            r"\s*[-+]?\.?\d", value
        ):
            number = f"the number{unit and ' in' + unit}"
            left_out = "quotes" if re.fullmatch(r"[-+.\de\s]+", value) else "its unit"
            return Issue(field, f"{shown} is not a number; write {number}, without {left_out}.")
        case "float_type" if type(value) is int:
            return Issue(
                field,
                f"{shown} is too large for a float; write a smaller number{unit and ' in' + unit}.",
            )
        case "float_type" | "int_type":
            number = "a whole number" if kind == "int_type" else "a number"
            quotes = ", without quotes" if isinstance(value, str) else ""
            return Issue(
                field, f"{shown} is not {number}; write {number}{unit and ' in' + unit}{quotes}."
            )
        case "string_type":
            example = shorten(str(value), MAX_VALUE_LENGTH)
            return Issue(field, f'{shown} is not text; write it in quotes, such as "{example}".')
        case "bool_type" | "bool_parsing":
            return Issue(
                field, f"{shown} is neither true nor false; write true or false, without quotes."
            )
        case "list_type":
            plain = ",".join(map(str, value.values())) if isinstance(value, dict) else str(value)
            text = shorten(plain, MAX_VALUE_LENGTH).strip("[]").split(",")
            items = ",".join(json.dumps(item.strip(), ensure_ascii=False) for item in text)
            return Issue(
                field,
                f"{shown} is not a list; write '{field}=[{items}]', with both kinds of quotes.",
            )
        case "dict_type":
            return Issue(
                field, f"{shown} is not a table; write [{field}] and its entries below it."
            )
        case "model_type":
            return Issue(field, f"{shown} is not a table; {_show_parameter(location, model)}.")
        case "string_pattern_mismatch" if isinstance(info, FieldInfo) and (
            allowed := find_extra(info, "allowed")
        ):
            return Issue(field, f"{shown} cannot stand here; {allowed}.")
        case "string_pattern_mismatch":
            return Issue(
                field, f"{shown} cannot name a folder; use up to 40 letters, digits, - and _."
            )

    return Issue(field, f"{shown} is not valid: {details['msg']}.")


def _with_and_without_unit(name: str) -> tuple[str, str]:
    return name, name.rpartition("_")[0] or name


def _explain_choice(info: Any, word: str) -> str:
    """Explain why a word is none of a field's names; "" if the field does not know."""
    notes = info.metadata if isinstance(info, FieldInfo) else ()
    return next((note.explain(word) for note in notes if isinstance(note, OneOf)), "")


def _find_table(location: Sequence[str], model: type[BaseModel]) -> type[BaseModel]:
    for step in location[:-1]:
        info = model.model_fields.get(step)
        if info and isinstance(info.annotation, type) and issubclass(info.annotation, BaseModel):
            model = info.annotation

    return model


def _show_parameter(location: Sequence[str], model: type[BaseModel]) -> str:
    defaults = {
        key: info.default for key, info in _find_table([*location, ""], model).model_fields.items()
    }
    numbers = {key: value for key, value in defaults.items() if isinstance(value, float)}
    example = next((f"{key}={value:g}" for key, value in numbers.items()), "KEY=VALUE")
    return f"set its parameters one by one, such as {'.'.join(location)}.{example}"


def _suggest_parameter(location: Sequence[str], model: type[BaseModel]) -> str:
    """Suggest a parameter of the same table, or up to three of this name in other tables."""
    *tables, name = location
    known = list(_find_table(location, model).model_fields)

    if find_similar_name(name, known) is None:
        fields = {
            table: getattr(info.annotation, "model_fields", ())
            for table, info in model.model_fields.items()
        }
        places = [f"{table}.{name}" for table, names in fields.items() if name in names]
        if places:
            return f"did you mean {join_words(places[:3], 'or')}?"

    # The name is compared without its table, which would make all parameters of the table similar.
    return suggest_name(name, known).replace(
        "did you mean ", f"did you mean {'.'.join([*tables, ''])}"
    )
