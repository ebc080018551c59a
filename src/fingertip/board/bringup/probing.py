"""Mistakes of the person with the meter: readings that were taken between other points than the sheet says.

A board whose signal ground is half of the supply has two grounds. With the black probe at the wrong one, every direct
voltage is off by the same amount, and each looks like a fault of another part. Alternating voltages are the same at
both grounds.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from fingertip.board.bringup.pins import HOST
from fingertip.board.bringup.prediction import POINTS, Board, is_tone, name_voltage
from fingertip.board.circuits.signal_paths import RECT_OUT
from fingertip.board.nets import ENVELOPE, VMID

Voltages = Mapping[str, float]
_GROUND = name_voltage(VMID)


@dataclass(frozen=True)
class Mistake:
    """Way to take the readings wrongly."""

    sentence: str
    remedy: str
    apply: Callable[[Voltages], Voltages]
    """Readings that result [V], from those that the sheet asks for."""


def list_mistakes(board: Board) -> tuple[Mistake, ...]:
    """List the mistakes that are possible with the grounds of a board; none where both are one net."""
    return _TWO_GROUNDS if board.signal_ground == VMID else ()


def is_direct(name: str) -> bool:
    """Return whether a reading is a direct voltage: any without the tone, and the envelope and rectifier with it."""
    return not is_tone(name) or name.startswith(tuple(f"{POINTS[net].lower()}_" for net in (ENVELOPE, RECT_OUT)))


def _from_supply_ground(values: Voltages) -> Voltages:
    ground_v = values[_GROUND]
    return {name: v + ground_v if is_above_signal_ground(name) else v for name, v in values.items()}


def _from_signal_ground(values: Voltages) -> Voltages:
    ground_v = values[_GROUND]
    return {name: v - ground_v if _is_at_host(name) else v for name, v in values.items()}


def is_above_signal_ground(name: str) -> bool:
    """Return whether a reading is a direct voltage with the black probe at signal ground."""
    return is_direct(name) and name != _GROUND and not _is_at_host(name)


def _is_at_host(name: str) -> bool:
    """Return whether a reading is a direct voltage at a pin of the output connector, against supply ground."""
    return name.startswith(f"{HOST.lower()}_") and is_direct(name)


def _replace_ground(values: Voltages, ratio: float) -> Voltages:
    return {**values, _GROUND: ratio * values[_GROUND]}


_TWO_GROUNDS = (
    Mistake(
        "the direct voltages were taken with the black probe at supply ground (GND) instead of signal ground (TP5)",
        f"move the black probe to TP5, for all but {_GROUND} and those at {HOST}, and measure again",
        _from_supply_ground,
    ),
    Mistake(
        f"the direct voltages at {HOST} were taken with the black probe at signal ground (TP5)",
        "move the black probe to supply ground (GND) for them, and measure again",
        _from_signal_ground,
    ),
    Mistake(
        f"{_GROUND} was taken with the black probe at TP5 and the red one at supply ground (GND)",
        "exchange the probes for it, and measure again",
        lambda values: _replace_ground(values, -1.0),
    ),
    Mistake(
        f"{_GROUND} was taken with both probes at signal ground (TP5)",
        "move the black probe to supply ground (GND) for it, and measure again",
        lambda values: _replace_ground(values, 0.0),
    ),
)
