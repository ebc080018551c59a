"""Downloads of the studio: the files of a design, byte for byte those that `fingertip build` writes."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable, Mapping
from typing import NamedTuple

from fingertip.cad.files import stl, threemf
from fingertip.cad.kernel.mesh import Mesh
from fingertip.cad.printing.print_files import FDM, SLA, PlateKind, make_print_files
from fingertip.cad.report import DESIGN_HEADING
from fingertip.cad.shapes.parts import PARTS, parts_by_name, print_scale
from fingertip.catalogues.output_files import DESIGN, PRINT_FOLDER
from fingertip.design import Design
from fingertip.design.files import to_toml
from fingertip.design.geometry.solids import scaled
from fingertip.studio.answers import FILE_TOLERANCE_MM, AskingEvaluator
from fingertip.studio.worker import StillWanted

_FIRST_DATE = (1980, 1, 1, 0, 0, 0)
"""Earliest date of a ZIP file: the files have none, so that the same design gives the same bytes."""


class Download(NamedTuple):
    """File for the browser to save."""

    name: str
    content_type: str
    data: bytes


def download_design(design: Design, still_wanted: StillWanted) -> Download:
    """Write the design as commented TOML."""
    return Download(f"{design.name}.toml", "application/toml", to_toml(design, DESIGN_HEADING).encode())


def download_parts(design: Design, still_wanted: StillWanted) -> Download:
    """Write a ZIP file of the STL files of all parts, in place and as they lie on the bed, and of the design."""
    meshes = _make_meshes(design, still_wanted)
    files = {f"{name}.stl": stl.to_bytes(mesh, name, PARTS[name].note) for name, mesh in meshes.items()}
    prints = make_print_files(design, meshes, {}, with_stl=True)
    files |= {f"{PRINT_FOLDER}/{name}": data for name, data in prints.contents.items()}
    files[DESIGN] = download_design(design, still_wanted).data
    return Download(f"{design.name}_stl.zip", "application/zip", _pack(files))


def download_filament_plate(design: Design, still_wanted: StillWanted) -> Download:
    """Write the plate of a filament printer as 3MF, or a ZIP file of several plates."""
    return _download_plates(design, FDM, still_wanted)


def download_resin_plate(design: Design, still_wanted: StillWanted) -> Download:
    """Write the plate of a resin printer as 3MF, or a ZIP file of several plates."""
    return _download_plates(design, SLA, still_wanted)


DOWNLOADS: Mapping[str, tuple[str, Callable[[Design, StillWanted], Download]]] = {
    "design": ("design.toml", download_design),
    "stl": ("parts.zip (STL)", download_parts),
    "plate_fdm": ("filament plate (3MF)", download_filament_plate),
    "plate_sla": ("resin plate (3MF)", download_resin_plate),
}
"""Name in the address -> label of its button, and function that makes the file."""


def _download_plates(design: Design, kind: PlateKind, still_wanted: StillWanted) -> Download:
    meshes = _make_meshes(design, still_wanted)
    encoded = {name: threemf.encode_mesh(mesh) for name, mesh in meshes.items()}
    still_wanted()
    prints = make_print_files(design, meshes, encoded, with_stl=False)
    count = sum(name.startswith(f"plate_{kind.name}") for name in prints.plates)
    plates = {name: prints.contents[name] for name in kind.file_names(count)}
    if len(plates) == 1:
        ((name, data),) = plates.items()
        return Download(f"{design.name}_{name}", "model/3mf", data)
    return Download(f"{design.name}_plates_{kind.name}.zip", "application/zip", _pack(plates))


def _make_meshes(design: Design, still_wanted: StillWanted) -> dict[str, Mesh]:
    """Make the meshes of the files, with the printer's compensation."""
    evaluator = AskingEvaluator(FILE_TOLERANCE_MM, still_wanted)
    return {
        name: evaluator.mesh(scaled(part.solid(design), print_scale(design, part)))
        for name, part in parts_by_name(design).items()
    }


def _pack(files: Mapping[str, bytes]) -> bytes:
    """Pack files into a ZIP file without dates."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, _FIRST_DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, data)
    return packed.getvalue()
