"""Where the article's figures about its board do not add up: what it says, and what is right."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """One slip of the article about its own board: 1 uF, 2.4k, 1.2k, 4.7k, 100k, 1.5k, then 2k and 2.2 uF."""

    subject: str
    says: str
    right: str


FINDINGS: tuple[Finding, ...] = (
    Finding(
        "gain, eq. (2)",
        "G = 66.7 (36.5 dB) with G = 1 + R5/R4, R5 = 100k, R4 = 1.5k",
        "66.7 is R5/R4; G is 67.67 (36.61 dB)",
    ),
    Finding("cutoff, eq. (10)", "omega_c = 1/sqrt(R2 R3 C)", "omega_c = 1/(C sqrt(R2 R3))"),
    Finding(
        "transfer functions, eqs. (1), (3), (4), (9), (11)",
        "polynomials in omega with -omega^2 beside a real term in omega",
        "polynomials in s = j omega",
    ),
    Finding(
        "cutoff of the built filter",
        "67 Hz and Q = 1",
        "1.2k and 4.7k give f0 67.02 Hz and Q 0.9895; with the first pole at 66.31 Hz, -3 dB is at 67.26 Hz",
    ),
    Finding(
        "flatness",
        "Q = 1 makes the second stage maximally flat",
        "that stage alone peaks by 1.25 dB; the product of both is maximally flat (third-order Butterworth)",
    ),
    Finding(
        "envelope, eq. (11)",
        "H_LP = (1/C_LP)/(omega + omega_LP) is a low-pass filter at 36.17 Hz",
        "it is a transimpedance (ohm): a diode feeding R_LP parallel to C_LP is a peak detector, fast up, "
        "and down with tau = 4.40 ms (36.17 Hz)",
    ),
    Finding(
        "rectifier",
        "a diode downstream rectifies the filtered signal",
        "a 1N4148 conducts from about 0.45 V: below about 6.7 mV at the filter's input nothing comes out",
    ),
    Finding(
        "offset",
        "TL082 at this gain, no word on its offset",
        "R4 returns to ground directly, so 3 mV of offset become 203 mV ahead of C2; 16 uF or more in series "
        "with R4 cures it",
    ),
    Finding(
        "amplifier's inputs",
        "TL082 on plus and minus 5 V, no word on how far its inputs reach",
        "they end at about -2 V (-1 V to be sure), and below its output jumps up; a press to 1.5 N within 0.2 s takes "
        "the second stage's to -3.5 V; variants precision and comparator have a TLV2372",
    ),
)
