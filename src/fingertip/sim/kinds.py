"""Is a file a finger's scene, a hand's manipulation, or a design? And is a change one of the scene's, or of the
design's?"""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Iterable
from pathlib import Path

from fingertip.design import Design
from fingertip.errors import Issue, TraceError
from fingertip.sim.hand.manipulation_file import ManipulationFile
from fingertip.sim.scenes.scene_file import SceneFile

Kind = type[SceneFile] | type[ManipulationFile] | type[Design]

_WORDS: dict[Kind, str] = {SceneFile: "a scene", ManipulationFile: "a manipulation", Design: "a design"}


def kind_of(path: Path) -> Kind:
    """By the names at the file's top level; a file that cannot be read is left to the design's own sentences.

    Raises
    ------
    TraceError
        If the file holds tables of two kinds.
    """
    try:
        names = set(tomllib.loads(path.read_text(encoding="utf-8-sig")))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
        return Design
    of_scene, of_manipulation = set(SceneFile.model_fields), set(ManipulationFile.model_fields)
    own: dict[Kind, set[str]] = {
        ManipulationFile: names & (of_manipulation - of_scene),
        SceneFile: names & (of_scene - of_manipulation),
        Design: names & set(Design.model_fields),
    }
    if not own[ManipulationFile]:  # what both have, such as outputs, then means a scene
        own[SceneFile] = names & of_scene
    found: list[Kind] = [kind for kind, its in own.items() if its]
    if len(found) > 1:
        said = " and ".join(f"{min(own[kind])} of {_WORDS[kind]}" for kind in found)
        where = "and give the design's with --design" if Design in found else "one for each"
        raise TraceError(Issue(str(path), f"holds {said}; write them in two files {where}."))
    return found[0] if found else Design


def split(changes: Iterable[str], kind: Kind = SceneFile) -> tuple[list[str], list[str]]:
    """Changes of the scene, and all others, by the name before the first dot; an unknown name goes to whichever
    knows a similar one, to be refused there.

    Parameters
    ----------
    changes
        ``table.key=value``.
    kind
        Of the file they stand beside; with a design, names of any scene count as the scene's.
    """
    scene: list[str] = []
    design: list[str] = []
    kinds = (SceneFile, ManipulationFile) if kind is Design else (kind,)
    of_scene = [name for k in kinds for name in k.model_fields]
    known = [*Design.model_fields, *of_scene]
    for change in changes:
        name = change.partition("=")[0].partition(".")[0].strip()
        close = name if name in known else next(iter(difflib.get_close_matches(name, known, n=1, cutoff=0.5)), "")
        (scene if close in of_scene else design).append(change)
    return scene, design
