"""Page of a design: one HTML file that shows parts, checks, casting, board and signals, and needs no network."""

MAX_BYTES = 5_000_000
"""Size that a page stays below [byte], so that it can be sent by mail."""
