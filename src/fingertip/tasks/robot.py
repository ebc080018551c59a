"""Files of a finger's model for simulators of robots."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from fingertip.cad.files import stl
from fingertip.catalogues.output_files import README, ROBOT, ROBOT_FILES
from fingertip.design import Design
from fingertip.design.parameters.declaration import suggest_name
from fingertip.documents.robot import describe_model, render_robot_readme
from fingertip.foundation.errors import DesignError, Issue
from fingertip.robot.formats import render_model
from fingertip.robot.model import build_finger


def write_robot(
    design: Design,
    out: str | Path | None = None,
    *,
    file_format: str = "mjcf",
    force: bool = False,
    progress: Callable[[str], None] = lambda message: None,
) -> dict[str, Any]:
    """Write the model of a design's finger with its meshes and a README, and return its figures.

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
    folder, name = ROBOT.folder(design) if out is None else Path(out), ROBOT_FILES[file_format]
    writer = ROBOT.writer(design, folder, force)
    writer.check((README, name, "bone.stl", "skin.stl"))
    progress("meshing the parts, and fitting the contact to the pad")
    finger = build_finger(design)
    figures = describe_model(finger, file_format)
    comment = f"Finger {design.name} by fingertip robot; {README} states units and frames. {figures['errors']}"
    contents = {f"{mesh_name}.stl": stl.to_bytes(mesh, mesh_name) for mesh_name, mesh in finger.meshes.items()}
    contents[name] = render_model(finger, file_format, comment.replace("--", "-"))  # XML allows no two hyphens there
    contents[README] = render_robot_readme(figures).encode()
    writer.write(contents, [other for other in ROBOT_FILES.values() if other != name])
    return {**figures, "folder": str(folder), "files": list(contents)}
