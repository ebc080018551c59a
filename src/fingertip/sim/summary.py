"""What a simulation came to, in few words and as data."""

from __future__ import annotations

from typing import Any

import numpy as np

from fingertip.sim.contact.surfaces import SURFACES
from fingertip.sim.hand.manipulated import Manipulated
from fingertip.sim.stages.result import Simulated
from fingertip.slip.intervals import Interval, intervals


def as_data(found: Simulated | Manipulated) -> dict[str, Any]:
    """Plain mappings and lists, for JSON. Keys carry their units."""
    data = {
        "scene": found.scene.scene,
        "columns": ["time_s", *found.columns],
        "samples": len(found.time_s),
        "sample_rate_hz": round(1 / float(found.time_s[1] - found.time_s[0]), 6),
        "duration_s": round(float(found.time_s[-1]), 7),
        "force_n": round(found.force_n, 6),
        "seed": found.seed,
        "stages": [{"name": r.name, "states": r.states, "evaluations": r.evaluations} for r in found.ran],
        "slips": [{"onset_s": round(s.onset_s, 7), "end_s": round(s.end_s, 7)} for s in _slips(found)],
    }
    if isinstance(found, Simulated):
        slide = found.scene.slide
        own: dict[str, Any] = {"speed_m_s": slide.speed_m_s if slide.distance_m else 0.0}
        return data | {"surface": found.scene.contact.surface} | own
    held = found.scene.object
    return data | {
        "surface": held.surface,
        "speed_m_s": found.scene.knock.speed_m_s,
        "mass_kg": held.mass_kg,
        "grasp": found.scene.grasp.kind,
        "fingers": {name: round(f, 6) for name, f in zip(found.fingers, found.plan.force_n.tolist(), strict=True)},
        "knock_s": round(found.plan.knock_s, 7) if found.plan.pin else None,
        "held": found.lost_s is None,
        "lost_s": None if found.lost_s is None else round(found.lost_s, 7),
        "moved_m": round(float(found.signals["object_m"][-1]), 9),
    }


def as_text(found: Simulated | Manipulated) -> list[str]:
    """A line each."""
    size = f"seed {found.seed}: {len(found.time_s)} samples, {found.time_s[-1]:.2f} s"
    slips = [f"gross slip from {s.onset_s:.4f} s to {s.end_s:.4f} s" for s in _slips(found)]
    if isinstance(found, Simulated):
        scene = found.scene
        what = f"{SURFACES[scene.contact.surface].label}, {scene.slide.speed_m_s:g} m/s"
        return [f"{what if scene.slide.distance_m else scene.scene}, {found.force_n:.2f} N, {size}", *slips]
    held = found.scene.object
    what = f"{1000 * held.mass_kg:g} g of {SURFACES[held.surface].label}, {found.scene.grasp.kind} grasp"
    end = "held" if found.lost_s is None else f"left the fingers at {found.lost_s:.4f} s"
    moved = f"the object moved by {1000 * found.signals['object_m'][-1]:.1f} mm and was {end}"
    knock = [f"knock at {found.plan.knock_s:.4f} s"] if found.plan.pin else []
    slips = [f"thumb: {words}" for words in slips]
    moved = moved if found.lost_s is None else moved.replace("and was", "and")
    return [f"{what}, thumb {found.force_n:.2f} N, {size}", *knock, *slips, moved]


def _slips(found: Simulated | Manipulated) -> tuple[Interval, ...]:
    if "slip" not in found.columns:
        return ()
    return tuple(intervals(found.time_s, found.columns["slip"].astype(np.bool_)))
