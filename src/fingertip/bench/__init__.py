"""Measured figures of a built finger: guided recording, a folder that others can use, measured beside simulated."""
