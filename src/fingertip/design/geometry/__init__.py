"""Geometry derived from the parameters: superconics, dimensions, draft, skin thickness, misalignment, mold layout."""
