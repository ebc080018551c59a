"""Result of a build: its parts, files and checks, and the report on them."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fingertip import __version__
from fingertip.cad.files.step_process import BrepMeasurements
from fingertip.cad.kernel.mesh import Mesh
from fingertip.cad.printing.print_files import PrintFiles
from fingertip.cad.verification.check import Check, count_checks
from fingertip.cad.verification.skin import describe_lying_skin
from fingertip.cad.verification.strength import BoneStrength, strength_data
from fingertip.catalogues.output_files import ASSEMBLY, PRINT_FOLDER
from fingertip.catalogues.stated_errors import (
    StatedError,
    find_volume_error_mm3,
    list_mesh_errors,
    list_pad_errors,
    load_errors,
    to_entries,
)
from fingertip.design import Design
from fingertip.design.geometry.casting_layout import POURED
from fingertip.foundation.display import html_table, to_dataframe
from fingertip.foundation.files import round_for_output
from fingertip.models.hardware import hardware
from fingertip.models.making import making_of
from fingertip.models.parts import PARTS, Part
from fingertip.pad.survey import survey_pad

if TYPE_CHECKING:
    import pandas

_DECIMALS = 3
"""Decimals of what trimesh finds: it adds up volumes in another order on other machines."""
DESIGN_HEADING = "Design from which these files were built. `fingertip build` accepts this file."


@dataclass(frozen=True)
class BuiltPart:
    """Part as built: its mesh, its files, and measurements of its B-rep solid."""

    part: Part
    mesh: Mesh
    files: Mapping[str, str]
    brep: BrepMeasurements | None
    """Measurements of the B-rep solid; None unless STEP files were made."""


@dataclass(frozen=True)
class Build:
    """Result of a build: all files and all checks."""

    design: Design
    folder: Path
    tolerance_mm: float
    parts: tuple[BuiltPart, ...]
    contents: Mapping[str, bytes]
    """File name -> bytes."""
    prints: PrintFiles
    """Files for the printer, in a folder of their own."""
    checks: tuple[Check, ...]
    strength: BoneStrength | None
    casting: Any
    """Casting sheet, a `CastingSheet` of
    `fingertip.casting.sheet`; None unless all parts were built.
    """
    removed: tuple[str, ...] = ()
    """Files of another design that were removed from the folder."""
    opinions: tuple[Check, ...] = ()
    """Findings of trimesh in the mesh files; what does not pass is among the checks too."""

    @property
    def passed(self) -> bool:
        return all(check.passed for check in self.checks)

    def __repr__(self) -> str:
        names = ", ".join(built.part.name for built in self.parts)
        return f"Build({self.design.name} in {self.folder}: {names}; {count_checks(self.checks)})"

    def _repr_html_(self) -> str:
        """Table of the parts, and of the checks that failed, for Jupyter."""
        parts = [
            (built.part.name, f"{built.mesh.volume() / 1000:.2f}", ", ".join(built.files.values()))
            for built in self.parts
        ]
        text = html_table(repr(self), ("part", "volume [cm3]", "files"), parts)
        failed = [
            (check.name, f"{check.value:g}", f"{check.sign} {check.limit:g}", check.unit)
            for check in self.checks
            if not check.passed
        ]

        return text + (
            html_table("FAILED", ("check", "value", "limit", "unit"), failed) if failed else ""
        )

    def to_dataframe(self) -> pandas.DataFrame:
        """Return every check with value and limit as a data frame.

        Raises MissingLibraryError without pandas.
        """
        columns: dict[str, list[Any]] = {"check": [check.name for check in self.checks]}
        for key in ("value", "sign", "limit", "unit", "passed"):
            columns[key] = [getattr(check, key) for check in self.checks]

        return to_dataframe(columns, "Build.to_dataframe")

    def report(self) -> dict[str, Any]:
        """Return the content of report.json, which depends on the
        design alone, not on time or machine.
        """
        report: dict[str, Any] = {
            "fingertip": __version__,
            "design": self.design.name,
            "tolerance_mm": self.tolerance_mm,
            "passed": self.passed,
            "parts": {built.part.name: self._part_entry(built) for built in self.parts},
            "print": {
                f"{PRINT_FOLDER}/{file}": {
                    "parts": list(self.prints.plates.get(file, (file.partition(".")[0],))),
                    "sha256": hashlib.sha256(data).hexdigest(),
                }
                for file, data in self.prints.contents.items()
            },
            "checks": [check.to_dict() for check in self.checks],
            "errors": to_entries(self._list_errors()),
        }
        if ASSEMBLY in self.contents:
            names = [built.part.name for built in self.parts]
            bought = hardware(self.design, names)
            shown = [name for name in names if not PARTS[name].is_tool]
            report["assembly"] = {
                "file": ASSEMBLY,
                "parts": shown,
                "hardware": [item.name for item in bought],
            }

        for check in self.opinions:
            file, _, found = check.name.partition(".trimesh.")
            report.setdefault("trimesh", {}).setdefault(file, {})[found] = round(
                check.value, _DECIMALS
            )

        if self.strength:
            report["strength"] = strength_data(self.strength)

        if any(built.part.name == "skin" for built in self.parts):
            report["pad"] = survey_pad(self.design).to_dict()
            if not making_of(self.design).is_bonded:
                report["skin"] = describe_lying_skin(self.design)

        return report | ({"casting": asdict(self.casting)} if self.casting else {})

    def _list_errors(self) -> Iterator[StatedError]:
        """Yield the errors of what the report states."""
        yield from list_mesh_errors(self.tolerance_mm)
        errors = load_errors()
        skin = next((built.mesh for built in self.parts if built.part.name == "skin"), None)

        if self.strength:
            yield errors["strength"]

        if skin:
            yield from list_pad_errors(bonded=making_of(self.design).is_bonded)

        if self.casting and skin:
            volume_mm3 = POURED * find_volume_error_mm3(self.tolerance_mm, skin.area())
            by_mesh_g = self.casting.batch.density_g_cm3 * volume_mm3 / 1000.0
            rounded = errors["silicone"]
            bound = round(rounded.high + by_mesh_g, 3)
            yield replace(rounded, low=-bound, high=bound)
            yield errors["filament"]
            yield errors["print_time"]

    def _part_entry(self, built: BuiltPart) -> dict[str, Any]:
        area_mm2 = built.mesh.area()
        entry: dict[str, Any] = {
            "volume_mm3": round_for_output(built.mesh.volume()),
            "volume_error_mm3": round(find_volume_error_mm3(self.tolerance_mm, area_mm2), 3),
            "area_mm2": round_for_output(area_mm2),
            "triangles": len(built.mesh.triangles),
            "files": dict(built.files),
            "sha256": {
                file_format: hashlib.sha256(self.contents[file]).hexdigest()
                for file_format, file in built.files.items()
            },
        }
        if built.brep:
            entry["brep_volume_mm3"] = round_for_output(built.brep.volume_mm3)

        return entry
