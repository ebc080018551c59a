"""Parts of a board as data: components, pins and nets, symbols, and what can be bought.

A component's requirement comes in; its part goes out, or the reason why there is none
(`select_part`).

>>> from fingertip.board.parts.circuit import format_component_value, parse_component_value
>>> format_component_value(parse_component_value("4.7k") / 2)
'2.35k'
"""
