"""First and second set of tests: what runs without FINGERTIP_FULL=1.

The first set is the README's command. It was chosen by what it notices in a second
(`tools/mutation`), and by what a test of it costs: a second or two at most. A test that costs more
and is needed on every push is marked `second`: `.ci/run` runs these after the first set, by
`pytest -m second`. The others are marked `full`. The whole suite notices more and takes ten times
as long. Of a test with many cases a few run, spread evenly, unless it is marked `every_case`. A
test that is named on the command line with all its cases (`FILE::TEST`) always runs.
"""

from __future__ import annotations

import os
from collections.abc import Iterable

import pytest

FULL = bool(os.environ.get("FINGERTIP_FULL"))
"""True in `.ci/full`, where every test runs with all its cases but those marked `long`."""
LONG = os.environ.get("FINGERTIP_FULL") == "long"
"""True in `.ci/long`."""
MOST_CASES = 3
"""Number of cases of a test of the first set."""


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what is not in the set that runs."""
    if LONG or any("::" in word for word in config.args):
        return

    if FULL:
        kept = {item for item in items if not item.get_closest_marker("long")}
    else:
        kept = select(items, second=config.option.markexpr == "second")

    config.hook.pytest_deselected(items=[item for item in items if item not in kept])
    items[:] = [item for item in items if item in kept]


def select(items: Iterable[pytest.Item], second: bool = False) -> set[pytest.Item]:
    """Select the first set, or the second, among all tests."""
    families: dict[str, list[pytest.Item]] = {}
    for item in items:
        if item.get_closest_marker("full") or item.get_closest_marker("long"):
            continue
        if bool(item.get_closest_marker("second")) == second:
            families.setdefault(item.nodeid.partition("[")[0], []).append(item)
    kept = set[pytest.Item]()
    for family in families.values():
        step = 1 if family[0].get_closest_marker("every_case") else -(-len(family) // MOST_CASES)
        kept |= set(family[::step])
    return kept
