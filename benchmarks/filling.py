"""Error against run time of the filling prediction, beside the textbook's flow analysis network.

    python benchmarks/filling.py [picture.png]

Both solvers compute the same moving front on the same networks. The flow analysis network (Z. Tadmor and C. G. Gogos,
Principles of Polymer Processing, 2nd ed., section 13.2) solves the pressure of the full nodes with p = 0 in all others,
moves silicone until the next node is full, and repeats: one sparse solve (scipy) for each node. Errors are those
against the obstacle solution on a grid four times as fine in each direction: of the integral of the cavity's
resistance, of the arrival volume (mean over the cavity's volume, relative to the whole), and of the last point.
"""

from __future__ import annotations

import math
import os
import platform
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy is imported: CPU time is compared

import numpy as np

from fingertip.design import Design
from fingertip.filling.ducts_and_mouths import Mouth, mouth_resistance, open_mouth
from fingertip.filling.hele_shaw import fill
from fingertip.filling.network import FlowNetwork
from fingertip.filling.predict import refine_peak
from fingertip.filling.surface_links import COLUMNS, ROWS, Layer, build_skin_grid
from fingertip.foundation.numerics import Array

PARAMS = Path(__file__).resolve().parent.parent / "params"
DESIGNS = ("fsr400", "adult_finger", "fsr402")
GATES_Z_MM = (1.5, 10.0)
GATE_DIAMETER_MM = 2.74
GRIDS = ((20, 24), (28, 32), (ROWS, COLUMNS), (60, 72))
LEVELS = (6, 12, 24)
PEER_GRIDS = ((20, 24), (28, 32), (ROWS, COLUMNS))
OURS, PEER = "obstacle problem", "flow analysis network"
NOT_COVERED = (
    "the thin-gap model itself: both solvers and the reference share it",
    "trapped air that pushes back, gravity, curing, and viscosity that falls with shear",
    "commercial solvers (Moldflow, Moldex3D), which are not available here",
    "the peer could reuse factorisations from step to step; the textbook's does not",
)


@dataclass(frozen=True)
class Run:
    """Errors and CPU time of one solver on one grid of one case."""

    solver: str
    setting: str
    integral: float
    """Relative error of the resistance integral."""
    arrival: float
    """Mean error of the arrival volume, relative to the whole."""
    last_mm: float
    cpu_s: float


@dataclass(frozen=True, eq=False)
class Solution:
    """Solution of one case."""

    layer: Layer
    integral: float
    arrival: Array
    """Relative to the whole volume."""
    last_mm: tuple[float, float, float]


def solve_ours(layer: Layer, mouth: Mouth, levels: int) -> tuple[float, Array]:
    filling = fill(layer.network, mouth.shares(len(layer.points_mm)), levels)
    return float(filling.gate @ filling.fronts[-1].potential), filling.arrival_mm3


def solve_peer(network: FlowNetwork, gate: Array) -> tuple[float, Array]:
    """Fill node after node; a node's arrival is the volume at which it is half full."""
    from scipy.sparse import csr_matrix
    from scipy.sparse.linalg import spsolve

    a, b, k = network.links
    count = len(network.volume_mm3)
    diagonal = np.bincount(a, k, count) + np.bincount(b, k, count)
    number = np.arange(count)
    matrix = csr_matrix(
        (np.concatenate((diagonal, -k, -k)), (np.concatenate((number, a, b)), np.concatenate((number, b, a)))),
        (count, count),
    )
    held, injected, integral = np.zeros(count), 0.0, 0.0
    arrival = np.full(count, np.nan)
    is_full = np.zeros(count, dtype=bool)
    for _ in range(count):
        pressure = np.zeros(count)
        full = np.flatnonzero(is_full)
        if len(full):
            pressure[full] = spsolve(matrix[full][:, full].tocsc(), gate[full])
        inflow = np.where(is_full, 0.0, gate - matrix @ pressure)
        inflow[inflow < 1e-12] = 0.0
        room = np.where(inflow > 0.0, (network.volume_mm3 - held) / np.maximum(inflow, 1e-300), np.inf)
        step = float(room.min())
        halfway = (held < 0.5 * network.volume_mm3) & (held + step * inflow >= 0.5 * network.volume_mm3)
        arrival[halfway] = injected + (0.5 * network.volume_mm3 - held)[halfway] / inflow[halfway]
        held += step * inflow
        integral += step * float(gate @ pressure)
        injected += step
        is_full |= room <= step * (1.0 + 1e-9)
        if is_full.all():
            break
    return integral, arrival


def describe(layer: Layer, mouth: Mouth, integral: float, arrival: Array) -> Solution:
    """Add the mouth's own resistance, which no grid resolves."""
    total = layer.network.total_mm3
    integral += mouth_resistance(layer, mouth, GATE_DIAMETER_MM) * total
    return Solution(layer, integral, arrival / total, refine_peak(layer, arrival, int(np.argmax(arrival))))


def measure(solver: str, setting: str, found: Solution, reference: Solution, cpu_s: float) -> Run:
    exact = interpolate(reference, found.layer.points_mm)
    share = found.layer.network.volume_mm3 / found.layer.network.total_mm3
    return Run(
        solver, setting, abs(found.integral / reference.integral - 1.0),
        float(np.abs(found.arrival - exact) @ share), math.dist(found.last_mm, reference.last_mm),
        cpu_s,
    )  # fmt: skip


def interpolate(reference: Solution, points: Array) -> Array:
    """Interpolate a fine solution at points, from the four nearest nodes with the inverse square of their distance."""
    values = []
    for point in points:
        squared = ((reference.layer.points_mm - point) ** 2).sum(axis=1)
        nearest = np.argpartition(squared, 4)[:4]
        weights = 1.0 / (squared[nearest] + 1e-6)
        values.append(float(weights @ reference.arrival[nearest] / weights.sum()))
    return np.array(values)


def timed(make: Callable[[], tuple[float, Array]], repeats: int) -> tuple[tuple[float, Array], float]:
    """Return the result, and the median CPU time [s]."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        result = make()
        times.append(time.process_time() - start)
    return result, statistics.median(times)


def run_case(design: Design, z_mm: float) -> list[Run]:
    dims = design.dimensions
    scale = dims.shrinkage * dims.outer.scale_at(z_mm / dims.shrinkage)
    point = (dims.outer.section.half_width * scale, 0.0, z_mm)

    def build(rows: int, columns: int) -> tuple[Layer, Mouth]:
        layer = build_skin_grid(design, rows, columns).layer
        return layer, open_mouth(layer, point, GATE_DIAMETER_MM)

    layer, mouth = build(4 * ROWS, 4 * COLUMNS)
    reference = describe(layer, mouth, *solve_ours(layer, mouth, 16))
    runs = []
    settings = [(rows, columns, 12) for rows, columns in GRIDS]
    settings += [(ROWS, COLUMNS, levels) for levels in LEVELS if levels != 12]
    for rows, columns, levels in settings:
        start = time.process_time()
        layer, mouth = build(rows, columns)
        built_s = time.process_time() - start
        result, cpu_s = timed(lambda at=layer, by=mouth, n=levels: solve_ours(at, by, n), 3)
        name = f"{rows} x {columns}, {levels} volumes"
        runs.append(measure(OURS, name, describe(layer, mouth, *result), reference, built_s + cpu_s))
    for rows, columns in PEER_GRIDS:
        start = time.process_time()
        layer, mouth = build(rows, columns)
        built_s = time.process_time() - start
        gate = mouth.shares(len(layer.points_mm))
        result, cpu_s = timed(lambda at=layer, by=gate: solve_peer(at.network, by), 1)
        name = f"{rows} x {columns}"
        runs.append(measure(PEER, name, describe(layer, mouth, *result), reference, built_s + cpu_s))
    return runs


def spread(values: list[float], unit: float = 1.0) -> str:
    """Median, 90th percentile and worst."""
    median, p90, worst = (float(np.quantile(values, q)) * unit for q in (0.5, 0.9, 1.0))
    return f"{median:8.3f}{p90:8.3f}{worst:8.3f}"


def print_tables(runs: list[Run]) -> None:
    head = f"{'median':>8}{'p90':>8}{'worst':>8}"
    print(f"\n{'':46}{'integral of R [%]':>24}{'mean arrival [%]':>24}{'last point [mm]':>24}{'CPU [s]':>24}")
    print(f"{'solver':24}{'grid':22}" + 4 * head)
    keys = dict.fromkeys((run.solver, run.setting) for run in runs)
    groups = {key: [run for run in runs if (run.solver, run.setting) == key] for key in keys}
    for (solver, setting), its in groups.items():
        print(
            f"{solver:24}{setting:22}" + spread([r.integral for r in its], 100) + spread([r.arrival for r in its], 100)
            + spread([r.last_mm for r in its]) + spread([r.cpu_s for r in its])
        )  # fmt: skip
    print(f"\n{PEER} / {OURS} on the same grid: CPU time, and mean error of the arrival")
    print(f"{'grid':22}{head}{head}")
    for rows, columns in PEER_GRIDS:
        peer, ours = groups[PEER, f"{rows} x {columns}"], groups[OURS, f"{rows} x {columns}, 12 volumes"]
        pairs = list(zip(peer, ours, strict=True))
        print(
            f"{f'{rows} x {columns}':22}" + spread([p.cpu_s / o.cpu_s for p, o in pairs])
            + spread([p.arrival / o.arrival for p, o in pairs])
        )  # fmt: skip


def draw(runs: list[Run], path: Path) -> None:
    """Draw a work-precision diagram: mean error of the arrival over CPU time."""
    from fingertip.foundation.plot_style import BLUE, ORANGE, new_figure, style_axes, to_png

    figure = new_figure(8.0, 5.0)
    axes = figure.subplots()
    for solver, colour in ((OURS, BLUE), (PEER, ORANGE)):
        its = [run for run in runs if run.solver == solver]
        axes.loglog([r.cpu_s for r in its], [100 * r.arrival for r in its], "o", color=colour, label=solver)
    axes.set_xlabel("CPU time with the grid [s]")
    axes.set_ylabel("mean error of the arrival volume [%]")
    axes.set_title("Filling of three skins from two gates each (lower and further left is better)")
    axes.legend()
    style_axes(axes, "both")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(to_png(figure))


def main() -> None:
    picture = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out") / "filling.png"
    load, runs = os.getloadavg()[0], []
    print(f"{platform.machine()}, {os.cpu_count()} cores, load {load:.1f}, Python {platform.python_version()}")
    for name in DESIGNS:
        design = Design.load(PARAMS / f"{name}.toml")
        for z_mm in GATES_Z_MM:
            found = run_case(design, z_mm)
            runs += found
            ours = next(run for run in found if run.setting == f"{ROWS} x {COLUMNS}, 12 volumes")
            print(
                f"{name}, gate at z = {z_mm:g} mm: integral {100 * ours.integral:.2f} %, arrival "
                f"{100 * ours.arrival:.2f} %, last point {ours.last_mm:.2f} mm, {ours.cpu_s:.3f} s",
                flush=True,
            )
    print_tables(runs)
    draw(runs, picture)
    print("\nnot covered:", *NOT_COVERED, sep="\n- ")
    print(f"\ndrawn to {picture}; load at the end {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
