"""The board's values: formulas, preferred values, and what built parts achieve."""
