"""Geometry kernels: two independent programs that evaluate solids, as triangle meshes or as exact
B-reps.

In: an expression of `models.solids`. Out: a `Mesh` or a `manifold3d.Manifold`, or a shape
of Open CASCADE.

>>> from fingertip.cad.kernel.mesh import MeshEvaluator
>>> from fingertip.models.solids import Box
>>> MeshEvaluator(0.1).mesh(Box((0.0, 0.0, 0.0), (1.0, 2.0, 3.0))).volume()
6.0
"""
