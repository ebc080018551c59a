"""Continue with parts of a design in plain CadQuery: a nail on the skin, a rib and a logo on the
bone.

Each goes through the project's checks of STL files, and is written by its STL writer, which gives
the same bytes each time: .venv/bin/python examples/continue_in_cadquery.py
"""

import tempfile
from pathlib import Path

import cadquery as cq

from fingertip import Design, bone, mesh_of, skin
from fingertip.cad.files import stl
from fingertip.cad.verification.printing import check_mesh_file
from fingertip.models.parts import PARTS

design = Design.load("fsr400").replace({"skin.width_mm": 18})
back = design.skin.semi_axis_dorsal_mm
length = design.skin.length_mm
nail = (
    cq.Workplane("XY").ellipse(5.0, 1.0).extrude(12.0).translate((0.0, back - 1.0, length - 18.0))
)
beside = design.dimensions.bone_outline.section.half_width
rib = cq.Workplane("XY").box(1.2, 1.2, 6.0).translate((beside, 0.0, -10.0))
# Of a clevis, tag="cheek_left".
end = bone(design).faces(tag="post").workplane(centerOption="CenterOfMass")
logo = end.slot2D(4.0, 1.2).cutBlind(-0.8)
made = {"skin": skin(design).union(nail), "bone": logo.union(rib)}
steps = ((skin(design), made["skin"]), (bone(design), logo), (logo, made["bone"]))
assert all(abs(after.val().Volume() - before.val().Volume()) > 1.0 for before, after in steps), (
    "a feature met nothing"
)

folder = Path(tempfile.mkdtemp())
for name, part in made.items():
    mesh = mesh_of(part)
    data = stl.to_bytes(mesh, name, "with features of its own")
    checks = list(check_mesh_file(design, PARTS[name], stl.from_bytes(data), "stl"))
    assert all(check.passed for check in checks), [
        check.name for check in checks if not check.passed
    ]
    (folder / f"{name}.stl").write_bytes(data)
    print(f"{folder / name}.stl: {mesh.volume():.1f} mm3, {len(checks)} checks passed")
