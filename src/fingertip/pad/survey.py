"""Survey of a pad: shares of a force in the poses in which a finger presses, turn-on, stiffness and
strain.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from fingertip.design import Design
from fingertip.foundation.errors import TraceError
from fingertip.pad.layer import GRID_MM, Contact, find_contacts, find_rest_n
from fingertip.pad.pad_geometry import PadForm
from fingertip.pad.touch import Pose

TILTS_DEG = (-5.0, 0.0, 2.0, 5.0, 10.0, 15.0, 20.0)
"""Tilts at which a plate is touched: tip up, flat, and tip down as in a grasp [deg]."""
GRASP_DEG = (0.0, 10.0)
WIDE_DEG = (-5.0, 15.0)
"""Ranges of tilt over which the least share is stated."""
ROLL_DEG = 10.0
ROLLED_TILT_DEG = 2.0
FORCE_N = 1.0
FIRM_N = 5.0
"""Force of the shares, and of the strain [N]."""
_TURN_ON_STEPS = 4
"""Steps of the search for the turn-on, each of which takes the share at the force of the step
before.
"""
_LEAST_FORCE_N = 0.01
"""Force below which the share is taken not to change: the contact is one cell of the grid [N]."""
MAX_TURN_ON_N = 20.0
"""Force on the pad up to which a turn-on is searched [N]."""


@dataclass(frozen=True)
class PadSurvey:
    """Figures of a pad on a plate. A pose in which the bone touches first has the share 0."""

    shares: tuple[float, ...]
    """Share of 1 N that reaches the sensor, at each of `TILTS_DEG`."""
    turn_on_n: tuple[float, ...]
    """Force on the pad at which the sensor turns on; infinite if it does not."""
    rolled_share: float
    """Share at a roll of 10 degrees."""
    stiffness_n_per_mm: float
    strain: float
    """Indentation over thickness at 5 N."""
    rest_n: float = 0.0
    """Force on the sensor when nothing touches the finger."""

    def least_share(self, low_deg: float, high_deg: float) -> float:
        return min(self._between(self.shares, low_deg, high_deg))

    @property
    def evenness(self) -> float:
        """Least share over the largest one in a grasp; 0 if nothing reaches the sensor."""
        shares = self._between(self.shares, *GRASP_DEG)
        return min(shares) / max(shares) if max(shares) > 0.0 else 0.0

    @property
    def worst_turn_on_n(self) -> float:
        return self.dead_zone_n(*WIDE_DEG)

    def dead_zone_n(self, low_deg: float, high_deg: float) -> float:
        """Largest force on the pad that the sensor does not feel, in a range of tilts."""
        return max(self._between(self.turn_on_n, low_deg, high_deg))

    def to_dict(self) -> dict[str, Any]:
        """Return the section `pad` of a report.

        A force that does not turn the sensor on is None.
        """
        rows = zip(TILTS_DEG, self.shares, self.turn_on_n, strict=True)
        return {
            "tilts": [
                {
                    "tilt_deg": tilt,
                    "share": round(share, 4),
                    "turn_on_n": round(force, 3) if force < math.inf else None,
                }
                for tilt, share, force in rows
            ],
            "rolled_share": round(self.rolled_share, 4),
            "evenness": round(self.evenness, 4),
            "stiffness_n_per_mm": round(self.stiffness_n_per_mm, 3),
            "strain": round(self.strain, 4),
            **({"rest_n": round(self.rest_n, 4)} if self.rest_n else {}),
        }

    @staticmethod
    def _between(values: Sequence[float], low_deg: float, high_deg: float) -> list[float]:
        return [
            value
            for tilt, value in zip(TILTS_DEG, values, strict=True)
            if low_deg <= tilt <= high_deg
        ]


def survey_pad(design: Design, *, is_loose: bool = False) -> PadSurvey:
    """Survey the pad of a design by the layer model; the same form is computed once.

    A skin that was made apart has its tightest fit, or its loosest.
    """
    return _survey(PadForm.of_design(design, is_loose=is_loose))


def find_own_mode_hz(design: Design) -> float:
    """Lowest resonance of the silicone over the sensor [Hz]: a quarter of a shear wave, ``sqrt(G /
    rho) / (4 h)``.

    The simulation leaves the mass of the silicone out. Far below this frequency that costs ``(f /
    this)^2``.
    """
    form = PadForm.of_design(design)
    density = design.silicone.material.density_g_cm3
    shear_pa = 1e6 * form.young_mpa / (2 * (1 + form.poisson))
    rho = 500.0 * (density.low + density.high)

    return math.sqrt(shear_pa / rho) / (4e-3 * form.over_sensor_mm)


@lru_cache(maxsize=256)
def _survey(form: PadForm) -> PadSurvey:
    shares = tuple(_share(form, Pose(tilt), FORCE_N) for tilt in TILTS_DEG)
    turn_on = tuple(find_turn_on_n(form, tilt) for tilt in TILTS_DEG)
    rolled = _share(form, Pose(ROLLED_TILT_DEG, ROLL_DEG), FORCE_N)
    low, high, firm = find_contacts(
        form, Pose(ROLLED_TILT_DEG), (0.9 * FORCE_N, 1.1 * FORCE_N, FIRM_N), math.inf
    )
    stiffness = (high.force_n - low.force_n) / (high.depth_mm - low.depth_mm)

    return PadSurvey(
        shares=shares,
        turn_on_n=turn_on,
        rolled_share=rolled,
        stiffness_n_per_mm=stiffness,
        strain=firm.strain,
        rest_n=find_rest_n(form),
    )


def try_contacts(
    form: PadForm, pose: Pose, *forces_n: float, grid_mm: float = GRID_MM
) -> list[Contact]:
    """Find the contacts whatever the strain, which is a figure of its own.

    There are none in an impossible pose.
    """
    try:
        return find_contacts(
            form,
            pose=pose,
            forces_n=forces_n,
            max_strain=math.inf,
            grid_mm=grid_mm,
        )
    except TraceError:
        return []


@lru_cache(maxsize=256)
def _share(form: PadForm, pose: Pose, force_n: float) -> float:
    contacts = try_contacts(form, pose, force_n)
    return contacts[0].share if contacts else 0.0


def find_turn_on_n(form: PadForm, tilt_deg: float) -> float:
    """Find the force [N] of which the sensor's share, with what is there at rest, is its turn-on.

    It may be infinite.
    """
    share = _share(form, Pose(tilt_deg), FORCE_N)
    force = math.inf
    missing = max(0.0, form.turn_on_n - find_rest_n(form))

    for _ in range(_TURN_ON_STEPS):
        if share <= missing / MAX_TURN_ON_N:
            return math.inf

        before = force
        force = missing / share
        if abs(force - before) <= 0.01 * force:
            break

        share = _share(form, Pose(tilt_deg), max(force, _LEAST_FORCE_N))

    return force
