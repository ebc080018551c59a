"""Finite elements of the pad beside CalculiX, which solves the
same mesh, supports and loads from a file.
"""

from __future__ import annotations

import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fingertip.pad.fem_contact import PadModel
from fingertip.pad.fem_elastic import factorise
from fingertip.pad.fem_mesh import MeshSize
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.touch import X, Z
from tests.pad.bonded import CROWNED
from tests.tools import require_tool

C3D15 = [0, 1, 2, 12, 13, 14, 3, 4, 5, 15, 16, 17, 6, 7, 8]
"""Nodes of a wedge in the order of CalculiX, whose wedge lacks the middles of the upright faces."""


def write_deck(
    model: PadModel, forces: np.ndarray, path: Path, *, is_large: bool = False
) -> np.ndarray:
    """Write mesh, materials, supports and nodal forces as an
    input file; return the nodes that it has.
    """
    mesh = model.mesh
    body = model.body
    used = np.unique(mesh.wedges[:, C3D15])
    held = np.zeros(mesh.nodes.size, bool)
    held[body._fixed] = True
    lines = [
        "*NODE, NSET=ALL",
        *(f"{n + 1}, {x:.12g}, {z:.12g}, {y:.12g}" for n, (x, z, y) in enumerate(mesh.nodes)),
    ]
    lines = [line for line in lines if line[0] == "*" or int(line.split(",")[0]) - 1 in set(used)]
    for young, poisson in sorted(set(zip(body.young_mpa, body.poisson, strict=True))):
        name = f"E{young:.0f}"
        lines.append(f"*ELEMENT, TYPE=C3D15, ELSET={name}")
        chosen = np.flatnonzero(body.young_mpa == young)
        lines += [
            f"{e + 1}, {', '.join(str(n + 1) for n in mesh.wedges[e, C3D15])}" for e in chosen
        ]
        neo_hookean = f"{young / (4 + 4 * poisson):.12g}, {6 * (1 - 2 * poisson) / young:.12g}"
        elastic = (
            ["*HYPERELASTIC, NEO HOOKE", neo_hookean]
            if is_large
            else ["*ELASTIC", f"{young:.12g}, {poisson:.12g}"]
        )
        lines += [f"*MATERIAL, NAME={name}", *elastic]
        lines.append(f"*SOLID SECTION, ELSET={name}, MATERIAL={name}")
    lines += ["*BOUNDARY"]
    lines += [
        f"{n + 1}, {axis + 1}, {axis + 1}"
        for n in used
        for axis in np.flatnonzero(held.reshape(-1, 3)[n])
    ]
    lines += [f"*STEP{', NLGEOM' if is_large else ''}", "*STATIC", "*CLOAD"]
    lines += [
        f"{n + 1}, {axis + 1}, {forces[n, axis]:.12g}"
        for n in used
        for axis in range(3)
        if forces[n, axis]
    ]
    path.write_text("\n".join([*lines, "*NODE PRINT, NSET=ALL", "U", "*END STEP", ""]))
    return used


def solve(ccx: str, folder: Path, used: np.ndarray) -> np.ndarray:
    """Solve the file and return the displacements of its nodes."""
    subprocess.run([ccx, "-i", "pad"], cwd=folder, check=True, capture_output=True, timeout=300)
    rows = [row.split() for row in (folder / "pad.dat").read_text().splitlines()[3:] if row.strip()]
    assert [int(row[0]) - 1 for row in rows[-len(used) :]] == used.tolist()
    return np.array([[float(value) for value in row[1:]] for row in rows[-len(used) :]])


def smooth_load(model: PadModel) -> np.ndarray:
    """Forces of nodes of a pressure beside the sensor, with some shear."""
    top = model.top.points
    loads = np.zeros(model.mesh.nodes.shape)
    near = np.exp(-(top[:, X] ** 2 + (top[:, Z] - model.form.sensor_z_mm + 1.0) ** 2) / 4.0)
    loads[model._upper] = model.top.trace @ (near[:, None] * np.array([0.0, 0.01, -0.05]))
    return loads


@pytest.mark.full
def test_pad_yields_at_large_strain_as_by_calculix(tmp_path: Path) -> None:
    ccx = require_tool("ccx", "as root on Debian, sh .ci/install-calculix")
    model = PadModel(replace(PadForm.of_design(CROWNED), poisson=0.3), MeshSize(1.0), is_half=True)
    loads = 12.0 * smooth_load(model)
    free = np.flatnonzero(~model.body.is_fixed)
    ours = np.zeros_like(loads)
    small = model.body.move(loads[..., None])[..., 0]
    for part in np.linspace(0.1, 1.0, 10):
        for _ in range(6):
            matrix, held = model.body.tangent(ours)
            ours.ravel()[free] += factorise(matrix[free][:, free]).solve(
                (part * loads - held).ravel()[free]
            )
    used = write_deck(model, loads, tmp_path / "pad.inp", is_large=True)
    theirs = solve(ccx, tmp_path, used)
    assert np.linalg.norm(small - ours) > 0.1 * np.linalg.norm(ours)
    assert (theirs * loads[used]).sum() / (ours * loads).sum() == pytest.approx(1.0, abs=0.01)
    assert np.linalg.norm(theirs - ours[used]) < 0.04 * np.linalg.norm(ours[used])


@pytest.mark.full
@pytest.mark.parametrize(("poisson", "stiffer"), [(0.3, 0.0), (0.49, 0.05)])
def test_pad_yields_as_by_calculix(tmp_path: Path, poisson: float, stiffer: float) -> None:
    """A smooth pressure beside the sensor with some shear.

    Nearly incompressible, the wedges of CalculiX lock.
    """
    ccx = require_tool("ccx", "as root on Debian, sh .ci/install-calculix")
    model = PadModel(
        replace(PadForm.of_design(CROWNED), poisson=poisson), MeshSize(1.0), is_half=True
    )
    loads = smooth_load(model)
    ours = model.body.move(loads[..., None])[..., 0]
    used = write_deck(model, loads, tmp_path / "pad.inp")
    theirs = solve(ccx, tmp_path, used)
    assert (theirs * loads[used]).sum() / (ours * loads).sum() == pytest.approx(
        1.0 - stiffer, abs=0.01 + 0.4 * stiffer
    )
    assert np.linalg.norm(theirs - ours[used]) < (0.04 + 2.0 * stiffer) * np.linalg.norm(ours[used])
