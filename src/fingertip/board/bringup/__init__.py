"""Bring-up of a board: what to measure, and what a good board reads.

>>> from fingertip.board.bringup.expected_readings import Limits
>>> Limits(0.143, 0.130, 0.156).high
0.156
"""
