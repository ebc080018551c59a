"""Files for board house and assembly house: gerbers, bill of materials, placement, provenance.

A circuit and its placement come in; the content of the files goes out. Gerbers and renderings need
KiCad.

>>> from fingertip.board.fabrication.bom import find_rotation
>>> find_rotation("Package_TO_SOT_SMD:SOT-23").rotation_deg
180
"""
