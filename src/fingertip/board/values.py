"""The board's values: from a design to ideal, preferred and achieved."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from fingertip.board.bridge import Bridge, fit_bridge
from fingertip.board.decision import Decision, fit_decision
from fingertip.board.filters import Response, response
from fingertip.board.findings import FINDINGS, Finding
from fingertip.board.preferred import preferred_components
from fingertip.design import Design
from fingertip.design.filter_components import Components, ideal_components


@dataclass(frozen=True)
class BoardValues:
    """Component values of one design's board and what they do."""

    variant: str
    """Name of the board's variant."""
    ideal: Components
    """What the formulas give (article, eqs. 2, 5, 6, 7, 11)."""
    preferred: Components
    """What is fitted: resistors of the design's series; capacitors as in the design."""
    wanted: Response
    """The response of the ideal values."""
    achieved: Response
    """The response of the preferred values."""
    bridge: Bridge
    """What is fitted ahead of the filter, preferred values."""
    decision: Decision | None
    """Around the comparator; None in variants without."""
    findings: tuple[Finding, ...] = FINDINGS
    """Slips of the article; the same for every design."""

    def as_data(self) -> dict[str, Any]:
        """Plain mappings and lists, for JSON. Keys carry their units."""
        return asdict(self)


def board_values(design: Design) -> BoardValues:
    """Compute the board's values.

    Raises
    ------
    BoardError
        If a resistor has no preferred value; a validated design does not come to that.
    """
    ideal = ideal_components(design.board)
    preferred = preferred_components(ideal, design.board.series)
    detector, decision = design.detector, None
    if design.board.variant == "comparator":
        window_s = detector.window_samples / detector.sample_rate_hz
        decision = fit_decision(detector.threshold_v, window_s, design.board.supply_v, design.board.series)
    return BoardValues(
        variant=design.board.variant,
        ideal=ideal,
        preferred=preferred,
        wanted=response(ideal, design.board.gain_bandwidth_hz),
        achieved=response(preferred, design.board.gain_bandwidth_hz),
        decision=decision,
        bridge=fit_bridge(design.board.supply_v, design.board.series, design.dimensions.sensor.active_diameter_mm),
    )
