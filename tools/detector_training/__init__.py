"""Training of the detector `fast`: simulated signals, labels, and the fit of its trees.

A developer's tool.
"""
