"""Pad of the finger as a mechanism: from its form and a pose to the share of the force that the sensor feels."""
