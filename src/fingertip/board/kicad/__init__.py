"""What KiCad's files have in common: expressions, identifiers, symbols, footprints; and the netlist."""
