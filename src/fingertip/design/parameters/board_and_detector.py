"""Parameters of the analog filter board and of slip detection.

The defaults are a board for a controller of 3.3 V with the article's filter; the bundled design
`article` has the article's own circuit, supply and converter.
"""

from __future__ import annotations

from typing import Annotated, Literal

from fingertip.catalogues.electronics import AMPLIFIER_CATALOGUE, AUTO, NAMES
from fingertip.design.parameters.declaration import Above, OneOf, ParameterTable, choice, quantity


class Board(ParameterTable):
    """Analog slip filter (article, eqs. 1 to 11 and figure 3)."""

    variant: Literal["article", "precision", "comparator", "divider"] = choice(
        "precision",
        "article: the article's circuit, on plus and minus 5 V; precision: for a controller of "
        "3.3 V, whose software "
        "computes the envelope; comparator: the same with rectifier, envelope and an ON/OFF "
        "output; divider: no board, "
        "the sensor and one resistor on a controller's pin.",
    )
    divider_ohm: float = quantity(
        10e3,
        "ohm",
        (1000, 1e6),
        "Resistor from the controller's pin to ground; the sensor is above it (divider).",
    )
    channels: int = quantity(
        1,
        "",
        (1, len(NAMES)),
        "Fingers that one board reads; from 2 on the board has five places, of which that many "
        "are fitted (precision).",
    )
    cable_m: float = quantity(
        0.5,
        "m",
        (0.05, 5),
        "Length of the cables of a board of several fingers, for which their crosstalk is "
        "computed.",
    )
    cutoff_hz: float = quantity(
        67.0, "Hz", (0.0001, 10000), "Cutoff of the third-order Butterworth high-pass."
    )
    capacitor_uf: float = quantity(
        0.1,
        "uF",
        (1e-6, 1000),
        "Filter capacitors C1 = C2 = C3: C0G up to 0.1 uF; the article has 1 uF.",
    )
    passband_gain: float = quantity(
        1 + 100 / 1.5,
        "",
        (Above(1), 10000),
        "Passband gain G = 1 + R5/R4; the article prints 66.7, which is R5/R4 alone.",
    )
    r5_ohm: float = quantity(100e3, "ohm", (1000, 10e6), "Feedback resistor R5 of the first stage.")
    envelope_cutoff_hz: float = quantity(
        36.17,
        "Hz",
        (0.0001, 10000),
        "Cutoff frequency of the envelope, on the board or in software.",
    )
    envelope_capacitor_uf: float = quantity(
        2.2, "uF", (1e-6, 1000), "Envelope capacitor C_LP (article, comparator)."
    )
    capacitor_series: Literal["given", "E6", "E12", "preferred"] = choice(
        "given",
        "given: the capacitors above; E6, E12: selected from this series by cutoff, together with "
        "the resistors; "
        "preferred: only values that are sold.",
    )
    series: Literal["E12", "E24", "E96"] = choice(
        "E24", "Series of preferred values for resistors (IEC 60063)."
    )
    resistor_tolerance_percent: float = quantity(
        1.0, "%", (0, 20), "Tolerance of the filter's resistors, for the tolerance analysis."
    )
    capacitor_tolerance_percent: float = quantity(
        0.0,
        "%",
        (0, 20),
        "Tolerance of the signal path's capacitors; 0: that of the parts sold (X7R 10 %, C0G 5 "
        "%). Article: 5 %.",
    )
    band_limit_hz: float = quantity(
        1000.0,
        "Hz",
        (10, 1e5),
        "Low-pass cutoff of the first stage against amplifier noise (precision, comparator; "
        "article has none).",
    )
    amplifier: Annotated[str, OneOf(AUTO, *AMPLIFIER_CATALOGUE)] = choice(
        AUTO,
        "Dual amplifiers of the board; auto: TL082 (article), MCP6022 (precision; from 2 channels "
        "on TLV2372, which "
        "draw less), OPA2376 (comparator).",
    )
    resistor_choice: Literal["joint", "apart"] = choice(
        "joint",
        "joint: R1, R2, R3 that together deviate least from a Butterworth response; apart: each "
        "nearest to its ideal.",
    )
    supply_v: float = quantity(
        3.3,
        "V",
        (3.1, 5.5),
        "Supply voltage: 3.1 to 3.6 (divider: to 5.5), or each half of that of variant article: 5 "
        "to 5.5.",
    )

    @property
    def is_for_controller(self) -> bool:
        """True for a board on 3.3 V, with VMID as its signal ground
        and the filtered signal at its connector.
        """
        return self.variant in ("precision", "comparator")

    @property
    def has_filter(self) -> bool:
        """True for a board with filter and amplifiers; a divider has the tactile voltage alone."""
        return self.variant != "divider"

    @property
    def has_envelope(self) -> bool:
        """True for a board that gives the envelope; of another, software computes it.

        A test reads the circuit.
        """
        return self.variant in ("article", "comparator")

    @property
    def tactile_rises(self) -> bool:
        """True if the tactile voltage rises with the force. A test compares it with the circuit."""
        return self.variant != "article"


class Detector(ParameterTable):
    """Slip detection: sampling, averaging window and threshold (article, eq. 12)."""

    kind: Literal["fast", "incipient", "digital", "analog", "fft"] = choice(
        "fast", "Detector that is meant for this finger and board: a validation judges it."
    )
    sample_rate_hz: float = quantity(2000.0, "Hz", (1000, 20000), "Sampling rate of the traces.")
    window_samples: int = quantity(60, "samples", (1, 10000), "Length L of the averaging window.")
    threshold_v: float = quantity(
        0.023,
        "V",
        (1e-9, 10),
        "Threshold of the mean envelope above which slip is ON, of digital and analog "
        "(kind=analog: of analog alone); default: its mean plus 6 standard deviations in noise.",
    )
    noise_v: float = quantity(
        0.5e-3,
        "V",
        (0, 1),
        "RMS noise of the sampled voltages without ADC quantisation; default: 0.6 steps of 12 "
        "bits over 3.3 V. "
        "(unverified)",
    )
    adc_bits: int = quantity(12, "bit", (8, 24), "Resolution of the ADC.")
    adc_range_v: float = quantity(3.3, "V", (0.01, 100), "Upper end of the ADC's input range.")
    adc_polarity: Literal["bipolar", "unipolar"] = choice(
        "unipolar",
        "Input range of the ADC: plus and minus adc_range_v, or from 0 to it as in most "
        "microcontrollers.",
    )

    @property
    def adc_low_v(self) -> float:
        return -self.adc_range_v if self.adc_polarity == "bipolar" else 0.0

    @property
    def adc_step_v(self) -> float:
        """Step of the ADC [V]: its least significant bit."""
        return float((self.adc_range_v - self.adc_low_v) / 2**self.adc_bits)

    @property
    def adc_range_text(self) -> str:
        return f"+/-{self.adc_range_v:g} V" if self.adc_low_v else f"0 to {self.adc_range_v:g} V"
