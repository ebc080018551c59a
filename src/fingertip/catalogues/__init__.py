"""Catalogues of what can be bought or is bundled, each figure with its source. They know no design.

Tables stand apart from formulas, so that a figure can be corrected without touching one. Figures that are `unverified`,
or not `verified`, were not found in a document of the product or of its kind.
"""
