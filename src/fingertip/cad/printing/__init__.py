"""Preparation of parts for printing: poses on the bed, plates, places of supports, overhangs and
print time.

In: a design and the meshes of its parts. Out: files for the printer, with the settings of a slicer.

>>> from fingertip import Design
>>> from fingertip.cad.printing.orientations import print_orientations
>>> print_orientations(Design())["core"].face_on_plate
'the plate, with its name'
"""
