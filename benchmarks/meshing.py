"""Error against run time of several meshers on the skin's outer surface, and cost of all checks of
a design.

    python benchmarks/meshing.py [picture.png]

The meshers are the structured grid of `cad.kernel.tessellate`, Open CASCADE's mesher at several
linear and angular tolerances, and gmsh, if it is installed, on the STEP file at several numbers of
elements per turn. Each mesh is judged by its measured errors, not by the requested tolerance: the
largest distance of a facet from the exact surface (`cad.verification.surface_deviation`), and the
volume error against the closed form. Only meshing is timed, in CPU seconds of this process on one
thread. Reading a mesh out of Open CASCADE or gmsh is not counted.
"""

from __future__ import annotations

import importlib.util
import math
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fingertip.cad.kernel.mesh import Mesh
from fingertip.cad.kernel.tessellate import tessellate
from fingertip.design import Design
from fingertip.models.conic import ConicBody
from fingertip.models.solids import SuperconicSolid
from tests.cad.test_tessellate import distance_to_surface

DESIGN = Path(__file__).resolve().parent.parent / "params" / "fsr400.toml"
TOLERANCES_MM = (0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001)
OCC = {
    "OCC by tolerance": [
        (linear, 0.5) for linear in (0.1, 0.03, 0.01, 0.003, 0.001, 0.0005, 0.0002)
    ],
    "OCC by both": [(linear, 0.2) for linear in (0.1, 0.03, 0.01, 0.003)],
    "OCC by angle": [(1.0, angular) for angular in (0.2, 0.1, 0.05, 0.03, 0.02, 0.01)],
}
"""Linear [mm] and angular [rad] tolerances of each series, in
which one of them or both limit the mesh.
"""
GMSH_PER_TURN = (12, 24, 48, 96, 192, 384)
MAX_MESHING_S = 8.0
"""CPU time after which a mesher is not refined further [s]."""
MAX_POINTS = 300_000
"""Number of points on facets whose distance from the surface is measured."""
GRID = "structured grid"
MARKS = {
    "deviation_mm": (0.1, 0.05, 0.03, 0.01, 0.003, 0.001),
    "volume_error": (5e-3, 2e-3, 1e-3, 5e-4, 1e-4),
}
NOT_COVERED = (
    "Open CASCADE with angular tolerances below 0.01: on parts with booleans 0.1 already took "
    "minutes",
    "Open CASCADE and gmsh on several threads: CPU time is compared, not wall time",
    "time to import cadquery or gmsh, to build the B-rep, to read STEP, and to read the meshes out",
    "gmsh has no tolerance; elements per turn of curvature replace it; its other algorithms were "
    "not tried",
    "parts with booleans: the second table gives their cost for our mesh kernel only",
    "distances are measured from facets to the surface; a missing piece of surface shows in the "
    "volume only",
    "meshes of more than 50 000 triangles are measured on a random sample of facets, which "
    "favours their mesher",
)


@dataclass(frozen=True)
class MeshResult:
    """Errors and CPU time of one mesh."""

    mesher: str
    setting: str
    triangles: int
    deviation_mm: float
    volume_error: float
    cpu_s: float


def exact_volume(body: ConicBody) -> float:
    """Compute the volume [mm3]: section area times the integral of the
    squared scale (Gauss quadrature in the tip).
    """
    total = sum(
        (z1 - z0) * (a * a + a * b + b * b) / 3
        for (z0, a), (z1, b) in zip(body.stations, body.stations[1:], strict=False)
    )
    nodes, weights = np.polynomial.legendre.leggauss(60)
    step = 1e-5

    for node, weight in zip((nodes + 1) / 2, weights / 2, strict=True):
        slope = (body.tip_point(node + step)[0] - body.tip_point(node - step)[0]) / (2 * step)
        total += weight * body.tip_point(node)[1] ** 2 * slope

    return body.section.area() * total


def median_cpu_time(make: Callable[[], object]) -> float:
    """Return the median CPU time [s] of a few runs, or of many if they are short."""
    times: list[float] = []
    while len(times) < 3 or (sum(times) < 0.3 and len(times) < 60):
        start = time.process_time()
        make()
        times.append(time.process_time() - start)
        if times[0] > 1.0:
            break

    return statistics.median(times)


def measure_mesh(
    body: ConicBody,
    mesher: str,
    setting: str,
    mesh: Mesh,
    cpu_s: float,
) -> MeshResult:
    """Measure the errors of a mesh; on large meshes at fewer
    points per facet, and then on fewer facets.
    """
    corners = mesh.vertices[mesh.triangles]
    k = 4 if 15 * len(corners) <= MAX_POINTS else 2
    weights = (
        np.array([(i, j, k - i - j) for i in range(k + 1) for j in range(k + 1 - i)], dtype=float)
        / k
    )
    maximum = MAX_POINTS // len(weights)
    if len(corners) > maximum:
        corners = corners[np.random.default_rng(0).choice(len(corners), maximum, replace=False)]

    points = np.einsum("kc,fcx->fkx", weights, corners).reshape(-1, 3)
    deviation = float(
        np.concatenate(
            [distance_to_surface(body, part) for part in np.array_split(points, 8)]
        ).max()
    )
    error = abs(mesh.volume() / exact_volume(body) - 1)
    return MeshResult(
        mesher=mesher,
        setting=setting,
        triangles=len(mesh.triangles),
        deviation_mm=deviation,
        volume_error=error,
        cpu_s=cpu_s,
    )


def structured_grid(body: ConicBody) -> Iterator[MeshResult]:
    """Mesh with the structured grid of `cad.kernel.tessellate`."""
    for tolerance in TOLERANCES_MM:
        mesh = Mesh(*tessellate(SuperconicSolid(body), tolerance))
        yield measure_mesh(
            body,
            mesher=GRID,
            setting=f"{tolerance:g} mm",
            mesh=mesh,
            cpu_s=median_cpu_time(lambda at=tolerance: tessellate(SuperconicSolid(body), at)),
        )


def open_cascade(body: ConicBody) -> Iterator[MeshResult]:
    """Mesh with Open CASCADE's incremental mesher, on the B-rep solid of `cad.kernel.brep`."""
    import cadquery as cq
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.BRepTools import BRepTools

    from fingertip.cad.kernel import brep

    shape = brep.BrepEvaluator().shape(SuperconicSolid(body))

    def run(linear: float, angular: float) -> None:
        BRepTools.Clean_s(shape)  # otherwise the mesher reuses a finer mesh of a previous run
        BRepMesh_IncrementalMesh(shape, linear, False, angular, False)

    for mesher, tolerances in OCC.items():
        for linear, angular in tolerances:
            cpu = median_cpu_time(lambda at=linear, turn=angular: run(at, turn))
            vertices, triangles = cq.Shape.cast(shape).tessellate(linear, angular)
            mesh = Mesh(np.array([v.toTuple() for v in vertices]), np.array(triangles))
            yield measure_mesh(
                body,
                mesher=mesher,
                setting=f"{linear:g} mm, {angular:g}",
                mesh=mesh,
                cpu_s=cpu,
            )
            if cpu > MAX_MESHING_S:
                break


def gmsh_surface_mesher(body: ConicBody) -> Iterator[MeshResult]:
    """Mesh with gmsh's default surface mesher, on the STEP file."""
    import cadquery as cq
    import gmsh

    from fingertip.cad.kernel import brep

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)

    with tempfile.TemporaryDirectory() as folder:
        step = str(Path(folder) / "outer.step")
        cq.exporters.export(
            cq.Workplane(cq.Shape.cast(brep.BrepEvaluator().shape(SuperconicSolid(body)))), step
        )
        gmsh.model.occ.importShapes(step)

    gmsh.model.occ.synchronize()

    def run() -> None:
        gmsh.model.mesh.clear()
        gmsh.model.mesh.generate(2)

    for count in GMSH_PER_TURN:
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", count)
        cpu = median_cpu_time(run)
        tags, xyz, _ = gmsh.model.mesh.getNodes()
        row_of = np.zeros(int(tags.max()) + 1, dtype=np.int64)
        row_of[tags] = np.arange(len(tags))
        triangles = row_of[gmsh.model.mesh.getElementsByType(2)[1].astype(np.int64)].reshape(-1, 3)
        mesh = Mesh(np.array(xyz).reshape(-1, 3), triangles)
        yield measure_mesh(
            body,
            mesher="gmsh",
            setting=f"{count} per turn",
            mesh=mesh,
            cpu_s=cpu,
        )
        if cpu > MAX_MESHING_S:
            break

    gmsh.finalize()


def interpolate_time(rows: list[MeshResult], measure: str, error: float) -> float | None:
    """Interpolate the CPU time [s] at an error between meshes, in
    logarithms; None outside the measured range.
    """
    known = sorted((math.log(getattr(r, measure)), math.log(r.cpu_s)) for r in rows)
    x = math.log(error)
    if not known[0][0] <= x <= known[-1][0]:
        return None

    return math.exp(float(np.interp(x, *zip(*known, strict=True))))


def convergence_order(rows: list[MeshResult], errors: NDArray[np.float64]) -> float:
    """Fit the order of convergence: slope of the error against the chord length, in logarithms.

    The chord length falls with the root of the number of triangles.
    """
    chords = -0.5 * np.log([r.triangles for r in rows])
    return float(np.polyfit(chords, np.log(errors), 1)[0])


def print_tables(rows: list[MeshResult]) -> None:
    print(
        f"{'mesher':20}{'requested':>15}{'triangles':>11}{'deviation mm':>14}"
        f"{'volume error':>14}{'CPU s':>10}"
    )
    for r in rows:
        print(
            f"{r.mesher:20}{r.setting:>15}{r.triangles:11}{r.deviation_mm:14.2e}{r.volume_error:14.2e}{r.cpu_s:10.4f}"
        )

    meshers = {
        mesher: [r for r in rows if r.mesher == mesher]
        for mesher in dict.fromkeys(r.mesher for r in rows)
    }
    for measure, marks in MARKS.items():
        print(
            f"\nCPU time relative to the structured grid at equal {measure} (interpolated; - "
            "where not measured)"
        )
        print(f"{'':20}" + "".join(f"{mark:>10g}" for mark in marks))
        for mesher, its in meshers.items():
            if mesher != GRID:
                pairs = [
                    (
                        interpolate_time(its, measure, mark),
                        interpolate_time(meshers[GRID], measure, mark),
                    )
                    for mark in marks
                ]
                print(
                    f"{mesher:20}"
                    + "".join(f"{a / b:9.0f}x" if a and b else f"{'-':>10}" for a, b in pairs)
                )

    print("\nOrder of convergence in the chord length (2 expected)")
    for mesher, its in meshers.items():
        if len(its) >= 3:
            fitted = [
                convergence_order(its, np.array(e))
                for e in ([r.deviation_mm for r in its], [r.volume_error for r in its])
            ]
            print(f"{mesher:20} deviation {fitted[0]:5.2f}   volume {fitted[1]:5.2f}")


def draw(rows: list[MeshResult], path: Path) -> None:
    """Draw a work-precision diagram: deviation and volume error over CPU time."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(12, 5.2), sharex=True, layout="constrained")

    for mesher in dict.fromkeys(r.mesher for r in rows):
        its = [r for r in rows if r.mesher == mesher]
        style = (
            {"linewidth": 2.6, "marker": "o", "color": "black"}
            if mesher == GRID
            else {"marker": "s", "markersize": 4}
        )
        axes[0].loglog([r.cpu_s for r in its], [r.deviation_mm for r in its], label=mesher, **style)
        axes[1].loglog([r.cpu_s for r in its], [r.volume_error for r in its], label=mesher, **style)

    axes[0].set_ylabel("largest deviation from the exact surface [mm]")
    axes[1].set_ylabel("relative volume error")
    axes[0].axhspan(0.001, 0.1, color="0.93", zorder=0)
    axes[0].text(
        0.98,
        0.098,
        "0.1 to 0.001 mm",
        ha="right",
        va="top",
        transform=axes[0].get_yaxis_transform(),
    )

    for axis in axes:
        axis.set_xlabel("CPU time of meshing [s]")
        axis.grid(True, which="major", color="0.85")

    # One legend for both; in the left diagram it would cover data.
    axes[1].legend(loc="upper right")
    figure.suptitle(
        "Meshing the outer surface of the FSR 400 fingertip (lower and further left is better)"
    )
    figure.savefig(path, dpi=110, metadata={"Software": None})


def process_times(*command: str) -> tuple[float, float]:
    """Measure wall and CPU time [s] of a Python process and its children."""
    before = os.times()
    start = time.perf_counter()
    subprocess.run(
        [sys.executable, *command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    wall = time.perf_counter() - start
    after = os.times()

    return (
        wall,
        after.children_user - before.children_user + after.children_system - before.children_system,
    )


def print_design_costs(design: Design) -> None:
    """Print the cost of all parts with all checks, and of all files
    with STEP against importing cadquery alone.
    """
    from fingertip.cad.kernel.mesh import MeshEvaluator
    from fingertip.cad.verification.verify import verify
    from fingertip.models.parts import parts_by_name

    cpu = median_cpu_time(
        lambda: verify(design, parts_by_name(design), ("stl",), MeshEvaluator(0.01))
    )
    print(f"\nall parts with all mesh checks at 0.01 mm: {cpu:.2f} s CPU, warm (goal 0.5 s)")

    with tempfile.TemporaryDirectory() as folder:
        cold = [process_times("-m", "fingertip", "check", str(DESIGN), "-q") for _ in range(3)]
        print("`fingertip check`, cold: {:.2f} s wall, {:.2f} s CPU".format(*min(cold)))
        build = ("-m", "fingertip", "build", str(DESIGN), "--out", folder, "-q")
        stl = [process_times(*build, "--formats", "stl") for _ in range(3)]
        print(
            "`fingertip build --formats stl`, cold: {:.2f} s wall, "
            "{:.2f} s CPU (goal 0.8 s)".format(*min(stl))
        )
        process_times("-c", "import cadquery")  # one run, not counted, fills the disk cache
        pairs = [(process_times("-c", "import cadquery"), process_times(*build)) for _ in range(3)]

    walls = statistics.median(full[0] / alone[0] for alone, full in pairs)
    cpus = statistics.median(full[1] / alone[1] for alone, full in pairs)
    alone, full = pairs[-1]
    print(f"import cadquery: {alone[0]:.2f} s wall, {alone[1]:.2f} s CPU")
    print(
        f"all files with STEP: {full[0]:.2f} s wall, {full[1]:.2f} s CPU: {walls:.2f}x wall, "
        f"{cpus:.2f}x CPU (goal 2x)"
    )


def main() -> None:
    picture = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out") / "meshing.png"
    load, design = os.getloadavg()[0], Design.load(DESIGN)
    body = design.dimensions.outer
    print(
        f"{platform.machine()}, {os.cpu_count()} cores, load {load:.1f}, Python "
        f"{platform.python_version()}"
    )
    rows = [*structured_grid(body), *open_cascade(body)]
    not_covered = list(NOT_COVERED)

    if importlib.util.find_spec("gmsh"):
        rows += gmsh_surface_mesher(body)
    else:
        not_covered.append("gmsh: not installed (pip install gmsh)")

    print_tables(rows)
    print_design_costs(design)
    picture.parent.mkdir(parents=True, exist_ok=True)
    draw(rows, picture)
    print("\nnot covered:", *not_covered, sep="\n- ")
    print(f"\ndrawn to {picture}; load at the end {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
