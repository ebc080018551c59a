"""The delay by how hard the surface starts: the one assumption that moves it most.

The article gives a trapezoidal profile, 4 cm at 4, 6 or 8 cm/s, and that 4 cm at 4 cm/s "lasted one second" (figure 9).
A start of acceleration a adds ``v / a`` to that second: 40 ms at the 1 m/s2 assumed here, 4 ms at 10 m/s2, and both are
one second to the eye. Vibration of the fingertip's band needs ``v / lambda``, so a harder start is heard sooner, by
every detector and by the bound.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from fingertip.campaign.judge import judge
from fingertip.campaign.plan import HELD_OUT_FROM, Amount, cases
from fingertip.campaign.record import reads_board, record
from fingertip.campaign.studies.limit import limits_s, quantile_s
from fingertip.design import Design
from fingertip.sim import SceneFile
from fingertip.sim.jit import compiled
from fingertip.slip import DETECTORS

ACCELERATIONS_M_S2 = (0.5, 1.0, 2.0, 5.0, 10.0)
ASSUMED_M_S2 = 1.0
"""The scenes' own."""


@dataclass(frozen=True)
class Start:
    """One detector (or the bound, named ``bound``) at one acceleration; delays infinite if too few slips were found."""

    acceleration_m_s2: float
    who: str
    found_share: float
    median_s: float
    p90_s: float


def starts(
    design: Design,
    trials: int = 24,
    first_seed: int = HELD_OUT_FROM,
    accelerations_m_s2: Sequence[float] = ACCELERATIONS_M_S2,
    detectors: Sequence[str] = tuple(DETECTORS),
) -> list[Start]:
    """The same trials at each acceleration, thresholds as the design has them."""
    amount = Amount(trials, 0.5)
    out = []
    for a in accelerations_m_s2:

        def harder(scene: SceneFile, a: float = a) -> SceneFile:
            return scene.model_copy(update={"slide": scene.slide.model_copy(update={"acceleration_m_s2": a})})

        delays: dict[str, list[float]] = {name: [] for name in detectors}
        slips = dict.fromkeys(detectors, 0)
        with compiled():
            for case in cases(amount, first_seed):
                if case.cause != "slip":
                    break
                changed = replace(case, scene=harder(case.scene))
                trace, force_n = record(design, changed, reads_board(*detectors))
                for name in detectors:
                    (verdict,) = judge(changed, trace, force_n, name, design, [1.0])
                    delays[name] += verdict.delays_s
                    slips[name] += verdict.slips
        bounds = limits_s(design, amount, first_seed, harder)
        for name, found, count in [("bound", bounds, len(bounds)), *((n, delays[n], slips[n]) for n in detectors)]:
            known = sum(delay < float("inf") for delay in found) / count
            out.append(Start(a, name, known, quantile_s(found, count, 0.5), quantile_s(found, count, 0.9)))
    return out
