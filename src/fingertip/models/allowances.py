"""Allowances that all parts share: plays of mating parts, ledges that print, and the lengths by
which solids overlap so that no faces coincide.
"""

LEDGE_MM = 0.7
"""Ledge that prints over air without supports [mm]."""
TANGENT_STEP_MM = 0.05
"""Step between a round surface and the flat ones beside it [mm]: tangent ones leave a stray edge in
the B-rep solid.
"""
PAST_MM = 1.0
"""Length by which cuts reach past the face in which they open, and solids into those on which they
stand [mm].
"""
MATING_PLAY_MM = 0.2
"""Play between an interface and a printed mating part [mm]. A recommendation."""
