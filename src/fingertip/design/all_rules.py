"""Rules between parameters: a design that cannot be made is refused, with a remedy that passes.

A rule checks parameters that are each within their own bounds. Which parameters it reads is recorded, not declared: if
one of them is not valid by itself, the rule is skipped, so that one mistake gives one message and all other rules are
still checked.
"""

from __future__ import annotations

from fingertip.design import interfaces
from fingertip.design.interfaces import clevis_rules, flange, rigid
from fingertip.design.rules import amplifiers, board, bone, skin

PART_RULES = (
    *skin.RULES, *bone.WALL_RULES, *interfaces.LENGTH_RULES, *clevis_rules.LENGTH_RULES, *bone.RULES, *rigid.RULES,
    *flange.RULES, *clevis_rules.RULES, *bone.MOLD_RULES,
)  # fmt: skip
"""Rules of the printed parts and the skin. They read no electronic table."""
ELECTRONIC_RULES = (
    *board.CHANNEL_RULES, *board.RULES, *amplifiers.SUPPLY_RULES, *amplifiers.RULES, *board.SIGNAL_RULES,
    *skin.FORCE_CURVE_RULES,
)  # fmt: skip
"""Rules of the board and of slip detection. They read only the electronic tables."""
RULES = (*PART_RULES, *ELECTRONIC_RULES)
