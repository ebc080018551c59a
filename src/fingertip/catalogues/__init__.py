"""Catalogues of what can be bought or is bundled: a name comes in, and a row of a table goes out.

Tables know no design and stand apart from formulas, so that a figure can be corrected without
touching one. Each figure has a source; those that are `unverified`, or not `verified`, were not
found in a document of the product.

>>> from fingertip.catalogues.electronics import SENSORS
>>> SENSORS["fsr400"].head_diameter_mm
7.62
"""
