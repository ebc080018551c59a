"""KiCad files: netlist, schematic, layout with its placement and tracks, and 3D models."""
