"""Filling, parts, mechanics of the pad and play of the bone."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from benchmarks.extremes.draw import Draw
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.parts import parts_by_name
from fingertip.cad.verification.verify import verify
from fingertip.design import Design
from fingertip.design.files import list_parameters
from fingertip.design.new_design import PRESETS
from fingertip.filling.hele_shaw import fill
from fingertip.filling.network import FlowNetwork
from fingertip.foundation.errors import DesignError
from fingertip.foundation.numerics import maximise_linear
from fingertip.pad.form import PadForm
from fingertip.pad.layer import find_contacts
from fingertip.pad.pose import ObjectShape, Pose
from fingertip.pad.response import Backing, Pad


def filling(draw: Draw) -> float:
    """Bound 1e-6: mass of every front; pressure of a row of cells, which is known, where all columns are alike."""
    rows, columns = draw.rng.randint(3, 24), draw.rng.randint(3, 16)
    contrast = draw.log("contrast of thickness", (1.0, 6.0), (1.0, 100.0))
    is_row = draw.choose("columns alike", (True, False))
    nodes = rows * columns

    def thickness(count: int, width: int) -> np.ndarray:
        drawn = [contrast ** draw.rng.random() for _ in range(count * (1 if is_row else width))]
        return np.broadcast_to(np.reshape(drawn, (count, -1)), (count, width))

    volume = np.append(thickness(rows, columns).ravel(), 0.0)
    along, none = thickness(rows - 1, columns) ** 3 / 12, np.zeros((rows - 1, columns))
    network = FlowNetwork(volume, along, thickness(rows, columns) ** 3 / 12, none, none, np.zeros(columns))
    gate = np.zeros(nodes + 1)
    gate[:columns] = 1 / columns
    found = fill(network, gate)
    total = network.total_mm3
    errors = [abs(front.filled @ volume - front.injected_mm3) / total for front in found.fronts]
    errors += [float(np.abs(np.clip(front.filled, 0.0, 1.0) - front.filled).max()) for front in found.fronts]
    arrival = found.arrival_mm3[:-1]
    errors.append(0.0 if (arrival >= 0.0).all() and (arrival <= total * (1 + 1e-9)).all() else math.inf)
    if is_row:
        beyond = total - np.cumsum(volume[:-1].reshape(rows, columns).sum(axis=1))[:-1]
        exact = float((beyond / along.sum(axis=1)).sum())
        errors.append(abs(found.gate @ found.fronts[-1].potential / exact - 1.0))
    return float(max(errors)) / 1e-6


_TABLES = ("sensor.", "bone.", "hand.", "skin.", "mold.")
_NOT_GEOMETRY = ("excess", "fill_time", "syringe_force", "syringe_volume", "leak_length", "anchor_pin_stress")
"""Checks that a printer, a syringe or a load decides, not the shapes."""


def geometry(draw: Draw) -> float:
    """Bound: no failed check. Inside the bounds is what the rules accept; beyond, refusals are part of the answer."""
    name = draw.choose("design", ("fsr400", "fsr402", "fsr400_compact", *PRESETS))
    base = Design.load(name)
    varied = [p.path for p in list_parameters() if p.path.startswith(_TABLES) and p.unit]
    while True:
        changes = ["strength.min_grip_factor=0", "strength.min_shock_factor=0"]
        for path in draw.rng.sample(varied, draw.rng.randint(3, 12)):
            table, key = path.split(".")
            scale = draw.log("parameter / its value", (0.5, 2.0), (0.05, 20.0))
            changes.append(f"{path}={getattr(getattr(base, table), key) * scale}")
        changes.append(f"bone.interface={draw.choose('interface', ('post', 'socket', 'flange', 'clevis'))}")
        try:
            design = Design.load(name, changes=changes)
            break
        except DesignError:
            if not draw.is_inside:
                raise
    found = verify(design, list(parts_by_name(design)), ("stl",), MeshEvaluator(0.03)).checks
    failed = [check for check in found if not check.passed and not check.name.endswith(_NOT_GEOMETRY)]
    draw.values["failed"] = [check.name for check in failed]
    return 0.0 if not failed else 1.0 + len(failed)


def pad(draw: Draw) -> float:
    """Bound 5e-3: twice modulus and force press alike, more force presses deeper; force over depth has its inverse."""
    form = PadForm.of_design(Design.load(draw.choose("design", ("fsr400", "fsr402", "article"))))
    young = draw.log("modulus [MPa]", (0.01, 50.0), (1e-3, 1e3))
    form = replace(form, young_mpa=young, poisson=0.5 - draw.log("0.5 - Poisson's ratio", (0.001, 0.1), (1e-9, 0.45)))
    shapes: tuple[ObjectShape, ...] = "plate", "cylinder", "sphere"
    shape = draw.choose("object", shapes)
    radius = draw.log("radius [mm]", (1.0, 500.0), (0.5, 1e5)) if shape != "plate" else 0.0
    tilt = draw.rng.uniform(-5.0, 20.0) if draw.is_inside else draw.rng.uniform(-89.0, 89.0)
    force = draw.log("force / (modulus mm2)", (0.01, 5.0), (1e-6, 100.0)) * young
    pose = Pose(tilt, 0.0, shape, radius)
    one = find_contacts(form, pose, [force, 2 * force], math.inf)
    two = find_contacts(replace(form, young_mpa=2 * young), pose, [2 * force], math.inf)[0]
    errors = [abs(two.depth_mm / one[0].depth_mm - 1), abs(two.share - one[0].share)]
    errors.append(0.0 if one[1].depth_mm > one[0].depth_mm and one[1].area_mm2 >= one[0].area_mm2 else math.inf)
    errors.append(max(0.0, one[0].share - 1.0))
    stiffness = draw.log("stiffness at 1 N [N/m]", (300.0, 3e4), (1.0, 1e8))
    backing = Backing(0.035, draw.log("stiffness behind it [N/m]", (10.0, 1e5), (1e-3, 1e9)))
    curve = Pad(stiffness, 1e-5, (0.5,), (0.0,), 0.5, backing=backing)
    forces = np.logspace(-6, 1.7, 40) if draw.is_inside else np.logspace(-12, 6, 40)
    errors.append(float(np.abs(curve.force_n(np.array([curve.depth_m(f) for f in forces])) / forces - 1).max()))
    return max(errors) / 5e-3


def play(draw: Draw) -> float:
    """Bound 1e-6 of the largest motion: the same linear programs, solved by scipy's HiGHS."""
    from scipy.optimize import linprog

    length, size = draw.log("length [mm]", (10.0, 60.0), (0.1, 1e3)), draw.log("radius [mm]", (4.0, 12.0), (0.1, 300.0))
    rows, gaps = [], []
    for _ in range(draw.rng.randint(8, 40)):
        angle, z = draw.rng.uniform(0, 2 * math.pi), draw.rng.choice((-length, 0.0, 0.3 * length))
        normal = np.array([math.cos(angle), math.sin(angle), draw.rng.uniform(-0.3, 0.3)])
        point = np.array([size * normal[0], size * normal[1], z])
        rows.append(np.concatenate((normal, np.cross(point, normal))))
        gaps.append(draw.log("gap [mm]", (0.02, 0.5), (1e-6, 10.0)))
    goals = []
    for _ in range(6):
        normal = np.array([draw.rng.gauss(0, 1) for _ in range(3)])
        normal /= np.linalg.norm(normal)
        point = np.array([draw.rng.uniform(-size, size), draw.rng.uniform(-size, size), draw.rng.uniform(0, length)])
        goals.append(np.concatenate((normal, np.cross(point, normal))))
    found = maximise_linear([goal.tolist() for goal in goals], [row.tolist() for row in rows], gaps, 100.0)
    exact = [-linprog(-goal, np.array(rows), gaps, bounds=[(-100.0, 100.0)] * 6).fun for goal in goals]
    return float(max(abs(a - b) / max(abs(b), 1e-3) for (a, _), b in zip(found, exact, strict=True))) / 1e-6
