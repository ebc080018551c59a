"""The router that made the tracks."""
