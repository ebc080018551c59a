"""Campaign of simulated trials: which cases it has, what a detector makes of each, and the
article's closed loop.

A design, cases and detectors come in; delays and false alarms go out, pooled by threshold.

>>> from fingertip.lab.campaign.run import quantile_s
>>> quantile_s([0.02, 0.01], slips=3, fraction=0.5)
0.02
"""
