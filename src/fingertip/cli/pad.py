"""Command `fingertip pad`: the part of a force that reaches the sensor, by pose."""

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
"""Largest strain, and indentation over thickness, without a comment on small strains."""
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
    from fingertip.catalogues.stated_errors import list_pad_errors, to_entries
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
    errors = list_pad_errors(bonded=form.bonded)
    data["errors"] = to_entries(errors)
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
            f"the skin lies on the bone without a bond (skin.made=encapsulated compares); {at_rest}"
        )

    lines.append(
        f"silicone over the sensor resonates at {data['own_mode_hz']:.0f} Hz; simulations leave "
        "its mass out"
    )
    lines += [error.line for error in errors]
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
    worst: dict[str, float] = {}

    for is_fine in (False, True)[: 1 + refine]:
        console.progress(
            ShareText(f"finite elements{', finer mesh' if is_fine else ''}", 0.5 * is_fine)
        )
        contacts = _press(form, is_fine)
        name = "fem_refined" if is_fine else "fem"
        title = "finite elements, edges 0.7" if is_fine else "the same, finite elements"
        data[name] = [contact and _round_contact(contact) for contact in contacts]
        shares = [f"{contact.share:.2f}" if contact else "-" for contact in contacts]
        lines.insert(3 + is_fine, _row(title, shares))

        bonded = [contact for contact in contacts if contact and form.bonded]
        worst = {}
        if bonded:
            worst = {
                figure: max(getattr(contact, figure) for contact in bonded) for figure in _WORST
            }

        data[f"{name}_worst"] = {figure: round(value, 4) for figure, value in worst.items()}
        is_refused = None in contacts

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


def _round_contact(contact: PadContact | LargeStrainContact) -> dict[str, float]:
    return {"share": round(contact.share, 4), "depth_mm": round(contact.depth_mm, 4)}


def _list_large_strain(rows: list[dict[str, Any]], friction: float) -> list[str]:
    titles = {
        "small": "small strain",
        "large": "large strain",
        "friction": f"with friction of {friction:g}",
    }
    poses = [f"{row['force_n']:g} N, {row['tilt_deg']:g} deg" for row in rows]
    lines = [
        f"finite elements, edges of {_COARSE_MM:g} mm:",
        _row("share and depth [mm]", poses, 17),
    ]
    is_refused = False

    for name, title in titles.items():
        contacts = [row[name] for row in rows]
        texts = [f"{contact[0]:.3f}  {contact[1]:.3f}" if contact else "-" for contact in contacts]
        lines.append(_row(title, texts, 17))
        is_refused = is_refused or not all(contacts)

    return [*lines, _REFUSED] if is_refused else lines


def _press(form: PadForm, is_fine: bool) -> list[PadContact | LargeStrainContact | None]:
    """Press the pad by finite elements at the survey's tilts; None where they refuse.

    A skin that lies on the bone is pressed at large strain, with its friction inside and on the
    plate.
    """
    from fingertip.pad.fem_contact import PadModel, Patch
    from fingertip.pad.fem_large_strain import press_large_strain
    from fingertip.pad.fem_mesh import MeshSize
    from fingertip.pad.survey import FORCE_N, TILTS_DEG
    from fingertip.pad.touch import Pose

    size = MeshSize() if form.bonded else MeshSize(_LYING_MM)
    if is_fine:
        size = replace(size, edge_mm=_REFINED * size.edge_mm)

    model = PadModel(form, size, is_half=True)
    contacts: list[PadContact | LargeStrainContact | None] = []

    for tilt in TILTS_DEG:
        pose = Pose(tilt)
        try:
            if form.bonded:
                contacts.append(Patch(model, pose).press(FORCE_N))
            else:
                contacts.append(next(press_large_strain(model, pose, (FORCE_N,), form.friction)))
        except TraceError:
            contacts.append(None)

    return contacts


def _compare_large_strain(console: Console, form: PadForm, friction: float) -> list[dict[str, Any]]:
    """Press with a usual and a firm force, at small and large strain; None if refused."""
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
        pose = Pose(tilt)
        patch = Patch(model, pose)
        small = (patch.press(force, with_strain=False) for force in forces)
        methods = {
            "small": _collect(small) if form.bonded else [],
            "large": _collect(press_large_strain(model, pose, forces)),
            "friction": _collect(press_large_strain(model, pose, forces, friction)),
        }

        for index, force in enumerate(forces):
            contacts = {
                name: results[index] if index < len(results) else None
                for name, results in methods.items()
            }
            rows.append({"tilt_deg": tilt, "force_n": force, **contacts})

    return rows


def _collect(contacts: Iterator[PadContact | LargeStrainContact]) -> list[list[float]]:
    """Return share and depth of contacts, up to the first that is refused."""
    rows: list[list[float]] = []
    with suppress(TraceError):
        for contact in contacts:
            rows.append([round(contact.share, 4), round(contact.depth_mm, 4)])

    return rows


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
