"""Runs of scenes with one finger, and of manipulations with a hand that holds an object while a pin
hits it.

A design, a scene file and a seed come in; the signals of the fingers, the true slips and the
object's way go out.

>>> from fingertip.sim.runs.timeline import TrapezoidalMove
>>> move = {"distance_m": 0.04, "speed_m_s": 0.04, "acceleration_m_s2": 1.0}
>>> TrapezoidalMove.with_speed(start_s=0.0, **move).end_s
1.04
"""
