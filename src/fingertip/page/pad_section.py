"""Section of the page: what the sensor feels, over the place of a force on the pad and over the tilt of the finger."""

from __future__ import annotations

import math

from fingertip.design import Design
from fingertip.pad.contacts import map_shares
from fingertip.pad.form import PadForm
from fingertip.pad.survey import FORCE_N, GRASP_DEG, TILTS_DEG, survey_pad
from fingertip.page.html import Markup, element, join
from fingertip.page.svg import Axis, Frame, figure_svg, line, number, text

_PX_PER_MM = 8.0
_CELL_MM = 0.75
_LEAST_SHOWN = 0.02
_LEFT, _TOP, _GAP, _PLOT_WIDTH = 70.0, 30.0, 110.0, 420.0


def render_pad(design: Design) -> Markup:
    """Render a map of the pad and a plot of the share over tilt, computed by the layer model."""
    survey, form = survey_pad(design), PadForm.of_design(design)
    least = survey.least_share(*GRASP_DEG)
    grasp = f"{GRASP_DEG[0]:g} to {GRASP_DEG[1]:g}"
    turn_on = _format_force(max(survey.turn_on_n[1:5]))
    said = (
        f"At tilts of {grasp} degrees at least {least:.0%} of a force of {FORCE_N:g} N on a flat plate reaches the "
        f"sensor, and it turns on at {turn_on} at the latest; rolled by 10 degrees it gets {survey.rolled_share:.0%}. "
        f"Computed by the {form.model}, with silicone of {form.young_mpa:.2g} MPa on rigid bone."
    )
    length, half = form.outer.spans[-1].z[2], form.outer.section.half_width
    width = 2 * half * _PX_PER_MM
    height = length * _PX_PER_MM
    shares = Axis(0.0, 1.0, f"share of {FORCE_N:g} N that reaches the sensor")
    frame = Frame(
        Axis(TILTS_DEG[0], TILTS_DEG[-1], "tilt of the finger, tip down [degrees]"), shares,
        _LEFT + width + _GAP, _TOP, _PLOT_WIDTH, height - 20.0,
    )  # fmt: skip
    points = list(zip(TILTS_DEG, survey.shares, strict=True))
    plot = [frame.axes(), frame.span(*GRASP_DEG, "var(--band)", 0.45), frame.line(points, "var(--series-1)", 2.0)]
    plot += [_dot(*frame.point(*point), "var(--series-1)") for point in points]
    whole = _LEFT + width + _GAP + _PLOT_WIDTH + 20.0
    title = "What the sensor feels: share of a force by its place on the pad, and by the tilt of the finger"
    return join((
        element("p", said),
        figure_svg(whole, _TOP + height + 40.0, title, *_draw_places(form, half, length), *plot),
    ))  # fmt: skip


def _format_force(force_n: float) -> str:
    return "no force" if force_n == math.inf else f"{force_n:.2g} N"


def _draw_places(form: PadForm, half: float, length: float) -> list[Markup]:
    """Draw the pad from the palmar side, tip up: the share of a force on a small place, and the active area."""

    def place(x: float, z: float) -> tuple[float, float]:
        return _LEFT + (x + half) * _PX_PER_MM, _TOP + (length - z) * _PX_PER_MM

    heights = [length * i / 60 for i in range(61)]
    widths = [form.outer.section.half_width * form.outer.scale_at(z) for z in heights]
    outline = [place(w, z) for w, z in zip(widths, heights, strict=True)]
    outline += [place(-w, z) for w, z in zip(reversed(widths), reversed(heights), strict=True)]
    d = "M" + "L".join(f"{number(x)} {number(y)}" for x, y in outline) + "Z"
    x_mm, dz_mm, shares = map_shares(form)
    step = max(1, round(_CELL_MM / (x_mm[1] - x_mm[0])))
    size = number(_CELL_MM * _PX_PER_MM + 0.2)
    cells = []
    for i in range(0, len(x_mm), step):
        for j in range(0, len(dz_mm), step):
            x, z, share = float(x_mm[i]), float(dz_mm[j]) + form.sensor_z_mm, float(shares[i, j])
            if share >= _LEAST_SHOWN and abs(x) < form.outer.section.half_width * form.outer.scale_at(z):
                px, py = place(x - _CELL_MM / 2, z + _CELL_MM / 2)
                cells.append(
                    element("rect", x=number(px), y=number(py), width=size, height=size, fill="var(--series-1)",
                            fill_opacity=f"{share:.2f}")
                )  # fmt: skip
    centre = place(0.0, form.sensor_z_mm)
    ring = element(
        "circle", cx=number(centre[0]), cy=number(centre[1]), r=number(form.active_radius_mm * _PX_PER_MM),
        fill="none", stroke="var(--series-3)", stroke_width=2,
    )  # fmt: skip
    low = place(-half, 0.0)
    return [
        element("path", d=d, fill="none", stroke="var(--text)", stroke_width=1), *cells, ring,
        line(low, place(half, 0.0), "var(--text)", 1),
        text(centre[0], _TOP - 10, "place on the pad; ring: active area", "middle"),
        text(centre[0], low[1] + 17, "collar", "middle"),
    ]  # fmt: skip


def _dot(x: float, y: float, colour: str) -> Markup:
    return element("circle", cx=number(x), cy=number(y), r=3, fill=colour)
