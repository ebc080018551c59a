"""Summary of a simulation, as text and as data."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from fingertip.foundation.files import round_for_output
from fingertip.sim.contact.surface_files import SurfaceTable
from fingertip.sim.runs.scene import SceneRecord
from fingertip.sim.signal.grid import TARGETS
from fingertip.slip.traces.truth import STICK_S, merge

if TYPE_CHECKING:
    from fingertip.design import Design
    from fingertip.sim.runs.manipulation import ManipulationResult
    from fingertip.sim.simulation import Simulation


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


_NAMES = {
    "force_n": ("force", "N", ""),
    "tactile_v": ("voltage", "V", " ahead of the converter"),
    "envelope_v": ("envelope", "V", ""),
}
"""Signal whose error is stated -> its name, its unit, and where it is taken."""


@dataclass(frozen=True)
class Cost:
    """Time that a simulation took, and the errors of its time step."""

    computed_s: float
    step_s: float
    errors: Mapping[str, float] = field(default_factory=dict)
    """Signal -> bound of its error [N, V]."""
    compared_s: float | None = None
    """Time of the comparison with half the step, whose errors these are.
    None: they are the targets.
    """

    def as_data(self) -> dict[str, Any]:
        basis = "95 % of runs" if self.compared_s is None else "half the step"
        return {
            "computed_s": round(self.computed_s, 3),
            "step_s": round(self.step_s, 9),
            "errors": {name: float(f"{error:.2g}") for name, error in self.errors.items()},
            "errors_from": basis if self.errors else None,
        }

    def as_text(self) -> str:
        """Return one line."""
        text = f"computed in {self.computed_s:.2g} s with steps of {1e6 * self.step_s:.3g} us"
        bounds = []
        for signal, error in self.errors.items():
            name, unit, place = _NAMES[signal]
            bounds.append(f"{name} within {error:.1e} {unit}{place}")

        if not bounds:
            return text

        basis = "in at least 95 % of runs; --verbose measures this one"
        if self.compared_s is not None:
            basis = f"by half the step, in {self.compared_s:.2g} s more"

        return f"{text}: {', '.join(bounds)}, {basis}"


def list_error_signals(simulation: Simulation) -> list[str]:
    """List the signals behind the outputs of a simulation whose errors can be stated."""
    outputs = {*simulation.scene.outputs}
    if "voltage_v" in outputs:
        outputs.add("tactile_v")

    return [signal for signal in TARGETS if signal in outputs]


def has_target(design: Design, signal: str) -> bool:
    """True unless it is an envelope of the board `article`, whose amplifier can reverse."""
    return signal != "envelope_v" or design.board.variant != "article"


def find_targets(simulation: Simulation) -> dict[str, float]:
    """Return the targets of these signals."""
    signals = list_error_signals(simulation)
    return {name: TARGETS[name] for name in signals if has_target(simulation.design, name)}


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
