"""Finite elements of the eye of a joint: pin and hand's shoulder touch half a bone with contact, in
CalculiX.

The pin is of the bone's material, 0.01 mm thinner in radius than its bore, and held where the
hand's tongue or fork holds it. The hand's shoulder is rigid, and the finger straight. All contact
is free of friction. The bone is symmetric to x = 0.
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from benchmarks.strength.bone_elements import (
    COARSE_MM,
    LOADED_MM,
    POISSON,
    YOUNG_MPA,
    read_mesh,
    read_stresses,
)
from fingertip.design import Design
from fingertip.models.bone import bone
from fingertip.models.joint import Joint
from fingertip.models.solids import Box

PLAY_MM = 0.01
BASE_MM = 0.8
AROUND_MM = 1.0
FAR_MM = 60.0
FACES = ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0))
"""Corners of the faces of a tetrahedron, in CalculiX's order."""
MESH = """Mesh.CharacteristicLengthExtendFromBoundary = 0;
Mesh.CharacteristicLengthFromPoints = 0;
Mesh.ElementOrder = 2;
Mesh.SecondOrderLinear = 1;
Mesh.MshFileVersion = 2.2;
"""
BONE = """SetFactory("OpenCASCADE");
Merge "bone.step";
Field[1] = Cylinder; Field[1].VIn = {fine}; Field[1].VOut = {coarse}; Field[1].XAxis = 60; Field[1].ZAxis = 0;
Field[1].YCenter = {y}; Field[1].ZCenter = {z}; Field[1].Radius = {around};
Field[2] = Box; Field[2].VIn = {base}; Field[2].VOut = {coarse}; Field[2].XMin = -60; Field[2].XMax = 60;
Field[2].YMin = -60; Field[2].YMax = 60; Field[2].ZMin = -60; Field[2].ZMax = {top}; Field[2].Thickness = 2;
Field[3] = Min; Field[3].FieldsList = {{1, 2}};
Background Field = 3;
"""  # noqa: E501
PIN = """SetFactory("OpenCASCADE");
Cylinder(1) = {{0, {y}, {z}, {length}, 0, 0, {radius}}};
Mesh.CharacteristicLengthMax = {fine};
"""
SOLVE = f"""*MATERIAL, NAME=RESIN
*ELASTIC
{YOUNG_MPA}, {POISSON}
*MATERIAL, NAME=STEEL
*ELASTIC
200000, 0.3
*SOLID SECTION, ELSET=BONE, MATERIAL=RESIN
*SOLID SECTION, ELSET=PIN, MATERIAL=RESIN
*SOLID SECTION, ELSET=HAND, MATERIAL=STEEL
*SURFACE INTERACTION, NAME=TOUCH
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
100000, 0.0001
*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE
BORE, ROUND
*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE
STOP, SHOULDER
"""


def solve_eye(
    design: Design, folder: Path, fine_mm: float, force_n: float
) -> tuple[np.ndarray, np.ndarray, float]:
    """Return points around the bore, their largest principal stress [MPa], and the height z of the
    load.

    The load, `force_n` [N], pushes the bone's tip away from the palm.
    """
    import cadquery as cq

    from fingertip.cad.kernel.brep import BrepEvaluator

    joint = design.dimensions.joint
    assert joint
    half = bone(design).intersect(Box((0.0, -FAR_MM, -FAR_MM), (FAR_MM, FAR_MM, FAR_MM)))
    cq.exporters.export(
        cq.Workplane(obj=cq.Solid(BrepEvaluator().solid(half))), str(folder / "bone.step")
    )
    length = (
        design.dimensions.eyes.half_width_at(joint.axis_y)
        if joint.is_fork
        else joint.half_width + 3.0
    )
    sizes = {
        "fine": fine_mm,
        "coarse": COARSE_MM,
        "base": BASE_MM,
        "y": joint.axis_y,
        "z": joint.axis_z,
        "length": length,
        "around": joint.pin_radius + AROUND_MM,
        "radius": joint.pin_radius - PLAY_MM,
        "top": joint.shoulder_z + 1.0,
    }
    (nodes, tetrahedra), (pin_nodes, pin) = (
        mesh(folder, name, (text + MESH).format(**sizes))
        for name, text in (("bone", BONE), ("pin", PIN))
    )
    shift = max(nodes)
    nodes |= {number + shift: point for number, point in pin_nodes.items()}
    used = np.unique(tetrahedra)
    loaded = used[
        [
            nodes[number][2] > max(point[2] for point in nodes.values()) - LOADED_MM
            for number in used
        ]
    ]
    lines = _deck(
        design,
        joint=joint,
        nodes=nodes,
        bone=tetrahedra,
        pin=pin + shift,
        loaded=loaded,
        force_n=force_n,
    )
    (folder / "eye.inp").write_text("\n".join(lines))
    subprocess.run(["ccx", "-i", "eye"], cwd=folder, capture_output=True, check=True)
    numbers, stresses = read_stresses((folder / "eye.frd").read_text().splitlines())
    of_bone = np.isin(numbers, used)
    points = np.array(
        [nodes[number] for number, inside in zip(numbers, of_bone, strict=True) if inside]
    )
    near = (
        np.hypot(points[:, 1] - joint.axis_y, points[:, 2] - joint.axis_z)
        < joint.pin_radius + AROUND_MM
    )
    tension = np.linalg.eigvalsh(stresses[-1][of_bone])[:, -1]

    return points[near], tension[near], float(np.mean([nodes[number][2] for number in loaded]))


def mesh(folder: Path, name: str, geo: str) -> tuple[dict, np.ndarray]:
    (folder / f"{name}.geo").write_text(geo)
    subprocess.run(
        ["gmsh", "-3", f"{name}.geo", "-o", f"{name}.msh"],
        cwd=folder,
        capture_output=True,
        check=True,
    )
    return read_mesh((folder / f"{name}.msh").read_text().splitlines())


def _deck(
    design: Design,
    joint: Joint,
    nodes: dict,
    bone: np.ndarray,
    pin: np.ndarray,
    loaded: np.ndarray,
    force_n: float,
) -> Iterator[str]:
    """Yield the lines of the input file, in which the bone's elements
    come first, then the pin's, then the hand.
    """
    far = FAR_MM
    low = joint.low_z
    first = max(nodes) + 1
    square = ((-far, -far), (far, -far), (far, far), (-far, far))
    hand = {first + i: (*square[i % 4], low - 2.0 * (i < 4)) for i in range(8)}
    yield "*NODE, NSET=ALL"
    used = [*np.unique(bone), *np.unique(pin)]
    for number, point in [*((number, nodes[number]) for number in used), *hand.items()]:
        yield f"{number}, " + ", ".join(f"{value:.9g}" for value in point)

    for kind, name, start, elements in (
        ("C3D10", "BONE", 1, bone),
        ("C3D10", "PIN", 1 + len(bone), pin),
        ("C3D8", "HAND", 0, [[*hand]]),
    ):
        yield f"*ELEMENT, TYPE={kind}, ELSET={name}"
        start = start or 1 + len(bone) + len(pin)
        yield from (
            f"{start + i}, " + ", ".join(map(str, corners)) for i, corners in enumerate(elements)
        )

    def at_radius(radius: float) -> Callable[[np.ndarray], bool]:
        return lambda at: bool(
            np.all(abs(np.hypot(at[:, 1] - joint.axis_y, at[:, 2] - joint.axis_z) - radius) < 1e-3)
        )

    def on_stop(at: np.ndarray) -> bool:
        return bool(np.all(abs(at[:, 2] - low) < 1e-4) and at[:, 1].mean() > joint.axis_y)

    yield from _surface(
        "BORE",
        elements=bone,
        nodes=nodes,
        first=1,
        keeps=at_radius(joint.pin_radius),
    )
    yield from _surface(
        "STOP",
        elements=bone,
        nodes=nodes,
        first=1,
        keeps=on_stop,
    )
    yield from _surface(
        "ROUND",
        elements=pin,
        nodes=nodes,
        first=1 + len(bone),
        keeps=at_radius(joint.pin_radius - PLAY_MM),
    )
    yield f"*SURFACE, NAME=SHOULDER, TYPE=ELEMENT\n{1 + len(bone) + len(pin)}, S2"

    for axis in (2, 3):  # weak springs hold the bone until it touches
        yield (
            f"*ELEMENT, TYPE=SPRING1, ELSET=WEAK{axis}\n{1 + len(bone) + len(pin) + axis}, "
            f"{loaded[0]}"
        )
        yield f"*SPRING, ELSET=WEAK{axis}\n{axis}\n0.02"

    yield SOLVE + "*BOUNDARY"
    half = design.hand.width_mm / 2
    for number in np.unique(pin):
        x = nodes[number][0]
        if x < half if joint.is_fork else x > half:
            yield f"{number}, 1, 3"

    yield from (f"{number}, 1" for number in used if abs(nodes[number][0]) < 1e-5)
    yield from (f"{number}, 1, 3" for number in hand)
    yield "*STEP, INC=200\n*STATIC\n0.5, 1.0, 1e-5, 1.0\n*CLOAD"
    yield from (f"{number}, 2, {force_n / 2 / len(loaded):.9g}" for number in loaded)
    yield "*EL FILE, FREQUENCY=100\nS\n*END STEP\n"


def find_faces(
    elements: np.ndarray, nodes: dict, keeps: Callable
) -> Iterator[tuple[int, int, np.ndarray]]:
    """Find the faces that belong to one tetrahedron only and are where
    they should be: element, side and corners.
    """
    found: dict[tuple[int, ...], list[tuple[int, int, list[int]]]] = {}
    for i, corners in enumerate(elements):
        for side, face in enumerate(FACES, 1):
            ordered = [int(corners[at]) for at in face]
            found.setdefault(tuple(sorted(ordered)), []).append((i, side, ordered))

    for same in found.values():
        at = np.array([nodes[number] for number in same[0][2]])
        if len(same) == 1 and keeps(at):
            yield same[0][0], same[0][1], at


def _surface(
    name: str,
    elements: np.ndarray,
    nodes: dict,
    first: int,
    keeps: Callable,
) -> Iterator[str]:
    yield f"*SURFACE, NAME={name}, TYPE=ELEMENT"
    yield from (f"{first + i}, S{side}" for i, side, _ in find_faces(elements, nodes, keeps))
