"""Choice of the board's dual amplifier, and the stability, currents and swing that it must have.

The rules refuse by these formulas, which are closed forms for ideal component values.
`fingertip.board.analysis.gate` computes the same conditions from the circuit with its preferred
values, and a test compares both.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable

from fingertip.catalogues import electronics
from fingertip.catalogues.electronics import Amplifier
from fingertip.design.formulas import filter as filter_components
from fingertip.design.parameters.board_and_detector import Board
from fingertip.foundation.numerics import bisect


def total_supply_v(board: Board) -> float:
    """Voltage between both supply pins [V]."""
    return board.supply_v if board.is_for_controller else 2.0 * board.supply_v


def works_on_supply(amplifier: Amplifier, board: Board) -> bool:
    return amplifier.min_supply_v <= total_supply_v(board) <= amplifier.max_supply_v


def choose_amplifier(board: Board) -> Amplifier:
    """Return the dual amplifier of a board: the one it names, or for "auto" the one that fits the
    variant.

    The article's own board has the article's amplifier. Variant comparator has a threshold of some
    millivolts in hardware, and five offsets add up in its envelope, so it has an amplifier of low
    offset. A board of several fingers has twenty amplifiers, so it has those of low supply current.
    """
    is_named = board.amplifier != electronics.AUTO
    name = board.amplifier if is_named else choose_automatically(board)
    return electronics.AMPLIFIER_CATALOGUE[name]


def choose_automatically(board: Board) -> str:
    """Return the amplifier of the variant, as `choose_amplifier` explains."""
    if board.variant == "article":
        return electronics.ARTICLE_AMPLIFIER
    if board.variant == "comparator":
        return electronics.LOW_OFFSET_AMPLIFIER

    if board.channels > 1:
        return electronics.LOW_POWER_AMPLIFIER

    return electronics.RAIL_TO_RAIL_AMPLIFIER


def find_gain_bandwidth_hz(board: Board) -> float:
    return choose_amplifier(board).bandwidth_hz


BAND_CUTOFFS = 3.0
"""Band of vibrations that is kept, in cutoffs: slip of the embedded finger ends at 1.5, that of the
bare sensor reaches about 3.
"""
RAIL_DISTANCE_V = 0.5
"""Distance from the rails at which data sheets state the output current [V]."""
MID_RAIL_RATIO = 2.0
"""Ratio of an output's current at mid-supply to the stated one near a rail (assumed)."""
DIODE_V = 0.6
"""Forward voltage of a rectifier's diode for a large signal [V]."""
_LOW_HZ = 1e3
_HIGH_HZ = 1e9
_POINTS_PER_DECADE = 24
_PEAK_HZ = tuple(
    10.0 ** (point / _POINTS_PER_DECADE)
    for point in range(4 * _POINTS_PER_DECADE, 8 * _POINTS_PER_DECADE + 1)
)
"""Frequencies at which a resonance is searched, over four decades [Hz]."""
_HALVINGS = 50

Feedback = Callable[[float], complex]
"""Ratio of the voltage fed back to the output's, as a function of the frequency [Hz]."""


def first_stage_feedback(board: Board, amplifier: Amplifier, r5_ohm: float) -> Feedback:
    """Feedback of the first stage: R5 and C20 against R4 and the input's capacitance.

    Variant article has no C20.
    """
    r4_ohm = filter_components.r4_ohm(board.passband_gain, r5_ohm)
    c20_f = 0.0
    if board.variant != "article":
        c20_f = filter_components.compute_limiting_capacitor_f(r5_ohm, board.band_limit_hz)

    return divider(r5_ohm, c20_f, r4_ohm, amplifier.input_f)


def divider(upper_ohm: float, upper_f: float, lower_ohm: float, lower_f: float) -> Feedback:
    """Feedback through a resistor and a capacitor in parallel, against the same to ground."""

    def feedback(f_hz: float) -> complex:
        s = 2j * math.pi * f_hz
        upper = 1.0 / upper_ohm + s * upper_f
        lower = 1.0 / lower_ohm + s * lower_f
        return upper / (upper + lower)

    return feedback


def compute_phase_margin_deg(amplifier: Amplifier, feedback: Feedback) -> float:
    """Compute the phase above -180 degrees at which a loop's gain falls to 1 [degree]."""

    def loop_gain(log_hz: float) -> complex:
        return amplifier.open_loop_gain(math.exp(log_hz)) * feedback(math.exp(log_hz))

    low = math.log(_LOW_HZ)
    high = math.log(_HIGH_HZ)
    crossing, _ = bisect(lambda log_hz: abs(loop_gain(log_hz)) > 1.0, low, high, halvings=_HALVINGS)
    loop = loop_gain(crossing)
    # All poles of the loop together lag by less than 270 degrees, so that the phase wraps once at
    # most.
    phase = math.degrees(math.atan2(loop.imag, loop.real))

    return 180.0 + (phase if phase <= 0.0 else phase - 360.0)


RECTIFIER_OHMS = (10e3, 4.7e3, 2.2e3)
"""Resistances of the precision rectifier [ohm], the preferred one first."""
GOOD_PHASE_MARGIN_DEG = 45.0
"""Phase margin below which a loop rings [degree]."""


def select_rectifier_ohm(amplifier: Amplifier) -> float:
    """Select both resistors of the precision rectifier [ohm].

    A large capacitance of the input needs small ones.
    """
    for ohm in RECTIFIER_OHMS:
        feedback = divider(ohm, 0.0, ohm, amplifier.input_f)
        if compute_phase_margin_deg(amplifier, feedback) >= GOOD_PHASE_MARGIN_DEG:
            return ohm

    return RECTIFIER_OHMS[-1]


def compute_peaking_db(amplifier: Amplifier, feedback: Feedback, passband_gain: float) -> float:
    """Compute the largest gain of both filter stages beyond the band, over the passband's [dB]."""
    largest = 0.0
    for f_hz in _PEAK_HZ:
        gain = amplifier.open_loop_gain(f_hz)
        largest = max(largest, abs(gain / (1.0 + gain * feedback(f_hz)) * gain / (1.0 + gain)))

    return 20.0 * math.log10(largest / passband_gain)


def input_swing_v(board: Board, amplifier: Amplifier) -> float:
    """Typical swing of a follower around the signal ground [V], limited by output or input."""
    headroom_v = filter_components.smaller_headroom_v(board)
    return headroom_v - max(amplifier.output_from_rail_v, amplifier.input_from_lower_v[0])


def loaded_swing_v(board: Board, amplifier: Amplifier) -> float:
    """Amplitude for which output currents are compared [V].

    It is no nearer to a rail than data sheets state them.
    """
    to_rail_v = filter_components.smaller_headroom_v(board) - RAIL_DISTANCE_V
    return min(input_swing_v(board, amplifier), to_rail_v)


@functools.cache
def section_currents() -> tuple[float, float, float]:
    """Largest currents of the Sallen-Key section in the band, over (2 pi f_c C V).

    Returns those of the first stage's output, of the second's, and of R3, for a first stage that
    swings by V in its passband. With s = j f / f_c the section is s^2 / (1 + s + s^2), and the
    voltage between C2 and C3 is (1 + 2 s) / (2 s) times that at the amplifier's input.
    """
    largest = [0.0, 0.0, 0.0]
    for point in range(_POINTS_PER_DECADE):
        s = 1j * BAND_CUTOFFS ** (point / (_POINTS_PER_DECADE - 1))
        first = s / (1.0 + s)
        output = first * s * s / (1.0 + s + s * s)
        middle = output * (1.0 + 2.0 * s) / (2.0 * s)
        for i, current in enumerate((s * (first - middle), 2.0 * (output - middle), 0.5 * output)):
            largest[i] = max(largest[i], abs(current))

    return largest[0], largest[1], largest[2]


def compute_filter_current_a(board: Board) -> float:
    """Compute the larger output current of both filter amplifiers for the largest signal [A].

    The current of the rectifier is left out.
    """
    amplitude_v = loaded_swing_v(board, choose_amplifier(board))
    first, second, _ = section_currents()
    c_f = filter_components.to_farads(board.capacitor_uf)
    scale = math.tau * board.cutoff_hz * c_f * amplitude_v
    return max(first * scale + amplitude_v / board.r5_ohm, second * scale)


def compute_charging_current_a(peak_v: float, f_hz: float, ohm: float, farad: float) -> float:
    """Compute the peak current of a peak detector in its steady state [A], for a sine.

    Behind a diode with a fixed drop, the capacitor is charged to the peak less the drop, V. It
    decays through the resistor, and is charged again from the angle at which the sine less the drop
    meets it. The current, C dv/dt + v / R, is largest there or a little later.
    """
    top_v = peak_v - DIODE_V
    if top_v <= 0.0:
        return 0.0

    omega = math.tau * f_hz

    def is_below_capacitor(angle: float) -> bool:
        elapsed_s = (1.5 * math.pi + angle) / omega
        return peak_v * math.sin(angle) - DIODE_V < top_v * math.exp(-elapsed_s / (ohm * farad))

    low, _ = bisect(
        is_below_capacitor, math.asin(DIODE_V / peak_v), math.pi / 2.0, halvings=_HALVINGS
    )
    angles = [low + i / 8.0 * (math.pi / 2.0 - low) for i in range(9)]
    return max(
        farad * omega * peak_v * math.cos(angle) + (peak_v * math.sin(angle) - DIODE_V) / ohm
        for angle in angles
    )


def compute_envelope_current_a(board: Board, c_lp_f: float) -> float:
    """Compute the peak current into the envelope capacitor of variant article [A].

    It is that of the largest and fastest vibration.
    """
    amplitude_v = loaded_swing_v(board, choose_amplifier(board))
    r_lp_ohm = filter_components.r_lp_ohm(board.envelope_cutoff_hz, c_lp_f)
    return compute_charging_current_a(amplitude_v, BAND_CUTOFFS * board.cutoff_hz, r_lp_ohm, c_lp_f)
