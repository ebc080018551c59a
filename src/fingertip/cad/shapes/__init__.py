"""Solid of each part, and the registry of the parts that a design has."""
