"""Show the bone with a hole of your own, the sensor's place and all parts, in CQ-editor or VS Code.

Open this file in CQ-editor and render it, or run it in VS Code with the viewer ocp_vscode. Without
a viewer, it says what it would show: .venv/bin/python examples/show_in_cq_editor.py
"""

from typing import Any

import cadquery as cq

import fingertip

if "show_object" not in globals():  # CQ-editor provides it
    try:
        from ocp_vscode import show_object
    except ImportError:

        def show_object(shown: Any, name: str) -> None:
            print(f"{name}: {type(shown).__name__}")


design = fingertip.Design.load("params/fsr400.toml", changes={"skin.width_mm": 18})
bone = (
    fingertip.part_workplane(design, "bone")
    .faces(tag="post")
    .workplane()
    .circle(1.0)
    .cutBlind(-5.0)
)
sensor = cq.Workplane(cq.Plane(fingertip.frames(design)["sensor"])).circle(3.8).extrude(0.3)

show_object(bone, name="bone")
show_object(sensor, name="sensor")
show_object(fingertip.assembly(design), name="all parts")
