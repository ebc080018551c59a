"""One simulated trial: request, checks, and the stages put together."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass

import numpy as np

from fingertip.design import Design
from fingertip.design.faults import nearest
from fingertip.errors import Fault, TraceError
from fingertip.sim import fsr, vibration
from fingertip.sim.contact import Mount, drag
from fingertip.sim.pad import DAMPING_RATIO, Pad
from fingertip.sim.scene import SLIDE_M, sliding_finger
from fingertip.sim.surfaces import SURFACES
from fingertip.slip.trace import Trace

FORCES_N = (0.2, 2.0)
"""Range of the article's random interaction force [N]."""
MOST_FORCE_N = 4.0
"""More would need so much travel of the hand that the lift of 5 cm did not end the contact."""
SPEEDS_M_S = (0.005, 0.2)
"""Slower takes minutes of computing time; faster is not reached within 4 cm."""
GROSS_SLIP_M_S = 1e-3
"""Velocity of the pad over the surface above which slip is gross [m/s]. Assumption: 1/40 of the slowest
sliding."""
LOAD_SHIFT_PER_M = (1 - 0.035 / 0.32) / 6e-3
"""Share of the force the sensor loses per metre by which the pad is sheared towards the base [1/m].

From a linear finite-element trial of such a finger: a pad load moved by 6 mm towards the base left 0.035 of
it on the active area instead of 0.32. That the article's slide shears the pad towards the base is an
assumption.
"""
_LONGEST_STEP_S = 1.25e-4  # velocities are then within 1e-5 m/s of the limit (the convergence test holds that)


@dataclass(frozen=True)
class Trial:
    """What is asked for: surface, sliding speed, holding force, and the seed of everything random.

    Raises
    ------
    TraceError
        With one sentence for each value that is refused.
    """

    surface: str = "medium"
    speed_m_s: float = 0.04
    force_n: float | None = None
    """Holding force [N]; None takes one between 0.2 and 2 N, by the seed."""
    seed: int = 0

    def __post_init__(self) -> None:
        faults = []
        if self.surface not in SURFACES:
            faults.append(Fault("--surface", f"{self.surface!r} is not known; {nearest(self.surface, list(SURFACES))}"))
        least, most = SPEEDS_M_S
        if not least <= self.speed_m_s <= most:
            faults.append(
                Fault(
                    "--speed-m-s",
                    f"{self.speed_m_s:g} m/s is refused; choose {least:g} to {most:g} m/s (article: 0.04).",
                )
            )
        if self.force_n is not None and not 0.0 < self.force_n <= MOST_FORCE_N:
            faults.append(
                Fault(
                    "--force-n",
                    f"{self.force_n:g} N is refused; choose above 0 and at most {MOST_FORCE_N:g} N, or leave it out.",
                )
            )
        if self.seed < 0:
            faults.append(Fault("--seed", f"{self.seed} is negative; choose a whole number of at least 0."))
        if faults:
            raise TraceError(faults)

    @property
    def holding_force_n(self) -> float:
        """The holding force [N]: the one asked for, or the seed's."""
        if self.force_n is not None:
            return self.force_n
        low, high = FORCES_N
        return low + (high - low) * self.stream("force").random()

    def stream(self, what: str) -> random.Random:
        """Random numbers for one purpose: setting the force changes neither the surface nor the noise."""
        return random.Random(f"{self.seed}:{what}")


def simulate(design: Design, trial: Trial | None = None) -> Trace:
    """Simulate one sliding-finger trial of the article.

    The pad is dragged with the quasi-static normal force. Vibration is computed along the way it took and
    does not act back on friction, because plain LuGre creeps under vibration below breakaway (P. Dupont et
    al., IEEE Trans. Automatic Control 47(5), 2002, doi:10.1109/TAC.2002.1000274); it is a few percent of
    the force.

    Parameters
    ----------
    design
        Gives the pad's form, the sampling rate, the converter and its noise.
    trial
        What to do; by default the article's slowest slide on its medium surface.

    Returns
    -------
    Trace
        With voltage, true normal force and true gross slip. The same design and trial give the same trace.
    """
    trial = trial or Trial()
    surface, pad, force = SURFACES[trial.surface], Pad.of(design), trial.holding_force_n
    scene = sliding_finger(trial.speed_m_s, pad.depth_m(force))
    rate = design.detector.sample_rate_hz
    substeps = math.ceil(1 / (rate * _LONGEST_STEP_S) - 1e-9)
    h = 1 / (rate * substeps)
    time = np.arange(math.ceil(scene.duration_s * rate) * substeps + 1, dtype=np.float64) * h

    normal = pad.force_n(scene.depth_m(time))
    stage = scene.slide.position_m(time)
    k = pad.tangential_stiffness_n_per_m(force)
    mount = Mount(pad.mass_kg, k, 2 * DAMPING_RATIO * math.sqrt(k * pad.mass_kg))
    motion = drag(surface.friction, mount, h, stage, scene.slide.velocity_m_s(time), normal)

    line = vibration.profile(trial.stream("surface"), surface.roughness_um, surface.cutoff_wavelength_m, SLIDE_M)
    height = vibration.height_m(line, motion.position_m)
    felt = vibration.left_by_hand(height, h, pad.hand_hz)
    # The load presses the pad into the profile: stiffness at the force of the moment, none without contact.
    stiffness = pad.normal_stiffness_n_per_m(1.0) * np.cbrt(normal)
    drive = normal + stiffness * felt
    contact = vibration.resonate(drive, normal > 0.0, h, pad.resonance_hz(force), DAMPING_RATIO)

    shear = stage - motion.position_m
    sensed = contact * np.clip(1 - LOAD_SHIFT_PER_M * shear, 0.0, None)
    every = slice(None, None, substeps)
    shown = fsr.with_hysteresis(sensed[every])
    slip = (np.abs(motion.velocity_m_s) > GROSS_SLIP_M_S) & (normal > 0.0)
    return Trace(time[every], fsr.sample(design, shown, trial.stream("noise")), contact[every], slip[every])
