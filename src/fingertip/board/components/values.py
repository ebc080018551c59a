"""Supplies of a board, and the values of all its components, selected for a design."""

from __future__ import annotations

import functools
import itertools
import math
from dataclasses import dataclass

from fingertip.board.components import front_end, selection
from fingertip.board.components.front_end import Bridge, size_bridge
from fingertip.board.parts.nets import GND, VEE, VMID
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import choose_amplifier
from fingertip.design.formulas.filter import (
    AVERAGING_OHM,
    MAX_AVERAGING_F,
    VMID_BOTTOM_OHM,
    VMID_TOP_OHM,
    FilterComponents,
)
from fingertip.design.parameters.board_and_detector import Board
from fingertip.foundation.errors import BoardError, Issue

# Supplies of a board: signal ground, negative rail of the amplifiers, and headroom of each.
#
# On a split supply of plus and minus 5 V, signal ground is supply ground (0 V), as in the article.
# On 3.3 V it is VMID (buffered mid-supply, `fingertip.design.formulas.filter`). Filters, rectifier,
# envelope and threshold refer to it, and the amplifiers need rail-to-rail inputs and outputs. These
# boards are made for the controller of a hand: their outputs stay within the supply, their
# connectors are keyed and lock, and neither a reversed supply nor a static discharge into the
# sensor's cable does harm.


@dataclass(frozen=True)
class Supply:
    signal_ground: str
    """Net to which the signals refer."""
    negative_rail: str
    description: str
    nominal_v: float
    signal_ground_ratio: float = 0.0
    """Voltage of the signal ground above ground, as a ratio of the supply voltage."""

    def signal_ground_v(self, supply_v: float) -> float:
        return self.signal_ground_ratio * supply_v

    def upper_headroom_v(self, supply_v: float) -> float:
        """Voltage from the signal ground to the upper rail [V]."""
        return supply_v * (1.0 - self.signal_ground_ratio)

    def lower_headroom_v(self, supply_v: float) -> float:
        """Voltage from the lower rail to the signal ground [V]."""
        return supply_v * self.signal_ground_ratio if self.signal_ground_ratio else supply_v


_CONTROLLER = Supply(
    signal_ground=VMID,
    negative_rail=GND,
    description="3.3 V supply with VMID (buffered mid-supply)",
    nominal_v=3.3,
    signal_ground_ratio=VMID_BOTTOM_OHM / (VMID_TOP_OHM + VMID_BOTTOM_OHM),
)
SUPPLIES = {
    "article": Supply(GND, VEE, "split supply", 5.0),
    "precision": _CONTROLLER,
    "comparator": _CONTROLLER,
}
"""Supply of each variant with a board; a test compares them with the design file's variants."""
VARIANT_CHANGES = {
    variant: (f"board.variant={variant}", f"board.supply_v={supply.nominal_v:g}")
    for variant, supply in SUPPLIES.items()
}
"""Changes that select each board; the bundled design `article` keeps the article's 1 uF too."""
BOARD_REMEDY = "use " + " ".join(f"--set {change}" for change in VARIANT_CHANGES["precision"])
"""Remedy of what a divider lacks."""


# Values of the components.


@dataclass(frozen=True)
class Tolerance:
    resistor_percent: float
    capacitor_percent: float
    """Tolerance of the capacitors [%]; 0 is that of the parts sold."""


@dataclass(frozen=True)
class ComparatorStage:
    """Preferred resistances [ohm] and capacitance [F] around the comparator."""

    averaging_ohm: float
    averaging_f: float
    trimmer_top_ohm: float
    """Resistance from the supply to the trimmer."""
    hysteresis_ohm: float
    """Resistance from the output back to the threshold."""

    def by_reference(self) -> dict[str, float]:
        return {
            "R18": self.averaging_ohm,
            "C17": self.averaging_f,
            "R19": self.trimmer_top_ohm,
            "R20": self.hysteresis_ohm,
            "R21": PULL_UP_OHM,
            "RV1": TRIMMER_OHM,
        }


@dataclass(frozen=True)
class AdcInterface:
    """Preferred resistances [ohm] and capacitances [F] ahead of the ADC pins."""

    first_ohm: float
    first_f: float
    """First section, from the tactile voltage to the node between the sections."""
    second_ohm: float
    second_f: float
    """Second section, from the node between the sections to the tactile pin."""
    output_ohm: float
    output_f: float
    """Section from the envelope, or from the filtered signal, to its pin."""

    def by_reference(self) -> dict[str, float]:
        return {
            "R7": self.output_ohm,
            "C8": self.output_f,
            "R8": self.first_ohm,
            "C9": self.first_f,
            "R9": self.second_ohm,
            "C19": self.second_f,
            "R27": self.output_ohm,
            "C25": self.output_f,
        }


@dataclass(frozen=True)
class ComponentValues:
    variant: str
    amplifier: str
    """Dual amplifier of filter and rectifier, by its name in `AMPLIFIER_CATALOGUE`."""
    ideal: FilterComponents
    """Values by the formulas (article, eqs. 2, 5, 6, 7, 11)."""
    preferred: FilterComponents
    """Fitted values: resistors of the design's series; given capacitors, or of their series."""
    first_stage_capacitors: selection.FirstStageCapacitors | None
    """Capacitors of the first stage that variant article does not have; None there."""
    rectifier_ohm: float | None
    """Both resistors of the precision rectifier; None on boards without one."""
    tolerance: Tolerance
    bridge: Bridge | None
    """Bridge of variant article; None on boards with a transimpedance stage."""
    adc_interface: AdcInterface
    comparator_stage: ComparatorStage | None
    """Values around the comparator; None in variants without one."""

    @functools.cached_property
    def by_reference(self) -> dict[str, float]:
        """Value of each component [ohm, F] by reference, those of other boards included."""
        values = selection.FilterSelection(
            self.ideal, self.preferred, self.first_stage_capacitors, self.rectifier_ohm
        ).by_reference()
        values |= self.bridge.by_reference() if self.bridge else front_end.STAGE_VALUES
        values |= self.adc_interface.by_reference()

        return values | (self.comparator_stage.by_reference() if self.comparator_stage else {})


def select_components(design: Design) -> ComponentValues:
    """Select the values of a board's components.

    Raises BoardError, also for a divider, which has none of them.
    """
    if not design.board.has_filter:
        raise BoardError(Issue("board.variant", f"divider is no board; {BOARD_REMEDY}."))

    detector = design.detector
    supply = SUPPLIES[design.board.variant]
    board = design.board
    chosen = selection.select_filter(board)
    comparator_stage = None

    if board.variant == "comparator":
        window_s = detector.window_samples / detector.sample_rate_hz
        comparator_stage = size_comparator(
            detector.threshold_v, window_s, board, supply.signal_ground_ratio
        )

    return ComponentValues(
        variant=board.variant,
        amplifier=choose_amplifier(board).name,
        ideal=chosen.ideal,
        preferred=chosen.preferred,
        first_stage_capacitors=chosen.capacitors,
        rectifier_ohm=chosen.rectifier_ohm,
        tolerance=Tolerance(board.resistor_tolerance_percent, board.capacitor_tolerance_percent),
        bridge=None
        if board.is_for_controller
        else size_bridge(board.supply_v, board.series, design.dimensions.sensor.active_diameter_mm),
        adc_interface=size_adc_interface(
            detector.sample_rate_hz, board.series, board.capacitor_series
        ),
        comparator_stage=comparator_stage,
    )


# Component values of variant `comparator`: the article's threshold on the windowed mean, in
# hardware.
#
# The window of L samples becomes an RC low-pass of the same delay, tau = L / (2 fs). A trimmer sets
# the threshold between 0 and about twice the design's threshold, which corresponds to its midpoint.
# The output reports slip while the averaged envelope exceeds the threshold. Positive feedback
# lowers the threshold by a quarter while the output reports slip.

TRIMMER_OHM = 10e3
PULL_UP_OHM = 4.7e3
HYSTERESIS_RATIO = 0.25
_MIN_AVERAGING_F = 1e-9


def size_comparator(
    threshold_v: float, window_s: float, board: Board, signal_ground_ratio: float = 0.0
) -> ComparatorStage:
    """Size the comparator stage for a threshold [V] and a window [s]."""
    upper_v = (1.0 - signal_ground_ratio) * board.supply_v
    low_ohm = TRIMMER_OHM / 2.0
    # Supply and output together pull the threshold up by x = 1 / high and y = 1 / (hysteresis +
    # pull-up), where x + y = T / low / (U - T). When the output falls by the whole supply, the
    # threshold falls by about supply y / (x + y + 1 / low).
    pull = threshold_v / low_ohm / (upper_v - threshold_v)
    feedback = HYSTERESIS_RATIO * threshold_v / board.supply_v * (pull + 1.0 / low_ohm)

    def error(pair: tuple[float, float]) -> float:
        # The trimmer is at its midpoint. Until slip is detected, the pull-up connects the output's
        # end of the hysteresis resistor to the supply.
        trimmer_top_ohm, hysteresis_ohm = pair
        pull = 1.0 / (low_ohm + trimmer_top_ohm) + 1.0 / (hysteresis_ohm + PULL_UP_OHM)
        return round(abs(math.log(upper_v * pull / (pull + 1.0 / low_ohm) / threshold_v)), 12)

    tops = selection.neighbouring_values(
        1.0 / (pull - 1.0 / (1.0 / feedback + PULL_UP_OHM)) - low_ohm, board.series
    )
    feedbacks = selection.neighbouring_values(1.0 / feedback, board.series)
    trimmer_top_ohm, hysteresis_ohm = min(itertools.product(tops, feedbacks), key=error)
    tau_s = window_s / 2.0
    nearest_f = selection.nearest_capacitance(tau_s / AVERAGING_OHM, board.capacitor_series)
    averaging_f = min(max(nearest_f, _MIN_AVERAGING_F), MAX_AVERAGING_F)

    return ComparatorStage(
        selection.nearest_value(tau_s / averaging_f, board.series),
        averaging_f,
        trimmer_top_ohm,
        hysteresis_ohm,
    )


# Components between the board and the analog-to-digital converter (ADC): anti-aliasing poles for
# its sampling rate.
#
# Frequencies above half the sampling rate alias to below it. The band of the vibrations ends at
# `BAND_CUTOFFS` cutoffs, and the lowest frequency that aliases into it is the sampling rate less
# that. The tactile voltage passes two poles, both near a quarter of the sampling rate: the second
# section has ten times the impedance of the first, so that they hardly interact. The envelope has a
# pole of its own already (in variant `article` only for falling voltages), and passes one.
#
# `fingertip.board.analysis.interference` computes what they attenuate.

POLE_PER_SAMPLE_RATE = 0.25
FIRST_OHM = 1e3
SECOND_OHM = 10e3
"""Approximate resistances; they also limit the pin current to 1 mA at 10 V."""
CLAMP_A = 0.1e-6
MAX_CLAMP_A = 2e-6
"""Reverse current of a diode of the BAT54S at a pin [A]: that of the SPICE deck's model, and the
maximum of a BAT54 at 25 V and 25 degrees Celsius (its data sheets; unverified).
"""
MAX_SUPPRESSOR_A = 0.1e-6
"""Leakage of a suppressor at a pin of the board for a controller [A]: maximum of a PESD5V0S1BA at 5
V (recalled of Nexperia's data sheet; unverified).
"""


def size_adc_interface(
    sample_rate_hz: float, series: str, capacitor_series: str = "given"
) -> AdcInterface:
    """Size the anti-aliasing poles for a sampling rate [Hz], with values of these series."""
    target_hz = POLE_PER_SAMPLE_RATE * sample_rate_hz

    def size_section(approximate_ohm: float) -> tuple[float, float]:
        ideal_f = selection.pole_hz(approximate_ohm, target_hz)  # 1 / (2 pi R f) is C
        c_f = selection.nearest_capacitance(ideal_f, capacitor_series)
        return selection.nearest_value(selection.pole_hz(target_hz, c_f), series), c_f

    return AdcInterface(
        *size_section(FIRST_OHM), *size_section(SECOND_OHM), *size_section(SECOND_OHM)
    )
