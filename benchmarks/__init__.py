"""Measurements of error beside run time. Run one with `python benchmarks/NAME.py`."""

import tools  # noqa: F401  (tells worker processes where the packages of the repository are)
