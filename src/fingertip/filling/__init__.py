"""Filling of the mold: how the silicone spreads around the bone, how long it takes, and where air is trapped."""
