"""The fingertip first_finger in its closed mold: the core lies where the bone will.

A part is made by its script, with your own features, or else by fingertip_models.
"""

import sys
from pathlib import Path
from runpy import run_path

import cadquery as cq

folder = Path(globals().get("__file__", "script.py")).absolute().parent  # the current one in CQGI
sys.path[:0] = [str(folder), str(folder.parent)]  # one of them holds fingertip_models

from fingertip_models.finger import read_finger  # noqa: E402
from fingertip_models.hardware import hardware  # noqa: E402
from fingertip_models.parts import parts_by_name, print_scale  # noqa: E402
from fingertip_models.workplanes import make_part  # noqa: E402

finger = read_finger(folder, __name__)
parts = parts_by_name(finger)
bought = {item.name: item for item in hardware(finger, parts)}
made = {}
for name in [*parts, *bought]:
    script = folder / f"{name}.cq.py"
    made[name] = run_path(str(script))[name] if script.is_file() else make_part(finger, name)

assembly = cq.Assembly(name=finger.name)
for name, each in {**parts, **bought}.items():
    if name in bought or not each.is_tool:  # tools lie nowhere in the finger or its mold
        assembly.add(made[name], name=name, color=cq.Color(*each.colour))

if show := globals().get("show_object"):  # in CQ-editor, or imported from ocp_vscode
    for name, workplane in made.items():
        show(workplane, name=name)
    show(assembly, name="finger")
elif __name__ == "__main__":
    out = folder / "out"
    out.mkdir(exist_ok=True)
    assembly.export(str(out / f"{finger.name}.step"))
    for name, workplane in made.items():
        cq.exporters.export(workplane, str(out / f"{name}.step"))
        scale = print_scale(finger, parts[name]) if name in parts else 1.0  # of the printer
        solid = workplane.val().scale(scale)
        mesh = str(out / f"{name}.stl")
        cq.exporters.export(solid, mesh, tolerance=0.01, angularTolerance=0.1)
    print(f"{out}: {finger.name}.step, and .step and .stl of {', '.join(made)}")
