"""KiCad files: the routed project of each board, what a design enters into it, and the netlist.

A circuit comes in; layout, schematic and netlist go out, which `sexpr` reads and edits word by
word.

>>> from fingertip.board.kicad.sexpr import read_expression
>>> read_expression('(footprint "R_0603" (property "Value" "2.4k"))').word("property", 2)
'2.4k'
"""
