"""Strategies of values and texts: from the declarations of
parameters, at their bounds, and far outside.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from hypothesis import strategies as st
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from fingertip.design.parameters import ParameterTable
from fingertip.design.parameters.declaration import find_bounds, list_choices

Raw = str
"""Text of a TOML value, as it stands in a file."""

ODD_TEXTS = (
    "",
    " ",
    "\0",
    "\x1b[31m",
    "\u202e",
    "\ud7ff",
    "\N{PILE OF POO}",
    "x" * 5000,
    "../../etc",
    "a\nb",
    "'\"",
    "%s%n",
    "nan",
    "__class__",
    "self",
    "-",
    "=",
    ".",
    "none",
    "\\",
    "fsr402",
    "true",
)
ODD_NUMBERS = (
    "nan",
    "inf",
    "-inf",
    "-0.0",
    "0",
    "1e308",
    "1e-308",
    "5e-324",
    "-1",
    "9223372036854775807",
    "9223372036854775808",
    "0x7fffffffffffffff",
    "1" + "0" * 400,
    "9" * 5000,
    "1_000",
    "1e400",
    "0.1e-999",
)
ODD_VALUES = (
    "true",
    "false",
    "[]",
    "[[]]",
    "{}",
    '[""]',
    "[1, 2, 3]",
    "1979-05-27",
    "07:32:00",
    "1979-05-27T07:32:00Z",
    '""',
    "[" * 30 + "]" * 30,
    "[" * 3000 + "]" * 3000,
    "{a = 1}",
    '"""x"""',
    "[nan]",
    "[1, 'a', []]",
    "",
    "'",
    "1,5",
    "3 mm",
)


def write_text(text: str) -> Raw:
    """Write a text as TOML, whose escapes are those of JSON but for surrogates."""
    return json.dumps(text.encode("utf-8", "replace").decode(), ensure_ascii=False).replace(
        "\x7f", "\\u007f"
    )


def odd_values() -> st.SearchStrategy[Raw]:
    """Values that no parameter has, or hardly any."""
    return st.one_of(
        st.sampled_from(ODD_NUMBERS),
        st.sampled_from(ODD_VALUES),
        st.sampled_from(ODD_TEXTS).map(write_text),
        st.floats().map(repr),
        st.integers(-(2**70), 2**70).map(str),
        st.text(max_size=20).map(write_text),
    )


def values_of(info: FieldInfo) -> st.SearchStrategy[Raw]:
    """Values of a parameter: mostly within its bounds, often at them or
    next to them, and some that it cannot have.
    """
    choices = list_choices(info)
    if choices:
        inside: st.SearchStrategy[Raw] = st.sampled_from(choices).map(write_text)
    elif info.annotation is bool:
        inside = st.sampled_from(("true", "false"))
    elif info.annotation in (int, float):
        inside = _numbers_of(info)
    else:
        inside = st.text(max_size=12).map(write_text)

    return st.one_of(inside, inside, inside, inside, odd_values())


def _numbers_of(info: FieldInfo) -> st.SearchStrategy[Raw]:
    bounds = find_bounds(info)
    default = info.default
    low = bounds.minimum if bounds.minimum is not None else bounds.above
    low = -1e6 if low is None else low
    high = 1e6 if bounds.maximum is None else bounds.maximum

    if info.annotation is int:
        edges = [int(edge) + step for edge in (low, high) for step in (-1, 0, 1)]
        return st.one_of(
            st.sampled_from([*edges, int(default or 0)]), st.integers(int(low), int(high))
        ).map(str)

    edges_f = [math.nextafter(edge, to) for edge in (low, high) for to in (-math.inf, math.inf)]
    near = st.floats(0.5, 2.0).map(lambda factor: float(f"{factor * float(default or 0.0):.4g}"))
    return st.one_of(near, near, st.sampled_from([low, high, *edges_f]), st.floats(low, high)).map(
        repr
    )


def list_parameters(model: type[BaseModel]) -> Mapping[str, FieldInfo]:
    """Parameters of a file by dotted name."""
    found: dict[str, FieldInfo] = {}
    for name, info in model.model_fields.items():
        if isinstance(info.default, ParameterTable):
            found |= {
                f"{name}.{key}": field for key, field in type(info.default).model_fields.items()
            }
        else:
            found[name] = info

    return found


def _odd_name(name: str) -> st.SearchStrategy[str]:
    return st.sampled_from(
        (
            name[:-1],
            name.upper(),
            name.replace("_", "-"),
            "self",
            "skin.self",
            "a",
            "skin.width_mm.x",
            "model_config",
            "skin.dimensions",
            "__init__",
            "x" * 2000,
        )
    )


@st.composite
def parameter_lines(
    draw: st.DrawFn, model: type[BaseModel], most: int = 6
) -> list[tuple[str, Raw]]:
    """Names and values of some parameters of a file; a few names are unknown."""
    parameters = list_parameters(model)
    names = draw(st.lists(st.sampled_from(sorted(parameters)), max_size=most, unique=True))
    lines = []

    for name in names:
        value = draw(values_of(parameters[name]))
        lines.append((draw(_odd_name(name)) if draw(st.integers(0, 19)) == 0 else name, value))

    return lines


@st.composite
def toml_files(draw: st.DrawFn, model: type[BaseModel], most: int = 8) -> bytes:
    """Text of a file whose parameters are drawn from a model."""
    lines = [f"{name} = {value}" for name, value in draw(parameter_lines(model, most))]
    return "\n".join(lines).encode("utf-8", "replace")


def as_python(raw: Raw) -> Any:
    """Value of a number's or word's text."""
    return json.loads(raw)
