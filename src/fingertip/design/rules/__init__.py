"""Rules between parameters, by what they are about, and the engine that checks them.

In: the tables of a design. Out: a `Violation` for each rule that it breaks, with the values that
pass.

>>> from fingertip.design.geometry import DesignTables
>>> from fingertip.design.rules import skin
>>> from fingertip.design.rules.ruleset import find_violations
>>> tables = DesignTables().with_values({"skin.tip_length_mm": 39.0})
>>> [broken.rule.field for broken in find_violations(skin.RULES, tables)]
['skin.tip_length_mm']
"""
