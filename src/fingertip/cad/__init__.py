"""The parts: described once as expressions, evaluated by a mesh kernel and a B-rep kernel, checked, written."""
