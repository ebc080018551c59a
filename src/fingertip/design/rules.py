"""All rules between parameters: what cannot be made is refused, with the bound and a value that would pass.

A rule reads certain fields. If one of those is faulty by itself the rule is not asked, so that one mistake gives one
sentence, and every other rule still speaks.
"""

from __future__ import annotations

from collections.abc import Iterator

from fingertip.design import board_rules, bone_rules, finger_rules, mold_rules, recess_rules, sensor_rules, signal_rules
from fingertip.design.ruleset import broken_rules
from fingertip.design.tables import Tables
from fingertip.errors import Issue

PARTS = (*sensor_rules.RULES, *finger_rules.RULES, *bone_rules.RULES, *recess_rules.RULES, *mold_rules.RULES)
"""Of the printed parts and the skin."""
RULES = (*PARTS, *board_rules.RULES, *signal_rules.RULES)
"""In the order they are asked."""


def broken(design: Tables) -> Iterator[tuple[Issue, frozenset[str]]]:
    """Each broken rule's issue, with the fields the rule reads."""
    yield from broken_rules(RULES, design)
