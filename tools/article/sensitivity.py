"""Sensitivity of the delay to the simulation's assumptions, one at a time, on the same trials.

Among them are effects that real fingers show and that the trials leave out by default: a pad that
averages the surface over its contact patch, stick-slip, noise that is not white, mains hum, and
converters of microcontrollers. Their levels are assumptions that nobody has verified.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, TypeAlias

import numpy as np

from fingertip.design import Design
from fingertip.foundation.workers import call_each
from fingertip.lab.campaign import run as campaign
from fingertip.lab.campaign.campaign import HELD_OUT_FROM, CampaignPlan, Case
from fingertip.pad.response import Backing
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.runs.scene_and_manipulation_files import SceneFile
from fingertip.slip.detectors.analog_and_digital import noise_level
from tools.article.steps import generate_limited_cases

_SCENE = "scene."


@dataclass(frozen=True)
class Factor:
    """Factor of the value that a parameter has already."""

    by: float


@dataclass(frozen=True)
class BySurface:
    """Value for each of some surfaces; on others a parameter keeps the value that it has."""

    values: Mapping[str, float]


Change: TypeAlias = "bool | int | float | str | Factor | BySurface"


@dataclass(frozen=True)
class Variation:
    """Assumption that is changed, by one parameter or by several that belong together."""

    label: str
    changes: Mapping[str, Change]
    """Dotted parameter of the design, or of the scene after `scene.`
    -> its value, or the factor of its value.
    """
    is_realistic: bool = False
    """True for an effect that real fingers show and the trials leave out by default."""
    is_law: bool = False
    """True for another law of friction and vibration in the contact,
    where no source settles which one is right.
    """

    def vary_scene(self, scene: SceneFile) -> SceneFile:
        changes = {
            name.removeprefix(_SCENE): to
            for name, to in self.changes.items()
            if name.startswith(_SCENE)
        }
        return SceneFile(**_apply(scene.model_dump(), changes)) if changes else scene

    def vary_design(self, design: Design) -> Design:
        """Return a changed design; its threshold changes by the
        same ratio as the noise-derived one.
        """
        changes = {name: to for name, to in self.changes.items() if not name.startswith(_SCENE)}
        if not changes:
            return design

        tables = _apply(design.model_dump(), changes)
        before = noise_level(design).threshold_v
        after = noise_level(Design(**tables)).threshold_v
        if before > 0.0 and after > 0.0:
            tables["detector"]["threshold_v"] *= after / before

        return Design(**tables)


def _apply(tables: dict[str, Any], changes: Mapping[str, Change]) -> dict[str, Any]:
    """Change parameters of tables in place, and return the tables."""
    for name, change in changes.items():
        table, _, key = name.partition(".")
        if isinstance(change, BySurface):
            change = change.values.get(tables["contact"]["surface"], tables[table][key])

        tables[table][key] = (
            tables[table][key] * change.by if isinstance(change, Factor) else change
        )

    return tables


def change_converter(bits: int, high_v: float) -> dict[str, Change]:
    """Parameters of a converter from 0 V to `high_v` [V], in the scene and in the design.

    A user of this converter states it in the design, because the thresholds follow from the
    design's noise and step. The noise ahead of the converter stays the design's.
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
"""Holding time before slip in which a detector can adapt to noise
[s]; the article's trials hold for 1 s.
"""
HELD_LONGER = f"held for {LONG_WAIT_S:g} s"
PATCH_AVERAGE = "profile averaged over the contact patch"
STICK_SLIP = "stick-slip"
BOTH = "patch average and stick-slip"
ELASTO_PLASTIC = "elasto-plastic bristles"
"""Labels of variations whose results the report explains."""

VARIATIONS: tuple[Variation, ...] = (
    Variation("surface accelerates at 0.5 m/s2", {"scene.slide.acceleration_m_s2": Factor(0.5)}),
    Variation("surface accelerates at 4 m/s2", {"scene.slide.acceleration_m_s2": Factor(4.0)}),
    Variation("resonance two thirds as high", {"scene.mount.mass_kg": 2.25 * Backing.mass_kg}),
    Variation("resonance half as high again", {"scene.mount.mass_kg": Backing.mass_kg / 2.25}),
    Variation(
        "half the force",
        {"scene.hold.min_force_n": Factor(0.5), "scene.hold.max_force_n": Factor(0.5)},
    ),
    Variation("half the noise", {"detector.noise_v": Factor(0.5)}),
    Variation("twice the noise", {"detector.noise_v": Factor(2.0)}),
    Variation("half the speed", {"scene.slide.speed_m_s": Factor(0.5)}),
    Variation("load law hertz", {"scene.surface.load_law": "hertz"}, is_law=True),
    Variation(
        "longest waves by ISO 4288: 2.5 mm on gross and wood",
        {"scene.surface.longest_wave_mm": BySurface({"gross": 2.5, "wood": 2.5})},
        is_law=True,
    ),
    Variation("Hurst exponent 0.5", {"scene.surface.hurst": 0.5}, is_law=True),
    Variation("Hurst exponent 1", {"scene.surface.hurst": 1.0}, is_law=True),
    Variation("slides towards the base", {"scene.slide.towards": "base"}, is_law=True),
    Variation("slides to the side", {"scene.slide.towards": "side"}, is_law=True),
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


UNCHANGED = Variation("unchanged", {})
_NEGATIVE_MINUTES = 2.0
LOADED_ON = "gross"
LOADS_N = (0.5, 2.0)
"""Holding forces at which the envelope is measured on the surface `LOADED_ON` [N]."""
_LOAD_SEEDS = 2


def slide_at(surface: str, force_n: float) -> SceneFile:
    """Return the article's trial at 6 cm/s with a holding force [N]."""
    hold = {"min_force_n": force_n, "max_force_n": force_n}
    slide = {"distance_m": 0.04, "speed_m_s": 0.06}
    return SceneFile(
        scene="sliding_finger",
        contact={"surface": surface},
        hold=hold,
        slide=slide,
    )


def measure_envelope_v(
    design: Design,
    surface: str,
    force_n: float,
    seeds: Sequence[int],
    variation: Variation = UNCHANGED,
) -> float:
    """Measure a board's mean envelope in slip at 6 cm/s and a force
    that no variation changes [V]; NaN without slip.
    """
    scene = variation.vary_scene(slide_at(surface, force_n))
    changed = variation.vary_design(design)
    hold = scene.hold.model_copy(update={"min_force_n": force_n, "max_force_n": force_n})
    scene = scene.model_copy(update={"hold": hold, "outputs": ["voltage_v", "slip", "envelope_v"]})
    means_v = []

    for seed in seeds:
        columns = run_scene(changed, scene, seed).columns
        slips = columns["slip"].astype(bool)
        means_v += [float(columns["envelope_v"][slips].mean())] if slips.any() else []

    return float(np.mean(means_v)) if means_v else math.nan


@dataclass(frozen=True)
class VariationResult:
    label: str
    is_realistic: bool
    """True for an effect that real fingers show and the trials leave out by default."""
    is_law: bool
    """True for another law of the contact."""
    slips: int
    """Number of true slips; a trial with stick-slip may have several."""
    found_share: float
    median_s: float
    """Median delay over all slips [s]; infinite if fewer than half were found."""
    change_s: float
    """Change of the median against the unchanged trials [s]; NaN if either is infinite."""
    alarms_per_minute: float
    """False alarms in a few minutes without slip: a change that
    shortens the delay may also cause alarms.
    """
    onset_change_s: float
    """Median change of the true onset of slip, counted from the start
    of the slide [s]; NaN if none is comparable.
    """
    vibration_n: float
    """RMS vibration of the normal force in slip, median of the trials [N]; NaN without slip."""
    p90_s: float
    worst_mean_s: float
    """Mean delay on the worst surface [s], of the slips found; infinite if none was found there."""
    light_v: float
    """Mean envelope in slip on the surface `LOADED_ON` at the smaller one of `LOADS_N` [V]."""
    firm_v: float
    """The same at the larger one [V]."""


def study_assumptions(
    design: Design, detector: str, trials: int = 24, variations: Sequence[Variation] = VARIATIONS
) -> list[VariationResult]:
    """Measure the delay without and with each change; all thresholds
    follow the noise, the design's own one too.
    """
    cases = list(generate_limited_cases(CampaignPlan(trials, _NEGATIVE_MINUTES)))
    all_variations = (UNCHANGED, *variations)
    runs = list(
        call_each(
            partial(_run_variation, design, detector, cases, variation)
            for variation in all_variations
        )
    )
    before, onsets_before_s, _, _ = runs[0]
    results = []

    for variation, (pooled, onsets_s, vibrations_n, envelopes_v) in zip(
        all_variations, runs, strict=True
    ):
        median_s = pooled.delay_s(0.5)
        before_s = before.delay_s(0.5)
        is_comparable = math.isfinite(median_s) and math.isfinite(before_s)
        change_s = median_s - before_s if is_comparable else math.nan
        onset_s = campaign.median_of_known(
            now - then for now, then in zip(onsets_s, onsets_before_s, strict=True)
        )
        worst_s = max(
            (mean for mean, _, _ in pooled.group_delays(campaign.surface).values()),
            default=math.inf,
        )
        row = VariationResult(
            variation.label,
            variation.is_realistic,
            variation.is_law,
            pooled.slips,
            pooled.found_share,
            median_s,
            change_s,
            pooled.alarms_per_minute,
            onset_s,
            campaign.median_of_known(vibrations_n),
            pooled.delay_s(0.9),
            worst_s,
            *envelopes_v,
        )
        results.append(row)

    return results


def _run_variation(
    design: Design, detector: str, cases: Sequence[Case], variation: Variation
) -> tuple[campaign.DetectorResult, list[float], list[float], list[float]]:
    """Run the cases with a change: pooled result, onset and vibration
    in each trial, and the envelope at `LOADS_N`.
    """
    changed_design = variation.vary_design(design)
    collected: list[campaign.TrialResult] = []
    onsets_s = []
    vibrations_n = []

    for case in cases:
        changed_case = replace(case, scene=variation.vary_scene(case.scene))
        trace = campaign.simulate_trace(changed_design, changed_case, [detector])
        collected += campaign.evaluate(
            changed_case,
            trace=trace,
            detector=detector,
            design=changed_design,
            scales=[1.0],
        )

        if case.cause == "slip":
            onsets_s.append(campaign.find_onset_s(changed_design, changed_case, trace))
            vibrations_n.append(campaign.measure_vibration_n(trace))

    seeds = range(HELD_OUT_FROM, HELD_OUT_FROM + _LOAD_SEEDS)
    envelopes_v = [
        measure_envelope_v(
            design,
            surface=LOADED_ON,
            force_n=force_n,
            seeds=seeds,
            variation=variation,
        )
        for force_n in LOADS_N
    ]
    return campaign.DetectorResult(1.0, tuple(collected)), onsets_s, vibrations_n, envelopes_v
