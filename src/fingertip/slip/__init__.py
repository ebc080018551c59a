"""Slip on a sampled voltage: from traces to intervals, scored where true slip is known.

Nothing here knows the simulation. `traces` reads recordings, and `detectors` judges their samples.

>>> import numpy as np
>>> from fingertip.slip.traces.truth import intervals
>>> intervals(np.array([0.0, 0.1, 0.2, 0.3]), np.array([False, True, True, False]))
(Interval(onset_s=0.1, end_s=0.3),)
"""
