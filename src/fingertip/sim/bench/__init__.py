"""Benchmarks: error against run time of our integrators and of other solvers. Needs scipy."""
