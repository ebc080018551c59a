"""Files of a finger's model for simulators of robots."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from fingertip.cad.files import stl
from fingertip.catalogues.output_files import README, ROBOT, ROBOT_FILES
from fingertip.design import Design
from fingertip.design.finger_set import FingerSet, Form
from fingertip.design.parameters.declaration import suggest_name
from fingertip.documents.robot import describe_model, render_robot_readme, render_set_readme
from fingertip.foundation.errors import DesignError, Issue
from fingertip.robot.finger_model import build_finger
from fingertip.robot.formats import Placed, render_model

_GAP_MM = 5.0
"""Distance between the skins of two fingers of a set."""


def write_robot(
    design: Design | FingerSet,
    out: str | Path | None = None,
    *,
    file_format: str = "mjcf",
    force: bool = False,
    progress: Callable[[str], None] = lambda message: None,
) -> dict[str, Any]:
    """Write the robot model of a finger or a set, with meshes and README; return its figures.

    The folder is `out/NAME/robot` by default, the format "mjcf" or "urdf". With `force`, files may
    be overwritten that this function did not write, or that were changed since.

    Raises DesignError if the format is not known, and OutputError if the folder cannot be written,
    or holds a file of these names that is somebody's own. Nothing has been written then.
    """
    if file_format not in ROBOT_FILES:
        message = (
            f"{file_format!r} is no format of a model; "
            f"{suggest_name(file_format, tuple(ROBOT_FILES))}"
        )
        raise DesignError(Issue("--format", message))

    folder = ROBOT.folder(design, out)
    file = ROBOT_FILES[file_format]
    is_set = isinstance(design, FingerSet)
    forms = design.forms if isinstance(design, FingerSet) else (Form(design, (design.name,)),)
    # The files of a set are told apart by their form.
    prefixes = {form: f"{form.design.name}_" if is_set else "" for form in forms}
    writer = ROBOT.writer(design, folder, force)
    names = (README, "bone.stl", "skin.stl")
    form_files = itertools.product(prefixes.values(), names)
    writer.check({README, file, *(f"{prefix}{name}" for prefix, name in form_files)})
    places_m = _place(design) if isinstance(design, FingerSet) else {design.name: 0.0}
    placed = dict[str, Placed]()
    figures = dict[str, dict[str, Any]]()
    contents = dict[str, bytes]()

    for form, prefix in prefixes.items():
        progress(f"{form.design.name}: meshing the parts, and fitting the contact to the pad")
        model = build_finger(form.design)
        placed |= {
            finger: Placed(finger, model, prefix, places_m[finger]) for finger in form.fingers
        }
        description = describe_model(model, file_format)
        data = asdict(description)
        figures[form.design.name] = data
        contents |= {
            f"{prefix}{name}.stl": stl.to_bytes(mesh, name) for name, mesh in model.meshes.items()
        }
        contents[f"{prefix}{README}"] = render_robot_readme(description, form.fingers).encode()

    origin = f"by fingertip robot; {README} states units and frames."
    if isinstance(design, FingerSet):
        data = {
            "set": design.name,
            "format": file_format,
            "places_m": places_m,
            "forms": figures,
        }
        contents[README] = render_set_readme(design, file, places_m).encode()
        comment = f"Fingers of {design.name} {origin}"
    else:
        comment = f"Finger {design.name} {origin} {data['errors']}"

    # XML allows no two hyphens in a comment.
    in_order = [placed[finger] for finger in places_m]
    contents[file] = render_model(design.name, in_order, file_format, comment.replace("--", "-"))
    writer.write(contents, [name for name in ROBOT_FILES.values() if name != file])
    return {**data, "folder": str(folder), "files": list(contents)}


def _place(fingers: FingerSet) -> dict[str, float]:
    """Place the fingers side by side in the order of the hand, palm towards -y: name -> x [m]."""
    step_m = 1e-3 * (max(form.design.skin.width_mm for form in fingers.forms) + _GAP_MM)
    step_m *= -1.0 if fingers.side == "right" else 1.0
    middle = (len(fingers.fingers) - 1) / 2

    return {
        name: round((i - middle) * step_m, 6) + 0.0 for i, (name, _) in enumerate(fingers.fingers)
    }
