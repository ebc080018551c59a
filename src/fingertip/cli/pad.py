"""Command `fingertip pad`: what part of a force reaches the sensor,
in the poses in which a finger presses.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from fingertip.cli.console import Console
from fingertip.cli.options import CHANGES, DESIGN_FILE, command, flag, load_design, refuse
from fingertip.foundation import extras
from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.progress import ShareText

if TYPE_CHECKING:
    from fingertip.pad.fem_contact import PadContact
    from fingertip.pad.fem_large_strain import LargeStrainContact
    from fingertip.pad.pad_geometry import PadForm
    from fingertip.pad.survey import PadSurvey

_WORST = ("strain", "bond_shear_mpa", "bond_tension_mpa")
"""Figures of which the largest over all tilts is stated."""
_SMALL_STRAIN = 0.1
_DEPTH = 0.3
"""Strain of the elements, and indentation over thickness, up to
which small strains are not commented on.
"""
_FRICTION = 0.5
"""Friction of silicone on a dry plate. An assumption."""
_REFUSED = "-: the plate reaches the rigid collar, or the strain is too large for this computation"
_COARSE_MM = 1.2
_STRAINED_DEG = (0.0, 10.0)
"""Edges of the mesh [mm] and tilts of large strains."""
_LYING_MM = 1.8
"""Edges of the mesh of a skin that lies on the bone [mm]."""
_REFINED = 0.7
"""Length of the finer mesh's edges over those of the mesh."""


@command
def pad(
    console: Console,
    design: Path = DESIGN_FILE,
    fem: bool = flag(
        "Compute the same by finite elements, some 5 s; 3 minutes for a skin that lies on the bone."
    ),
    refine: bool = flag("Repeat them on a mesh with edges 0.7 times as long, some 20 s."),
    large_strain: bool = flag("Compare them with large strains and friction, some 2 minutes."),
    friction: float | None = typer.Option(
        None, help="Friction on the plate, 0 to 2, for --large-strain."
    ),
    changes: list[str] | None = CHANGES,
) -> None:
    """State what the sensor feels of a force on the pad: its share over tilt and roll, turn-on,
    stiffness and strain.

    A layer model of the silicone on the bone computes the contact with a flat, rigid plate; a skin
    that was made apart lies on the bone, with its tightest and its loosest fit. With an insert
    finite elements do, which takes half a minute the first time. At a tilt of 0 the straight part
    of the pad at its base is parallel to the plate; a positive tilt turns the tip down. `fingertip
    picture DESIGN --pad` draws the same over the place and the force.
    """
    from fingertip.pad.pad_geometry import PadForm
    from fingertip.pad.survey import find_own_mode_hz, survey_pad

    if friction is not None and not large_strain:
        refuse([Issue("--friction", "acts only with --large-strain; add that.")])
    if friction is not None and not 0 <= friction <= 2:
        refuse([Issue("--friction", f"{friction:g} is out of bounds; choose 0 to 2.")])
    if fem or refine or large_strain:
        extras.require("--fem", "scipy")

    loaded = load_design(design, changes, console)
    survey = survey_pad(loaded)
    form = PadForm.of_design(loaded)
    data: dict[str, Any] = {
        "design": loaded.name,
        "young_mpa": round(form.young_mpa, 4),
        **survey.to_dict(),
    }
    data["own_mode_hz"] = round(find_own_mode_hz(loaded), 1)
    lines = _list_lines(loaded.name, form, survey)

    if not form.bonded:
        loose = survey_pad(loaded, is_loose=True)
        data["loose"] = loose.to_dict()
        lines[4:4] = _list_row_lines(loose, "with the loosest fit: ")
        at_rest = (
            f"with the tightest fit {survey.rest_n:.2g} N press on the sensor at rest; "
            "shares leave that out"
        )
        lines.append(
            f"the skin lies on the bone without a bond (skin.bonded=true compares); {at_rest}"
        )

    lines.append(
        f"silicone over the sensor resonates at {data['own_mode_hz']:.0f} Hz; simulations leave "
        "its mass out"
    )
    if fem or refine:
        stretch_percent = loaded.silicone.material.elongation_percent.low
        lines += _add_elements(
            console,
            form=form,
            refine=refine,
            data=data,
            lines=lines,
            stretch_percent=stretch_percent,
            large_strain=large_strain,
        )

    if large_strain:
        friction = _FRICTION if friction is None else friction
        data["large_strain"] = _compare_large_strain(console, form, friction)
        lines += _list_large_strain(data["large_strain"], friction)

    console.result(data, "\n".join(lines))


def _add_elements(
    console: Console,
    form: PadForm,
    refine: bool,
    data: dict[str, Any],
    lines: list[str],
    stretch_percent: float,
    large_strain: bool,
) -> list[str]:
    """Press by finite elements, on a finer mesh too; add figures and rows, and return remarks."""
    from fingertip.pad.survey import FORCE_N

    is_refused = False
    worst = dict[str, float]()

    for is_fine in (False, True)[: 1 + refine]:
        console.progress(
            ShareText(f"finite elements{', finer mesh' if is_fine else ''}", 0.5 * is_fine)
        )
        found = _press(form, is_fine)
        name, title = (
            ("fem_refined", "finite elements, edges 0.7")
            if is_fine
            else ("fem", "the same, finite elements")
        )
        data[name] = [
            None if c is None else {"share": round(c.share, 4), "depth_mm": round(c.depth_mm, 4)}
            for c in found
        ]
        lines.insert(
            3 + is_fine, _row(title, ["-" if c is None else f"{c.share:.2f}" for c in found])
        )
        pressed = [c for c in found if c and form.bonded]
        worst = {part: max(getattr(c, part) for c in pressed) for part in _WORST} if pressed else {}
        data[f"{name}_worst"] = {part: round(value, 4) for part, value in worst.items()}
        is_refused = None in found

    remarks = [_REFUSED] if is_refused else []
    if worst:
        remarks += [
            f"worst of these at {FORCE_N:g} N: strain {worst['strain']:.0%} (the silicone breaks "
            "at "
            f"{stretch_percent:.0f} %), at the bond {worst['bond_shear_mpa']:.2f} MPa of shear, "
            f"{worst['bond_tension_mpa']:.2f} MPa of tension,",
            "on this mesh: at edges of the bone finer ones find more, so compare forms by them "
            "and no more",
        ]
        if worst["strain"] > _SMALL_STRAIN and not large_strain:
            remarks.append("such strains are not small: --large-strain states what they change")

    return remarks


def _list_large_strain(rows: list[dict[str, Any]], friction: float) -> list[str]:
    titles = {
        "small": "small strain",
        "large": "large strain",
        "friction": f"with friction of {friction:g}",
    }
    lines = [
        f"finite elements, edges of {_COARSE_MM:g} mm:",
        _row(
            "share and depth [mm]", [f"{r['force_n']:g} N, {r['tilt_deg']:g} deg" for r in rows], 17
        ),
    ]
    lines += [
        _row(title, [f"{r[name][0]:.3f}  {r[name][1]:.3f}" if r[name] else "-" for r in rows], 17)
        for name, title in titles.items()
    ]
    return lines if all(row[name] for row in rows for name in titles) else [*lines, _REFUSED]


def _press(form: PadForm, is_fine: bool) -> list[PadContact | LargeStrainContact | None]:
    """Press the pad by finite elements at all tilts of the survey; None where they refuse the
    contact.

    A skin that lies on the bone is pressed at large strain, with its friction inside and on the
    plate.
    """
    from fingertip.pad.fem_contact import PadModel, Patch
    from fingertip.pad.fem_large_strain import press_large_strain
    from fingertip.pad.fem_mesh import MeshSize
    from fingertip.pad.survey import FORCE_N, TILTS_DEG
    from fingertip.pad.touch import Pose

    size = MeshSize() if form.bonded else MeshSize(_LYING_MM)
    model = PadModel(
        form, replace(size, edge_mm=_REFINED * size.edge_mm) if is_fine else size, is_half=True
    )
    found: list[PadContact | LargeStrainContact | None] = []

    for tilt in TILTS_DEG:
        far = press_large_strain(model, Pose(tilt), (FORCE_N,), form.friction)
        try:
            found.append(Patch(model, Pose(tilt)).press(FORCE_N) if form.bonded else next(far))
        except TraceError:
            found.append(None)

    return found


def _compare_large_strain(console: Console, form: PadForm, friction: float) -> list[dict[str, Any]]:
    """Press with a usual and a firm force, at small and at
    large strain; None where that is refused.
    """
    from fingertip.pad.fem_contact import PadModel, Patch
    from fingertip.pad.fem_large_strain import press_large_strain
    from fingertip.pad.fem_mesh import MeshSize
    from fingertip.pad.survey import FIRM_N, FORCE_N
    from fingertip.pad.touch import Pose

    model = PadModel(form, MeshSize(_COARSE_MM), is_half=True)
    forces = (FORCE_N, FIRM_N)
    rows: list[dict[str, Any]] = []

    for done, tilt in enumerate(_STRAINED_DEG):
        console.progress(
            ShareText(f"large strain at a tilt of {tilt:g} degrees", done / len(_STRAINED_DEG))
        )
        patch = Patch(model, Pose(tilt))
        ways = {
            "small": _collect(patch.press(force, with_strain=False) for force in forces)
            if form.bonded
            else [],
            "large": _collect(press_large_strain(model, Pose(tilt), forces)),
            "friction": _collect(press_large_strain(model, Pose(tilt), forces, friction)),
        }

        for index, force in enumerate(forces):
            found = {name: way[index] if index < len(way) else None for name, way in ways.items()}
            rows.append({"tilt_deg": tilt, "force_n": force, **found})

    return rows


def _collect(contacts: Iterator[PadContact | LargeStrainContact]) -> list[list[float]]:
    """Share and depth of contacts, up to the first that is refused."""
    found: list[list[float]] = []
    with suppress(TraceError):
        for contact in contacts:
            found.append([round(contact.share, 4), round(contact.depth_mm, 4)])

    return found


def _row(title: str, texts: list[str], width: int = 7) -> str:
    return f"{title:<30}" + "".join(f"{text:>{width}}" for text in texts)


def _list_row_lines(survey: PadSurvey, fit: str = "") -> list[str]:
    from fingertip.pad.survey import FORCE_N

    turn_on = [f"{force:.2f}" if force < math.inf else "never" for force in survey.turn_on_n]
    title = f"{fit}share" if fit else f"share of {FORCE_N:g} N"
    return [
        _row(title, [f"{share:.2f}" for share in survey.shares]),
        _row("force at turn-on [N]", turn_on),
    ]


def _list_lines(name: str, form: PadForm, survey: PadSurvey) -> list[str]:
    from fingertip.pad.survey import FIRM_N, FORCE_N, ROLL_DEG, ROLLED_TILT_DEG, TILTS_DEG

    return [
        f"{name}: what the sensor feels on a flat plate (layer model, {form.young_mpa:.2g} MPa)",
        _row("tilt, tip down [deg]", [f"{tilt:g}" for tilt in TILTS_DEG]),
        *_list_row_lines(survey),
        f"share at a roll of {ROLL_DEG:g} deg and a tilt of {ROLLED_TILT_DEG:g}: "
        f"{survey.rolled_share:.2f}",
        "evenness, least over largest share at the tilts of 0 to 10 deg above: "
        f"{survey.evenness:.2f}",
        f"at a tilt of {ROLLED_TILT_DEG:g} deg: slope of the force over the depth "
        f"{survey.stiffness_n_per_mm:.1f} N/mm "
        f"at {FORCE_N:g} N, depth {survey.strain:.0%} of the silicone there at {FIRM_N:g} N",
        f"turn-on: {form.turn_on_n:g} N on the active area of a typical sensor; others differ by "
        "a factor of 2 to 8",
        *(
            ["such a strain is not small: --large-strain states what it changes"]
            if survey.strain > _DEPTH
            else []
        ),
    ]
