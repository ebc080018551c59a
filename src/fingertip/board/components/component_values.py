"""Values of all components of a board, selected for a design."""

from __future__ import annotations

import functools
from dataclasses import dataclass

from fingertip.board.components.anti_aliasing import AdcInterface, size_adc_interface
from fingertip.board.components.bridge import CONTROLLER_SERIES, CONTROLLER_TARGET, VREF_RATIO, Bridge, size_bridge
from fingertip.board.components.comparator import ComparatorStage, size_comparator
from fingertip.board.components.filter import FilterSelection, FirstStageCapacitors, select_filter
from fingertip.board.supplies import SUPPLIES
from fingertip.design import Design
from fingertip.design.amplifier_choice import choose_amplifier
from fingertip.design.filter_components import FilterComponents


@dataclass(frozen=True)
class Tolerance:
    """Tolerances that the design states for the signal path."""

    resistor_percent: float
    capacitor_percent: float
    """Tolerance of the capacitors [%]; 0 is that of the parts sold."""


@dataclass(frozen=True)
class ComponentValues:
    """Values of the components of one design's board."""

    variant: str
    """Name of the board's variant."""
    supply: str
    """Name of the supply: split, single or single_3v3."""
    amplifier: str
    """Dual amplifier of filter and rectifier, by its name in `fingertip.amplifiers.CATALOGUE`."""
    ideal: FilterComponents
    """Values by the formulas (article, eqs. 2, 5, 6, 7, 11)."""
    preferred: FilterComponents
    """Values that are fitted: resistors of the design's series; capacitors as in the design, or of their own series."""
    first_stage_capacitors: FirstStageCapacitors | None
    """Capacitors of the first stage that variant article does not have; None there."""
    rectifier_ohm: float | None
    """Both resistors of the precision rectifier; None in variant article."""
    tolerance: Tolerance
    bridge: Bridge
    """Preferred values of the bridge ahead of the filter."""
    adc_interface: AdcInterface
    """Values of the anti-aliasing poles."""
    comparator_stage: ComparatorStage | None
    """Values around the comparator; None in variants without one."""

    @functools.cached_property
    def by_reference(self) -> dict[str, float]:
        """Value of each component [ohm, F] by its reference designator, as the circuit fits them."""
        values = FilterSelection(
            self.ideal, self.preferred, self.first_stage_capacitors, self.rectifier_ohm
        ).by_reference()
        values |= self.bridge.by_reference() | self.adc_interface.by_reference()
        if SUPPLIES[self.supply].is_for_controller:
            values |= self.adc_interface.filtered_by_reference()
        return values | (self.comparator_stage.by_reference() if self.comparator_stage else {})


def select_components(design: Design) -> ComponentValues:
    """Select the values of a board's components.

    Raises
    ------
    BoardError
        If a resistor has no preferred value, which does not occur for a validated design.
    """
    board, detector = design.board, design.detector
    supply, selection = SUPPLIES[board.supply], select_filter(board)
    comparator_stage = None
    if board.variant == "comparator":
        window_s = detector.window_samples / detector.sample_rate_hz
        comparator_stage = size_comparator(
            detector.threshold_v,
            window_s,
            board.supply_v,
            board.series,
            supply.signal_ground_ratio,
            board.capacitor_series,
        )
    return ComponentValues(
        variant=board.variant,
        supply=supply.name,
        amplifier=choose_amplifier(board).name,
        ideal=selection.ideal,
        preferred=selection.preferred,
        first_stage_capacitors=selection.capacitors,
        rectifier_ohm=selection.rectifier_ohm,
        tolerance=Tolerance(board.resistor_tolerance_percent, board.capacitor_tolerance_percent),
        bridge=size_bridge(
            board.supply_v,
            CONTROLLER_SERIES if supply.is_for_controller else board.series,
            design.dimensions.sensor.active_diameter_mm,
            supply.signal_ground_ratio,
            *((CONTROLLER_TARGET, VREF_RATIO) if supply.is_for_controller else ()),
        ),
        adc_interface=size_adc_interface(detector.sample_rate_hz, board.series, board.capacitor_series),
        comparator_stage=comparator_stage,
    )
