"""Model of a finger for simulators of robots: inertia, collision pieces, contact, and the formats
MJCF and URDF.

In: a design. Out: meshes, and figures in m, kg and N in the frame of the interface to the hand.

>>> from fingertip.design import Design
>>> from fingertip.pad.pad_geometry import PadForm
>>> from fingertip.robot.tactile_mesh import mesh_active_area
>>> len(mesh_active_area(PadForm.of_design(Design())).points_mm)  # points of the tactile sensor
121
"""
