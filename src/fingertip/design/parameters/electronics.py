"""Parameters of the analog filter board and of slip detection.

The defaults are a board for a controller of 3.3 V with the article's filter; the bundled design `article` has the
article's own circuit, supply and converter.
"""

from __future__ import annotations

from typing import Literal

from fingertip.catalogues.amplifiers import AmplifierName
from fingertip.design.parameters.declaration import ParameterTable, choice, quantity


class Board(ParameterTable):
    """Analog slip filter (article, eqs. 1 to 11 and figure 3)."""

    variant: Literal["article", "precision", "comparator"] = choice(
        "precision",
        "article: the article's circuit; precision: no dead zone, one envelope pole; comparator: an ON/OFF output too.",
    )
    cutoff_hz: float = quantity(
        67.0, "Hz", "Cutoff frequency of the third-order Butterworth high-pass.", above=0, maximum=10000
    )
    capacitor_uf: float = quantity(1.0, "uF", "Filter capacitors C1 = C2 = C3.", minimum=1e-6, maximum=1000)
    passband_gain: float = quantity(
        1 + 100 / 1.5,
        "",
        "Passband gain G = 1 + R5/R4; the article prints 66.7, which is R5/R4 alone.",
        above=1,
        maximum=10000,
    )
    r5_ohm: float = quantity(100e3, "ohm", "Feedback resistor R5 of the first stage.", minimum=1000, maximum=10e6)
    envelope_cutoff_hz: float = quantity(
        36.17, "Hz", "Cutoff frequency of the envelope, 1 / (2 pi R_LP C_LP).", above=0, maximum=10000
    )
    envelope_capacitor_uf: float = quantity(2.2, "uF", "Envelope capacitor C_LP.", minimum=1e-6, maximum=1000)
    capacitor_series: Literal["given", "E6", "E12", "preferred"] = choice(
        "given",
        "given: the capacitors above; E6, E12: selected from this series by cutoff, together with the resistors; "
        "preferred: only values that are sold.",
    )
    series: Literal["E12", "E24", "E96"] = choice("E24", "Series of preferred values for resistors (IEC 60063).")
    resistor_tolerance_percent: float = quantity(
        1.0, "%", "Tolerance of the filter's resistors, for the tolerance analysis.", minimum=0, maximum=20
    )
    capacitor_tolerance_percent: float = quantity(
        0.0,
        "%",
        "Tolerance of the signal path's capacitors; 0: that of the parts sold (X7R 10 %, C0G 5 %). Article: 5 %.",
        minimum=0,
        maximum=20,
    )
    band_limit_hz: float = quantity(
        1000.0,
        "Hz",
        "Low-pass cutoff of the first stage against amplifier noise (precision, comparator; article has none).",
        minimum=10,
        maximum=1e5,
    )
    amplifier: AmplifierName = choice(
        "auto",
        "Dual amplifier of filter and rectifier; auto: TL082 (article, split), OPA2197 (comparator; OPA2376 at 3.3 V), "
        "else TLV2372.",
    )
    resistor_choice: Literal["joint", "apart"] = choice(
        "joint",
        "joint: R1, R2, R3 that together deviate least from a Butterworth response; apart: each nearest to its ideal.",
    )
    supply: Literal["split", "single", "single_3v3"] = choice(
        "single_3v3",
        "split: plus and minus supply_v; single: supply_v alone, with signals around a buffered half of it; "
        "single_3v3: the same for a controller, with all outputs from 0 to 3.3 V.",
    )
    supply_v: float = quantity(
        3.3,
        "V",
        "Supply voltage, or each half of a split supply: 5 to 6, or 3.1 to 3.6 with single_3v3.",
        minimum=3.1,
        maximum=6,
    )


class Detector(ParameterTable):
    """Slip detection: sampling, averaging window and threshold (article, eq. 12)."""

    sample_rate_hz: float = quantity(2000.0, "Hz", "Sampling rate of the traces.", minimum=1000, maximum=20000)
    window_samples: int = quantity(60, "samples", "Length L of the averaging window.", minimum=1, maximum=10000)
    threshold_v: float = quantity(
        0.023,
        "V",
        "Threshold of the mean envelope above which slip is ON; default: its mean plus 6 standard deviations in noise.",
        above=0,
        maximum=10,
    )
    noise_v: float = quantity(
        0.5e-3,
        "V",
        "RMS noise of the sampled voltages without ADC quantisation; default: 0.6 steps of 12 bits over 3.3 V.",
        minimum=0,
        maximum=1,
        verified=False,
    )
    adc_bits: int = quantity(12, "bit", "Resolution of the ADC.", minimum=8, maximum=24)
    adc_range_v: float = quantity(3.3, "V", "Upper end of the ADC's input range.", minimum=0.01, maximum=100)
    adc_polarity: Literal["bipolar", "unipolar"] = choice(
        "unipolar", "Input range of the ADC: plus and minus adc_range_v, or from 0 to it as in most microcontrollers."
    )

    @property
    def adc_low_v(self) -> float:
        """Lower end of the ADC's input range [V]."""
        return -self.adc_range_v if self.adc_polarity == "bipolar" else 0.0

    @property
    def adc_step_v(self) -> float:
        """Step of the ADC [V]: its least significant bit."""
        return float((self.adc_range_v - self.adc_low_v) / 2**self.adc_bits)

    @property
    def adc_range_text(self) -> str:
        """Input range of the ADC in words."""
        return f"+/-{self.adc_range_v:g} V" if self.adc_low_v else f"0 to {self.adc_range_v:g} V"
