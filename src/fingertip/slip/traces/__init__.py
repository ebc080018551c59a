"""Traces: columns of samples, their validation, and the files they are read from."""
