"""All rules between parameters: what cannot be made is refused, with the bound and a value that would pass.

A rule reads certain fields. If one of those is faulty by itself the rule is not asked, so that one mistake gives one
sentence, and every other rule still speaks.
"""

from __future__ import annotations

from collections.abc import Iterator

from fingertip.design.parameters import DesignTables
from fingertip.design.rules import board, bone, mold, recess, sensor, signal, skin
from fingertip.design.rules.ruleset import broken_rules
from fingertip.errors import Issue

PARTS = (*sensor.RULES, *skin.RULES, *bone.RULES, *recess.RULES, *mold.RULES)
"""Of the printed parts and the skin."""
RULES = (*PARTS, *board.RULES, *signal.RULES)
"""In the order they are asked."""


def find_broken_rules(design: DesignTables) -> Iterator[tuple[Issue, frozenset[str]]]:
    """Each broken rule's issue, with the fields the rule reads."""
    yield from broken_rules(RULES, design)
