"""Two kernels that evaluate the same expressions: meshes by numpy and manifold3d, exact solids by cadquery."""
