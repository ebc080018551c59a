"""Cameras that several scenes share, with distal (z) to the right unless stated."""

from __future__ import annotations

from fingertip.view.raster import Camera

DORSAL = Camera.from_angles(28, 24)
PALMAR = Camera.from_angles(28, -38)
SIDE = Camera.from_angles(0, 0)
CUT_FROM_ABOVE = Camera.from_angles(24, 18)
"""Camera on the cut face of a section and on the dorsal side."""
CUT_FROM_BELOW = Camera.from_angles(24, -24)
"""Camera on the cut face of a section and on the palmar side, where the sensor lies."""
LOW = Camera.from_angles(28, 13)
"""Camera that sees both halves of a mold, one above the other."""
RUNNER_SIDE = Camera.from_angles(152, 14)
"""Camera on the side on which the runner lies, with distal to the left."""
CAVITY_UP = Camera.looking_from((-1.0, 0.0, 0.0), (0.0, -1.0, 0.0))
"""Camera on a section of the dorsal half that lies with its cavity up, with distal to the left."""
FUNNEL_UP = Camera.looking_from((-1.0, 0.5, 0.3), (0.0, 0.0, 1.0))
