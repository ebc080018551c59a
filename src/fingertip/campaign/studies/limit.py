"""How soon any detector could know on average, with the same spectrum and noise: Lorden's bound.

A change that raises the information by I per second is found no sooner, on average and for a mean time between false
alarms of gamma independent looks, than ``ln(gamma) / I`` (G. Lorden, Ann. Math. Stat. 42(6), 1971,
doi:10.1214/aoms/1177693055); CUSUM reaches it. Here slip grows, so the information is added up from the onset until it
comes to ln(gamma).

Gaussian noise of power n in a band of width B that becomes n + s tells ``B (r - 1 - ln r)`` nats per second, with
r = 1 + s / n. The band is the wide one of the detector `fast`, seen through its own causal filters, whose delay is in
the limit too; s is what the same trial shows there without any noise. The bound knows noise and slip only: it need not
tell slip from a change of grip, and it knows beforehand how strong this slip will be. So it is a floor, not a goal; and
a floor for the average over the noise: the same slip is found a little sooner in some noise, and later in other.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from fingertip.campaign.plan import HELD_OUT_FROM, Amount, cases
from fingertip.design import Design
from fingertip.sim import SceneFile, run_scene
from fingertip.sim.jit import compiled
from fingertip.slip.detectors.fast import Fast, FastSettings
from fingertip.slip.detectors.noise import mean_quantised_v

ALARMS_PER_MINUTE = 0.1
_MIN_V = 1e-12
"""Stands for no noise at all."""
_AHEAD_S = 0.02
"""Before slip is gross, what a creeping pad tells counts too: the robot has moved for some 13 ms by then."""
_SMOOTH_S = 0.002
"""Over which the power of the moment is averaged, half of it ahead: the bound may know the slip."""


def quantile_s(delays_s: Sequence[float], slips: int, share: float) -> float:
    """Delay by which that share of all slips was found [s]; infinite if fewer were."""
    ranked = sorted(delays_s) + [math.inf] * (slips - len(delays_s))
    return float(ranked[min(len(ranked) - 1, int(share * len(ranked)))]) if ranked else math.inf


def limits_s(
    design: Design,
    amount: Amount,
    first_seed: int = HELD_OUT_FROM,
    altered: Callable[[SceneFile], SceneFile] = lambda scene: scene,
) -> list[float]:
    """The bound on the average delay of each slip of a campaign [s], each scene altered first; infinite where it never
    knows enough."""
    detector = design.detector
    seen_in_v = mean_quantised_v(detector.noise_v, 2 * detector.adc_range_v / 2**detector.adc_bits)
    settings = FastSettings.of(design, max(seen_in_v, _MIN_V))
    rate, width = settings.sample_rate_hz, settings.high_hz - settings.low_hz
    wanted = math.log(2 * width * 60 / ALARMS_PER_MINUTE)
    noise = Fast(settings).noise_energy_v2
    fine = design.model_dump()
    fine["detector"]["adc_bits"] = 24
    silent = Design(**fine)
    smooth, ahead = max(1, round(_SMOOTH_S * rate)), round(_AHEAD_S * rate)
    found = []
    with compiled():
        for case in cases(amount, first_seed):
            if case.cause != "slip":
                break
            scene = altered(case.scene)
            sensing = scene.sensing.model_copy(update={"noise": False})
            scene = scene.model_copy(update={"outputs": ["voltage_v", "slip"], "sensing": sensing})
            trace = run_scene(silent, scene, case.seed).trace
            assert trace.slip is not None
            moving = np.flatnonzero(trace.slip)
            shown = Fast(settings).process(trace.voltage_v).filtered_v
            begin = max(0, moving[0] - ahead)
            power = np.convolve(shown * shown, np.full(smooth, 1 / smooth), "same")[begin : moving[-1] + 1]
            r = 1 + power / noise
            told = np.cumsum(width * (r - 1 - np.log(r))) / rate
            known = np.flatnonzero(told >= wanted)
            found.append(max(0.0, float(begin + known[0] + 1 - moving[0]) / rate) if known.size else math.inf)
    return found
