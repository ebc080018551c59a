"""Step between a round surface and the flat ones beside it.

Tangent surfaces would leave a stray edge in the B-rep solid, so a round end stands a little above its flat sides.
"""

TANGENT_STEP_MM = 0.05
"""Height of the step [mm]."""
