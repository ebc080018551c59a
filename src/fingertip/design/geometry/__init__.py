"""Lengths and outlines that follow from the parameters: conics, draft, skin thickness, misalignment, mold layout."""
