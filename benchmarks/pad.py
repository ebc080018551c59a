"""Error and run time of the layer model of the pad, against finite elements on random forms and
poses.

    python benchmarks/pad.py [--designs 34] [--seed 1] [--json] [--turn-on]

Each form is the default design with a random crown or none, thickness, modulus, and place of the
sensor; it is pressed at three random tilts with 1 and 5 N. Forms that break a rule, and contacts
that the finite elements refuse because the collar touches first or the strain is too large, are
drawn again. The force of the layer model is that at the depth of the finite elements. With
`--turn-on` the forces at which the sensor turns on are compared instead, at the tilts of a grasp:
of such forms, and of bundled designs, encapsulated and with a skin that lies on the bone.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import random
import time
from collections.abc import Iterator

import numpy as np

from fingertip.design import Design
from fingertip.foundation.errors import FingertipError, TraceError
from fingertip.pad.fem_contact import PadModel, Patch
from fingertip.pad.fem_large_strain import press_large_strain
from fingertip.pad.fem_mesh import MeshSize
from fingertip.pad.layer import find_contacts, find_rest_n
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.survey import find_turn_on_n
from fingertip.pad.touch import Pose

FORCES_N = (1.0, 5.0)
_AROUND = (0.5, 0.75, 1.0, 1.3, 1.7, 2.2, 3.0)
"""Forces about each one, between which the force at a depth is interpolated."""
_NEAR = (0.7, 1.0, 1.4)
"""The same about the layer model's turn-on."""
_TURN_ON_DEG = (0.0, 5.0, 10.0)
_LYING = ("fsr400", "first_finger", "adult_thumb", "child_finger")
_ENCAPSULATED = ("article", "first_finger", "fsr402")
_LYING_MM = 1.8
"""Edges of the mesh of a skin that lies on the bone [mm]."""


def draw_form(rng: random.Random) -> PadForm:
    """Draw a form that the rules accept."""
    while True:
        radius = rng.choice((0.0, rng.uniform(8.0, 30.0)))
        changes = {
            "skin.made": "encapsulated",
            "skin.crown_radius_mm": radius,
            "skin.crown_offset_mm": rng.uniform(0.0, 2.0),
            "skin.crown_drop_mm": rng.uniform(1.0, 2.2),
            "skin.thickness_palmar_mm": rng.uniform(2.4, 4.0),
            "skin.semi_axis_palmar_mm": rng.uniform(6.0, 8.0),
            "skin.pulp_fullness": rng.uniform(0.875, 0.92),
            "bone.platform_mm": rng.uniform(0.0, 1.8),
            "sensor.distance_from_tip_mm": rng.uniform(10.5, 12.5),
            "silicone.product": "own",
            "silicone.modulus_mpa": math.exp(rng.uniform(math.log(0.3), math.log(3.0))),
        }
        try:
            return PadForm.of_design(
                Design.load("fsr400", changes=[f"{k}={v}" for k, v in changes.items()])
            )
        except FingertipError:
            continue


def compare_turn_on(form: PadForm) -> Iterator[float]:
    """Yield the relative error of the layer model's turn-on at the tilts of a grasp.

    By finite elements it is the force on the pad that leaves the turn-on on the sensor, together
    with what presses there at rest.
    """
    size = MeshSize() if form.bonded else MeshSize(_LYING_MM)
    model = PadModel(form, size, is_half=True)
    missing_n = form.turn_on_n - find_rest_n(form)

    for tilt in _TURN_ON_DEG:
        layer_n = find_turn_on_n(form, tilt)
        if math.isinf(layer_n):
            continue

        forces_n = [share * layer_n for share in _NEAR]
        try:
            if form.bonded:
                patch = Patch(model, Pose(tilt))
                pressed = [patch.press(force, with_strain=False) for force in forces_n]
            else:
                pressed = [*press_large_strain(model, Pose(tilt), forces_n, form.friction)]
        except TraceError:
            continue

        felt_n = [one.share * force for one, force in zip(pressed, forces_n, strict=True)]
        if felt_n[0] <= missing_n <= felt_n[-1]:
            yield layer_n / float(np.interp(missing_n, felt_n, forces_n)) - 1.0


def sum_up(errors: list[float]) -> dict[str, float]:
    """Sum up the errors in all contacts."""
    return {
        "contacts": len(errors),
        "rms": float(np.sqrt(np.mean(np.square(errors)))),
        "worst": float(np.abs(errors).max()),
    }


def main() -> None:
    """Print the errors and the times."""
    parser = argparse.ArgumentParser(description="Layer model of the pad against finite elements.")
    parser.add_argument("--designs", type=int, default=34)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--json", action="store_true", help="print the errors as data in place of lines"
    )
    parser.add_argument("--turn-on", action="store_true", help="compare turn-on alone")
    given = parser.parse_args()
    rng = random.Random(given.seed)
    if given.turn_on:
        kinds = {
            "bonded": [draw_form(rng) for _ in range(given.designs)],
            "encapsulated": [
                PadForm.of_design(Design.load(name, changes=["skin.made=encapsulated"]))
                for name in _ENCAPSULATED
            ],
            "lying": [PadForm.of_design(Design.load(name)) for name in _LYING],
        }
        for kind, forms in kinds.items():
            errors = [*itertools.chain.from_iterable(map(compare_turn_on, forms))]
            ends = {"lowest": min(errors), "highest": max(errors)}
            print(json.dumps({kind: sum_up(errors) | ends}), flush=True)

        return

    shares: dict[float, list[float]] = {force: [] for force in FORCES_N}
    ratios: dict[float, list[float]] = {force: [] for force in FORCES_N}
    layer_s = []
    fem_s = []

    for _ in range(given.designs):
        form = draw_form(rng)
        begin = time.process_time()
        model = PadModel(form, MeshSize(), is_half=True)
        spent = time.process_time() - begin
        pressed = 0

        for _ in range(30):
            if pressed == 3:
                break

            pose = Pose(rng.uniform(-5.0, 20.0))
            for force in FORCES_N:
                begin = time.process_time()
                try:
                    patch = Patch(model, pose)
                    found = patch.press(force)
                    around = find_contacts(
                        form, pose, [share * force for share in _AROUND], math.inf
                    )
                except TraceError:
                    continue

                spent += time.process_time() - begin
                begin = time.process_time()
                one = find_contacts(form, pose, (force,), math.inf)[0]
                layer_s.append(time.process_time() - begin)
                depth = found.depth_mm / math.cos(math.radians(pose.tilt_deg))  # along the heights
                at = np.interp(
                    math.log(depth),
                    np.log([c.depth_mm for c in around]),
                    np.log([c.force_n for c in around]),
                )
                shares[force].append(one.share - found.share)
                ratios[force].append(math.exp(float(at)) / force)
                pressed += force == FORCES_N[0]

        fem_s.append(spent)

    if given.json:
        print(json.dumps({f"{force:g}": sum_up(shares[force]) for force in FORCES_N}, indent=1))
        return

    for force in FORCES_N:
        error = np.abs(shares[force])
        ratio = np.array(ratios[force])
        rms = float(np.sqrt(np.mean(np.square(shares[force]))))
        print(
            f"{force:g} N, {len(error)} contacts: share rms {rms:.3f}, median "
            f"{np.median(error):.3f}, 90th percentile "
            f"{np.quantile(error, 0.9):.3f}, worst {error.max():.3f}; force {ratio.min():.3f} to "
            f"{ratio.max():.3f}, "
            f"median {np.median(ratio):.3f}, 90 % within {np.quantile(np.abs(ratio - 1), 0.9):.3f}"
        )

    print(
        f"a contact of the layer model {1e3 * np.median(layer_s):.1f} ms CPU; three poses of a "
        "form by finite elements "
        f"{np.median(fem_s):.1f} s; {3 * np.median(fem_s) / 18 / np.median(layer_s):.0f} times as "
        "long a contact"
    )


if __name__ == "__main__":
    main()
