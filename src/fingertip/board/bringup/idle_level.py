"""Idle level of the envelope beside the threshold of a detector in software: what to measure, and where to add it."""

from __future__ import annotations

from fingertip.board.bringup.bench import HOST
from fingertip.board.bringup.plan import QUIET_ENVELOPE, BringUp
from fingertip.board.parts.circuit import VMID

_SHARE = 0.5
"""Share of the detector's threshold above which the envelope at rest is to be added to it."""
_ONLY_ANALOG = (
    "Never change it for `digital`, the default: its envelope is computed from T and has no offset of the board."
)


def describe_idle_level(plan: BringUp, threshold_v: float) -> str:
    """Describe how the idle level is measured, and to what it is added, for a board without a comparator.

    `threshold_v` is that of the detector [V].
    """
    limits = plan.levels[QUIET_ENVELOPE]
    return (
        f"The detector `analog` compares the envelope with `detector.threshold_v` ({1e3 * threshold_v:g} mV) and "
        f"subtracts no offset, while a good board may read up to {1e3 * limits.high_v:.0f} mV at TP4. `--readings` "
        f"says so where `{QUIET_ENVELOPE}` exceeds {100 * _SHARE:.0f} % of the threshold. Then measure the mean of "
        f"{_name_level(plan)}, with the sensor at J1, untouched, and the ADC connected. The threshold allows for the "
        f"mean due to noise ({1e3 * limits.expected_v:.1f} mV): take that off, and add the rest to the threshold for "
        f"`analog` alone: `{_options('...')}`. {_ONLY_ANALOG}"
    )


def note_idle_level(plan: BringUp, volts: float, threshold_v: float) -> list[str]:
    """Say where the envelope at rest at TP4 [V] is large beside the detector's threshold [V]."""
    limits = plan.levels[QUIET_ENVELOPE]
    # Beyond its limits it is a fault or a mistake of the measurement, and no offset to allow for.
    if not _SHARE * threshold_v < volts <= limits.high_v:
        return []
    raised = threshold_v + volts - limits.expected_v
    return [
        f"{QUIET_ENVELOPE}: {1e3 * volts:.0f} mV is {100 * volts / threshold_v:.0f} % of detector.threshold_v "
        f"({1e3 * threshold_v:g} mV). For the detector `analog` alone, add it, less the mean due to noise "
        f"({1e3 * limits.expected_v:.1f} mV): `{_options(f'{raised:.3f}')}`; {_name_level(plan)} in place of "
        f"{QUIET_ENVELOPE} is more exact. {_ONLY_ANALOG}"
    ]


def _options(threshold: str) -> str:
    return f"--detector analog --set detector.threshold_v={threshold}"


def _name_level(plan: BringUp) -> str:
    return f"{'E minus M' if plan.board.signal_ground == VMID else 'E'} at {HOST}"
