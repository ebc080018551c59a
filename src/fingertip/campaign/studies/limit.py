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
from fingertip.slip.detectors.noise import input_noise_v

ALARMS_PER_MINUTE = 0.1
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
    settings = FastSettings.of(design, input_noise_v(design))
    rate, width = settings.sample_rate_hz, settings.high_hz - settings.low_hz
    wanted = math.log(2 * width * 60 / ALARMS_PER_MINUTE)
    noise = Fast(settings).noise_energy_v2
    fine = design.model_dump()
    fine["detector"]["adc_bits"] = 24
    silent = Design(**fine)
    smooth = max(1, round(_SMOOTH_S * rate))
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
            power = np.convolve(shown * shown, np.full(smooth, 1 / smooth), "same")[moving[0] : moving[-1] + 1]
            r = 1 + power / noise
            told = np.cumsum(width * (r - 1 - np.log(r))) / rate
            known = np.flatnonzero(told >= wanted)
            found.append(float(known[0] + 1) / rate if known.size else math.inf)
    return found
