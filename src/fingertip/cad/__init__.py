"""Computer-aided design of the parts.

A part is described once as a solid (`solids`, `shapes`). Two geometry kernels evaluate it (`kernel`): one as a triangle
mesh, the other as an exact B-rep. `files` writes the results, and `verification` checks them.
"""
