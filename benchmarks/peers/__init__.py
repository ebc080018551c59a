"""Peers of the simulation: error against run time of its integrators and of other solvers.

Needs scipy, numba and matplotlib; SUNDIALS and ngspice are measured where they are installed.
"""
