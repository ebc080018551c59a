"""Contact between skin and surface: friction, pad, surface profile, vibration, and the integrators for them."""
