"""Rules between parameters: a design that cannot be made is refused, with a remedy that passes.

A rule checks parameters that are each within their own bounds. Which parameters it reads is recorded, not declared: if
one of them is not valid by itself, the rule is skipped, so that one mistake gives one message and all other rules are
still checked.
"""

from __future__ import annotations

from fingertip.design.rules import (
    amplifiers,
    board,
    bone,
    chaplet,
    fold,
    force_curve,
    joint,
    mold,
    recess,
    sensor,
    signal,
    skin,
)

PART_RULES = (
    *sensor.RULES,
    *skin.RULES,
    *bone.RULES,
    *fold.RULES,
    *joint.RULES,
    *recess.RULES,
    *mold.RULES,
    *chaplet.RULES,
)
"""Rules of the printed parts and the skin. They read no electronic table."""
ELECTRONIC_RULES = (*board.RULES, *amplifiers.RULES, *signal.RULES, *force_curve.RULES)
"""Rules of the board and of slip detection. They read only the electronic tables."""
RULES = (*PART_RULES, *ELECTRONIC_RULES)
"""All rules, in the order in which they are checked."""
