"""Summary of a simulation, as text and as data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from fingertip.sim.contact.surfaces import SURFACES
from fingertip.sim.hand.manipulation import ManipulationResult
from fingertip.sim.scene.run import SceneRecord
from fingertip.slip.intervals import STICK_S, merge


def as_data(result: SceneRecord | ManipulationResult, grips_s: Sequence[float] | None = None) -> dict[str, Any]:
    """Return the summary as plain mappings and lists, for JSON. Keys carry their units.

    Parameters
    ----------
    result
        Result of a simulation.
    grips_s
        Moments at which a controller tightened the grip [s]; None without a controller.
    """
    data = {
        "scene": result.scene.name,
        "columns": ["time_s", *result.column_names],
        "samples": result.samples,
        "sample_rate_hz": round(result.sample_rate_hz, 6),
        "duration_s": round(result.duration_s, 7),
        "force_n": round(result.force_n, 6),
        "seed": result.seed,
        "stages": [{"name": s.name, "states": s.states, "evaluations": s.evaluations} for s in result.stages],
        "slips": [{"onset_s": round(s.onset_s, 7), "end_s": round(s.end_s, 7)} for s in result.slips],
    }
    if isinstance(result, SceneRecord):
        slide = result.scene.slide
        speed = slide.speed_m_s if slide.distance_m else 0.0
        return data | {"surface": result.scene.contact.surface, "speed_m_s": speed}
    target, plan = result.scene.object, result.plan
    data |= {
        "surface": target.surface,
        "speed_m_s": result.scene.knock.speed_m_s,
        "mass_kg": target.mass_kg,
        "grasp": result.scene.grasp.kind,
        "fingers": {name: round(f, 6) for name, f in zip(result.fingers, plan.force_n.tolist(), strict=True)},
        "knock_s": round(plan.knock_s, 7) if plan.pin else None,
        "held": result.lost_s is None,
        "lost_s": None if result.lost_s is None else round(result.lost_s, 7),
        "moved_m": round(float(result.signals.object_m[-1]), 9),
    }
    return data if grips_s is None else data | {"grips_s": [*grips_s]}


def as_text(result: SceneRecord | ManipulationResult, grips_s: Sequence[float] | None = None) -> list[str]:
    """Return the summary as lines of text. The parameters are those of `as_data`.

    Slips that are no further apart than `STICK_S` are one line, as `fingertip detect` counts them.
    """
    size = f"seed {result.seed}: {result.samples} samples, {result.duration_s:.2f} s"
    slips = [f"gross slip from {s.onset_s:.4f} s to {s.end_s:.4f} s" for s in merge(result.slips, STICK_S)]
    if isinstance(result, SceneRecord):
        scene = result.scene
        slides = scene.slide.distance_m > 0.0
        title = f"{_describe_surface(scene.contact.surface)}, {scene.slide.speed_m_s:g} m/s" if slides else scene.name
        return [f"{title}, {result.force_n:.2f} N, {size}", *slips]
    target = result.scene.object
    surface = _describe_surface(target.surface)
    title = f"object: {surface}, {1000 * target.mass_kg:g} g, {result.scene.grasp.kind} grasp"
    moved = f"the object moved by {1000 * result.signals.object_m[-1]:.1f} mm"
    end = "was held" if result.lost_s is None else f"left the fingers at {result.lost_s:.4f} s"
    lines = [f"{title}, thumb {result.force_n:.2f} N, {size}"]
    lines += [f"knock at {result.plan.knock_s:.4f} s"] if result.plan.pin else []
    lines += [f"thumb: {slip}" for slip in slips]
    lines.append(f"{moved} and {end}")
    if grips_s is not None:
        times = ", ".join(f"{at:.2f} s" for at in grips_s)
        lines.append(
            f"the controller tightened the grip at {times}" if times else "the controller never tightened the grip"
        )
    return lines


def _describe_surface(name: str) -> str:
    label = SURFACES[name].label
    return name if label == name else f"{name} ({label})"
