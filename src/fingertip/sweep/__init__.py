"""Sweeps: many designs described by one file, computed by worker processes or a cluster.

A sweep file comes in: axes, outputs and objectives. A database with one row for every point goes
out, and its report.

>>> from fingertip.sweep.sweep_plan import SweepPlan
>>> axes = {"board.cutoff_hz": [50.0, 60.0, 70.0]}
>>> plan = SweepPlan.from_tables({"outputs": ["q"], "axes": axes})
>>> plan.size, plan.point(1)
(3, {'board.cutoff_hz': 60.0})
"""
