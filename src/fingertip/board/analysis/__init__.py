"""Analysis of the board: frequency response, noise, offsets and tolerances."""
