"""Continue in build123d with the bone of a design: drill its post, and write it as STEP.

build123d and cadquery need different versions of one geometry kernel, so that each has an
environment of its own; STEP files pass between them. Write them with `.venv/bin/fingertip build
fsr400 --formats step`, install build123d elsewhere with `pip install build123d`, and run
examples/continue_in_build123d.py there.
"""

from build123d import Axis, Cylinder, export_step, import_step

(bone,) = import_step("out/fsr400/bone.step").solids()
post = bone.faces().sort_by(Axis.Z).first
(drilled,) = (bone - post.center_location * Cylinder(radius=1.0, height=10.0)).solids()
export_step(drilled, "drilled_bone.step")
print(f"drilled out of the bone: {bone.volume - drilled.volume:.2f} mm3")
