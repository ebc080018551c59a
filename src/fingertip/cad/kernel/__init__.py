"""Geometry kernels: two independent programs that turn solids into geometry, as triangle meshes or as exact B-reps."""
