"""Contact in both directions with error control: a pad dragged and pressed, that sticks, slips, bounces.

States: x, v of the pad along the surface [m, m/s], z of the bristles [m], y, w: the contact's compression as the
force it makes, and its rate [N, N/s]. With N = max(y, 0):

    dz/dt = v - alpha(v, z) sigma0 |v| z / g(v) - r(N) z       alpha = 1: plain LuGre
    m dv/dt = k (X - x) + c (V - v) - N (sigma0 z + sigma1 dz/dt + sigma2 v)
    dy/dt = w
    dw/dt = omega^2 (d - y) - 2 zeta omega w                   touching, y > 0
    dw/dt = omega^2 (d - rho y) - 2 zeta sqrt(rho) omega w     in flight: only the hand pulls the pad back

X, V is the stage's motion (cubic between samples), d the force that presses (linear between samples). Every sample is
a step's end, so kinks and jumps of the drive at samples cost no order. RODAS with analytic Jacobian; the blocks
(y, w) and (x, v, z) are solved in closed form.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.errors import Issue, TraceError
from fingertip.sim.contact import coupled_loop
from fingertip.sim.contact.friction import Friction
from fingertip.sim.contact.tangential import Mount
from fingertip.sim.validation import columns, not_negative, positive, refuse

STEPS_CAP = 200_000
"""Most steps between two samples."""
STATES = 5


@dataclass(frozen=True)
class Press:
    """How the contact swings in the normal direction.

    Raises
    ------
    TraceError
        If a value is out of its bounds.
    """

    resonance_hz: float
    damping_ratio: float
    hand_share: float = 0.02
    """Stiffness of the hand behind the pad, as a share of the contact's: 90 N/m of some 5 kN/m (`sim.pad`)."""

    def __post_init__(self) -> None:
        refuse(
            [
                *positive("press.resonance_hz", self.resonance_hz, "Hz", "90"),
                *not_negative("press.damping_ratio", self.damping_ratio, ""),
                *positive("press.hand_share", self.hand_share, "", "0.02"),
            ]
        )


@dataclass(frozen=True)
class Coupled:
    """What the pad does, one value per sample, and what it took."""

    position_m: Array
    velocity_m_s: Array
    bristle_m: Array
    force_n: Array
    """Normal force, exactly 0 in flight."""
    steps: int
    rejected: int

    @property
    def evaluations(self) -> int:
        """Evaluations of the right side."""
        return 6 * (self.steps + self.rejected)


def integrate(
    friction: Friction,
    mount: Mount,
    press: Press,
    step_s: float,
    stage_m: Array,
    stage_m_s: Array,
    pressing_n: Array,
    tolerance_n: float = 1e-6,
) -> Coupled:
    """Integrate from rest, in balance with the first sample's pressing force.

    Parameters
    ----------
    friction, mount, press
        The surface, and the pad along and across it.
    step_s
        Time between samples [s].
    stage_m, stage_m_s, pressing_n
        Position [m] and velocity [m/s] of the stage, and the force that presses [N], at the samples.
    tolerance_n
        Error of one step, as a force [N].

    Raises
    ------
    TraceError
        For values out of bounds, input that is not finite (with its first such sample), or a sample that needs more
        than `STEPS_CAP` steps.
    """
    refuse(
        [
            *positive("step_s", step_s, "s", "0.0005"),
            *positive("tolerance_n", tolerance_n, "N", "1e-6"),
            *columns(stage_m=stage_m, stage_m_s=stage_m_s, pressing_n=pressing_n),
        ]
    )
    out = [np.zeros(len(stage_m)) for _ in range(4)]
    count = np.zeros(3)
    maximum = max(float(np.max(pressing_n)), 1e-3)
    spring = max(mount.stiffness_n_per_m, maximum * friction.sigma0 * 1e-3)
    resist = (mount.stiffness_n_per_m * mount.mass_kg) ** 0.5 + mount.damping_n_s_per_m
    omega = 2 * np.pi * press.resonance_hz
    coupled_loop.run(
        (friction.mu_c, friction.mu_s - friction.mu_c, friction.stribeck_m_s, friction.elastic),
        (friction.sigma0, friction.sigma1, friction.sigma2),
        (mount.mass_kg, mount.stiffness_n_per_m, mount.damping_n_s_per_m),
        (float(omega), press.damping_ratio, press.hand_share),
        (
            spring / tolerance_n,
            (resist + maximum * (friction.sigma1 + friction.sigma2)) / tolerance_n,
            maximum * friction.sigma0 / tolerance_n,
            1 / tolerance_n,
            1 / (tolerance_n * float(omega)),
        ),
        STEPS_CAP, step_s, stage_m, stage_m_s, pressing_n, *out, count,
    )  # fmt: skip
    if (failed := int(count[2])) > 0:
        raise TraceError(
            Issue(
                f"sample {failed}",
                f"needs more than {STEPS_CAP} steps after the sample before; choose a larger tolerance_n than "
                f"{tolerance_n:g} N, or a softer contact.",
            )
        )
    x, v, z, y = out
    return Coupled(x, v, z, np.maximum(y, 0.0), int(count[0]), int(count[1]))
