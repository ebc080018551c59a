"""Peers of the simulation: error against run time of its integrators and of other solvers, for `fingertip bench`.

Needs scipy, numba and matplotlib; SUNDIALS and ngspice are measured where they are installed.
"""
