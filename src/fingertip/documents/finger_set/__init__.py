"""Sheets of a set of fingers: what to do on which day, what to buy, and acceptance."""
