"""The article's detector by its board: as drawn, with a bare diode, and with a precision rectifier.

A silicon diode conducts from some 0.45 V, which is 6.7 mV of vibration ahead of the gain. The article does not say
which diode it had, nor how strong its vibrations were. On the simulated ones a bare 1N4148 stays shut on smooth
surfaces, whatever the threshold; the article's figures come out on the board without that dead zone. There the noise
allows a much lower threshold than on the sampled voltage, for it is the converter's that is strong, and the board's
gain stands ahead of it. The lower the threshold, the sooner, and the more changes of grip are taken for slip.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from fingertip.campaign.judge import Verdict, judge
from fingertip.campaign.plan import HELD_OUT_FROM, Amount, cases
from fingertip.campaign.record import record
from fingertip.campaign.study import Total, surface
from fingertip.design import Design
from fingertip.design.board_rules import BAND_CUTOFFS
from fingertip.errors import DesignError
from fingertip.sim.electronics.board_output import rest_level
from fingertip.sim.jit import compiled

VARIANTS = ("article", "precision")


@dataclass(frozen=True)
class Board:
    """The detector `analog` on one board at one threshold; delays infinite if too few slips were found."""

    variant: str
    threshold_v: float
    by_rule: bool
    """Whether the threshold follows from the noise of this board's output; else it is the design's."""
    found_share: float
    median_s: float
    p90_s: float
    below_30_ms: float
    worst_mean_s: float
    """Mean of the delays on the worst surface, of slips that were found."""
    alarms_per_minute: float


def _built(design: Design) -> Iterator[Design]:
    """The boards that can be made of this design: another variant may need other values."""
    for variant in VARIANTS:
        try:
            yield of_variant(design, variant)
        except DesignError:
            continue


def of_variant(design: Design, variant: str) -> Design:
    """The design with another board. What only that one has is moved out of the vibrations' way."""
    tables = design.model_dump()
    if design.board.variant != variant:
        minimum = BAND_CUTOFFS * design.board.cutoff_hz
        tables["board"] |= {"variant": variant, "band_limit_hz": max(design.board.band_limit_hz, minimum)}
    return Design(**tables)


def boards(
    design: Design, trials: int = 24, quiet_minutes: float = 2.0, first_seed: int = HELD_OUT_FROM
) -> list[Board]:
    """The same trials on each board, at the design's threshold and at the one that its noise allows."""
    out = []
    for built in _built(design):
        variant = built.board.variant
        rule = rest_level(built).rounded_v
        own = built.detector.threshold_v
        verdicts: tuple[list[Verdict], list[Verdict]] = ([], [])
        with compiled():
            for case in cases(Amount(trials, quiet_minutes), first_seed):
                trace, force_n = record(built, case)
                judged = judge(case, trace, force_n, "analog", built, [1.0, rule / own])
                for kept, verdict in zip(verdicts, judged, strict=True):
                    kept.append(verdict)
        for by_rule, kept in zip((False, True), verdicts, strict=True):
            total = Total(1.0, tuple(kept))
            below = sum(d < 0.03 for d in total.delays_s) / max(1, total.slips)
            means = [mean for mean, _, _ in total.by(surface).values()]
            out.append(
                Board(
                    variant,
                    rule if by_rule else own,
                    by_rule,
                    total.found_share,
                    total.delay_s(0.5),
                    total.delay_s(0.9),
                    below,
                    max(means),
                    total.alarms_per_minute,
                )
            )
    return out
