"""Fabrication files for board and assembly houses, the bill of materials and the record of what they were made from."""
