"""A design's divider beside the board that could take its place: detector `fast` on the same trials and seeds.

The divider has neither gain nor filter ahead of the converter, so its noise and steps are those of the signal. More
noise than the design states shows how much is left: nobody has measured that of a controller at the desk of a reader.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from fingertip.board.components.values import BOARD_REMEDY
from fingertip.design import Design
from fingertip.foundation.errors import DesignError
from fingertip.lab.campaign.plan import CampaignPlan
from fingertip.lab.campaign.run import CampaignResult, DetectorResult, run_campaign
from fingertip.lab.report.numbers import format_ms, to_number
from fingertip.lab.studies.boards import with_variant
from fingertip.slip.detectors.registry import DIVIDER_DETECTORS

DETECTOR = DIVIDER_DETECTORS[0]
NOISE_FACTORS = (2.0, 4.0)
"""Factors of the design's noise at which the divider is tried too, without the scenes that have no slip."""
LEFT_OUT = (
    "Left out, because they study the filter board or detectors that need it: other detectors, windows, spectra, "
    "bounds, assumptions, time step, rates, boards, the article's protocol, previous works, motors, knocks and the "
    f"wider mix. For these {BOARD_REMEDY}."
)


@dataclass(frozen=True, eq=False)
class BoardComparison:
    """Results by what the sensor is read with: the divider as designed first."""

    rows: dict[str, DetectorResult]
    reason: str
    """Reason why there is no board to compare; empty if there is one."""

    def as_data(self) -> dict[str, Any]:
        return {
            "comparison": {name: _summarise(result) for name, result in self.rows.items()},
            "no_board": self.reason,
            "left_out": LEFT_OUT,
        }

    def as_text(self) -> str:
        lines = [f"{'detector fast, same trials and seeds':38} {'found':>12} {'median':>9} {'p90':>9}  false alarms"]
        for name, result in self.rows.items():
            alarms, found = result.limited_alarms, f"{len(result.delays_s)} of {result.slips}"
            minutes = f"{alarms} in {result.limited_minutes:.1f} min"
            lines.append(f"{name:38} {found:>12} {_ms(result, 0.5):>9} {_ms(result, 0.9):>9}  {minutes}")
        return "\n".join([*lines, "", self.reason or self._tell_gain(), LEFT_OUT])

    def tell(self, passed: bool) -> str:
        """Tell whether the divider suffices, and what a board would add."""
        verdict = "the divider suffices" if passed else "the divider does not suffice"
        return f"{verdict}; {self.reason or self._tell_gain()}"

    def _tell_gain(self) -> str:
        divider, board = self.rows[DIVIDER], self.rows[BOARD]
        more = len(board.delays_s) - len(divider.delays_s)
        found = f"find {more} more of {board.slips} slips" if more > 0 else "find no more slips"
        return (
            f"a board would {found}; delay {_ms(board, 0.5)} in place of {_ms(divider, 0.5)} (median), "
            f"{_ms(board, 0.9)} in place of {_ms(divider, 0.9)} (90th percentile)."
        )


DIVIDER, BOARD = "divider as designed", "board (board.variant=precision)"


def compare_with_board(
    design: Design, result: CampaignResult, advance: Callable[[float], None] = lambda _: None
) -> BoardComparison:
    """Run the trials of a divider's campaign again with more noise, and the whole of it on the board of the design."""
    rows, plan, reason = {DIVIDER: result.at_nominal_threshold(DETECTOR)}, result.plan, ""
    try:
        board = with_variant(design, "precision")
    except DesignError as error:
        reason = f"a board is not compared, because the design's filter is refused: {error.issues[0]}"
    else:
        rows[BOARD] = run_campaign(board, plan, (DETECTOR,), (1.0,), result.first_seed).at_nominal_threshold(DETECTOR)
    for i, factor in enumerate(NOISE_FACTORS):
        advance((i + 1) / (len(NOISE_FACTORS) + 1))
        noise_v = factor * design.detector.noise_v
        noisy = Design(**design.with_values({"detector.noise_v": noise_v}).model_dump())
        trials = CampaignPlan(plan.trials, min(0.5, plan.negative_minutes))
        found = run_campaign(noisy, trials, (DETECTOR,), (1.0,), result.first_seed)
        rows[f"divider at {1000 * noise_v:g} mV of noise"] = found.at_nominal_threshold(DETECTOR)
    return BoardComparison(rows, reason)


def _summarise(result: DetectorResult) -> dict[str, Any]:
    return {
        "found": len(result.delays_s),
        "slips": result.slips,
        "median_s": to_number(result.delay_s(0.5)),
        "p90_s": to_number(result.delay_s(0.9)),
        "alarms_per_minute": to_number(result.alarms_per_minute),
    }


def _ms(result: DetectorResult, fraction: float) -> str:
    return format_ms(result.delay_s(fraction), otherwise="infinite")
