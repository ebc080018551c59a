"""Designs that several tests compare, beside the default: the
article's circuit, supply and converter.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from fingertip.board.components.values import VARIANT_CHANGES
from fingertip.design import Design

VARIANT_BY_CHANGE = {changes[0]: changes for changes in VARIANT_CHANGES.values()}
ARTICLE_CHANGES = (
    "board.variant=article",
    "board.supply_v=5",
    "board.capacitor_uf=1",
    "detector.threshold_v=0.017",
    "detector.noise_v=0.0004",
    "detector.adc_bits=16",
    "detector.adc_range_v=10",
    "detector.adc_polarity=bipolar",
)
"""Changes to the default design that give the article's circuit, supply and converter, with
capacitors as are sold. The bundled design `article` has the article's capacitors of 5 % too.
"""
ARTICLE_OPTIONS = [word for change in ARTICLE_CHANGES for word in ("--set", change)]
"""The same as words of a command line."""


def load_article(changes: Iterable[str] = ()) -> Design:
    """Load the default design with the article's circuit, supply and converter, and then these
    changes.

    Another variant gets its own supply and capacitors.
    """
    changes = list(changes)
    supplies = [
        word
        for change in changes
        if change in VARIANT_BY_CHANGE
        for word in VARIANT_BY_CHANGE[change]
    ]
    if supplies and "board.variant=article" not in supplies:
        supplies.append("board.capacitor_uf=0.1")
    return Design.load(changes=[*ARTICLE_CHANGES, *supplies, *changes])


def article_design(**tables: dict[str, Any]) -> Design:
    """Build the design of `load_article` with values of tables,
    such as ``board={"cutoff_hz": 50.0}``.
    """
    variant = tables.get("board", {}).get("variant", "article")
    values = load_article(VARIANT_CHANGES[variant]).model_dump()
    for table, changed in tables.items():
        values[table] |= changed
    return Design(**values)


ARTICLE = load_article()
