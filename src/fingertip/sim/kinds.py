"""Is a file a scene or a design? And is a change one of the scene's, or of the design's?"""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Literal

from fingertip.design import Design
from fingertip.errors import Fault, TraceError
from fingertip.sim.scene_file import SceneFile


def kind_of(path: Path) -> Literal["scene", "design"]:
    """By the names at the file's top level; a file that cannot be read is left to the design's own sentences.

    Raises
    ------
    TraceError
        If the file holds tables of both.
    """
    try:
        names = set(tomllib.loads(path.read_text(encoding="utf-8")))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
        return "design"
    of_scene, of_design = names & set(SceneFile.model_fields), names & set(Design.model_fields)
    if of_scene and of_design:
        mixed = f"holds {min(of_scene)} of a scene and {min(of_design)} of a design"
        raise TraceError(Fault(str(path), f"{mixed}; write them in two files and give the design's with --design."))
    return "scene" if of_scene else "design"


def split(changes: Iterable[str]) -> tuple[list[str], list[str]]:
    """Changes of the scene, and all others, by the name before the first dot; an unknown name goes to whichever
    knows a similar one, to be refused there.
    """
    scene: list[str] = []
    design: list[str] = []
    known = [*Design.model_fields, *SceneFile.model_fields]
    for change in changes:
        name = change.partition("=")[0].partition(".")[0].strip()
        close = name if name in known else next(iter(difflib.get_close_matches(name, known, n=1, cutoff=0.5)), "")
        (scene if close in SceneFile.model_fields else design).append(change)
    return scene, design
