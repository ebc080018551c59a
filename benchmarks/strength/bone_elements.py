"""Finite elements of a bone: Gmsh meshes its STEP file, and CalculiX
solves the mesh under forces at the apex.
"""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fingertip.design import Design
from fingertip.models.bone import bone

YOUNG_MPA = 2800.0
POISSON = 0.4
"""Stresses under given forces do not depend on the first, and hardly on the second."""
COARSE_MM = 1.8
LOADED_MM = 1.0
DIRECTIONS = 150
GEO = """SetFactory("OpenCASCADE");
Merge "bone.step";
Mesh.CharacteristicLengthMax = {coarse};
Mesh.CharacteristicLengthExtendFromBoundary = 0;
Mesh.CharacteristicLengthFromPoints = 0;
Field[1] = Box;
Field[1].VIn = {fine};
Field[1].VOut = {coarse};
Field[1].XMin = -50; Field[1].XMax = 50; Field[1].YMin = -50; Field[1].YMax = 50;
Field[1].ZMin = {low}; Field[1].ZMax = {high}; Field[1].Thickness = 2;
Background Field = 1;
Mesh.ElementOrder = 2;
Mesh.SecondOrderLinear = 1;
Mesh.MshFileVersion = 2.2;
"""
"""Straight edges: curved ones turn some quadratic tetrahedra at small faces inside out."""


@dataclass(frozen=True)
class Stresses:
    points_mm: np.ndarray
    """Nodes, (n, 3)."""
    tension_mpa_per_n: np.ndarray
    """Largest principal stress at each over all directions of a force of 1 N at the apex."""


def write_step(design: Design, folder: Path) -> None:
    import cadquery as cq

    from fingertip.cad.kernel.brep import BrepEvaluator

    solid = cq.Solid(BrepEvaluator().solid(bone(design)))
    cq.exporters.export(cq.Workplane(obj=solid), str(folder / "bone.step"))


def solve_bone(
    design: Design, folder: Path, fine_mm: float, zone_mm: tuple[float, float]
) -> Stresses:
    """Solve the bone in a folder that holds bone.step, with
    elements of `fine_mm` [mm] in a range of z [mm].
    """
    geo = GEO.format(
        coarse=COARSE_MM,
        fine=fine_mm,
        low=zone_mm[0],
        high=zone_mm[1],
    )
    (folder / "bone.geo").write_text(geo)
    subprocess.run(
        ["gmsh", "-3", "bone.geo", "-o", "bone.msh"], cwd=folder, capture_output=True, check=True
    )
    nodes, tetrahedra = read_mesh((folder / "bone.msh").read_text().splitlines())
    used = np.unique(tetrahedra)
    points = np.array([nodes[number] for number in used])
    held = used[is_held(design, points)]
    loaded = used[points[:, 2] > points[:, 2].max() - LOADED_MM]
    (folder / "bone.inp").write_text("\n".join(deck(nodes, tetrahedra, held, loaded)))
    subprocess.run(["ccx", "-i", "bone"], cwd=folder, capture_output=True, check=True)
    numbers, stresses = read_stresses((folder / "bone.frd").read_text().splitlines())

    return Stresses(np.array([nodes[number] for number in numbers]), largest_tension(stresses))


def read_mesh(lines: list[str]) -> tuple[dict[int, tuple[float, ...]], np.ndarray]:
    """Read nodes and tetrahedra; CalculiX numbers the last two
    middles of edges the other way round.
    """
    begin = lines.index("$Nodes") + 2
    rows = (line.split() for line in lines[begin : begin + int(lines[begin - 1])])
    nodes = {int(number): tuple(map(float, xyz)) for number, *xyz in rows}
    begin = lines.index("$Elements") + 2
    elements = (
        list(map(int, line.split())) for line in lines[begin : begin + int(lines[begin - 1])]
    )
    tetrahedra = np.array([row[-10:] for row in elements if row[1] == 11])

    return nodes, tetrahedra[:, [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]]


def is_held(design: Design, points: np.ndarray) -> np.ndarray:
    """Find the nodes that the hand holds: far from the root, whose stress they must not touch."""
    at = design.bone
    z = points[:, 2]
    end = -design.bone.base_length_mm

    match at.interface:
        case "post":
            return z < end - at.post_length_mm / 2
        case "flange":
            return z < end + 1e-6
        case "socket":
            radius = np.hypot(points[:, 0], points[:, 1] - design.dimensions.base_middle_y)
            return (abs(radius - at.socket_diameter_mm / 2) < 0.02) & (
                z < end + at.socket_depth_mm / 2
            )

    assert design.dimensions.joint
    return z < design.dimensions.joint.axis_z


def describe_solid(nodes: dict, tetrahedra: np.ndarray) -> Iterator[str]:
    yield "*NODE, NSET=ALL"
    for number in np.unique(tetrahedra):
        yield f"{number}, " + ", ".join(f"{value:.9g}" for value in nodes[number])

    yield "*ELEMENT, TYPE=C3D10, ELSET=BONE"
    for i, corners in enumerate(tetrahedra):
        yield f"{i + 1}, " + ", ".join(map(str, corners))

    yield (
        f"*MATERIAL, NAME=RESIN\n*ELASTIC\n{YOUNG_MPA}, {POISSON}\n*SOLID SECTION, ELSET=BONE, "
        "MATERIAL=RESIN"
    )


def deck(
    nodes: dict, tetrahedra: np.ndarray, held: np.ndarray, loaded: np.ndarray
) -> Iterator[str]:
    """Yield the lines of the input file: three steps with a force of 1 N along x, y and z."""
    yield from describe_solid(nodes, tetrahedra)
    yield "*BOUNDARY"
    yield from (f"{number}, 1, 3" for number in held)

    for axis in (1, 2, 3):
        yield "*STEP\n*STATIC\n*CLOAD, OP=NEW"
        yield from (f"{number}, {axis}, {1 / len(loaded):.9g}" for number in loaded)
        yield "*EL FILE\nS\n*END STEP"

    yield ""


def read_stresses(lines: list[str]) -> tuple[list[int], np.ndarray]:
    """Read the nodes, and the stress tensor of each in each step, (3, n, 3, 3) [MPa]."""
    blocks: list[list[str]] = []
    reads = False

    for line in lines:
        if line.startswith(" -4"):
            reads = "STRESS" in line
            if reads:
                blocks.append([])
        elif reads and line.startswith(" -1"):
            blocks[-1].append(line)
        elif line.startswith(" -3"):
            reads = False

    rows = [
        [[float(line[13 + 12 * i : 25 + 12 * i]) for i in range(6)] for line in block]
        for block in blocks
    ]
    xx, yy, zz, xy, yz, zx = np.moveaxis(np.array(rows), -1, 0)
    tensors = np.stack(
        [np.stack(row, -1) for row in ((xx, xy, zx), (xy, yy, yz), (zx, yz, zz))], -2
    )
    return [int(line[3:13]) for line in blocks[0]], tensors


def largest_tension(tensors: np.ndarray) -> np.ndarray:
    """Find the largest principal stress at each node over directions
    of the force, spread evenly over a sphere.
    """
    steps = np.arange(DIRECTIONS) + 0.5
    polar = np.arccos(1 - 2 * steps / DIRECTIONS)
    around = np.pi * (1 + 5**0.5) * steps
    forces = np.stack(
        [np.cos(around) * np.sin(polar), np.sin(around) * np.sin(polar), np.cos(polar)], 1
    )
    found = np.zeros(tensors.shape[1])

    for force in forces:
        found = np.maximum(
            found, np.linalg.eigvalsh(np.einsum("i,injk->njk", force, tensors))[:, -1]
        )

    return found
