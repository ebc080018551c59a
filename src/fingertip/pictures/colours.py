"""Colours of what lies beside the parts in the pictures of the steps."""

from __future__ import annotations

from fingertip.models.parts import PARTS

SENSOR = (0.86, 0.68, 0.24)
"""Film of the sensor."""
WIRE = (0.72, 0.20, 0.16)
"""Red wire of the sensor."""
STEEL = (0.62, 0.63, 0.66)
"""Tools, bolts and the legs of the sensor."""
GLASS = (0.80, 0.86, 0.90)
"""Mixing cup."""
SILICONE = PARTS["skin"].colour
"""Silicone before it cures: the colour of the skin."""
PAPER = (0.93, 0.91, 0.86)
"""Parts of the user's hand, and the silicone that is added second."""
