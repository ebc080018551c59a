"""Analysis of a board: response, noise, offsets, tolerances, loads, and the gate.

A circuit comes in; figures with their limits go out, which `board_values` collects for a design.

>>> from fingertip.board.analysis.interference import crosstalk_warning, SharedFigures
>>> from fingertip import Design
>>> crosstalk_warning(SharedFigures(0.02, crosstalk_db=-50.0, crosstalk_hz=201.0), Design().board)
'slip at one finger shows at others with -50 dB, above -60 dB; give board.cable_m of 0.15 ...'
"""
