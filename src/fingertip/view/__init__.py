"""Pictures of the parts, drawn in software: no display, no graphics card, no system library."""
