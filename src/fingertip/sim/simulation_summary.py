"""Summary of a simulation, as text and as data."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from fingertip.foundation.files import round_for_output
from fingertip.sim.contact.surface_files import SurfaceTable
from fingertip.sim.runs.scene import SceneRecord
from fingertip.slip.traces.truth import STICK_S, merge

if TYPE_CHECKING:
    from fingertip.sim.runs.manipulation import ManipulationResult


def as_data(
    result: SceneRecord | ManipulationResult, grips_s: Sequence[float] | None = None
) -> dict[str, Any]:
    """Return the summary as plain mappings and lists, for JSON. Keys carry their units."""
    data = {
        "scene": result.scene.name,
        "columns": [
            "time_s",
            *(result.scene.outputs if isinstance(result, SceneRecord) else result.columns),
        ],
        "samples": result.samples,
        "sample_rate_hz": round(result.sample_rate_hz, 6),
        "duration_s": round(result.duration_s, 7),
        "force_n": round(result.force_n, 6),
        "seed": result.seed,
        "stages": [
            {"name": s.name, "states": s.states, "evaluations": s.evaluations}
            for s in result.stages
        ],
        "slips": [
            {"onset_s": round(s.onset_s, 7), "end_s": round(s.end_s, 7)} for s in result.slips
        ],
    }
    if isinstance(result, SceneRecord):
        slide = result.scene.slide
        speed = slide.speed_m_s if slide.distance_m else 0.0
        pose = result.pose
        data |= {
            "tilt_deg": pose.tilt_deg,
            "roll_deg": pose.roll_deg,
            "sensor_share": round(result.sensor_share, 4),
        }
        return data | {"surface": result.scene.contact.surface, "speed_m_s": speed}

    target = result.scene.object
    plan = result.plan
    data |= {
        "surface": target.surface,
        "speed_m_s": result.scene.knock.speed_m_s,
        "mass_kg": target.mass_kg,
        "grasp": result.scene.grasp.kind,
        "fingers": dict(
            zip(result.fingers, map(round_for_output, plan.force_n.tolist()), strict=True)
        ),
        "knock_s": round(plan.knock_s, 7) if plan.pin else None,
        "held": result.lost_s is None,
        "lost_s": None if result.lost_s is None else round(result.lost_s, 7),
        "moved_m": round(float(result.signals.object_m[-1]), 9),
    }
    return data if grips_s is None else data | {"grips_s": [*grips_s]}


MAX_OUT_OF_CONTACT_SHARE = 0.02
"""Share of the slip out of contact up to which nothing is said.
The article's 120 trials, as simulated, have 0.012.
"""


def find_warnings(result: SceneRecord | ManipulationResult) -> Iterator[str]:
    """Yield a warning if a pad does not touch for much of its slip, or the board clips in it."""
    share = result.out_of_contact_share
    if share > MAX_OUT_OF_CONTACT_SHARE:
        what = (
            f"the pad leaves the surface for {share:.0%} of its slip, beyond any trial of the "
            "article"
        )
        table = "contact" if isinstance(result, SceneRecord) else "object"
        yield f"{what}: choose a smoother surface, or set {table}.patch_average=true in a scene"

    if result.clip_share:
        share_text = f"{max(result.clip_share, 0.001):.{0 if result.clip_share >= 0.01 else 1}%}"
        yield (
            f"the board clips in {share_text} of the slide: choose a smaller force, or lower "
            "board.passband_gain"
        )


def as_text(
    result: SceneRecord | ManipulationResult, grips_s: Sequence[float] | None = None
) -> list[str]:
    """Return the summary as lines of text.

    Slips within `STICK_S` are one line, as in `fingertip detect`.
    """
    size = f"seed {result.seed}: {result.samples} samples, {result.duration_s:.2f} s"
    slips = [
        f"gross slip from {s.onset_s:.4f} s to {s.end_s:.4f} s"
        for s in merge(result.slips, STICK_S)
    ]

    if isinstance(result, SceneRecord):
        scene = result.scene
        title = scene.name
        pose = result.pose

        if scene.slide.distance_m:
            title = (
                f"{_describe_surface(scene.contact.surface, scene.surface)}, "
                f"{scene.slide.speed_m_s:g} m/s"
            )

        turned = (
            f"tilt {pose.tilt_deg:g} degrees, roll {pose.roll_deg:g} degrees on a {pose.object}"
        )
        felt = f"{turned}: {result.sensor_share:.0%} of the force reaches the sensor"
        return [f"{title}, {result.force_n:.2f} N, {size}", felt, *slips]

    target = result.scene.object
    surface = _describe_surface(target.surface, result.scene.surface)
    title = f"object: {surface}, {1000 * target.mass_kg:g} g, {result.scene.grasp.kind} grasp"
    moved = f"the object moved by {1000 * result.signals.object_m[-1]:.1f} mm"
    end = "was held" if result.lost_s is None else f"left the fingers at {result.lost_s:.4f} s"
    lines = [f"{title}, thumb {result.force_n:.2f} N, {size}"]
    if has_event(result):
        lines.append(f"{name_event(result)} at {result.plan.knock_s:.4f} s")

    lines += [f"thumb: {slip}" for slip in slips]
    lines.append(f"{moved} and {end}")
    if grips_s is not None:
        times = ", ".join(f"{at:.2f} s" for at in grips_s)
        lines.append(
            "the controller "
            f"{f'tightened the grip at {times}' if times else 'never tightened the grip'}"
        )

    return lines


def has_event(result: ManipulationResult) -> bool:
    """Return whether a pin comes, and while the fingers hold the object."""
    return result.plan.pin is not None and not (
        result.lost_s and result.lost_s < result.plan.knock_s
    )


def name_event(result: ManipulationResult) -> str:
    return "pull" if result.scene.knock.attached else "knock"


def _describe_surface(name: str, table: SurfaceTable) -> str:
    material = table.complete(name).material
    return material if table.material or material == name else f"{name} ({material})"
