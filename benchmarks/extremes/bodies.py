"""Parts, and mechanics of the pad."""

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
from fingertip.foundation.errors import DesignError
from fingertip.pad.form import PadForm
from fingertip.pad.layer import find_contacts
from fingertip.pad.response import Backing, Pad
from fingertip.pad.touch import ObjectShape, Pose

_TABLES = ("sensor.", "bone.", "hand.", "skin.", "mold.")
_NOT_GEOMETRY = ("excess", "plunge_pressure", "core_bending", "creep", "seat_film", "palmar_error", "fitting_stretch")
"""Checks that a printer, a silicone or a load decides, not the shapes."""


def geometry(draw: Draw) -> float:
    """Bound: no failed check. Inside the bounds is what the rules accept; beyond, refusals are part of the answer."""
    name = draw.choose("design", ("fsr400", "fsr402", "first_finger", *PRESETS))
    base = Design.load(name)
    varied = [p.path for p in list_parameters() if p.path.startswith(_TABLES) and p.unit]
    while True:
        changes = ["strength.min_grip_factor=0", "strength.min_knock_factor=0"]
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
