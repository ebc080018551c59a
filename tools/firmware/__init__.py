"""Compilers and emulators for the C library of `fingertip
firmware`: its tests, and the table of its costs.
"""
