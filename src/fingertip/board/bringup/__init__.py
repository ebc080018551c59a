"""Bring-up of a board: what to measure, what it should read, and which part is wrong if it does not."""
