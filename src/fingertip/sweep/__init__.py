"""Design-parameter sweeps: evaluate many designs described by one file, and keep one row for every point."""
