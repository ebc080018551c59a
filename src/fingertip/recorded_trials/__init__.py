"""Recorded trials of a built finger beside its simulation.

Lines of the firmware's stream come in; a folder of labelled trials goes out (`fingertip record`),
and figures measured beside simulated (`fingertip validate --recordings`).

>>> from fingertip.recorded_trials.trials import kind_of
>>> [kind_of(number) for number in (1, 40)]
['slide', 'hand']
"""
