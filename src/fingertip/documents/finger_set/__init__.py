"""Sheets of a set of fingers: casting plan, parts list and acceptance."""
