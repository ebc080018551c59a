"""Fuzzing of everything that is read: generated and damaged inputs, run within limits of time and
memory.

`python -m tools.fuzz.run` runs thousands of cases and prints what was found; `tests/fuzz` runs some
hundred.
"""
