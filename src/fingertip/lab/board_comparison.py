"""A design's divider beside the board that could take its place: detector `fast` on the same trials
and seeds.

The divider is tried with twice the noise too: nobody has measured that of a controller at a
reader's desk.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fingertip.board.components.values import BOARD_REMEDY, SUPPLIES
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import BAND_CUTOFFS
from fingertip.foundation.errors import DesignError
from fingertip.lab.campaign.campaign import CampaignPlan
from fingertip.lab.campaign.run import CampaignResult, DetectorResult, run_campaign
from fingertip.lab.report.results import format_ms, to_number

DIVIDER = "divider"
NOISY = "divider, twice the noise"
BOARD = "board"
LEFT_OUT = (
    "Left out, because they study the filter board or detectors that need it: all other tables "
    "and figures of a "
    f"validation. For these {BOARD_REMEDY}."
)


@dataclass(frozen=True, eq=False)
class BoardComparison:
    """Results with a divider, with a noisier one, and with a board."""

    rows: dict[str, DetectorResult]
    reason: str
    """Reason why there is no board to compare; empty if there is one."""

    def as_data(self) -> dict[str, Any]:
        rows = {
            name: {
                "found": len(row.delays_s),
                "slips": row.slips,
                "median_s": to_number(row.delay_s(0.5)),
                "p90_s": to_number(row.delay_s(0.9)),
                "alarms_per_minute": to_number(row.alarms_per_minute),
            }
            for name, row in self.rows.items()
        }
        return {"comparison": rows, "no_board": self.reason, "left_out": LEFT_OUT}

    def as_text(self) -> str:
        lines = [
            f"{name:25} {len(row.delays_s)} of {row.slips} slips found, median {_ms(row, 0.5)}, "
            f"90 % {_ms(row, 0.9)}, "
            f"{row.limited_alarms} false alarms in {row.limited_minutes:.1f} min"
            for name, row in self.rows.items()
        ]
        return "\n".join([*lines, LEFT_OUT])

    def tell(self, passed: bool) -> str:
        """Tell whether the divider suffices, and what a board would add."""
        verdict = f"the divider {'suffices' if passed else 'does not suffice'}"
        if self.reason:
            return f"{verdict}; {self.reason}"

        divider = self.rows[DIVIDER]
        board = self.rows[BOARD]
        return (
            f"{verdict}; a board would find {len(board.delays_s)} slips in place of "
            f"{len(divider.delays_s)}, with a "
            f"median delay of {_ms(board, 0.5)} in place of {_ms(divider, 0.5)}, and 90 % within "
            f"{_ms(board, 0.9)} in "
            f"place of {_ms(divider, 0.9)}."
        )


def with_variant(design: Design, variant: str) -> Design:
    """Return a copy with another board, on its own supply and with its band limit above slip."""
    tables = design.model_dump()
    if design.board.variant != variant:
        minimum = BAND_CUTOFFS * design.board.cutoff_hz
        supply_v = SUPPLIES[variant].nominal_v
        limit_hz = max(design.board.band_limit_hz, minimum)
        tables["board"] |= {"variant": variant, "supply_v": supply_v, "band_limit_hz": limit_hz}

    return Design(**tables)


def compare_with_board(design: Design, result: CampaignResult, detector: str) -> BoardComparison:
    """Run the campaign of a divider on a board too, and its trials with more noise."""

    def run(changed: Design, plan: CampaignPlan) -> DetectorResult:
        return run_campaign(
            changed,
            plan=plan,
            detectors=(detector,),
            scales=(1.0,),
            first_seed=result.first_seed,
        ).at_nominal_threshold(detector)

    rows = {DIVIDER: result.at_nominal_threshold(detector)}
    reason = ""
    noisy = design.with_values({"detector.noise_v": min(1.0, 2 * design.detector.noise_v)})
    rows[NOISY] = run(Design(**noisy.model_dump()), CampaignPlan(result.plan.trials, 0.5))

    try:
        rows[BOARD] = run(with_variant(design, "precision"), result.plan)
    except DesignError as error:
        reason = f"no board is compared, because the design's filter is refused: {error.issues[0]}"

    return BoardComparison(rows, reason)


def _ms(result: DetectorResult, fraction: float) -> str:
    return format_ms(result.delay_s(fraction), otherwise="infinite")
