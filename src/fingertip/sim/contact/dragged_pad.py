"""Pad that is dragged over a surface and pressed on it, and that sticks, slips or bounces, with
error control.

States: position x [m] and velocity v [m/s] of the pad along the surface, bristles s [m sqrt(N)],
compression of the contact expressed as its force y [N], and its rate w [N/s]. The normal force is N
= max(y, 0). With c = 1 / sqrt(N + N0) and the mean bristle deflection z = c s
(`fingertip.sim.contact.friction`):

    L       = v - alpha(v, z) sigma0 |v| z / g(v)            plain LuGre friction: alpha = 1
    ds/dt   = N c L - r(N, z) s
    m dv/dt = k (X - x) + c_m (V - v) - N (sigma0 z + sigma1 c ds/dt + sigma2 v)
    dy/dt   = w
    dw/dt   = omega^2 (d - y) - 2 zeta omega w               touching, y > 0
    dw/dt   = omega^2 (d - rho y) - 2 zeta sqrt(rho) omega w   in flight, drawn by the hand alone

k and c_m are stiffness and damping of the mount, X and V position and velocity of the carriage
(cubic between samples), d is the pressing force (linear between samples), alpha is the
elasto-plastic factor of Dupont et al. 2002, and r relaxes bristles without contact or beyond
breakaway. Without a resonance in the normal direction, y is d. Losing contact is not singular: at N
= 0 friction vanishes. Every sample is the end of a step, so kinks and jumps of the drive at samples
do not reduce the order. The method is Shampine's of order 4 with the analytic Jacobian
(`fingertip.sim.contact.dragged_pad_loop`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.numerics import Array
from fingertip.sim.contact import dragged_pad_loop
from fingertip.sim.contact.friction import LOAD_SCALE_N, RELAX_PER_S, Friction

MAX_STEPS = 200_000
TOLERANCE_N = 1e-6
"""Permitted error of one step [N]."""
STATES = 5
_MIN_LOAD_N = 1e-3
"""Smallest load for which errors are weighted [N]."""
_SHARE = 3.0
"""Number of steps whose errors may add up to the tolerance."""
_MAX_BENT = 100.0
"""Largest weight of what an error of v bends, relative to its other weight: stiff bristles would
take ten times the steps.
"""


@dataclass(frozen=True)
class Mount:
    """Spring and damper between the pad and the carriage that drags it."""

    mass_kg: float
    stiffness_n_per_m: float
    damping_n_s_per_m: float


@dataclass(frozen=True)
class NormalContact:
    """Resonance of the contact in the normal direction."""

    resonance_hz: float
    """Undamped resonance while touching [Hz]."""
    damping_ratio: float
    hand_ratio: float = 0.02
    """Ratio of the hand's stiffness behind the pad to the contact's.
    Some 0.008 in trials (`pad.response`).
    """

    @property
    def period_s(self) -> float:
        """Time of one radian of the resonance [s]."""
        return 1 / (2 * math.pi * self.resonance_hz)

    @property
    def rates(self) -> dragged_pad_loop.Normal:
        """Stiffness and damping while touching, ratio of the hand's stiffness, and damping in
        flight.
        """
        omega = 2 * math.pi * self.resonance_hz
        damping_per_s = 2 * self.damping_ratio * omega
        in_flight = math.sqrt(self.hand_ratio) * damping_per_s
        return omega * omega, damping_per_s, self.hand_ratio, in_flight


@dataclass(frozen=True)
class PadMotion:
    """Motion of the pad and normal force, one value per sample, and the number of steps."""

    position_m: Array
    velocity_m_s: Array
    bristle_m: Array
    force_n: Array
    """Normal force [N], exactly 0 in flight."""
    steps: int
    rejected: int

    @property
    def evaluations(self) -> int:
        """Number of evaluations of the right-hand side, at most: a sample at rest counts as a
        step.
        """
        return 3 * (self.steps + self.rejected)


def weigh_errors(
    friction: Friction, mount: Mount, max_load_n: float, step_s: float, tolerance_n: float
) -> tuple[float, float, float]:
    """Return weights that turn errors of x, v and s into forces as shares of the tolerance:
    stiffness for x, damping for v, bristle stiffness for z = s / sqrt(N).

    An error of v or w also counts with what it moves within a sample: bristles that stick forget
    nothing, and a pad in flight meets the surface too early or too late.
    """
    max_load = max(max_load_n, _MIN_LOAD_N)
    stiffness = max(mount.stiffness_n_per_m, max_load * friction.sigma0 * 1e-3)
    damping = (mount.stiffness_n_per_m * mount.mass_kg) ** 0.5 + mount.damping_n_s_per_m
    damping += max_load * (friction.sigma1 + friction.sigma2)
    damping += min(max_load * friction.sigma0 * step_s, _MAX_BENT * damping)
    per_n = _SHARE / tolerance_n

    return stiffness * per_n, damping * per_n, math.sqrt(max_load) * friction.sigma0 * per_n


class DraggedPad:
    """A pad under a drive in any chunks, from standstill with relaxed bristles, in balance with the
    first force.

    Without a `NormalContact` the pressing force is the normal force. Raises TraceError.
    """

    def __init__(
        self,
        friction: Friction,
        mount: Mount,
        normal: NormalContact | None,
        step_s: float,
        max_pressing_n: float,
        tolerance_n: float = TOLERANCE_N,
    ) -> None:
        self._parameters = (
            (friction.mu_c, friction.mu_s, 1 / friction.stribeck_m_s, friction.elastic),
            (friction.sigma0, friction.sigma1, friction.sigma2, RELAX_PER_S, LOAD_SCALE_N),
            (
                mount.stiffness_n_per_m / mount.mass_kg,
                mount.damping_n_s_per_m / mount.mass_kg,
                1 / mount.mass_kg,
            ),
            normal.rates if normal else dragged_pad_loop.GIVEN,
        )
        x, v, bristles = weigh_errors(friction, mount, max_pressing_n, step_s, tolerance_n)
        per_n = _SHARE / tolerance_n
        rate_s = (normal.period_s if normal else 0.0) + step_s
        self._weights = (x, v, bristles, per_n, rate_s * per_n)
        self._step_s = step_s
        self._tolerance_n = tolerance_n
        self._hand_ratio = normal.hand_ratio if normal else 1.0
        self._carried = np.zeros(7)
        self._last = np.zeros((3, 0))
        self._samples = 0

    def process(self, carriage_m: Array, carriage_m_s: Array, pressing_n: Array) -> PadMotion:
        """Return the motion at the next samples; the very first sample is the start.

        Raises TraceError.
        """
        # The interval before a chunk's first sample begins at the last sample of the chunk before.
        repeated = self._last.shape[1]
        drive: tuple[Array, ...] = (carriage_m, carriage_m_s, pressing_n)

        if repeated:
            drive = tuple(np.concatenate((self._last, drive), axis=1))
        else:
            start_n = float(pressing_n[0])
            balance_n = start_n if start_n > 0.0 else start_n / self._hand_ratio
            self._carried[:] = (carriage_m[0], 0.0, 0.0, balance_n, 0.0, self._step_s, 0.0)

        out = [np.zeros(len(drive[0])) for _ in range(4)]
        carried = self._carried.copy()
        stats = np.zeros(3)
        dragged_pad_loop.run(
            *self._parameters, self._weights, MAX_STEPS, self._step_s, *drive, carried, *out, stats
        )
        failed = int(stats[dragged_pad_loop.FAILED_SAMPLE])

        if failed > 0:
            problem = f"needs more than {MAX_STEPS} steps from the previous sample"
            remedy = (
                f"choose a larger tolerance_n than {self._tolerance_n:g} N, or a softer contact."
            )
            raise TraceError(
                Issue(f"sample {self._samples - repeated + failed}", f"{problem}; {remedy}")
            )

        self._carried = carried
        self._last = np.array([[column[-1]] for column in drive], dtype=np.float64)
        self._samples += len(carriage_m)
        x, v, s, y = (column[repeated:] for column in out)
        force_n = np.maximum(y, 0.0)
        deflection_m = s / np.sqrt(force_n + LOAD_SCALE_N)
        steps = int(stats[dragged_pad_loop.ACCEPTED])
        rejected = int(stats[dragged_pad_loop.REJECTED])

        return PadMotion(
            position_m=x,
            velocity_m_s=v,
            bristle_m=deflection_m,
            force_n=force_n,
            steps=steps,
            rejected=rejected,
        )


def integrate(
    friction: Friction,
    mount: Mount,
    normal: NormalContact | None,
    step_s: float,
    carriage_m: Array,
    carriage_m_s: Array,
    pressing_n: Array,
    tolerance_n: float = TOLERANCE_N,
) -> PadMotion:
    """Integrate from standstill, in balance with the pressing force of the first sample.

    Raises TraceError.
    """
    max_pressing_n = max(float(np.max(pressing_n)), 0.0)
    pad = DraggedPad(
        friction=friction,
        mount=mount,
        normal=normal,
        step_s=step_s,
        max_pressing_n=max_pressing_n,
        tolerance_n=tolerance_n,
    )
    return pad.process(carriage_m, carriage_m_s, pressing_n)
