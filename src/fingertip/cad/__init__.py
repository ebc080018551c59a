"""Computer-aided design of the parts: solids, the kernels that evaluate them, files, printing and
checks.

In: a design. Out: meshes and exact solids of its parts, the bytes of their files, and checks with
value and limit.

The parametric models themselves stand in `fingertip.models`. `examples/cadquery` holds them with a
CadQuery script for each part, as `files.cadquery_scripts` writes them.

>>> from fingertip import Design
>>> from fingertip.models.parts import parts_by_name
>>> list(parts_by_name(Design()))
['bone', 'skin', 'mold_palmar', 'mold_dorsal', 'core', 'stand']
"""
