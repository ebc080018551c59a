"""Contact in both directions with error control: a pad that is dragged and pressed, and that sticks, slips or bounces.

States: position x [m] and velocity v [m/s] of the pad along the surface, bristle deflection z [m], compression of the
contact expressed as its force y [N], and its rate w [N/s]. With the normal force N = max(y, 0):

    dz/dt = v - alpha(v, z) sigma0 |v| z / g(v) - r(N) z       plain LuGre friction: alpha = 1
    m dv/dt = k (X - x) + c (V - v) - N (sigma0 z + sigma1 dz/dt + sigma2 v)
    dy/dt = w
    dw/dt = omega^2 (d - y) - 2 zeta omega w                   touching, y > 0
    dw/dt = omega^2 (d - rho y) - 2 zeta sqrt(rho) omega w     in flight, where only the hand pulls the pad back

X and V are position and velocity of the carriage (cubic between samples), d is the pressing force (linear between
samples), alpha is the elasto-plastic factor of Dupont et al. 2002, and r(N) relaxes bristles without contact. Every
sample is the end of a step, so kinks and jumps of the drive at samples do not reduce the order. The method is RODAS
with the analytic Jacobian (`fingertip.sim.contact.coupled_loop`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fingertip.arrays import Array
from fingertip.errors import Issue, TraceError
from fingertip.sim.contact import coupled_loop
from fingertip.sim.contact.friction import RELAX_PER_S, Friction
from fingertip.sim.contact.tangential import Mount
from fingertip.sim.validation import find_column_issues, find_negative, find_not_positive, raise_issues

MAX_STEPS = 200_000
"""Maximum number of steps between two samples."""
STATES = 5
"""Number of integrated states."""


@dataclass(frozen=True)
class NormalContact:
    """Resonance of the contact in the normal direction.

    Raises
    ------
    TraceError
        If a value is out of its bounds.
    """

    resonance_hz: float
    """Undamped resonance while touching [Hz]."""
    damping_ratio: float
    """Damping ratio while touching."""
    hand_ratio: float = 0.02
    """Ratio of the hand's stiffness behind the pad to the contact's: 90 N/m to some 5 kN/m (`sim.contact.pad`)."""

    def __post_init__(self) -> None:
        raise_issues(
            [
                *find_not_positive("normal.resonance_hz", self.resonance_hz, "Hz", "90"),
                *find_negative("normal.damping_ratio", self.damping_ratio, ""),
                *find_not_positive("normal.hand_ratio", self.hand_ratio, "", "0.02"),
            ]
        )


@dataclass(frozen=True)
class CoupledMotion:
    """Motion of the pad and normal force, one value per sample, and the number of steps."""

    position_m: Array
    """Position along the surface [m]."""
    velocity_m_s: Array
    """Velocity along the surface [m/s]."""
    bristle_m: Array
    """Mean bristle deflection [m]."""
    force_n: Array
    """Normal force [N], exactly 0 in flight."""
    steps: int
    """Accepted steps."""
    rejected: int
    """Rejected steps."""

    @property
    def evaluations(self) -> int:
        """Number of evaluations of the right-hand side."""
        return 6 * (self.steps + self.rejected)


def integrate(
    friction: Friction,
    mount: Mount,
    normal: NormalContact,
    step_s: float,
    carriage_m: Array,
    carriage_m_s: Array,
    pressing_n: Array,
    tolerance_n: float = 1e-6,
) -> CoupledMotion:
    """Integrate from standstill, in balance with the pressing force of the first sample.

    Parameters
    ----------
    friction, mount, normal
        Surface, mount of the pad along the surface, and resonance normal to it.
    step_s
        Time between samples [s].
    carriage_m, carriage_m_s, pressing_n
        Position [m] and velocity [m/s] of the carriage, and pressing force [N], at the samples.
    tolerance_n
        Permitted error of one step, as a force [N].

    Raises
    ------
    TraceError
        If a value is out of bounds, an input is not finite (the error names the first such sample), or a sample needs
        more than `MAX_STEPS` steps.
    """
    raise_issues(
        [
            *find_not_positive("step_s", step_s, "s", "0.0005"),
            *find_not_positive("tolerance_n", tolerance_n, "N", "1e-6"),
            *find_column_issues(carriage_m=carriage_m, carriage_m_s=carriage_m_s, pressing_n=pressing_n),
        ]
    )
    out = [np.zeros(len(carriage_m)) for _ in range(4)]
    stats = np.zeros(3)
    omega = float(2 * np.pi * normal.resonance_hz)

    # Weights that turn the error of each state into a force: stiffness for x, damping for v, bristle stiffness for z.
    max_load = max(float(np.max(pressing_n)), 1e-3)
    stiffness = max(mount.stiffness_n_per_m, max_load * friction.sigma0 * 1e-3)
    damping = (mount.stiffness_n_per_m * mount.mass_kg) ** 0.5 + mount.damping_n_s_per_m
    weights = (
        stiffness / tolerance_n,
        (damping + max_load * (friction.sigma1 + friction.sigma2)) / tolerance_n,
        max_load * friction.sigma0 / tolerance_n,
        1 / tolerance_n,
        1 / (tolerance_n * omega),
    )
    coupled_loop.run(
        (friction.mu_c, friction.mu_s - friction.mu_c, friction.stribeck_m_s, friction.elastic),
        (friction.sigma0, friction.sigma1, friction.sigma2, RELAX_PER_S),
        (mount.mass_kg, mount.stiffness_n_per_m, mount.damping_n_s_per_m),
        (omega, normal.damping_ratio, normal.hand_ratio),
        weights,
        MAX_STEPS, step_s, carriage_m, carriage_m_s, pressing_n, *out, stats,
    )  # fmt: skip
    if (failed := int(stats[coupled_loop.FAILED_SAMPLE])) > 0:
        raise TraceError(
            Issue(
                f"sample {failed}",
                f"needs more than {MAX_STEPS} steps from the previous sample; choose a larger tolerance_n than "
                f"{tolerance_n:g} N, or a softer contact.",
            )
        )
    x, v, z, y = out
    steps, rejected = int(stats[coupled_loop.ACCEPTED]), int(stats[coupled_loop.REJECTED])
    return CoupledMotion(x, v, z, np.maximum(y, 0.0), steps, rejected)
