"""Cameras that several pictures share, with distal (z) to the right."""

from __future__ import annotations

from fingertip.pictures.raster import Camera

DORSAL = Camera.from_angles(28, 24)
"""Camera on the back of the finger."""
PALMAR = Camera.from_angles(28, -38)
"""Camera on the pad of the finger, from below."""
CUT_FROM_BELOW = Camera.from_angles(24, -24)
"""Camera on the cut face of a section and on the palmar side, where the sensor lies."""
