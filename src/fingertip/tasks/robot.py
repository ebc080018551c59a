"""Files of a finger's model for simulators of robots."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from fingertip.cad.files import stl
from fingertip.catalogues.output_files import README, ROBOT, ROBOT_FILES
from fingertip.design import Design
from fingertip.design.finger_set import FingerSet, Form
from fingertip.design.parameters.declaration import suggest_name
from fingertip.documents.robot import describe_model, render_robot_readme, render_set_readme
from fingertip.foundation.errors import DesignError, Issue
from fingertip.robot.formats import Placed, render_model
from fingertip.robot.model import FingerModel, build_finger

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
    """Write the model of a finger, or of those of a set, with its meshes and a README, and return its figures.

    The folder is `out/NAME/robot` by default, the format "mjcf" or "urdf". With `force`, files may be overwritten that
    this function did not write, or that were changed since.

    Raises
    ------
    DesignError
        If the format is not known.
    OutputError
        If the folder cannot be written, or holds a file of these names that is somebody's own. Nothing has been
        written then.
    """
    if file_format not in ROBOT_FILES:
        message = f"{file_format!r} is no format of a model; {suggest_name(file_format, tuple(ROBOT_FILES))}"
        raise DesignError(Issue("--format", message))
    folder, file = ROBOT.folder(design) if out is None else Path(out), ROBOT_FILES[file_format]
    forms = design.forms if isinstance(design, FingerSet) else (Form(design, (design.name,)),)
    # The files of a set are told apart by their form.
    prefixes = [f"{form.design.name}_" if isinstance(design, FingerSet) else "" for form in forms]
    writer = ROBOT.writer(design, folder, force)
    writer.check(
        {README, file, *(f"{prefix}{name}" for prefix in prefixes for name in (README, "bone.stl", "skin.stl"))}
    )
    models, figures, contents = list[FingerModel](), dict[str, dict[str, Any]](), dict[str, bytes]()
    for form, prefix in zip(forms, prefixes, strict=True):
        progress(f"{form.design.name}: meshing the parts, and fitting the contact to the pad")
        models.append(build_finger(form.design))
        figures[form.design.name] = described = describe_model(models[-1], file_format)
        contents |= {f"{prefix}{name}.stl": stl.to_bytes(mesh, name) for name, mesh in models[-1].meshes.items()}
        contents[f"{prefix}{README}"] = render_robot_readme(described, form.fingers).encode()
    comment, data = f"by fingertip robot; {README} states units and frames.", figures[forms[0].design.name]
    if isinstance(design, FingerSet):
        placed = _place(design, dict(zip(forms, zip(models, prefixes, strict=True), strict=True)))
        places = {finger.name: finger.x_m for finger in placed}
        data = {"set": design.name, "format": file_format, "places_m": places, "forms": figures}
        contents[README] = render_set_readme(design, file, places).encode()
        comment = f"Fingers of {design.name} {comment}"
    else:
        placed, comment = [Placed(design.name, models[0])], f"Finger {design.name} {comment} {data['errors']}"
    # XML allows no two hyphens in a comment.
    contents[file] = render_model(design.name, placed, file_format, comment.replace("--", "-"))
    writer.write(contents, [other for other in ROBOT_FILES.values() if other != file])
    return {**data, "folder": str(folder), "files": list(contents)}


def _place(fingers: FingerSet, models: Mapping[Form, tuple[FingerModel, str]]) -> list[Placed]:
    """Place fingers side by side, in the order of the hand, with its palm towards -y."""
    step_m = 1e-3 * (max(form.design.skin.width_mm for form in fingers.forms) + _GAP_MM)
    step_m *= -1.0 if fingers.side == "right" else 1.0
    middle = (len(fingers.fingers) - 1) / 2
    return [
        Placed(name, *models[form], round((number - middle) * step_m, 6) + 0.0)
        for number, (name, form) in enumerate(fingers.fingers)
    ]
