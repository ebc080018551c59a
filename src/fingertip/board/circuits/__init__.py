"""Circuits of all boards and of a divider, the equations that follow from them, and the SPICE deck.

Component values come in; a checked `Circuit` goes out, and its `Network` of linear equations.

>>> from fingertip import Design
>>> from fingertip.board.circuits.board_circuit import divider_circuit
>>> divider_circuit(Design()).list_wires(divider_circuit(Design()).component("R1"))
[('1', 'TACTILE'), ('2', 'GND')]
"""
