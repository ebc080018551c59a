"""Finite elements of the tendon's anchor: Gmsh meshes half a bone, and CalculiX loads it as a bent finger.

A force pushes the apex away from the palm, the tendon presses on horn and back and holds it, and the pin's bore is
held. The finger is in balance, so that the bore feels no moment. The bone is symmetric to x = 0.
"""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from fingertip.cad.kernel.brep import BrepEvaluator
from fingertip.cad.shapes.bone import bone
from fingertip.design import Design
from fingertip.design.geometry.joint import HORN_RADIUS_MM
from fingertip.design.geometry.solids import Box, intersection
from fingertip.design.interfaces.clevis import tendon_force_per_n
from tests.cad.bone_elements import COARSE_MM, LOADED_MM, POISSON, YOUNG_MPA, read_stresses
from tests.cad.eye_elements import FACES, FAR_MM, MESH, mesh

AROUND_MM = 1.5
"""Depth of the fine mesh around the horn, within which the elements must find the largest tension [mm]."""
BONE = """SetFactory("OpenCASCADE");
Merge "bone.step";
Field[1] = Cylinder; Field[1].VIn = {fine}; Field[1].VOut = {coarse}; Field[1].XCenter = {x}; Field[1].XAxis = 1.5;
Field[1].YAxis = 0; Field[1].ZAxis = 0; Field[1].YCenter = {y}; Field[1].ZCenter = {z}; Field[1].Radius = {around};
Background Field = 1;
"""


def solve_anchor(design: Design, folder: Path, fine_mm: float) -> tuple[np.ndarray, np.ndarray]:
    """Return points around the horn, and their largest principal stress per newton at the apex [MPa/N]."""
    import cadquery as cq

    anchor, joint = design.dimensions.anchor, design.dimensions.joint
    assert anchor
    assert joint
    half = intersection(bone(design), Box((0.0, -FAR_MM, -FAR_MM), (FAR_MM, FAR_MM, FAR_MM)))
    cq.exporters.export(cq.Workplane(obj=cq.Solid(BrepEvaluator().solid(half))), str(folder / "bone.step"))
    axis = np.array([anchor.horn_y + HORN_RADIUS_MM, anchor.horn_low_z])
    sizes = {
        "fine": fine_mm, "coarse": COARSE_MM, "x": anchor.strand_x, "y": axis[0], "z": axis[1],
        "around": HORN_RADIUS_MM + AROUND_MM,
    }  # fmt: skip
    nodes, tetrahedra = mesh(folder, "bone", (BONE + MESH).format(**sizes))
    numbers = np.unique(tetrahedra)
    (folder / "anchor.inp").write_text("\n".join(_deck(design, nodes, tetrahedra, numbers)))
    subprocess.run(["ccx", "-i", "anchor"], cwd=folder, capture_output=True, check=True)
    found, stresses = read_stresses((folder / "anchor.frd").read_text().splitlines())
    points = np.array([nodes[number] for number in found])
    away = np.hypot(*(points[:, 1:] - axis).T)
    near = (abs(away - HORN_RADIUS_MM) < AROUND_MM) & (abs(points[:, 0] - anchor.strand_x) < AROUND_MM)
    near &= (points[:, 1] < axis[0]) & (points[:, 2] > axis[1])
    return points[near], np.linalg.eigvalsh(stresses[-1][near])[:, -1]


def _deck(design: Design, nodes: dict, tetrahedra: np.ndarray, numbers: np.ndarray) -> Iterator[str]:
    anchor, joint = design.dimensions.anchor, design.dimensions.joint
    assert anchor
    assert joint
    strand_n = tendon_force_per_n(design, design.skin.length_mm) / 2
    axis_y, axis_z = anchor.horn_y + HORN_RADIUS_MM, anchor.horn_low_z

    def on_horn(at: np.ndarray) -> bool:
        away = np.hypot(at[:, 1] - axis_y, at[:, 2] - axis_z)
        turns = at[:, 1].mean() < axis_y and at[:, 2].mean() > axis_z
        return bool(
            turns
            and abs(away - HORN_RADIUS_MM).max() < 0.02
            and abs(at[:, 0].mean() - anchor.strand_x) < anchor.line / 2
        )

    def on_back(at: np.ndarray) -> bool:
        within = anchor.low_z - 0.1 < at[:, 2].mean() < anchor.low_z + anchor.line + 0.2
        return bool(within and at[:, 1].mean() > 0.0 and _normal(at)[1] > 0.7)

    horn, back = (list(_faces(tetrahedra, nodes, keeps)) for keeps in (on_horn, on_back))
    yield "*NODE, NSET=ALL"
    for number in numbers:
        yield f"{number}, " + ", ".join(f"{value:.9g}" for value in nodes[number])
    yield "*ELEMENT, TYPE=C3D10, ELSET=BONE"
    for i, corners in enumerate(tetrahedra):
        yield f"{i + 1}, " + ", ".join(map(str, corners))
    yield f"*MATERIAL, NAME=RESIN\n*ELASTIC\n{YOUNG_MPA}, {POISSON}\n*SOLID SECTION, ELSET=BONE, MATERIAL=RESIN"
    yield "*BOUNDARY"
    points = np.array([nodes[number] for number in numbers])
    yield from (f"{number}, 1" for number in numbers[abs(points[:, 0]) < 1e-5])
    bore = abs(np.hypot(points[:, 1] - joint.axis_y, points[:, 2] - joint.axis_z) - joint.pin_radius) < 1e-3
    yield from (f"{number}, 2, 3" for number in numbers[bore])
    yield "*STEP\n*STATIC\n*CLOAD"
    loaded = numbers[points[:, 2] > points[:, 2].max() - LOADED_MM]
    yield from (f"{number}, 2, {0.5 / len(loaded):.9g}" for number in loaded)
    yield "*DLOAD"
    # The strand pulls its horn towards the hand and towards the back; it pushes the back as much.
    for faces, axis in ((horn, 2), (back, 1)):
        projected = sum(abs(_area(at)[axis]) for _, _, at in faces)
        yield from (f"{element}, P{side}, {strand_n / projected:.9g}" for element, side, _ in faces)
    yield "*EL FILE\nS\n*END STEP\n"


def _area(at: np.ndarray) -> np.ndarray:
    return np.cross(at[1] - at[0], at[2] - at[0]) / 2


def _normal(at: np.ndarray) -> np.ndarray:
    area = _area(at)
    return area / np.linalg.norm(area)


def _faces(elements: np.ndarray, nodes: dict, keeps) -> Iterator[tuple[int, int, np.ndarray]]:
    found: dict[tuple[int, ...], list[tuple[int, int, tuple[int, ...]]]] = {}
    for i, corners in enumerate(elements):
        for side, face in enumerate(FACES, 1):
            ordered = tuple(corners[list(face)])
            found.setdefault(tuple(sorted(ordered)), []).append((i + 1, side, ordered))
    for same in found.values():
        if len(same) == 1:
            at = np.array([nodes[number] for number in same[0][2]])
            if keeps(at):
                yield same[0][0], same[0][1], at
