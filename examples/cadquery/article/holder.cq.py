"""Holder of the fingertip article, in CadQuery.

Run it with Python, or open it in CQ-editor. Sizes stand in parameters.py, and the shape in
fingertip_models.
"""

import sys
from pathlib import Path

import cadquery as cq

folder = Path(globals().get("__file__", "script.py")).absolute().parent  # the current one in CQGI
sys.path[:0] = [str(folder), str(folder.parent)]  # one of them holds fingertip_models

from fingertip_models.finger import read_finger  # noqa: E402
from fingertip_models.workplanes import make_part  # noqa: E402

finger = read_finger(folder, __name__)
holder = make_part(finger, "holder")

# Add your own features here. Tags of faces: none.

if show := globals().get("show_object"):  # in CQ-editor, or imported from ocp_vscode
    show(holder, name="holder")
elif __name__ == "__main__":
    size = holder.val().BoundingBox()
    print(f"holder: {size.xlen:.3f} x {size.ylen:.3f} x {size.zlen:.3f} mm")
    cq.exporters.export(holder, "holder.step")
