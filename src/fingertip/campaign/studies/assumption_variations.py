"""Changes of the simulation's assumptions: parameters of scene and design, and the values or factors they take."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from fingertip.design import Design
from fingertip.sim import SceneFile
from fingertip.slip.detectors.noise import noise_level

_SCENE = "scene."


@dataclass(frozen=True)
class Factor:
    """Factor of the value that a parameter has already."""

    by: float


Change: TypeAlias = "bool | int | float | str | Factor"


@dataclass(frozen=True)
class Variation:
    """Assumption that is changed, by one parameter or by several that belong together."""

    label: str
    changes: Mapping[str, Change]
    """Dotted parameter -> its value, or the factor of its value. `scene.` precedes parameters of the scene, as in a
    sweep; the others are the design's."""
    is_realistic: bool = False
    """True for an effect that real fingers show and the trials leave out by default."""

    def vary_scene(self, scene: SceneFile) -> SceneFile:
        """Return a scene with the changes of its parameters."""
        changes = {name.removeprefix(_SCENE): to for name, to in self.changes.items() if name.startswith(_SCENE)}
        return SceneFile(**_apply(scene.model_dump(), changes)) if changes else scene

    def vary_design(self, design: Design) -> Design:
        """Return a design with the changes of its parameters.

        The threshold changes by the same ratio as the one that the design's noise allows, as a user would set it.
        """
        changes = {name: to for name, to in self.changes.items() if not name.startswith(_SCENE)}
        if not changes:
            return design
        tables = _apply(design.model_dump(), changes)
        before, after = noise_level(design).threshold_v, noise_level(Design(**tables)).threshold_v
        if before > 0.0 and after > 0.0:
            tables["detector"]["threshold_v"] *= after / before
        return Design(**tables)


def _apply(tables: dict[str, Any], changes: Mapping[str, Change]) -> dict[str, Any]:
    """Change parameters of tables in place, and return the tables."""
    for name, change in changes.items():
        table, _, key = name.partition(".")
        tables[table][key] = tables[table][key] * change.by if isinstance(change, Factor) else change
    return tables


def change_converter(bits: int, high_v: float) -> dict[str, Change]:
    """Parameters of a converter from 0 V to `high_v` [V], in the scene and in the design.

    A user of this converter states it in the design, because the thresholds follow from the design's noise and step.
    The noise ahead of the converter stays the design's.
    """
    return {
        "scene.converter.bits": bits,
        "scene.converter.low_v": 0.0,
        "scene.converter.high_v": high_v,
        "detector.adc_bits": bits,
        "detector.adc_range_v": high_v,
        "detector.adc_polarity": "unipolar",
    }


LONG_WAIT_S = 10.0
"""Holding time before slip in which a detector can adapt to noise [s]; the article's trials hold for 1 s."""
HELD_LONGER = f"held for {LONG_WAIT_S:g} s"
PATCH_AVERAGE = "profile averaged over the contact patch"
STICK_SLIP = "stick-slip"
BOTH = "patch average and stick-slip"
ELASTO_PLASTIC = "elasto-plastic bristles"
"""Labels of variations whose results the report explains."""

VARIATIONS: tuple[Variation, ...] = (
    Variation("surface accelerates at 0.5 m/s2", {"scene.slide.acceleration_m_s2": Factor(0.5)}),
    Variation("surface accelerates at 4 m/s2", {"scene.slide.acceleration_m_s2": Factor(4.0)}),
    Variation("resonance 60 Hz", {"scene.contact.resonance_hz": Factor(60 / 90)}),
    Variation("resonance 135 Hz", {"scene.contact.resonance_hz": Factor(1.5)}),
    Variation("half the force", {"scene.hold.min_force_n": Factor(0.5), "scene.hold.max_force_n": Factor(0.5)}),
    Variation("half the noise", {"detector.noise_v": Factor(0.5)}),
    Variation("twice the noise", {"detector.noise_v": Factor(2.0)}),
    Variation("half the speed", {"scene.slide.speed_m_s": Factor(0.5)}),
    Variation(PATCH_AVERAGE, {"scene.contact.patch_average": True}, True),
    Variation(STICK_SLIP, {"scene.contact.stick_slip": True}, True),
    Variation(BOTH, {"scene.contact.patch_average": True, "scene.contact.stick_slip": True}, True),
    Variation(ELASTO_PLASTIC, {"scene.contact.bristles": "elasto_plastic"}, True),
    Variation("pink noise, 0.1 mV per decade", {"scene.noise.pink_v": 1e-4}, True),
    Variation("vibration of the hand, 0.1 mV", {"scene.noise.hand_v": 1e-4}, True),
    Variation("vibration of the hand, 0.5 mV", {"scene.noise.hand_v": 5e-4}, True),
    Variation(
        f"vibration of the hand, 0.5 mV, {HELD_LONGER}",
        {"scene.noise.hand_v": 5e-4, "scene.hold.wait_s": LONG_WAIT_S},
        True,
    ),
    Variation("mains hum of 1 mV at 50 Hz, and harmonics", {"scene.noise.hum_v": 1e-3}, True),
    Variation(
        f"mains hum of 1 mV at 50 Hz, and harmonics, {HELD_LONGER}",
        {"scene.noise.hum_v": 1e-3, "scene.hold.wait_s": LONG_WAIT_S},
        True,
    ),
    Variation("converter of 12 bits, 0 to 5 V", change_converter(12, 5.0), True),
    Variation("converter of 10 bits, 0 to 5 V", change_converter(10, 5.0), True),
)
