"""One sliding-finger trial of the article: request, checks, and the scene it is."""

from __future__ import annotations

import random
from dataclasses import dataclass

from fingertip.design import Design
from fingertip.design.issues import suggest_name
from fingertip.errors import Issue, TraceError
from fingertip.sim.contact.surfaces import SURFACES
from fingertip.sim.scenes.scene import SLIDE_M
from fingertip.sim.scenes.scene_file import SceneFile
from fingertip.sim.stages.result import run_scene
from fingertip.slip.traces.trace import Trace

FORCES_N = (0.2, 2.0)
"""Range of the article's random interaction force [N]."""
MAX_FORCE_N = 4.0
"""More would need so much travel of the hand that the lift of 5 cm did not end the contact."""
SPEEDS_M_S = (0.005, 0.2)
"""Slower takes minutes of computing time; faster is not reached within 4 cm."""


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
        issues = []
        if self.surface not in SURFACES:
            issues.append(Issue("--surface", f"{self.surface!r} is not known; {suggest_name(self.surface, list(SURFACES))}"))
        minimum, maximum = SPEEDS_M_S
        if not minimum <= self.speed_m_s <= maximum:
            issues.append(
                Issue(
                    "--speed-m-s",
                    f"{self.speed_m_s:g} m/s is refused; choose {minimum:g} to {maximum:g} m/s (article: 0.04).",
                )
            )
        if self.force_n is not None and not 0.0 < self.force_n <= MAX_FORCE_N:
            issues.append(
                Issue(
                    "--force-n",
                    f"{self.force_n:g} N is refused; choose above 0 and at most {MAX_FORCE_N:g} N, or leave it out.",
                )
            )
        if self.seed < 0:
            issues.append(Issue("--seed", f"{self.seed} is negative; choose a whole number of at least 0."))
        if issues:
            raise TraceError(issues)

    @property
    def holding_force_n(self) -> float:
        """The holding force [N]: the one asked for, or the seed's."""
        if self.force_n is not None:
            return self.force_n
        low, high = FORCES_N
        return low + (high - low) * random.Random(f"{self.seed}:force").random()

    @property
    def scene(self) -> SceneFile:
        """The trial as a scene."""
        low, high = FORCES_N if self.force_n is None else (self.force_n, self.force_n)
        return SceneFile(
            scene="sliding_finger",
            contact={"surface": self.surface},
            hold={"min_force_n": low, "max_force_n": high},
            slide={"distance_m": SLIDE_M, "speed_m_s": self.speed_m_s},
        )


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
    return run_scene(design, trial.scene, trial.seed).trace
