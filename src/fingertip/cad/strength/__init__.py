"""Strength of the bone: loads, stresses by beam theory on its true cross-sections, and safety factors."""
