"""Faults that no reading of a bring-up reveals: every reading of a board that has one is within its limits."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from fingertip.board.bringup.diagnosis import fit_offset
from fingertip.board.bringup.faults import Fault, list_faults
from fingertip.board.bringup.plan import BringUp, resistance_limits
from fingertip.board.bringup.prediction import name_voltage, predict
from fingertip.board.nets import STAGE1_OUT

_VALUES = 2
"""Rarity from which a fault is a wrong value: those are left to the placement file."""


def list_hidden_faults(plan: BringUp) -> dict[str, list[str]]:
    """List the parts whose fault shows in no reading, by what is wrong with them."""
    board = plan.board
    faults = [fault for fault in list_faults(board.circuit, board.ends_v) if fault.rarity < _VALUES]
    hidden: dict[str, list[str]] = {}
    first_stage = name_voltage(STAGE1_OUT)
    beyond = {first_stage: 2.0 * plan.levels[first_stage].high_v}
    for fault, found in zip(faults, predict(board, faults), strict=True):
        # An offset that the fault lets through shows, unless it happens to be nearly none.
        values = fit_offset(board, fault, found, beyond)
        is_within = all(limits.low_v <= values[name] <= limits.high_v for name, limits in plan.levels.items())
        if is_within and not any(_list_wrong_resistances(plan, fault)):
            what = fault.description.removeprefix("is ").partition(":")[0]
            hidden.setdefault(what, []).append(fault.reference)
    return hidden


def list_unsimulated(plan: BringUp) -> list[str]:
    """List the clamps, whose faults are not simulated: without them every reading is as it should be."""
    return [part.reference for part in plan.board.circuit.components if part.symbol.name == "BAT54S"]


def _list_wrong_resistances(plan: BringUp, fault: Fault) -> Iterator[str]:
    """Yield the readings of the ohmmeter that a fault takes out of their limits."""
    found = resistance_limits(replace(plan.board, circuit=fault.circuit))
    for name, limits in plan.before_power.items():
        if not limits.low_v <= found[name].expected_v <= limits.high_v:
            yield name
