"""Pictures and drawings of the parts, rendered in software: no display or graphics card is needed."""
