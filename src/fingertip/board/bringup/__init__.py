"""Bring-up of a board: what to measure, what it should read, and which part is wrong if it does not.

A circuit and the readings of a multimeter come in; limits of the readings and likely faults go out.

>>> from fingertip.board.bringup.prediction import Limits, find_failed
>>> find_failed({"tp1_open_v": Limits(0.143, 0.130, 0.156)}, {"tp1_open_v": 0.30})
['tp1_open_v']
"""
