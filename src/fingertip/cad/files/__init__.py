"""File formats of parts: STL, 3MF, STEP and CadQuery scripts.

A mesh or a solid comes in, and bytes go out.

Files hold no date, path or random identifier: the same part gives the same bytes.

>>> from fingertip.cad.files import stl
>>> from fingertip.cad.kernel.mesh import MeshEvaluator
>>> from fingertip.models.solids import Box
>>> len(stl.to_bytes(MeshEvaluator(0.1).mesh(Box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))), "cube"))
684
"""
