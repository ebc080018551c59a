"""Surfaces on which a pad slides: the bundled ones of ``params/surfaces``, and those of scenes and
files of one's own.

The article's six flat surfaces are among them. The roughness of its three metals is the article's
(section III.C); it gives no coefficient of friction and calls the roughness of the other surfaces
unknown. Each file says what is assumed.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from fingertip.catalogues.file_kinds import PARAMS, SURFACE, FileKind, read_file
from fingertip.design.parameters import ParameterTable, choice, quantity, text
from fingertip.design.parameters.declaration import issues_from_pydantic, suggest_name
from fingertip.foundation.errors import FingertipError, Issue, TraceError
from fingertip.foundation.input_files import PARSED_LIMIT, read_input
from fingertip.foundation.numerics import Array
from fingertip.foundation.validation import round_down, round_up
from fingertip.sim.contact.friction import Friction

ARTICLE_SURFACES = ("smooth", "medium", "gross", "wood", "paper", "plastic")
"""Names of the article's six flat surfaces, in its order."""
_MAX_POINTS = 200_000
"""Largest number of points of a measured profile: 1 m in steps of 5 um."""
_EVEN = 0.01
"""Largest relative difference of the steps of a measured profile."""


class SurfaceTable(ParameterTable):
    """Surface of one's own, in place of the named one; 0, ""
    and "named" keep the value of that one.
    """

    material: str = text(
        "",
        "What it is, for reports.",
        pattern=r"^[^\x00-\x1f]{0,80}$",
        allowed="up to 80 characters",
    )
    static_friction: float = quantity(
        0.0,
        "",
        (0, 3),
        "Static coefficient of friction; below 1.3 times the kinetic one; 0: as named.",
    )
    kinetic_friction: float = quantity(
        0.0, "", (0, 3), "Kinetic coefficient of friction, at high speed; 0: as named."
    )
    stribeck_m_s: float = quantity(
        0.0,
        "m/s",
        (0, 1),
        "Speed at which half of the drop between them has happened; 0: as named.",
    )
    roughness_um: float = quantity(
        0.0,
        "um",
        (0, 100),
        "Mean deviation Ra of the heights, of waves of up to longest_wave_mm; 0: as named.",
    )
    longest_wave_mm: float = quantity(
        0.0,
        "mm",
        (0, 25),
        "Longest wave of the roughness, see ISO 4288; its spectrum goes to four times this; 0: as "
        "named.",
    )
    hurst: float = quantity(
        0.0,
        "",
        (0, 1),
        "Exponent H of the roughness: heights of waves grow with their length to the power H; 0: "
        "as named.",
    )
    felt_um: float = quantity(
        0.0,
        "um",
        (0, 100),
        "Roughness that the pad feels where Ra is 1 um: it spans waves; 0: as named.",
    )
    felt_exponent: float = quantity(
        0.0, "", (0, 3), "Exponent with which the felt roughness grows with Ra; 0: as named."
    )
    ridge_pitch_mm: float = quantity(
        0.0, "mm", (0, 20), "Distance between ridges across the slide."
    )
    ridge_depth_um: float = quantity(
        0.0, "um", (0, 1000), "Height of the ridges, from valley to crest; 0: none."
    )
    profile_um: list[float] = Field(
        [],
        max_length=_MAX_POINTS,
        description="Measured heights in um, in place of roughness and ridges.",
    )
    profile_step_um: float = quantity(0.0, "um", (0, 1000), "Distance between measured heights.")
    load_law: Literal["named", "hertz", "proportional"] = choice(
        "named",
        "Vibration against load. hertz: as the stiffness of a ball, with its cube root; "
        "proportional: as friction, and "
        "as the stiffness of a rough contact (B. N. J. Persson, Phys. Rev. Lett. 99, 2007, "
        "125502).",
    )

    def complete(self, name: str) -> SurfaceTable:
        """Return a table whose values all count: a bundled surface's where this one keeps them."""
        default = SurfaceTable()
        changed = {key: value for key, value in self if value != getattr(default, key)}
        if changed:
            changed.setdefault("material", f"own surface, else as {name}")

        return SURFACES[name].model_copy(update=changed)

    @property
    def friction(self) -> Friction:
        """Friction of a complete table, per newton of normal force. Raises TraceError."""
        return Friction(self.static_friction, self.kinetic_friction, self.stribeck_m_s)


class SurfaceFile(BaseModel):
    """File of one surface. Raises TraceError."""

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        title="fingertip surface",
    )
    file_kind: ClassVar[FileKind] = SURFACE

    surface: SurfaceTable = SurfaceTable()

    @classmethod
    def load(cls, path: Path) -> SurfaceFile:
        """Read a TOML file, or a CSV file of a measured profile. Raises TraceError."""
        if path.suffix.lower() == ".csv":
            return _read_profile(path)

        try:
            return cls(**read_file(path, SURFACE))
        except ValidationError as error:
            raise TraceError(issues_from_pydantic(error, cls)) from None
        except FingertipError as error:
            raise TraceError(error.issues) from None


_FILES = {path.stem: SurfaceFile.load(path) for path in (PARAMS / "surfaces").glob("*.toml")}
SURFACES: Mapping[str, SurfaceTable] = {
    name: _FILES[name].surface
    for name in (*ARTICLE_SURFACES, *sorted({*_FILES} - {*ARTICLE_SURFACES}))
}
"""Bundled surfaces by name, the article's six first."""


def find_surface_issues(
    field: str,
    name: str,
    table: SurfaceTable,
    path_field: str,
    path_m: float,
) -> Iterator[tuple[Issue, set[str]]]:
    """Yield why a surface cannot be, with the names of the parameters that each reason reads.

    `field` names the parameter that holds the name, `path_field` that of the length of the slide,
    `path_m` [m].
    """
    if name not in SURFACES:
        yield Issue(field, f"{name!r} is not known; {suggest_name(name, list(SURFACES))}"), {field}
        return

    full = table.complete(name)
    fields = {field, *(f"surface.{key}" for key in SurfaceTable.model_fields)}
    highest = Friction(1.0, 1.0).max_ratio * full.kinetic_friction

    if not full.kinetic_friction <= full.static_friction < highest:
        bounds = f"{full.kinetic_friction:g} and below {round_down(highest):g}"
        why = (
            "is below surface.kinetic_friction"
            if full.static_friction < highest
            else "lets friction deliver energy"
        )
        yield (
            Issue("surface.static_friction", f"{full.static_friction:g} {why}; at least {bounds}."),
            fields,
        )

    if full.ridge_depth_um and not full.ridge_pitch_mm:
        yield (
            Issue(
                "surface.ridge_pitch_mm",
                "0 leaves the ridges without a distance; choose one, such as 1.",
            ),
            fields,
        )

    if full.profile_um and not full.profile_step_um:
        yield (
            Issue(
                "surface.profile_step_um",
                "0 leaves the profile without a length; choose one, such as 5.",
            ),
            fields,
        )
    elif full.profile_um:
        length_m = 1e-6 * full.profile_step_um * (len(full.profile_um) - 1)
        if length_m < path_m:
            message = (
                f"{1000 * length_m:.4g} mm of profile are shorter than the path of "
                f"{1000 * path_m:g} mm; measure more"
            )
            remedy = f"set {path_field}={round_down(length_m):g}"
            yield (
                Issue("surface.profile_um", f"{message}, or {remedy}."),
                {*fields, path_field},
            )


def find_pitch_issues(
    name: str, table: SurfaceTable, speed_m_s: float, rate_hz: float
) -> Iterator[Issue]:
    """Yield a ridge that passes faster than samples can show."""
    surface = table.complete(name)
    least = 2.0 * speed_m_s / rate_hz

    if surface.ridge_depth_um and 1e-3 * surface.ridge_pitch_mm <= least:
        what = f"{surface.ridge_pitch_mm:g} mm passes at half of detector.sample_rate_hz or faster"
        yield Issue("surface.ridge_pitch_mm", f"{what}; above {round_up(1000 * least):g} mm.")


def find_profile_warnings(step_um: float, speed_m_s: float, cutoff_hz: float) -> Iterator[str]:
    """Yield a warning if a profile carries no vibration that a high-pass lets through: two points a
    wave are needed.
    """
    longest_um = 1e6 * speed_m_s / (2 * cutoff_hz)
    if step_um > longest_um:
        carried = (
            f"points of the profile {step_um:g} um apart carry "
            f"{cutoff_hz * longest_um / step_um:.3g} Hz at most"
        )
        passed = f"at {speed_m_s:g} m/s, and the board passes {cutoff_hz:g} Hz and more"
        yield f"{carried} {passed}; measure at steps of at most {round_down(longest_um):g} um"


def _read_profile(path: Path) -> SurfaceFile:
    """Read a measured profile: a line ``position_mm,height_um``, then one line for each point.

    Raises TraceError.
    """
    try:
        lines = read_input(path, PARSED_LIMIT).decode("utf-8-sig").splitlines()
        rows = _parse_rows(lines)
    except (ValueError, OSError) as error:
        raise TraceError(
            Issue(str(path), f"{error}; write position_mm,height_um and then one point a line.")
        ) from None
    except FingertipError as error:
        raise TraceError(error.issues) from None

    steps = np.diff(rows[:, 0])
    step_mm = float(np.mean(steps))
    if not step_mm > 0.0 or float(np.max(np.abs(steps - step_mm))) > _EVEN * step_mm:
        message = (
            f"steps of {steps.min():g} to {steps.max():g} mm are uneven; resample it at "
            "equal steps."
        )
        raise TraceError(Issue(str(path), message))

    heights = rows[:, 1] - rows[:, 1].mean()
    step_um = round(1000 * step_mm, 6)
    table = SurfaceTable(
        material=path.name, profile_um=heights.round(6).tolist(), profile_step_um=step_um
    )
    return SurfaceFile(surface=table)


def _parse_rows(lines: list[str]) -> Array:
    if not lines or [cell.strip() for cell in lines[0].split(",")] != ["position_mm", "height_um"]:
        raise ValueError("does not begin with the columns position_mm and height_um")

    rows = np.array(
        [[float(cell) for cell in line.split(",")] for line in itertools.islice(lines, 1, None)]
    )
    if rows.ndim != 2 or rows.shape[1] != 2 or len(rows) < 2 or not np.isfinite(rows).all():
        raise ValueError("does not hold two finite numbers in each line, and two lines or more")
    if len(rows) > _MAX_POINTS:
        raise ValueError(f"has {len(rows)} points; at most {_MAX_POINTS} are read")
    if float(np.abs(rows[:, 1]).max()) > 1e6:
        raise ValueError("has heights beyond 1 m")

    return rows
