"""Geometry kernels: two independent programs that turn the solids of `cad.solids` into geometry.

- `mesh`: mesh kernel. Approximates surfaces by triangles within a tolerance (numpy grids, booleans of manifold3d).
- `brep`: boundary-representation (B-rep) kernel. Represents faces by exact surfaces (Open CASCADE).
"""
