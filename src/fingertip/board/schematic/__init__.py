"""Schematic: sheets as data, symbol graphics and KiCad's schematic file."""
