"""Pad of the finger: what part of a force reaches the sensor, by a layer model and by finite elements."""
