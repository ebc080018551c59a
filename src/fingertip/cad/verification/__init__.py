"""Verification of built parts: file topology, identities between parts, clearances and wall thicknesses.

`verify.verify` runs every check of a design. `bone`, `skin` and `mold` measure the parts that `cad.shapes` builds.
Limits come from the design. Where facets are measured, a limit is relaxed by the mesh tolerance.
"""
