"""Pictures of the casting steps, one scene for each step, drawn for the design at hand."""
