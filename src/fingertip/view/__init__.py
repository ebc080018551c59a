"""Pictures of the parts, rendered in software: no display, graphics card or system library is needed."""
