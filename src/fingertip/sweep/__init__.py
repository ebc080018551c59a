"""Design-parameter sweeps: many designs from one file, each a row that is never dropped."""
