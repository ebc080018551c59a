"""KiCad files: the routed project of each board, what a design enters into it, and the netlist."""
