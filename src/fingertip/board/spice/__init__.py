"""The SPICE deck."""
