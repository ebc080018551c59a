"""Training of the detector `fast`: signals, rows with labels and weights, and the fit of its table.

A developer's tool.
"""
