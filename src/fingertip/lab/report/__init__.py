"""Output of a validation: text, data, plots, and the page of failures and assumptions.

Results of a campaign and of the closed loop come in; text, data for JSON and pictures (PNG) go out.

>>> from fingertip.lab.report.results import format_ms
>>> format_ms(0.0185), format_ms(float("inf"))
('18.5 ms', 'missed')
"""
