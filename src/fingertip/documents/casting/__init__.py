"""Casting sheet of a design: its data, and the procedure in Markdown."""
