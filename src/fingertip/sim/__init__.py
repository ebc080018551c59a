"""Simulation of a fingertip up to the sampled voltage: scenes, contact, sensor and board.

A design with a scene of one finger (`SceneFile`) or of a hand (`ManipulationFile`) and a seed come
in; signals, true slips and a trace for a detector go out. `load_simulation` reads them as
``fingertip simulate`` does.

>>> from fingertip.sim.signal.grid import Grid
>>> Grid(refinement=2).rate_hz
20000.0
"""
