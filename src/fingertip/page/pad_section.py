"""Picture of what the sensor feels: share by place and tilt, force over depth."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from fingertip.catalogues.stated_errors import list_pad_errors
from fingertip.design import Design
from fingertip.models.making import making_of
from fingertip.pad.layer import Contact, map_shares
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.survey import (
    FORCE_N,
    GRASP_DEG,
    ROLL_DEG,
    TILTS_DEG,
    PadSurvey,
    survey_pad,
    try_contacts,
)
from fingertip.pad.touch import Pose
from fingertip.page.html import Markup, element, figure, join
from fingertip.page.svg import Axis, Frame, figure_svg, legend, number, text

_COLOURS = {
    0.3: "var(--series-3)",
    FORCE_N: "var(--series-1)",
    3.0: "var(--series-2)",
    8.0: "var(--slip)",
}
"""Force on the plate [N] -> colour of its curve."""
_DEPTH_COLOURS = {0.0: "var(--series-1)", 10.0: "var(--series-2)"}
"""Tilt [deg] -> colour of its force over indentation."""
_MARKED_DEG = (-5, 0, 5, 10, 15, 20)
_CELL_MM = 0.75
_LEAST_SHOWN = 0.02
_WIDTH = 680.0
_HEIGHT = 590.0
_LEFT = 45.0
_TOP = 88.0
_BOTTOM = 508.0
_MAP_WIDTH = 230.0
_PLOT_LEFT = 340.0
_PLOT_WIDTH = 325.0
_PLOT_BOTTOM = 313.0
_DEPTH_TOP = 385.0
_LINE = 18.0
"""Distance of two lines of text [px]."""


def render_pad(design: Design, still_wanted: Callable[[], None] = lambda: None) -> Markup:
    survey = survey_pad(design)
    form = PadForm.of_design(design)
    grasp = f"{GRASP_DEG[0]:g} to {GRASP_DEG[1]:g}"
    turn_on = max(survey.turn_on_n[1:5])
    summary = (
        f"At tilts of {grasp} degrees at least {survey.least_share(*GRASP_DEG):.0%} of a force of "
        f"{FORCE_N:g} N on a "
        "flat plate reaches the sensor; it turns on at "
        f"{f'{turn_on:.2g} N' if turn_on < math.inf else 'no force'} "
        f"at the worst of them. Rolled by {ROLL_DEG:g} degrees it gets {survey.rolled_share:.0%}. "
        f"Computed by the layer model, with silicone of {form.young_mpa:.2g} MPa on rigid bone."
    )

    errors = list_pad_errors(bonded=making_of(design).is_bonded)
    known = join(element("p", f"Error of {error.line}.") for error in errors)
    return join(
        (
            element("p", summary),
            known,
            figure(draw_pad(design, still_wanted), "", "what the sensor feels"),
        )
    )


def draw_pad(design: Design, still_wanted: Callable[[], None] = lambda: None) -> Markup:
    """Draw the share of a force by place and tilt, and the force over the indentation."""
    form = PadForm.of_design(design)
    by_tilt = dict[float, list[Contact]]()
    rolled = dict[float, list[Contact]]()

    for tilt in sorted({*range(int(TILTS_DEG[0]), int(TILTS_DEG[-1]) + 1, 2), *_MARKED_DEG}):
        still_wanted()
        by_tilt[tilt] = try_contacts(form, Pose(tilt), *_COLOURS)
        rolled[tilt] = try_contacts(form, Pose(tilt, ROLL_DEG), FORCE_N)

    title = (
        f"{design.name}: what the sensor feels on a flat plate (layer model, "
        f"{form.young_mpa:.2g} MPa)"
    )
    parts = [
        *_draw_places(form, by_tilt),
        *_draw_tilts(survey_pad(design), by_tilt, rolled),
        *_draw_depths(form),
    ]
    return figure_svg(_WIDTH, _HEIGHT, title, text(_LEFT, _LINE, title, weight="bold"), *parts)


def _draw_places(form: PadForm, by_tilt: dict[float, list[Contact]]) -> Iterator[Markup]:
    """Draw the pad from the palmar side: share of a small force, active area, touches."""
    length = form.outer.spans[-1].z[2]
    half = form.outer.section.half_width
    scale = min((_BOTTOM - _TOP) / length, _MAP_WIDTH / (2 * half))
    across = Axis(-half, half, "across [mm]")
    along = Axis(0.0, length, "distance from the collar [mm]")
    frame = Frame(
        x=across,
        y=along,
        left=_LEFT,
        top=_BOTTOM - length * scale,
        width=2 * half * scale,
        height=length * scale,
    )
    yield text(_LEFT, _TOP - 44, "ring: active area of the sensor")
    yield text(_LEFT, _TOP - 44 + _LINE, "dots: where a plate touches, by tilt")
    yield frame.axes(ticks_y=7)
    x_mm, dz_mm, shares = map_shares(form)
    step = max(1, round(_CELL_MM / (x_mm[1] - x_mm[0])))
    size = number(_CELL_MM * scale + 0.2)

    for x, row in zip(x_mm[::step], shares[::step, ::step], strict=True):
        for z, share in zip(dz_mm[::step] + form.sensor_z_mm, row, strict=True):
            if share >= _LEAST_SHOWN and abs(x) < half * form.outer.scale_at(z):
                yield _shade(*frame.point(x - _CELL_MM / 2, z + _CELL_MM / 2), size, size, share)

    heights = [length * math.sin(math.pi * i / 120) for i in range(61)]
    for side in (-half, half):
        yield frame.line([(side * form.outer.scale_at(z), z) for z in heights], "var(--text)", 1.0)

    x, y = frame.point(0.0, form.sensor_z_mm)
    ring = {"cx": number(x), "cy": number(y), "r": number(form.active_radius_mm * scale)}
    yield element("circle", **ring, fill="none", stroke="var(--series-2)", stroke_width=2)
    last_label = math.inf

    for tilt in _MARKED_DEG:
        if by_tilt[tilt]:
            y = frame.point(0.0, by_tilt[tilt][1].centre_mm[1] + form.sensor_z_mm)[1]
            yield _dot(x, y, "var(--ground)", f"{tilt:g}°")
            if abs(y - last_label) >= 12.0:  # px, so that no label lies on another
                yield text(frame.left + frame.width + 6, y + 4, f"{tilt:g}°")
                last_label = y

    yield text(_LEFT, _HEIGHT - 24, "share of a force on a small place:")
    for i in range(5):
        yield _shade(
            _LEFT + 46 * i,
            y=_HEIGHT - 16,
            width="14",
            height="12",
            share=0.2 * (i + 1),
        )
        yield text(_LEFT + 46 * i + 18, _HEIGHT - 6, f"{0.2 * (i + 1):.1f}")


def _draw_tilts(
    survey: PadSurvey, by_tilt: dict[float, list[Contact]], rolled: dict[float, list[Contact]]
) -> Iterator[Markup]:
    shares = Axis(0.0, 1.0, "share of the force that reaches the sensor")
    tilts = Axis(TILTS_DEG[0], TILTS_DEG[-1], "tilt of the finger, tip down [degrees]")
    frame = Frame(
        x=tilts,
        y=shares,
        left=_PLOT_LEFT,
        top=_TOP,
        width=_PLOT_WIDTH,
        height=_PLOT_BOTTOM - _TOP,
    )
    names = [(colour, "", f"{force:g} N") for force, colour in _COLOURS.items()]
    curves = [(_list_shares(rolled, 0), _COLOURS[FORCE_N], 1.5, "6 4")]
    for i, colour in enumerate(_COLOURS.values()):
        curves.append((_list_shares(by_tilt, i), colour, 2.0, ""))

    rolled_name = (_COLOURS[FORCE_N], "6 4", f"{FORCE_N:g} N, rolled by {ROLL_DEG:g}°")
    yield legend(_PLOT_LEFT, _TOP - 44, names)
    yield legend(_PLOT_LEFT, _TOP - 44 + _LINE, (rolled_name, ("var(--band)", "band", "checked")))
    yield frame.axes()
    yield frame.span(*GRASP_DEG, "var(--band)")
    yield from (frame.line(*curve) for curve in curves if curve[0])

    for tilt, share in zip(TILTS_DEG, survey.shares, strict=True):
        yield _dot(
            *frame.point(tilt, share),
            _COLOURS[FORCE_N],
            f"share {share:.4f} at a tilt of {tilt:g}°",
        )


def _list_shares(by_tilt: dict[float, list[Contact]], index: int) -> list[tuple[float, float]]:
    """List tilt and share of one of the forces, where the pad has a contact."""
    return [(tilt, contacts[index].share) for tilt, contacts in by_tilt.items() if contacts]


def _draw_depths(form: PadForm) -> list[Markup]:
    forces = np.geomspace(0.05, max(_COLOURS), 12).tolist()
    by_tilt = {
        tilt: [
            (contact.depth_mm, contact.force_n)
            for contact in try_contacts(form, Pose(tilt), *forces)
        ]
        for tilt in _DEPTH_COLOURS
    }
    deepest = max((points[-1][0] for points in by_tilt.values() if points), default=1.0)
    frame = Frame(
        x=Axis(0.0, deepest, "indentation [mm]"),
        y=Axis(0.0, max(_COLOURS), "force [N]"),
        left=_PLOT_LEFT,
        top=_DEPTH_TOP,
        width=_PLOT_WIDTH,
        height=_BOTTOM - _DEPTH_TOP,
    )
    names = [(colour, "", f"at a tilt of {tilt:g}°") for tilt, colour in _DEPTH_COLOURS.items()]
    curves = [
        frame.line([(0.0, 0.0), *by_tilt[tilt]], colour, 2.0)
        for tilt, colour in _DEPTH_COLOURS.items()
    ]

    return [frame.axes(), legend(_PLOT_LEFT + 70, _DEPTH_TOP - 8, names), *curves]


def _dot(x: float, y: float, colour: str, title: str) -> Markup:
    return element(
        "circle",
        element("title", title),
        cx=number(x),
        cy=number(y),
        r=3.5,
        fill=colour,
        stroke="var(--text)",
    )


def _shade(
    x: float,
    y: float,
    width: str,
    height: str,
    share: float,
) -> Markup:
    size = {"width": width, "height": height}
    return element(
        "rect",
        x=number(x),
        y=number(y),
        **size,
        fill="var(--series-1)",
        fill_opacity=f"{share:.2f}",
    )
