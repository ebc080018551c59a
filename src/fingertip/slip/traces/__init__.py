"""Traces: columns of samples, and the files and streams they come from."""
