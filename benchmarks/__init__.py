"""Measurements of error beside run time. Run one with `python benchmarks/NAME.py`."""
