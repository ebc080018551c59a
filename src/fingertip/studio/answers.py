"""Answers of the studio to a design of the form: data for its page, and files to save.

The files are byte for byte those that `fingertip build` writes. Whether the design passes the
rules, and with which values of the parameter in hand it would, is answered at once, beside whatever
the worker makes.
"""

from __future__ import annotations

import io
import itertools
import math
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any, NamedTuple

from pydantic import ValidationError

from fingertip.cad.build_result import DESIGN_HEADING
from fingertip.cad.files import stl, threemf
from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.parts import shapes_of_parameters
from fingertip.cad.printing.print_files import make_print_files
from fingertip.cad.verification.check import Check, Solids
from fingertip.cad.verification.verify import run_checks, verify
from fingertip.casting.sheet import casting_sheet
from fingertip.catalogues.output_files import DESIGN, PRINT_FOLDER
from fingertip.design import Design
from fingertip.design.design_file import flatten, to_toml
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_bounds
from fingertip.design.search import Band, as_typed, describe_bands, find_bands, is_number
from fingertip.documents.finger_sheets import FirstScreen, render_start
from fingertip.fitting.fitting import fit_tables
from fingertip.foundation.errors import DesignError, FingertipError, Issue
from fingertip.models.parts import PARTS, parts_by_name, print_scale
from fingertip.models.solids import Solid
from fingertip.page.html import Markup
from fingertip.page.markdown_sheets import render_facts, split_sections
from fingertip.page.model_section import Item, measure_finger, place_items, render_boxes, scene_data
from fingertip.page.pad_section import render_pad
from fingertip.page.parameters_and_checks import (
    EVERY_FILE,
    ReportedCheck,
    render_checks,
    render_verdict,
)
from fingertip.pictures.casting_scenes import draw_finger
from fingertip.studio.worker import StillWanted

if TYPE_CHECKING:
    from manifold3d import Manifold


VIEW_TOLERANCE_MM = 0.05
"""Tolerance of shown meshes and quick checks [mm]: as fine as a screen shows."""
FILE_TOLERANCE_MM = 0.01
"""Tolerance of the files and of all checks [mm], that of `fingertip build`."""
_MESHES_KEPT = 64
"""Number of meshes that are kept, of solids that the next change may leave as they are."""
_PICTURE_PX = 320
"""Width of the picture of a finger [px]."""


class AskingEvaluator(MeshEvaluator):
    """Mesh kernel that asks before each solid whether its result is still wanted."""

    def __init__(self, tolerance_mm: float, still_wanted: StillWanted) -> None:
        super().__init__(tolerance_mm)
        self._still_wanted = still_wanted

    def manifold(self, solid: Solid) -> Manifold:
        """Evaluate a solid, unless nobody waits any more."""
        self._still_wanted()
        return super().manifold(solid)


def read_design(tables: Mapping[str, Any], before: Design) -> Design:
    """Read the design of a form that was opened with another one. Raises DesignError."""
    guesses = [
        name
        for name, value in flatten(tables)
        if name in before.provisional and value == before.value(name)
    ]
    return Design.from_tables(tables, before.model_dump(mode="json"), provisional=guesses)


def describe_issues(error: FingertipError) -> list[dict[str, str]]:
    """Describe issues in the words of the page, on which a button fits the other values."""
    described = []
    for issue in error.issues:
        message = issue.message.replace("add --fit", "fit the other values")
        message = message.replace("--fit", "the fit")
        described.append({"field": issue.field, "message": message})

    return described


@dataclass(frozen=True)
class Answer:
    """Data for the page, of which each question gets some; the others are None and are not sent."""

    scene: list[dict[str, Any]] | None = None
    """Data of the 3D view."""
    boxes: Markup | None = None
    figures: Markup | None = None
    passed: bool | None = None
    failed: tuple[str, ...] | None = None
    count: int | None = None
    """Number of all checks; above, the verdict on them and those that failed."""
    verdict: Markup | None = None
    checks: Markup | None = None
    moves: Mapping[str, tuple[str, ...]] | None = None
    """Parameter -> items that it shapes."""
    pad: Markup | None = None
    """Picture of what the sensor feels."""
    bands: tuple[Band, ...] | None = None
    band_text: str | None = None
    """Values of the parameter in hand that pass with the others as they are."""
    issues: list[dict[str, str]] | None = None
    passing: float | None = None
    """Nearest value that passes; above, the reasons why the present one is refused."""
    fitted: tuple[dict[str, Any], ...] | None = None
    """Moves of a fit: `name`, `before`, `after` and `reason` of each value."""


def answer_parts(design: Design, still_wanted: StillWanted) -> Answer:
    items = make_items(design, still_wanted)
    return Answer(scene=scene_data(items), boxes=render_boxes(items))


def answer_figures(design: Design, still_wanted: StillWanted) -> Answer:
    """Return size, masses, days and prices, from meshes at the tolerance of the view."""
    items = make_items(design, still_wanted)
    casting = casting_sheet(design, AskingEvaluator(VIEW_TOLERANCE_MM, still_wanted))
    still_wanted()
    screen = FirstScreen(
        design=design,
        casting=casting,
        loads=None,
        size_mm=measure_finger(items),
        files=(),
        steps=0,
        verdict="",
    )
    sections = split_sections(render_start(screen))
    facts = {heading: sections[heading] for heading in _FIGURES if heading in sections}

    return Answer(figures=render_facts(facts))


_FIGURES = ("Size", "Print", "Silicone", "Time", "Money")
"""Sections of the first screen of a page that the studio shows."""


def make_items(design: Design, still_wanted: StillWanted = lambda: None) -> tuple[Item, ...]:
    """Make the meshes of parts and bought items, at the tolerance of the view."""
    meshes = {}
    for name, part in parts_by_name(design).items():
        still_wanted()
        if not part.is_tool:
            meshes[name] = _make_mesh(part.solid(design))

    still_wanted()
    return place_items(design, meshes, dict.fromkeys(meshes, 1.0), _make_mesh)


def answer_checks(design: Design, still_wanted: StillWanted) -> Answer:
    """Check the parts at the tolerance of the view, and find what each parameter shapes."""
    evaluator = AskingEvaluator(VIEW_TOLERANCE_MM, still_wanted)
    solids = Solids.of(design, evaluator, parts_by_name(design))
    checks = [*run_checks(design, solids)]
    still_wanted()
    basis = (
        f"Checked on meshes within {VIEW_TOLERANCE_MM:g} mm of the exact surface, coarser than "
        "those of the files, "
        "which have checks of their own. A check that fails names the parameters to change."
    )
    answer = _describe_checks(checks, "of the shape passed", basis)

    return replace(answer, moves=shapes_of_parameters(design))


def answer_all_checks(design: Design, still_wanted: StillWanted) -> Answer:
    """Make the files in memory and run every check of `fingertip build` that needs no STEP file."""
    evaluator = AskingEvaluator(FILE_TOLERANCE_MM, still_wanted)
    verified = verify(design, parts_by_name(design), ("stl", "3mf"), evaluator)
    answer = _describe_checks(verified.checks, "of shape and files passed", EVERY_FILE)
    return replace(answer, pad=render_pad(design))


def _describe_checks(checks: Sequence[Check], passed: str, basis: str) -> Answer:
    reported = [ReportedCheck.read(check.to_dict()) for check in checks]
    failed = tuple(check.name for check in checks if not check.passed)
    verdict = render_verdict(reported, passed)

    return Answer(
        passed=not failed,
        failed=failed,
        count=len(checks),
        verdict=verdict,
        checks=render_checks(reported, basis),
    )


@lru_cache(maxsize=_MESHES_KEPT)
def _make_mesh(solid: Solid) -> Mesh:
    return MeshEvaluator(VIEW_TOLERANCE_MM).mesh(solid)


ANSWERS: Mapping[str, Callable[[Design, StillWanted], Answer]] = {
    "parts": answer_parts,
    "figures": answer_figures,
    "checks": answer_checks,
    "pad": lambda design, still_wanted: Answer(pad=render_pad(design, still_wanted)),
    "all-checks": answer_all_checks,
}
"""Name in the address -> function that answers, after the answers before it."""

_FIRST_DATE = (1980, 1, 1, 0, 0, 0)
"""Earliest date of a ZIP file, for all files: the same design gives the same bytes."""


class Download(NamedTuple):
    """File that the page saves."""

    name: str
    content_type: str
    data: bytes


def download_design(design: Design, still_wanted: StillWanted) -> Download:
    return Download(
        f"{design.name}.toml", "application/toml", to_toml(design, DESIGN_HEADING).encode()
    )


def download_parts(design: Design, still_wanted: StillWanted) -> Download:
    """Write a ZIP file of the design and of the STL files, in place and on the bed."""
    meshes = _make_meshes(design, still_wanted)
    files = {
        f"{name}.stl": stl.to_bytes(mesh, name, PARTS[name].note) for name, mesh in meshes.items()
    }
    prints = make_print_files(design, meshes, {}, with_stl=True)
    files |= {f"{PRINT_FOLDER}/{name}": data for name, data in prints.contents.items()}
    files[DESIGN] = download_design(design, still_wanted).data

    return Download(f"{design.name}_stl.zip", "application/zip", _pack(files))


def download_plates(design: Design, still_wanted: StillWanted) -> Download:
    """Write the plate as 3MF, or a ZIP file of several plates."""
    meshes = _make_meshes(design, still_wanted)
    encoded = {name: threemf.encode_mesh(mesh) for name, mesh in meshes.items()}
    still_wanted()
    prints = make_print_files(design, meshes, encoded, with_stl=False)
    plates = {name: prints.contents[name] for name in prints.plates}

    if len(plates) == 1:
        ((name, data),) = plates.items()
        return Download(f"{design.name}_{name}", "model/3mf", data)

    return Download(f"{design.name}_plates.zip", "application/zip", _pack(plates))


_draw_finger = lru_cache(maxsize=_MESHES_KEPT)(partial(draw_finger, width_px=_PICTURE_PX))

DOWNLOADS: Mapping[str, tuple[str, Callable[[Design, StillWanted], Download]]] = {
    "design": ("design.toml", download_design),
    "stl": ("parts.zip (STL)", download_parts),
    "plate": ("plate to print (3MF)", download_plates),
    "picture": (
        "",
        lambda design, _: Download(f"{design.name}.png", "image/png", _draw_finger(design)),
    ),
}
"""Name in the address -> label of its button or "", and function that makes the file."""


def _make_meshes(design: Design, still_wanted: StillWanted) -> dict[str, Mesh]:
    evaluator = AskingEvaluator(FILE_TOLERANCE_MM, still_wanted)
    return {
        name: evaluator.mesh(part.solid(design).scaled(print_scale(design, part)))
        for name, part in parts_by_name(design).items()
    }


def _pack(files: Mapping[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, _FIRST_DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, data)

    return buffer.getvalue()


_BANDS_KEPT = 256
"""Number of bands that are kept: somebody who slides asks for the same ones again and again."""


class BandFinder:
    """Finder of the bands of a form's parameters, which keeps what it found."""

    def __init__(self, opened: Design) -> None:
        self.opened = opened
        self._bands: dict[tuple[DesignTables, str], tuple[Band, ...]] = {}

    def find(
        self, tables: Mapping[str, Any], path: str, still_wanted: StillWanted
    ) -> tuple[Band, ...]:
        """Find the bands of a parameter; none if it is no number, or others are not valid."""
        if path not in PARAMETERS or not is_number(path):
            return ()

        table, _, key = path.partition(".")
        try:
            present = tables[table][key]
            changed = {**tables[table], key: self.opened.value(path)}
            base = DesignTables(**{**tables, table: changed})
        except (ValidationError, LookupError, TypeError):
            return ()

        if (base, path) not in self._bands:
            bounds = find_bounds(PARAMETERS[path])
            is_valid = isinstance(present, int | float) and bounds.contain(present)
            tried = [as_typed(path, present)] if is_valid else []
            bands = find_bands(base, path, tried, still_wanted)
            if len(self._bands) >= _BANDS_KEPT:
                self._bands.clear()

            self._bands[base, path] = bands

        return self._bands[base, path]


def answer_bands(
    finder: BandFinder, tables: Mapping[str, Any], path: str, still_wanted: StillWanted
) -> Answer:
    bands = finder.find(tables, path, still_wanted)
    return Answer(bands=bands, band_text=describe_bands(path, bands) if bands else "")


def answer_rules(
    finder: BandFinder, tables: Mapping[str, Any], path: str, still_wanted: StillWanted
) -> Answer:
    """Return the values of the parameter in hand with which a refused design passes.

    Raises DesignError if no value of that parameter helps: its issues say what does.
    """
    try:
        Design.without_remedies(**tables)
    except DesignError as error:
        bands = finder.find(tables, path, still_wanted)
        if not bands:
            read_design(tables, finder.opened)

        problem = " ".join(
            issue.message if issue.field == path else str(issue) for issue in error.issues
        )
        values = describe_bands(path, bands)
        refused = Issue(path, f"{problem} With the other parameters as they are, {values} pass.")
        table, _, key = path.partition(".")
        passing = _find_nearest(tables[table][key], finder.opened.value(path), bands)
        return Answer(
            bands=bands,
            band_text=values,
            issues=describe_issues(DesignError(refused)),
            passing=passing,
        )

    return Answer()


def answer_fit(
    finder: BandFinder, tables: Mapping[str, Any], names: str, still_wanted: StillWanted
) -> Answer:
    """Fit the form's design to the values of these names, separated by spaces.

    Raises DesignError.
    """
    before = finder.opened.model_dump(mode="json")
    fitted = fit_tables(
        tables,
        before=before,
        changed=names.split(),
        progress=lambda _: still_wanted(),
        provisional=finder.opened.provisional,
    )
    return Answer(fitted=tuple(asdict(move) for move in fitted.moves))


def _find_nearest(present: object, opened: float, bands: Sequence[Band]) -> float:
    """Find the passing value nearest to the present one, or else to the opened one."""
    target = opened
    if isinstance(present, int | float) and math.isfinite(present):
        target = present

    candidates = list(itertools.chain.from_iterable(bands))
    if any(low <= opened <= high for low, high in bands):
        candidates.append(opened)

    return min(candidates, key=lambda value: abs(value - target))


AT_ONCE = {"rules": answer_rules, "bands": answer_bands, "fit": answer_fit}
"""Name in the address -> function that answers at once, beside the worker."""
