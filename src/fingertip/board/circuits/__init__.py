"""Circuits of all board variants, the equations that follow from them, and the SPICE deck."""
