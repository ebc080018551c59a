"""Scenes of one finger: strict files, their timeline, and the disturbances they contain."""
