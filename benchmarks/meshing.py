"""Error against run time for every way of meshing the skin's outer form, and what all checks of a design cost.

    python benchmarks/meshing.py [picture.png]

Ways: the structured grid of `cad.kernel.tessellate`; Open CASCADE's mesher at several linear and angular tolerances;
gmsh, if it is installed, on the STEP file, at several counts of elements per turn. Each is measured by what it made,
not by what it was asked for: the farthest point of any facet from the exact surface (`cad.verification.deviation`), and
the volume against the closed form. Only the meshing itself is timed, in CPU seconds of this process, one thread each;
reading a mesh out of Open CASCADE or gmsh is not counted against them.
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
from fingertip.cad.solids import SuperconicSolid
from fingertip.cad.verification.deviation import distance
from fingertip.design import Design
from fingertip.design.geometry.conic import ConicBody

DESIGN = Path(__file__).resolve().parent.parent / "params" / "fsr400.toml"
TOLERANCES_MM = (0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001)
OCC = {
    "OCC by tolerance": [(linear, 0.5) for linear in (0.1, 0.03, 0.01, 0.003, 0.001, 0.0005, 0.0002)],
    "OCC by both": [(linear, 0.2) for linear in (0.1, 0.03, 0.01, 0.003)],
    "OCC by angle": [(1.0, angular) for angular in (0.2, 0.1, 0.05, 0.03, 0.02, 0.01)],
}
"""Linear [mm] and angular [rad] tolerance: one of them steers, or both."""
GMSH_PER_TURN = (12, 24, 48, 96, 192, 384)
ENOUGH_S = 8.0  # a way is not refined further once a mesh of it takes longer than this
MAX_POINTS = 300_000  # of the facets, measured against the surface
OURS = "our grid"
MARKS = {"deviation_mm": (0.1, 0.05, 0.03, 0.01, 0.003, 0.001), "volume_error": (5e-3, 2e-3, 1e-3, 5e-4, 1e-4)}
OMITTED = (
    "angular tolerance below 0.01 with Open CASCADE: on parts with booleans it ran for minutes already at 0.1",
    "Open CASCADE and gmsh with several threads: CPU time, not wall time, is compared",
    "the time to import cadquery or gmsh, to build the B-rep, to read STEP, and to read the meshes out",
    "gmsh takes no tolerance: elements per turn of curvature stand in for it; its other algorithms were not tried",
    "parts with booleans: their cost is in the second table, for our kernel alone",
    "distances are from facets to the surface; that no place is left out shows in the volume only",
    "above 50 000 triangles a random part of the facets is measured, which favours the way that made them",
)


@dataclass(frozen=True)
class Row:
    """One mesh."""

    way: str
    setting: str
    triangles: int
    deviation_mm: float
    volume_error: float
    cpu_s: float


def exact_volume(body: ConicBody) -> float:
    """Closed form [mm3]: area of the section times the integral of the squared scale (Gauss on the tip's conic)."""
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


def timed(make: Callable[[], object]) -> float:
    """Median CPU time [s] of a few runs, of many if they are short."""
    times: list[float] = []
    while len(times) < 3 or (sum(times) < 0.3 and len(times) < 60):
        start = time.process_time()
        make()
        times.append(time.process_time() - start)
        if times[0] > 1.0:
            break
    return statistics.median(times)


def judged(body: ConicBody, way: str, setting: str, mesh: Mesh, cpu_s: float) -> Row:
    """A mesh with its errors; on big meshes fewer points of each facet, then fewer facets, are measured."""
    corners = mesh.vertices[mesh.triangles]
    k = 4 if 15 * len(corners) <= MAX_POINTS else 2
    weights = np.array([(i, j, k - i - j) for i in range(k + 1) for j in range(k + 1 - i)], dtype=float) / k
    maximum = MAX_POINTS // len(weights)
    if len(corners) > maximum:
        corners = corners[np.random.default_rng(0).choice(len(corners), maximum, replace=False)]
    points = np.einsum("kc,fcx->fkx", weights, corners).reshape(-1, 3)
    deviation = float(np.concatenate([distance(body, part) for part in np.array_split(points, 8)]).max())
    error = abs(mesh.volume() / exact_volume(body) - 1)
    return Row(way, setting, len(mesh.triangles), deviation, error, cpu_s)


def ours(body: ConicBody) -> Iterator[Row]:
    """The structured grid."""
    for tolerance in TOLERANCES_MM:
        mesh = Mesh(*tessellate(SuperconicSolid(body), tolerance))
        yield judged(body, OURS, f"{tolerance:g} mm", mesh, timed(lambda at=tolerance: tessellate(SuperconicSolid(body), at)))


def open_cascade(body: ConicBody) -> Iterator[Row]:
    """Open CASCADE's incremental mesher on the B-rep that `cad.kernel.brep` makes."""
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.BRepTools import BRepTools

    from fingertip.cad.kernel import brep

    shape = brep.BrepEvaluator().shape(SuperconicSolid(body))

    def run(linear: float, angular: float) -> None:
        BRepTools.Clean_s(shape.wrapped)  # or it takes over a finer mesh that is there already
        BRepMesh_IncrementalMesh(shape.wrapped, linear, False, angular, False)

    for way, tolerances in OCC.items():
        for linear, angular in tolerances:
            cpu = timed(lambda at=linear, turn=angular: run(at, turn))
            vertices, triangles = shape.tessellate(linear, angular)
            mesh = Mesh(np.array([v.toTuple() for v in vertices]), np.array(triangles))
            yield judged(body, way, f"{linear:g} mm, {angular:g}", mesh, cpu)
            if cpu > ENOUGH_S:
                break


def gmsh_rows(body: ConicBody) -> Iterator[Row]:
    """gmsh's default mesher for surfaces, on the STEP file."""
    import cadquery as cq
    import gmsh

    from fingertip.cad.kernel import brep

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)
    with tempfile.TemporaryDirectory() as folder:
        step = str(Path(folder) / "outer.step")
        cq.exporters.export(cq.Workplane(brep.BrepEvaluator().shape(SuperconicSolid(body))), step)
        gmsh.model.occ.importShapes(step)
    gmsh.model.occ.synchronize()

    def run() -> None:
        gmsh.model.mesh.clear()
        gmsh.model.mesh.generate(2)

    for count in GMSH_PER_TURN:
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", count)
        cpu = timed(run)
        tags, xyz, _ = gmsh.model.mesh.getNodes()
        row_of = np.zeros(int(tags.max()) + 1, dtype=np.int64)
        row_of[tags] = np.arange(len(tags))
        triangles = row_of[gmsh.model.mesh.getElementsByType(2)[1].astype(np.int64)].reshape(-1, 3)
        mesh = Mesh(np.array(xyz).reshape(-1, 3), triangles)
        yield judged(body, "gmsh", f"{count} a turn", mesh, cpu)
        if cpu > ENOUGH_S:
            break
    gmsh.finalize()


def time_at(rows: list[Row], measure: str, error: float) -> float | None:
    """CPU time [s] at an error, between two meshes in logarithms; None outside what was measured."""
    known = sorted((math.log(getattr(r, measure)), math.log(r.cpu_s)) for r in rows)
    x = math.log(error)
    if not known[0][0] <= x <= known[-1][0]:
        return None
    return math.exp(float(np.interp(x, *zip(*known, strict=True))))


def order(rows: list[Row], errors: NDArray[np.float64]) -> float:
    """Slope of an error against the chord length, which falls with the root of the number of triangles."""
    chords = -0.5 * np.log([r.triangles for r in rows])
    return float(np.polyfit(chords, np.log(errors), 1)[0])


def print_tables(rows: list[Row]) -> None:
    print(f"{'way':20}{'asked for':>15}{'triangles':>11}{'deviation mm':>14}{'volume error':>14}{'CPU s':>10}")
    for r in rows:
        print(f"{r.way:20}{r.setting:>15}{r.triangles:11}{r.deviation_mm:14.2e}{r.volume_error:14.2e}{r.cpu_s:10.4f}")
    ways = {way: [r for r in rows if r.way == way] for way in dict.fromkeys(r.way for r in rows)}
    for measure, marks in MARKS.items():
        print(f"\nCPU time against our grid's at equal {measure} (interpolated; - where not measured)")
        print(f"{'':20}" + "".join(f"{mark:>10g}" for mark in marks))
        for way, its in ways.items():
            if way != OURS:
                pairs = [(time_at(its, measure, mark), time_at(ways[OURS], measure, mark)) for mark in marks]
                print(f"{way:20}" + "".join(f"{a / b:9.0f}x" if a and b else f"{'-':>10}" for a, b in pairs))
    print("\nOrder of convergence in the chord length (2 expected)")
    for way, its in ways.items():
        if len(its) >= 3:
            fitted = [order(its, np.array(e)) for e in ([r.deviation_mm for r in its], [r.volume_error for r in its])]
            print(f"{way:20} deviation {fitted[0]:5.2f}   volume {fitted[1]:5.2f}")


def draw(rows: list[Row], path: Path) -> None:
    """Work-precision picture: deviation and volume error over CPU time."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(12, 5.2), sharex=True, layout="constrained")
    for way in dict.fromkeys(r.way for r in rows):
        its = [r for r in rows if r.way == way]
        style = {"linewidth": 2.6, "marker": "o", "color": "black"} if way == OURS else {"marker": "s", "markersize": 4}
        axes[0].loglog([r.cpu_s for r in its], [r.deviation_mm for r in its], label=way, **style)
        axes[1].loglog([r.cpu_s for r in its], [r.volume_error for r in its], label=way, **style)
    axes[0].set_ylabel("farthest facet point from the exact surface [mm]")
    axes[1].set_ylabel("relative error of the volume")
    axes[0].axhspan(0.001, 0.1, color="0.93", zorder=0)
    axes[0].text(0.98, 0.098, "0.1 to 0.001 mm", ha="right", va="top", transform=axes[0].get_yaxis_transform())
    for axis in axes:
        axis.set_xlabel("CPU time of meshing [s]")
        axis.grid(True, which="major", color="0.85")
    axes[1].legend(loc="upper right")  # for both: in the left picture it would hide a mesh
    figure.suptitle("Meshing the outer form of the FSR 400 fingertip: lower and further left is better")
    figure.savefig(path, dpi=110, metadata={"Software": None})


def cpu_of(*command: str) -> tuple[float, float]:
    """Wall and CPU time [s] of a process and its children."""
    before, start = os.times(), time.perf_counter()
    subprocess.run([sys.executable, *command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    wall, after = time.perf_counter() - start, os.times()
    return wall, after.children_user - before.children_user + after.children_system - before.children_system


def whole_designs(design: Design) -> None:
    """What all parts with all their checks cost, and all files with STEP against importing cadquery alone."""
    from fingertip.cad.kernel.mesh import MeshEvaluator
    from fingertip.cad.shapes.parts import parts_by_name
    from fingertip.cad.verification.verify import verify

    cpu = timed(lambda: verify(design, parts_by_name(design), ("stl",), MeshEvaluator(0.01)))
    print(f"\nall parts with all mesh checks at 0.01 mm: {cpu:.2f} s CPU, warm (goal 0.5 s)")
    with tempfile.TemporaryDirectory() as folder:
        cold = [cpu_of("-m", "fingertip", "check", str(DESIGN), "-q") for _ in range(3)]
        print("`fingertip check`, cold: {:.2f} s wall, {:.2f} s CPU".format(*min(cold)))
        build = ("-m", "fingertip", "build", str(DESIGN), "--out", folder, "-q")
        stl = [cpu_of(*build, "--formats", "stl") for _ in range(3)]
        print("`fingertip build --formats stl`, cold: {:.2f} s wall, {:.2f} s CPU (goal 0.8 s)".format(*min(stl)))
        cpu_of("-c", "import cadquery")  # once, uncounted: disk cache
        pairs = [(cpu_of("-c", "import cadquery"), cpu_of(*build)) for _ in range(3)]
    walls = statistics.median(full[0] / alone[0] for alone, full in pairs)
    cpus = statistics.median(full[1] / alone[1] for alone, full in pairs)
    alone, full = pairs[-1]
    print(f"import cadquery: {alone[0]:.2f} s wall, {alone[1]:.2f} s CPU")
    print(
        f"all files with STEP: {full[0]:.2f} s wall, {full[1]:.2f} s CPU: {walls:.2f}x wall, {cpus:.2f}x CPU (goal 2x)"
    )


def main() -> None:
    picture = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out") / "meshing.png"
    load, design = os.getloadavg()[0], Design.load(DESIGN)
    body = design.dimensions.outer
    print(f"{platform.machine()}, {os.cpu_count()} cores, load {load:.1f}, Python {platform.python_version()}")
    rows = [*ours(body), *open_cascade(body)]
    omitted = list(OMITTED)
    if importlib.util.find_spec("gmsh"):
        rows += gmsh_rows(body)
    else:
        omitted.append("gmsh: not installed (pip install gmsh)")
    print_tables(rows)
    whole_designs(design)
    picture.parent.mkdir(parents=True, exist_ok=True)
    draw(rows, picture)
    print("\nleft out:", *omitted, sep="\n- ")
    print(f"\ndrawn to {picture}; load at the end {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
