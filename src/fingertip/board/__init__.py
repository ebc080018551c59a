"""Slip-filter board of a design: component values, circuit, analysis, bring-up and KiCad files.

A `Design` comes in; a `Circuit` goes out, from which all files follow, and `BoardValues` with its
figures.

>>> from fingertip import Design
>>> from fingertip.board.circuits.board_circuit import board_circuit
>>> from fingertip.board.components.values import select_components
>>> board_circuit(select_components(Design())).component("R1").value
'24k'
"""
