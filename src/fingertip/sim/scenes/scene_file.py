"""A scene file: what one fingertip goes through, and which signals are wanted of it. Strict like a design file."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar

from pydantic import ConfigDict

from fingertip.errors import Issue
from fingertip.sim.scenes.scene_sections import Cable, Contact, Drift, Hold, LoadChange, Motor, Sensing, Slide, Tap
from fingertip.sim.scenes.simulation_file import StrictFile

OUTPUTS = (
    "voltage_v",
    "force_n",
    "slip",
    "velocity_m_s",
    "shear_m",
    "tactile_v",
    "filtered_v",
    "envelope_v",
    "slip_pin_v",
)
"""voltage_v: sampled; force_n: true normal force; slip: true gross slip, without the bending of bristles that stick;
velocity_m_s: of the pad over the surface, with it; shear_m: of the pad; tactile_v: ahead of converter and filter board;
filtered_v, envelope_v: of the filter board, above the level at which it rests; slip_pin_v: of the comparator's output,
low while it says slip."""


class SceneFile(StrictFile):
    """One scene, validated: all issues at once.

    Raises
    ------
    TraceError
        With one sentence for each parameter out of bounds, unknown name or broken rule.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, title="fingertip scene")
    known_outputs: ClassVar[tuple[str, ...]] = OUTPUTS

    contact: Contact = Contact()
    hold: Hold = Hold()
    slide: Slide = Slide()
    load_change: LoadChange = LoadChange()
    tap: Tap = Tap()
    motor: Motor = Motor()
    drift: Drift = Drift()
    cable: Cable = Cable()
    sensing: Sensing = Sensing()

    def __init__(self, **tables: Any) -> None:
        super().__init__(**tables)

    def broken(self) -> Iterator[tuple[Issue, set[str]]]:
        """Rules between parameters that do not hold, and the parameters each reads."""
        yield from super().broken()
        hold, slide, tap = self.hold, self.slide, self.tap
        if hold.min_force_n > hold.max_force_n:
            sentence = f"{hold.min_force_n:g} N is above hold.max_force_n; at most {hold.max_force_n:g} N."
            yield Issue("hold.min_force_n", sentence), {"hold.min_force_n", "hold.max_force_n"}
        if slide.distance_m > self.contact.length_m:
            sentence = f"{slide.distance_m:g} m is longer than contact.length_m; at most {self.contact.length_m:g} m."
            yield Issue("slide.distance_m", sentence), {"slide.distance_m", "contact.length_m"}
        if tap.force_n and tap.count > 1 and tap.interval_s < 2 * tap.rise_s:
            sentence = f"{tap.interval_s:g} s lets taps overlap; at least {2 * tap.rise_s:g} s."
            yield Issue("tap.interval_s", sentence), {"tap.interval_s", "tap.rise_s", "tap.count"}
        minimum = hold.min_force_n * (hold.share if hold.mode == "grasp" else 1.0)
        if self.load_change.by_n <= -minimum:
            sentence = f"{self.load_change.by_n:g} N ends the contact; above {-minimum:g} N, or use hold.release."
            yield Issue("load_change.by_n", sentence), {"load_change.by_n", "hold.min_force_n", "hold.share"}
