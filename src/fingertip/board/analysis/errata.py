"""Errata of the article about its own board: what it states, and what is correct."""

from __future__ import annotations

from dataclasses import dataclass, replace

from fingertip.catalogues.amplifiers import ARTICLE_AMPLIFIER, CATALOGUE

# Touches of the finger, and how far down each drives the filtered signal: results of simulations, stored as data.
#
# This package does not import the simulation. `tests/board/test_touches.py` simulates each touch again.


@dataclass(frozen=True)
class SimulatedTouch:
    """Touch of the finger and the lowest filtered voltage that it causes on the default board, by simulation.

    The amplifiers are ideal, so the voltage is that which would be reached if nothing limited it.
    """

    force_n: float
    rise_s: float
    """Time in which the force rises."""
    min_filtered_v: float


SLOW_PRESS = SimulatedTouch(1.5, 0.2, -0.1)
FAST_PRESSES = SimulatedTouch(1.5, 0.04, -2.1), SimulatedTouch(1.5, 0.025, -4.2)
"""Presses that reach the TL082's typical limit, and exceed it."""
KNOCK = SimulatedTouch(0.2, 0.004, -2.6)
"""Tap on an object that is held with 1 N."""


def describe_touches() -> str:
    """Describe which touches drive the filtered signal below the TL082's input range."""
    limit, beyond = FAST_PRESSES
    return (
        f"in simulations of the article's board a press to {limit.force_n:g} N takes the filtered signal to "
        f"{limit.min_filtered_v:.1f} V if the force rises within {1e3 * limit.rise_s:g} ms and to "
        f"{beyond.min_filtered_v:.1f} V within {1e3 * beyond.rise_s:g} ms, but only to "
        f"{SLOW_PRESS.min_filtered_v:.1f} V within {1e3 * SLOW_PRESS.rise_s:g} ms; a knock of {KNOCK.force_n:g} N "
        f"within {1e3 * KNOCK.rise_s:g} ms on a held object takes it to {KNOCK.min_filtered_v:.1f} V"
    )


@dataclass(frozen=True)
class Erratum:
    """One error of the article about its own board.

    Its components are C1 = C2 = C3 = 1 uF, R1 = 2.4k, R2 = 1.2k, R3 = 4.7k, R4 = 1.5k, R5 = 100k, R_LP = 2k and
    C_LP = 2.2 uF.
    """

    subject: str
    statement: str
    """Statement or omission of the article."""
    correction: str
    """Correct statement, with a note if it does not apply to the board at hand."""


ENVELOPE, RECTIFIER, OFFSET = "envelope, eq. (11)", "rectifier", "offset"
INPUT_RANGE = "input range of the amplifiers"

ERRATA: tuple[Erratum, ...] = (
    Erratum(
        "gain, eq. (2)",
        "G = 66.7 (36.5 dB) with G = 1 + R5/R4, R5 = 100k, R4 = 1.5k",
        "66.7 is R5/R4; G is 67.67 (36.61 dB)",
    ),
    Erratum("cutoff, eq. (10)", "omega_c = 1/sqrt(R2 R3 C)", "omega_c = 1/(C sqrt(R2 R3))"),
    Erratum(
        "transfer functions, eqs. (1), (3), (4), (9), (11)",
        "polynomials in omega, with -omega^2 and a real term in omega",
        "polynomials in s = j omega",
    ),
    Erratum(
        "cutoff with preferred values",
        "67 Hz and Q = 1",
        "1.2k and 4.7k give f0 67.02 Hz and Q 0.9895; with the first pole at 66.31 Hz, -3 dB is at 67.26 Hz "
        "(ideal amplifiers)",
    ),
    Erratum(
        "flatness",
        "Q = 1 makes the second stage maximally flat",
        "that stage alone peaks by 1.25 dB; the product of both is maximally flat (third-order Butterworth)",
    ),
    Erratum(
        ENVELOPE,
        "H_LP = (1/C_LP)/(omega + omega_LP) is a low-pass filter at 36.17 Hz",
        "it is a transimpedance (ohm): a diode feeding R_LP parallel to C_LP is a peak detector, which rises fast "
        "and decays with tau = 4.40 ms (36.17 Hz)",
    ),
    Erratum(
        RECTIFIER,
        "a diode downstream rectifies the filtered signal",
        "a 1N4148 conducts from about 0.45 V, so this half-wave rectifier has a dead zone: below about 6.7 mV at the "
        "filter's input the output stays zero",
    ),
    Erratum(
        OFFSET,
        "TL082 at this gain; its offset is not mentioned",
        "R4 returns to ground directly, so 3 mV of offset become 203 mV ahead of C2; a capacitor of at least 16 uF in "
        "series with R4 reduces the gain at DC to 1, and 3 mV remain",
    ),
    Erratum(
        INPUT_RANGE,
        "TL082 on plus and minus 5 V; its common-mode input range is not mentioned",
        "the range ends at about -2 V (guaranteed: -1 V), and below it the output reverses its phase and jumps up; "
        f"{describe_touches()}; variants precision and comparator have amplifiers with rail-to-rail inputs",
    ),
)


def board_errata(amplifier: str, has_diode: bool) -> tuple[Erratum, ...]:
    """List the errata, with notes on those that do not apply to a board."""
    notes = {}
    if amplifier != ARTICLE_AMPLIFIER:
        notes[INPUT_RANGE] = f"it has a {CATALOGUE[amplifier].order_name} with rail-to-rail inputs"
    if not has_diode:
        notes[OFFSET] = "C14 is such a capacitor"
        notes |= dict.fromkeys((ENVELOPE, RECTIFIER), "it has a precision rectifier and a low-pass")
    return tuple(
        replace(e, correction=f"{e.correction} (does not apply to this board: {notes[e.subject]})")
        if e.subject in notes
        else e
        for e in ERRATA
    )
