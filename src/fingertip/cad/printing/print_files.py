"""Files of the printed parts as they lie on the printer's bed: one STL file each, and plates as 3MF."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from fingertip.cad.files import stl
from fingertip.cad.files.threemf import Item, write_items
from fingertip.cad.kernel.mesh import Mesh
from fingertip.cad.printing.orientations import print_orientations
from fingertip.cad.printing.plates import FDM, PLATE_KINDS, Placed, arrange
from fingertip.cad.printing.pose import Pose, bed_pose
from fingertip.cad.printing.settings import describe_part, slicer_settings
from fingertip.cad.printing.supports import supports_by_part
from fingertip.design import Design
from fingertip.print_materials import PRINT_MATERIALS

PRINT_FOLDER = "print"
"""Folder of these files, inside that of the parts."""


@dataclass(frozen=True)
class PrintFiles:
    """Files of the printed parts."""

    contents: Mapping[str, bytes]
    """File name -> bytes; no file has been written."""
    plates: Mapping[str, tuple[str, ...]]
    """File name of each plate -> its parts."""


def make_print_files(
    design: Design, meshes: Mapping[str, Mesh], encoded: Mapping[str, str], with_stl: bool
) -> PrintFiles:
    """Make the files of the printed parts.

    Plates are made if all printed parts are there, so that none leaves out a part.

    Parameters
    ----------
    design
        The fingertip.
    meshes
        Meshes of the parts, with the printer's compensation; cast ones are left out.
    encoded
        The same meshes as text of 3MF files; without them no plates are made.
    with_stl
        Whether to make STL files.
    """
    orientations = print_orientations(design)
    poses = {name: bed_pose(meshes[name], lies.rotate_x_deg) for name, lies in orientations.items() if name in meshes}
    contents, plates = {}, {}
    if with_stl:
        contents = {f"{name}.stl": stl.to_bytes(pose.apply(meshes[name]), name) for name, pose in poses.items()}
    if set(orientations) <= set(encoded):
        footprints = {name: pose.size(meshes[name])[:2] for name, pose in poses.items()}
        supports, material = supports_by_part(design), PRINT_MATERIALS[design.strength.print_material]
        for kind in PLATE_KINDS:
            arranged = arrange(footprints, (design.printer.bed_x_mm, design.printer.bed_y_mm), kind.gap_mm)
            for file, plate in zip(kind.file_names(len(arranged)), arranged, strict=True):
                items = []
                for part in plate:
                    stands, pose = supports[part.name], _place(part, poses[part.name], meshes[part.name])
                    lies = orientations[part.name]
                    settings = slicer_settings(part.name, lies, stands) if kind is FDM else ()
                    note = describe_part(kind, part.name, lies, stands, material)
                    items.append(Item(part.name, encoded[part.name], note, pose.rotation, pose.shift, settings))
                contents[file] = write_items(f"{design.name} {file.removesuffix('.3mf')}", items)
                plates[file] = tuple(part.name for part in plate)
    return PrintFiles(contents, plates)


def _place(part: Placed, pose: Pose, mesh: Mesh) -> Pose:
    """Move a part to its place on the plate."""
    return (pose.turned() if part.is_turned else pose).on_bed(mesh, part.x, part.y)
