"""Picture of what the sensor feels: share of a force over its place on the pad, over tilt, and force over depth."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fingertip.design import Design
from fingertip.foundation.errors import TraceError
from fingertip.foundation.plot_style import RED, REFERENCE, SERIES, TEXT_COLOUR, new_figure, style_axes, to_png
from fingertip.pad.contacts import find_contacts, map_shares
from fingertip.pad.form import PadForm
from fingertip.pad.layer import Contact
from fingertip.pad.pose import Pose
from fingertip.pad.survey import survey_pad

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_FORCES_N = (0.3, 1.0, 3.0, 8.0)
_TILTS_DEG = tuple(float(tilt) for tilt in range(-5, 23))
_MARKED_DEG = (-5.0, 0.0, 5.0, 10.0, 15.0, 20.0)
_DEPTH_TILTS_DEG = (0.0, 10.0)


def draw_pad(design: Design) -> bytes:
    form, survey = PadForm.of_design(design), survey_pad(design)
    by_tilt = {tilt: _try(form, Pose(tilt), _FORCES_N) for tilt in _TILTS_DEG}
    figure = new_figure(14.0, 5.4)
    places, tilts, depths = figure.subplots(1, 3, width_ratios=[1.0, 1.7, 1.0])
    _draw_places(places, form, by_tilt)
    _draw_tilts(tilts, form, by_tilt)
    _draw_depths(depths, form)
    grasp = survey.least_share(0.0, 10.0)
    figure.suptitle(f"{design.name}: what the sensor feels\n", x=0.01, ha="left", fontweight="bold", fontsize=13)
    text = f"tilts of 0 to 10°: at least {grasp:.0%} of 1 N reaches the sensor; {form.model}, {form.young_mpa:.2g} MPa"
    figure.text(0.01, 0.915, text, fontsize=10.5, color=TEXT_COLOUR)
    return to_png(figure)


def _try(form: PadForm, pose: Pose, forces_n: tuple[float, ...]) -> list[Contact]:
    """Find the contacts at these forces; none in a pose that cannot be."""
    try:
        return find_contacts(form, pose, forces_n, float("inf"))
    except TraceError:
        return []


def _draw_places(axes: Axes, form: PadForm, by_tilt: dict[float, list[Contact]]) -> None:
    """Draw the share of a force over its place on the pad, the sensor, and where a plate touches at some tilts."""
    x, dz, shares = map_shares(form)
    z = dz + form.sensor_z_mm
    on_pad = np.isfinite(form.skin_mm(*np.meshgrid(x, z, indexing="ij")))
    shown = np.where(on_pad, shares, np.nan)
    mesh = axes.pcolormesh(x, z, shown.T, cmap="YlGnBu", vmin=0.0, vmax=1.0, shading="nearest")
    bar = axes.figure.colorbar(mesh, ax=axes, shrink=0.75, location="left", pad=0.02)
    bar.set_label("share of a force on a small place")
    length = form.outer.spans[-1].z[2]
    outline = np.linspace(0.0, length, 200)
    half = np.array([form.outer.section.half_width * form.outer.scale_at(float(value)) for value in outline])
    for side in (-1.0, 1.0):
        axes.plot(side * half, outline, color=REFERENCE, linewidth=1.0)
    angle = np.linspace(0.0, 2.0 * np.pi, 90)
    radius = form.active_radius_mm
    axes.plot(radius * np.sin(angle), form.sensor_z_mm + radius * np.cos(angle), color=RED, linewidth=1.5)
    for tilt in _MARKED_DEG:
        if by_tilt[tilt]:
            at = by_tilt[tilt][1].centre_mm[1] + form.sensor_z_mm
            axes.plot([0.0], [at], "o", color="white", markeredgecolor="black", markersize=4)
            axes.annotate(f"{tilt:g}°", (0.0, at), (half.max() + 0.7, at), va="center", fontsize=8, color=TEXT_COLOUR)
    axes.set_aspect("equal")
    axes.set_xlim(-half.max() - 0.5, half.max() + 3.5)
    axes.set_title("place on the pad (ring: active area,\ndots: a plate at these tilts)", fontsize=11)
    axes.set_xlabel("across [mm]")
    axes.set_ylabel("distance from the collar [mm]")
    axes.spines[["top", "right"]].set_visible(False)


def _draw_tilts(axes: Axes, form: PadForm, by_tilt: dict[float, list[Contact]]) -> None:
    for number, (force, colour) in enumerate(zip(_FORCES_N, SERIES, strict=False)):
        shares = [found[number].share if found else np.nan for found in by_tilt.values()]
        axes.plot(_TILTS_DEG, shares, color=colour, label=f"{force:g} N")
    rolled = [_try(form, Pose(tilt, 10.0), (1.0,)) for tilt in _TILTS_DEG]
    shares = [found[0].share if found else np.nan for found in rolled]
    axes.plot(_TILTS_DEG, shares, color=SERIES[1], linestyle="--", label="1 N, rolled by 10°")
    axes.axvspan(0.0, 10.0, color=REFERENCE, alpha=0.15, linewidth=0.0)
    axes.set_ylim(0.0, 1.0)
    axes.set_title("share over tilt, on a plate (grey: a grasp)", fontsize=11)
    axes.set_xlabel("tilt, tip down [°]")
    axes.set_ylabel("share of the force that reaches the sensor")
    axes.legend(frameon=False, fontsize=9, ncols=2, loc="upper left")
    style_axes(axes, "both")


def _draw_depths(axes: Axes, form: PadForm) -> None:
    forces = tuple(float(force) for force in np.geomspace(0.05, 8.0, 12))
    for tilt, colour in zip(_DEPTH_TILTS_DEG, SERIES, strict=False):
        found = _try(form, Pose(tilt), forces)
        axes.plot(
            [0.0, *(c.depth_mm for c in found)], [0.0, *(c.force_n for c in found)], color=colour, label=f"{tilt:g}°"
        )
    axes.set_title("force over indentation", fontsize=11)
    axes.set_xlabel("indentation [mm]")
    axes.set_ylabel("force [N]")
    axes.legend(frameon=False, fontsize=9, title="tilt")
    style_axes(axes, "both")
