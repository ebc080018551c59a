"""Notes on the supply, in the README of a board, and its known limitations."""

from __future__ import annotations

from fingertip.board.analysis.figures import format_figure
from fingertip.board.analysis.supply_ripple import describe_sensor
from fingertip.board.board_values import BoardValues
from fingertip.board.components.comparator import PULL_UP_OHM
from fingertip.board.spice import MAX_SWITCH_OHM
from fingertip.board.supplies import SUPPLIES
from fingertip.design import Design
from fingertip.design.rules.amplifiers import SUPPLY_RANGES_V

POWER_UP_S = 2.0
"""Time after power-up in which the voltages of a board for a controller settle [s]: eight time constants."""


def power_notes(values: BoardValues, design: Design) -> list[str]:
    """Requirements on the supply and, for variant comparator, on the input that S is connected to."""
    ripple, supply_v = values.supply_ripple, design.board.supply_v
    if SUPPLIES[values.supply].is_for_controller:
        return _controller_power_notes(values, design)
    effect = "makes the diode conduct" if values.output_offset is None else "counts as slip at the design's threshold"
    notes = [
        "The board has no reverse polarity protection: a reversed supply destroys it. Check the polarity of the plug "
        "for J2 with a meter before you connect the board.",
        f"The bridge is fed from +{supply_v:g} V. Ripple on this supply reaches the rectifier amplified up to "
        f"{ripple.gain:.0f} times, most at {format_figure(ripple.worst_hz, 2)} Hz (sensor open). Between "
        f"{ripple.low_hz:.3g} Hz and {ripple.high_hz / 1e3:g} kHz its peak must stay below {1e3 * ripple.max_v:.2g} "
        f"mV: more {effect}. Use a low-noise linear regulator near the board, and supply nothing else from it.",
    ]
    if values.comparator_levels:
        notes.append(
            f"S is an active-low logic output: low while slip is detected, and pulled up to +{supply_v:g} V by R21 "
            f"({PULL_UP_OHM / 1e3:g}k) otherwise. A 3.3 V input needs a divider or a level shifter."
        )
    return notes


def _controller_power_notes(values: BoardValues, design: Design) -> list[str]:
    """Describe protection and ripple of a board for a controller, and its slip output."""
    ripple, supply_v = values.supply_ripple, design.board.supply_v
    low_v, high_v = SUPPLY_RANGES_V[values.supply]
    effect = "makes the diode conduct" if values.output_offset is None else "counts as slip at the design's threshold"
    notes = [
        f"Supply {low_v:g} to {high_v:g} V at J2. Q1 blocks a reversed supply. It costs {1e3 * MAX_SWITCH_OHM:.0f} uV "
        f"per mA at most ({1e3 * MAX_SWITCH_OHM:g} mohm).",
        "The plugs of J1, J2 and J3 differ in size, and each fits one way round only.",
        "A divider, C23 and U6 feed the bridge with VREF, which follows the supply below 0.7 Hz only. Ripple on the "
        f"supply reaches the rectifier multiplied by {ripple.gain:.2f} at most, at "
        f"{format_figure(ripple.worst_hz, 2)} Hz ({describe_sensor(ripple)}). Between "
        f"{ripple.low_hz:.3g} Hz and "
        f"{ripple.high_hz / 1e3:g} kHz its peak must stay below {format_figure(1e3 * ripple.max_v, 2)} mV: more "
        f"{effect}. The supply rejection of the amplifiers themselves is not part of these figures.",
        f"After power-up VMID and VREF rise with a time constant of a quarter of a second: wait {POWER_UP_S:g} s.",
        "Feed the controller from the same 3.3 V. Then no signal exceeds its supply, and both go on and off together. "
        "The clamps lead to the supply of this board: they do not protect a controller that is off, or on less.",
    ]
    if values.comparator_levels:
        notes.append(
            f"SLIP is an active-low open collector with a pull-up to +{supply_v:g} V (R21, {PULL_UP_OHM / 1e3:g}k), "
            "which the hysteresis needs. Do not join the SLIP lines of two boards: each would change the threshold of "
            "the other."
        )
    return notes


def limitation_notes(values: BoardValues) -> list[str]:
    """Limitations that a user should know."""
    if SUPPLIES[values.supply].is_for_controller:
        return [
            "There is no protection against an excessive supply voltage.",
            "The filtered signal has less headroom than on the boards for 5 V: a fast press clips it for some "
            "milliseconds.",
        ]
    return [
        "There is no filter for the bridge's supply. A filter that rejects ripple at 30 Hz does not fit on this board.",
        "There is no protection against a reversed supply or an excessive supply voltage.",
    ]
