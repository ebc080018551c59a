"""The circuits of all variants, as parts, pins and nets."""
