"""Sensitivity of the delay to the acceleration of the surface, the assumption that changes it most.

The article gives a trapezoidal velocity profile, 4 cm at 4, 6 or 8 cm/s, and that 4 cm at 4 cm/s "lasted one second"
(figure 9). An acceleration a adds ``v / a`` to that second: 40 ms at the 1 m/s2 assumed here, 4 ms at 10 m/s2, and both
round to one second. Vibration in the fingertip's band needs a speed of ``f lambda``, frequency times wavelength, so
slip with a larger acceleration is found sooner, by every detector and by the bound.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from fingertip.campaign.evaluate import evaluate, simulate_trace
from fingertip.campaign.plan import HELD_OUT_FROM, CampaignPlan, generate_cases
from fingertip.campaign.run import quantile_s
from fingertip.campaign.studies.detection_bound import compute_bounds_s
from fingertip.design import Design
from fingertip.jit import compiled
from fingertip.sim import SceneFile
from fingertip.slip import DETECTORS

ACCELERATIONS_M_S2 = (0.5, 1.0, 2.0, 5.0, 10.0)
ASSUMED_M_S2 = 1.0
"""Acceleration of the scenes [m/s2]."""
BOUND = "bound"
"""Name that stands for a detector in the rows of Lorden's bound."""


@dataclass(frozen=True)
class AccelerationResult:
    """Result of one detector, or of the bound, at one acceleration; delays are infinite if too few slips were found."""

    acceleration_m_s2: float
    detector: str
    found_share: float
    median_s: float
    p90_s: float


def study_accelerations(
    design: Design,
    trials: int = 24,
    first_seed: int = HELD_OUT_FROM,
    accelerations_m_s2: Sequence[float] = ACCELERATIONS_M_S2,
    detectors: Sequence[str] = tuple(DETECTORS),
) -> list[AccelerationResult]:
    """Run the same trials at each acceleration, with the design's thresholds."""
    plan = CampaignPlan(trials, 0.5)
    results = []
    for a in accelerations_m_s2:

        def accelerate(scene: SceneFile, a: float = a) -> SceneFile:
            return scene.model_copy(update={"slide": scene.slide.model_copy(update={"acceleration_m_s2": a})})

        delays: dict[str, list[float]] = {name: [] for name in detectors}
        slips = dict.fromkeys(detectors, 0)
        with compiled():
            for case in generate_cases(plan, first_seed):
                if case.cause != "slip":
                    break
                changed = replace(case, scene=accelerate(case.scene))
                trace, force_n = simulate_trace(design, changed, detectors)
                for name in detectors:
                    (result,) = evaluate(changed, trace, force_n, name, design, [1.0])
                    delays[name] += result.delays_s
                    slips[name] += result.slips
        bounds = compute_bounds_s(design, plan, first_seed, accelerate)
        for name, found, count in [(BOUND, bounds, len(bounds)), *((n, delays[n], slips[n]) for n in detectors)]:
            fraction = sum(delay < float("inf") for delay in found) / count
            results.append(
                AccelerationResult(a, name, fraction, quantile_s(found, count, 0.5), quantile_s(found, count, 0.9))
            )
    return results
