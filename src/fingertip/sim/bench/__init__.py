"""Benchmarks: error against run time of this package's integrators and of other solvers. Needs scipy."""
