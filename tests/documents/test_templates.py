"""Every field that a template names is one of the dataclass that fills it, also where no design takes its branch."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import is_dataclass
from typing import Any, get_args, get_type_hints

import pytest
from jinja2 import meta, nodes

from fingertip.casting.sheet import CastingSheet
from fingertip.documents.acceptance import AcceptanceSheet
from fingertip.documents.finger import FirstScreen, Step
from fingertip.documents.finger_set import SetSheets
from fingertip.documents.robot import ModelFigures
from fingertip.documents.template import _environment
from tests.conftest import ROOT

ROBOT = (
    "fingers", "file", "tolerance_mm", "reference_n", "timestep_s", "pad_n", "spacing_mm", "facet_mm", "speed_rad_s",
)  # fmt: skip
FIELDS: dict[str, tuple[type, dict[str, Any]]] = {
    "acceptance.md": (AcceptanceSheet, {"preload": str}),
    "casting.md": (CastingSheet, {"steps": tuple[Step, ...], "pictures": Any, "number": Any, "usd": Any}),
    "casting_steps.md": (CastingSheet, {}),
    "start.md": (FirstScreen, {"usd": Any}),
    "robot.md": (ModelFigures, dict.fromkeys(ROBOT, Any)),
    "set_acceptance.md": (SetSheets, {}),
    "set_overview.md": (SetSheets, {}),
    "set_parts.md": (SetSheets, {}),
    "set_plan.md": (SetSheets, {}),
    "set_start.md": (SetSheets, {}),
}
"""Template -> dataclass that fills it, and what it is given besides."""


def list_missing(text: str, names: Mapping[str, Any]) -> Iterator[str]:
    """List what a template names and no field is. Names that it sets itself may be anything."""
    tree = _environment().parse(text)
    yield from sorted(meta.find_undeclared_variables(tree) - names.keys())
    types = dict(names)
    for loop in tree.find_all(nodes.For):
        if isinstance(loop.target, nodes.Name):
            types[loop.target.name] = (*get_args(find_type(loop.iter, types)), Any)[0]
    for access in tree.find_all(nodes.Getattr):
        owner = find_type(access.node, types)
        if is_dataclass(owner) and access.attr not in get_type_hints(owner) and not hasattr(owner, access.attr):
            yield f"{getattr(owner, '__name__', owner)}.{access.attr}"


def find_type(node: nodes.Node, types: Mapping[str, Any]) -> Any:
    """Find the type of an expression, without None; Any where it is not one of the dataclasses or a tuple of them."""
    match node:
        case nodes.Name(name=name):
            found = types.get(name, Any)
        case nodes.Getattr(node=owner, attr=name):
            kind = find_type(owner, types)
            found = get_type_hints(kind).get(name, Any) if is_dataclass(kind) else Any
        case nodes.Getitem(node=owner):
            found = (*get_args(find_type(owner, types)), Any)[0]
        case nodes.Filter(node=owner, name="selectattr" | "rejectattr" | "list") if owner:
            found = find_type(owner, types)
        case _:
            found = Any
    return (
        next((one for one in get_args(found) if is_dataclass(one)), found) if type(None) in get_args(found) else found
    )


@pytest.mark.every_case
@pytest.mark.parametrize("template", FIELDS)
def test_a_template_names_no_field_that_its_dataclass_has_not(template: str) -> None:
    kind, others = FIELDS[template]
    text = (ROOT / "src/fingertip/documents" / template).read_text(encoding="utf-8")
    assert list(list_missing(text, {**get_type_hints(kind), **others})) == []


def test_a_missing_field_is_noticed() -> None:
    names = get_type_hints(SetSheets)
    assert list(list_missing("{{ nothing }}{{ plan.cups[0].grams }}", names)) == ["nothing", "Cup.grams"]
    assert list(list_missing("{% for row in fingers %}{{ row.color }}{% endfor %}", names)) == ["FingerRow.color"]
    assert list(list_missing("{{ board.color }}{{ plan.days }}", names)) == ["SharedBoard.color"]
