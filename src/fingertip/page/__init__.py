"""Page of a design: one HTML file that shows parts, checks, casting, board and signals, and needs no network."""
