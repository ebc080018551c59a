"""What the board does beyond its ideal figures: Bode, noise, offsets, tolerances."""
