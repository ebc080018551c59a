"""Contacts of a pad: by the layer model, or with an insert from a table of finite elements.

The layer model does not hold around a stiff insert: its force is off by factors. So a plate is pressed on such a pad by
finite elements over tilt, roll and force, and smooth functions of them are fitted. That takes ten to forty seconds;
the result is kept in the user's cache folder, under a name made of the form and of this module's settings.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.polynomial.legendre import legval2d, legvander2d

from fingertip.foundation import extras
from fingertip.foundation.errors import Issue, OutputError, TraceError
from fingertip.foundation.files import write_file
from fingertip.foundation.numerics import Array
from fingertip.pad import layer
from fingertip.pad.form import PadForm
from fingertip.pad.layer import GRID_MM, MAX_STRAIN, Contact
from fingertip.pad.pose import Pose

TILTS_DEG, ROLLED_TILTS_DEG, ROLL_DEG = (-5.0, 0.0, 2.0, 5.0, 10.0, 15.0, 20.0), (0.0, 10.0, 20.0), 10.0
"""Poses of the table: without roll, and rolled."""
FORCES_N = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0)
_DEGREES, _ROLLED_DEGREES = (4, 3), (2, 1)
"""Degrees of the polynomials over tilt and logarithm of the force, and of the change that a roll brings."""
_DIGITS = 6
"""Decimals of their coefficients: processors differ in digits far beyond."""
_VERSION = 2
"""Counts changes of the finite elements that change a table."""


def find_contacts(
    form: PadForm, pose: Pose, forces_n: Sequence[float], max_strain: float = MAX_STRAIN
) -> list[Contact]:
    """Find the contact at each of some growing forces. Raises TraceError, and MissingLibraryError with an insert."""
    if form.insert is None:
        return layer.find_contacts(form, pose, forces_n, max_strain)
    check_pose(form, pose)
    table, roll = _read_table(form), abs(pose.roll_deg)
    force = np.array(forces_n)
    s, u = _scale(np.full_like(force, pose.tilt_deg), np.clip(force, FORCES_N[0], FORCES_N[-1]))
    change = legval2d(s, u, table.rolled) * (roll / ROLL_DEG) ** 2
    share, shear, depth, area, centre = legval2d(s, u, table.straight)
    # Depth and area go on as powers of the force beyond the table, the shares stay.
    beyond = np.log(force / np.clip(force, FORCES_N[0], FORCES_N[-1]))
    share, shear = share * np.exp(change[0]), shear * np.exp(change[0])
    depth, area = np.exp(depth + change[1] + 0.6 * beyond), np.exp(area + change[2] + 0.7 * beyond)
    over = form.over_sensor_mm - form.insert.height
    rows = np.stack([force, share, shear, depth, area, centre], axis=1).tolist()
    found = [Contact(f, part, along, d, a, math.nan, (0.0, at), over) for f, part, along, d, a, at in rows]
    if found[-1].strain > max_strain:
        message = f"{forces_n[-1]:g} N presses the skin over the insert by {found[-1].strain:.0%} of its thickness."
        raise TraceError(Issue("force_n", message))
    return found


def check_pose(form: PadForm, pose: Pose) -> None:
    """Raise a TraceError for a pose that cannot be, or for which no contact is known."""
    layer.bring(form, pose)
    if form.insert is None:
        return
    if pose.object != "plate":
        raise TraceError(
            Issue("pose.object", f"{pose.object} is not known with an insert on the sensor; set pose.object=plate.")
        )
    for name, value, low, high in (
        ("tilt_deg", pose.tilt_deg, TILTS_DEG[0], TILTS_DEG[-1]),
        ("roll_deg", pose.roll_deg, -2 * ROLL_DEG, 2 * ROLL_DEG),
    ):
        if not low <= value <= high:
            bounds = f"{low:g} to {high:g} degrees are known with an insert"
            raise TraceError(Issue(f"pose.{name}", f"{value:g} degrees: {bounds}; choose one of them."))


@lru_cache(maxsize=1024)
def is_possible(form: PadForm, pose: Pose) -> bool:
    with suppress(TraceError):
        check_pose(form, pose)
        return True
    return False


def is_quick(form: PadForm) -> bool:
    """Tell whether contacts take milliseconds, not the time of finite elements."""
    return form.insert is None or _name_table(form).exists()


def map_shares(form: PadForm) -> tuple[Array, Array, Array]:
    """Map the share of a force on a small place: x and distance distal to the sensor [mm], and the share at both."""
    if form.insert is None:
        return layer.map_shares(form)
    table = _read_table(form)
    return table.x_mm, table.dz_mm, table.shares


@dataclass(frozen=True, eq=False)
class _Table:
    """Coefficients of the polynomials, and the share of a force by its place."""

    straight: Array
    rolled: Array
    x_mm: Array
    dz_mm: Array
    shares: Array


def _scale(tilt_deg: Array, force_n: Array) -> tuple[Array, Array]:
    """Map tilt and logarithm of the force to the range -1 to 1 of the polynomials."""
    middle, half = (TILTS_DEG[0] + TILTS_DEG[-1]) / 2, (TILTS_DEG[-1] - TILTS_DEG[0]) / 2
    low, high = math.log(FORCES_N[0]), math.log(FORCES_N[-1])
    return (tilt_deg - middle) / half, (2 * np.log(force_n) - low - high) / (high - low)


@lru_cache(maxsize=64)
def _read_table(form: PadForm) -> _Table:
    """Read the table of a form from the cache, or compute and keep it."""
    path = _name_table(form)
    with suppress(OSError, ValueError, TypeError, AttributeError):  # missing, damaged, or of another version
        return _Table(**{name: np.array(values) for name, values in json.loads(path.read_text("utf-8")).items()})
    table = _compute_table(form)
    with suppress(OutputError):  # a folder that cannot be written costs the time again
        write_file(path, json.dumps({name: values.tolist() for name, values in vars(table).items()}).encode())
    return table


def _name_table(form: PadForm) -> Path:
    settings = repr((_VERSION, TILTS_DEG, ROLLED_TILTS_DEG, ROLL_DEG, FORCES_N, _DEGREES, _ROLLED_DEGREES, form))
    folder = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "fingertip" / "pads"
    return folder / f"{hashlib.sha256(settings.encode()).hexdigest()[:32]}.json"


def _compute_table(form: PadForm) -> _Table:
    """Press a plate on the pad in all poses with all forces, and fit the polynomials."""
    extras.require("sensor.insert", "scipy")
    from fingertip.pad.fem_contact import PadModel, Patch  # noqa: PLC0415
    from fingertip.pad.fem_mesh import MeshSize  # noqa: PLC0415

    # As many edges over a larger sensor, and not many more over a wider finger, whose table took two minutes.
    edge = max(0.8, 0.32 * form.active_radius_mm, form.outer.section.half_width / 12.0)

    def press(model: PadModel, pose: Pose) -> Array | None:
        """Press with all forces; None in a pose in which the plate meets the collar at the second or before."""
        patch, rows = Patch(model, pose), list[list[float]]()
        with suppress(TraceError):  # where the plate comes to lie on the collar, or the skin is too soft for the force
            for force in FORCES_N:
                c = patch.press(force, with_strain=False)
                rows.append([c.share, c.shear_share, math.log(c.depth_mm), math.log(c.area_mm2), c.centre_mm[1]])
        if len(rows) < 2:
            return None
        for _ in FORCES_N[len(rows) :]:  # the table goes on as before
            rows.append([*rows[-1][:2], *(2 * rows[-1][i] - rows[-2][i] for i in (2, 3)), rows[-1][4]])
        return np.array(rows)

    tilts = [tilt for tilt in TILTS_DEG if is_possible(form, Pose(tilt))]
    half = PadModel(form, MeshSize(edge), is_half=True)
    pressed = {tilt: rows for tilt in tilts if (rows := press(half, Pose(tilt))) is not None}
    if len(pressed) <= _DEGREES[0]:
        problem = f"is too soft for {FORCES_N[1]:g} N on an insert; set sensor.insert=none."
        raise TraceError(Issue("silicone.product", problem))
    fitted = _fit(list(pressed), np.array(list(pressed.values())), _DEGREES)
    shares = half.map_shares(GRID_MM)
    del half  # 0.3 GB, before the next stiffness is factorised
    # What a roll changes is found on a coarser mesh, which serves both.
    whole = PadModel(form, MeshSize(1.8 * edge), is_half=False)
    tilts = [tilt for tilt in ROLLED_TILTS_DEG if is_possible(form, Pose(tilt, ROLL_DEG)) and tilt in pressed]
    pairs = {tilt: [press(whole, Pose(tilt, roll)) for roll in (0.0, ROLL_DEG)] for tilt in tilts}
    pairs = {tilt: pair for tilt, pair in pairs.items() if all(rows is not None for rows in pair)}
    tilts = list(pairs)
    if len(tilts) <= _ROLLED_DEGREES[0]:
        return _Table(fitted, np.zeros((_ROLLED_DEGREES[0] + 1, _ROLLED_DEGREES[1] + 1, 3)), *shares)
    at_rest, rolled = np.array([*pairs.values()]).swapaxes(0, 1)
    share = np.log(np.maximum(rolled[..., 0], 1e-3) / np.maximum(at_rest[..., 0], 1e-3))
    change = np.stack([share, rolled[..., 2] - at_rest[..., 2], rolled[..., 3] - at_rest[..., 3]], axis=2)
    return _Table(fitted, _fit(tilts, change, _ROLLED_DEGREES), *shares)


def _fit(tilts_deg: Sequence[float], values: Array, degrees: tuple[int, int]) -> Array:
    """Fit values of shape (tilts, forces, quantities) by polynomials of both; coefficients have the quantity last."""
    s, u = _scale(*(grid.ravel() for grid in np.meshgrid(tilts_deg, FORCES_N, indexing="ij")))
    found = np.linalg.lstsq(legvander2d(s, u, degrees), values.reshape(len(s), -1), rcond=None)[0]
    return np.asarray(np.round(found.reshape(degrees[0] + 1, degrees[1] + 1, -1), _DIGITS))
