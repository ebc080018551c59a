"""KiCad files: s-expressions, UUIDs, symbols and footprints, the netlist and the project file."""
