"""First and second set of tests: what they leave out."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import pytest

from tests.first_set import pytest_collection_modifyitems, select


@dataclass(frozen=True)
class Item:
    nodeid: str
    marks: tuple[str, ...] = ()

    def get_closest_marker(self, name: str) -> bool:
        return name in self.marks


def test_a_few_cases_run_evenly_spread_or_all_that_are_asked_for(monkeypatch: Any) -> None:
    many = [Item(f"a.py::test_many[{i}]") for i in range(20)]
    every = [Item(f"a.py::test_every[{i}]", ("every_case",)) for i in range(20)]
    items: list[Any] = [
        Item("a.py::test_full", ("full",)),
        Item("a.py::test_long", ("long",)),
        *many,
        *every,
    ]
    assert select(items) == {many[0], many[7], many[14], *every}
    deselected: list[Any] = []
    hook = SimpleNamespace(pytest_deselected=lambda items: deselected.extend(items))
    first = SimpleNamespace(markexpr="")
    named: Any = SimpleNamespace(args=["a.py::test_full"], hook=hook, option=first)
    pytest_collection_modifyitems(named, items)
    assert len(items) == 42
    whole: Any = SimpleNamespace(args=["a.py"], hook=hook, option=first)
    for full, left in ((True, 41), (False, 23)):
        monkeypatch.setattr("tests.first_set.FULL", full)
        pytest_collection_modifyitems(whole, items)
        assert (len(items), len(items) + len(deselected)) == (left, 42)


def test_the_second_set_is_what_is_marked_and_the_whole_suite_has_both() -> None:
    for expression, full, names in (
        ("", False, ["test_quick"]),
        ("second", False, ["test_slow"]),
        ("", True, ["test_quick", "test_slow", "test_full"]),
    ):
        items: list[Any] = [
            Item("a.py::test_quick"),
            Item("a.py::test_slow", ("second",)),
            Item("a.py::test_full", ("full",)),
        ]
        config: Any = SimpleNamespace(
            args=["a.py"],
            hook=SimpleNamespace(pytest_deselected=lambda items: None),
            option=SimpleNamespace(markexpr=expression),
        )
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("tests.first_set.FULL", full)
            pytest_collection_modifyitems(config, items)

        assert [item.nodeid.partition("::")[2] for item in items] == names
