"""A kit: a design in, and out a folder with its parts, the sheet to cast them by, and a report on both."""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingertip._version import __version__
from fingertip.cad.files.step import Exact, StepFiles, StepJob, StepRequest
from fingertip.cad.kernel.mesh import Evaluator, Mesh
from fingertip.cad.shapes.parts import PARTS, Part, parts_of, print_scale
from fingertip.cad.verification import checks, exact
from fingertip.cad.verification.checks import Check
from fingertip.cad.verification.verify import as_data, refuse_tolerance, settled, verify
from fingertip.casting import markdown, sheet, volumes
from fingertip.casting.materials import silicone
from fingertip.design import Design
from fingertip.design.document import to_toml
from fingertip.design.issues import nearest
from fingertip.errors import DesignError, Issue
from fingertip.files import write_whole

FORMATS = ("stl", "3mf", "step")
DESIGN, REPORT, SHEET, ASSEMBLY = "design.toml", "report.json", "casting.md", "assembly.step"
WRITTEN = (*(f"{part}.{kind}" for part in PARTS for kind in FORMATS), ASSEMBLY, SHEET, REPORT, DESIGN)
"""Every file a build may write."""


@dataclass(frozen=True)
class BuiltPart:
    """One part as built."""

    part: Part
    mesh: Mesh
    files: Mapping[str, str]
    """Format -> file name."""
    exact: Exact | None
    """What the B-rep kernel measured; None without STEP."""


@dataclass(frozen=True)
class Build:
    """What a build gave: every file, every check."""

    design: Design
    folder: Path
    tolerance_mm: float
    parts: tuple[BuiltPart, ...]
    contents: Mapping[str, bytes]
    checks: tuple[Check, ...]
    casting: Mapping[str, Any] | None
    """Figures of the casting sheet, as `casting.sheet.figures` gives them; None if parts were left out."""
    removed: tuple[str, ...] = ()
    """Files of another design that stood in the folder."""

    @property
    def passed(self) -> bool:
        """Whether every check passed."""
        return all(check.passed for check in self.checks)

    def report(self) -> dict[str, Any]:
        """The content of report.json: nothing in it depends on when or where it was made."""
        report: dict[str, Any] = {
            "fingertip": __version__,
            "design": self.design.name,
            "tolerance_mm": self.tolerance_mm,
            "passed": self.passed,
            "parts": {built.part.name: self._part(built) for built in self.parts},
            "checks": [as_data(check) for check in self.checks],
        }
        return report | ({"casting": self.casting} if self.casting else {})

    def _part(self, built: BuiltPart) -> dict[str, Any]:
        entry: dict[str, Any] = {
            "volume_mm3": settled(built.mesh.volume()),
            "area_mm2": settled(built.mesh.area()),
            "triangles": len(built.mesh.triangles),
            "files": dict(built.files),
            "sha256": {kind: hashlib.sha256(self.contents[file]).hexdigest() for kind, file in built.files.items()},
        }
        if built.exact:
            entry["brep_volume_mm3"] = settled(built.exact.volume_mm3)
        return entry


def build(
    design: Design,
    out: str | Path | None = None,
    *,
    parts: Iterable[str] | None = None,
    formats: Iterable[str] = FORMATS,
    tolerance_mm: float = 0.01,
    material: str = "addition_40a",
    progress: Callable[[str], None] = lambda message: None,
) -> Build:
    """Build parts, check them, and write them with `design.toml`, `casting.md` and `report.json`.

    Only what is asked for is built, and cadquery is loaded (in a process of its own) only for "step". A folder holds
    one design: where its `design.toml` is another's, what an earlier build wrote there and this one does not replace
    is removed in the end.

    Parameters
    ----------
    design
        The fingertip.
    out
        Folder to write to; `out/<design name>` if None.
    parts
        Names from `PARTS`; None for all that the design has.
    formats
        Any of "stl", "3mf", "step".
    tolerance_mm
        Most a facet strays from the exact surface [mm], 0.0005 to 1.
    material
        Silicone of the casting sheet, a name from `casting.MATERIALS`. There is a sheet if all parts are built.
    progress
        Called with a sentence at each step.

    Raises
    ------
    DesignError
        If a part, a format, the tolerance, the silicone or the folder's name is not to be had.
    MissingLibraryError
        If STEP is asked for and cadquery cannot be loaded.
    GeometryError, OutputError
        If a kernel refuses a solid; if the folder cannot be written. Nothing has been written then.
    """
    if out is not None and not str(out).strip():
        raise DesignError(Issue("--out", "is empty; give a folder, such as . for this one, or leave it out."))
    folder = Path("out") / design.name if out is None else Path(out)
    known = tuple(parts_of(design))
    chosen = _ordered("--parts", known if parts is None else parts, known)
    kinds = _ordered("--formats", formats, FORMATS)
    refuse_tolerance(tolerance_mm)
    card, evaluator = silicone(material), Evaluator(tolerance_mm)

    with contextlib.ExitStack() as stack:
        request = None
        if "step" in kinds:
            progress("starting the B-rep kernel beside the mesh kernel")
            parts_to_make = tuple((n, PARTS[n].describe(design), PARTS[n].colour) for n in chosen)
            job = StepJob(design.name, parts_to_make, exact.hollows(design, chosen))
            request = stack.enter_context(StepRequest(job))
        verified = verify(design, chosen, kinds, evaluator, progress)
        meshes, found = verified.meshes, list(verified.checks)
        casting = sheet.figures(design, volumes.measure(design, evaluator), card) if chosen == [*known] else None
        step = StepFiles({}, {}, {})
        if request:
            progress("waiting for the B-rep kernel")
            step = request.result()
            for name, measured in step.exact.items():
                scale = print_scale(design, PARTS[name])
                found += checks.of_brep(design, PARTS[name], meshes[name], measured, scale, tolerance_mm)
            found += exact.of_volumes(design, step.exact, step.hollow_mm3)
        contents = dict(verified.contents) | step.contents

    built = tuple(
        BuiltPart(PARTS[name], meshes[name], {kind: f"{name}.{kind}" for kind in kinds}, step.exact.get(name))
        for name in chosen
    )
    heading = "The design these files were built from; `fingertip build` takes it as it is."
    if casting:
        contents[SHEET] = markdown.page(casting).encode()
    removed = tuple(name for name in _of_another(folder, design) if name not in (*contents, DESIGN, REPORT))
    result = Build(design, folder, tolerance_mm, built, contents, tuple(found), casting, removed)
    contents[REPORT] = (json.dumps(result.report(), indent=2) + "\n").encode()
    contents[DESIGN] = to_toml(design, heading).encode()  # the last: until it stands there, the folder is the old one's
    write_whole(folder, contents, removed)
    progress(f"{len(contents)} files in {folder}")
    if removed:
        progress(f"removed from {folder}, being of another design: {', '.join(removed)}")
    return result


def _of_another(folder: Path, design: Design) -> list[str]:
    """Files in a folder that a build of another design wrote; without a `design.toml` nobody can tell."""
    try:
        if not (folder / DESIGN).is_file() or Design.load(folder / DESIGN) == design:
            return []
    except DesignError:
        pass  # no longer a design, so not this one
    return [name for name in WRITTEN if (folder / name).is_file()]


def _ordered(option: str, asked: Iterable[str], known: tuple[str, ...]) -> list[str]:
    """What was asked for, in the fixed order and without repeats, so that the order of asking changes nothing."""
    if isinstance(asked, str):
        raise DesignError(Issue(option, f"{asked!r} is one text; give a list, such as {asked.split(',')!r}."))
    wanted = set(asked)
    if unknown := sorted(wanted - set(known)):
        raise DesignError([Issue(option, _unknown(word, known)) for word in unknown])
    if not wanted:
        raise DesignError(Issue(option, f"nothing was asked for; choose from {', '.join(known)}."))
    return [name for name in known if name in wanted]


def _unknown(word: str, known: tuple[str, ...]) -> str:
    if word in PARTS:  # so far there is one that not every design has
        return f"this design has no {word!r}, which only a sleeve is cast around; --set mold.method=sleeve."
    return f"there is no {word!r}; {nearest(word, known)}"
