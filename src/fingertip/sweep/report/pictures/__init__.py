"""Pictures of a sweep. The only modules of `sweep` that import matplotlib."""
