"""Finite elements of the tendon's anchor: Gmsh meshes half a bone, and CalculiX loads it as a bent
finger.

A force pushes the apex away from the palm, the tendon presses on horn and back and holds it, and
the pin's bore is held. The finger is in balance, so that the bore feels no moment. The bone is
symmetric to x = 0.
"""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.strength.bone_elements import COARSE_MM, LOADED_MM, describe_solid, read_stresses
from benchmarks.strength.eye_elements import FAR_MM, MESH, find_faces, mesh
from fingertip.design import Design
from fingertip.design.interfaces.clevis import tendon_force_per_n
from fingertip.models.bone import bone
from fingertip.models.joint import HORN_RADIUS_MM
from fingertip.models.solids import Box

INSIDE_MM = 0.2
ABOUT_MM = 0.05
"""Distance from the sharp inner corner of the horn at which
tension is taken: half a line of the printer.
"""
BALL_MM = 1.0
BALLS = 9
BALL = """Field[{i}] = Ball; Field[{i}].VIn = {fine}; Field[{i}].VOut = {coarse}; Field[{i}].Radius = {radius};
Field[{i}].Thickness = 3; Field[{i}].XCenter = {x}; Field[{i}].YCenter = {y}; Field[{i}].ZCenter = {z};
"""  # noqa: E501
BONE = """SetFactory("OpenCASCADE");
Merge "bone.step";
{balls}Field[100] = Min; Field[100].FieldsList = {{{fields}}};
Background Field = 100;
"""


def solve_anchor(design: Design, folder: Path, fine_mm: float) -> float:
    """Return the largest principal stress just inside the inner corner
    of the horn, per newton at the apex [MPa/N].
    """
    import cadquery as cq

    from fingertip.cad.kernel.brep import BrepEvaluator

    anchor = design.dimensions.anchor
    assert anchor
    half = bone(design).intersect(Box((0.0, -FAR_MM, -FAR_MM), (FAR_MM, FAR_MM, FAR_MM)))
    cq.exporters.export(
        cq.Workplane(obj=cq.Solid(BrepEvaluator().solid(half))), str(folder / "bone.step")
    )
    axis_y = anchor.horn_y + HORN_RADIUS_MM
    axis_z = anchor.horn_low_z
    turns = [np.pi / 2 * i / (BALLS - 1) for i in range(BALLS)]
    balls = "".join(
        BALL.format(
            i=i + 1,
            fine=fine_mm,
            coarse=COARSE_MM,
            radius=BALL_MM,
            x=anchor.half_width,
            y=axis_y - HORN_RADIUS_MM * np.cos(turn),
            z=axis_z + HORN_RADIUS_MM * np.sin(turn),
        )
        for i, turn in enumerate(turns)
    )
    geo = BONE.format(balls=balls, fields=", ".join(str(i + 1) for i in range(BALLS)))
    nodes, tetrahedra = mesh(folder, "bone", geo + MESH)
    numbers = np.unique(tetrahedra)
    (folder / "anchor.inp").write_text("\n".join(_deck(design, nodes, tetrahedra, numbers)))
    subprocess.run(["ccx", "-i", "anchor"], cwd=folder, capture_output=True, check=True)
    found, stresses = read_stresses((folder / "anchor.frd").read_text().splitlines())
    x, y, z = np.array([nodes[number] for number in found]).T
    off = np.hypot(y - axis_y, z - axis_z) - HORN_RADIUS_MM
    inside = abs(np.hypot(x - anchor.half_width, off) - INSIDE_MM) < ABOUT_MM
    inside &= (y < axis_y) & (z > axis_z)

    return float(np.linalg.eigvalsh(stresses[-1][inside])[:, -1].max())


def _deck(
    design: Design, nodes: dict, tetrahedra: np.ndarray, numbers: np.ndarray
) -> Iterator[str]:
    anchor = design.dimensions.anchor
    joint = design.dimensions.joint
    assert anchor
    assert joint
    strand_n = tendon_force_per_n(design, design.skin.length_mm) / 2
    axis_y = anchor.horn_y + HORN_RADIUS_MM
    axis_z = anchor.horn_low_z

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
        across = np.cross(at[1] - at[0], at[2] - at[0])
        return bool(within and at[:, 1].mean() > 0.0 and across[1] > 0.7 * np.linalg.norm(across))

    horn, back = (list(find_faces(tetrahedra, nodes, keeps)) for keeps in (on_horn, on_back))
    yield from describe_solid(nodes, tetrahedra)
    yield "*BOUNDARY"
    points = np.array([nodes[number] for number in numbers])
    yield from (f"{number}, 1" for number in numbers[abs(points[:, 0]) < 1e-5])
    bore = (
        abs(np.hypot(points[:, 1] - joint.axis_y, points[:, 2] - joint.axis_z) - joint.pin_radius)
        < 1e-3
    )
    yield from (f"{number}, 2, 3" for number in numbers[bore])
    yield "*STEP\n*STATIC\n*CLOAD"
    loaded = numbers[points[:, 2] > points[:, 2].max() - LOADED_MM]
    yield from (f"{number}, 2, {0.5 / len(loaded):.9g}" for number in loaded)
    yield "*DLOAD"

    # The strand pulls its horn towards the hand and towards the back; it pushes the back as much.
    for faces, axis in ((horn, 2), (back, 1)):
        projected = sum(abs(np.cross(at[1] - at[0], at[2] - at[0])[axis]) / 2 for _, _, at in faces)
        yield from (f"{i + 1}, P{side}, {strand_n / projected:.9g}" for i, side, _ in faces)

    yield "*EL FILE\nS\n*END STEP\n"
