"""The article's twelve manipulations (III.C) with a detector in the loop: four objects, three times each.

A robot's pin hits a grasped object at 8 cm/s. Held or lost, how soon the hand moves, and whether it ever gripped harder
without slip. The same manipulations are run without any control, for what the detector is worth.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.campaign.closed_loop.grip import Grip, GripSettings, Look
from fingertip.campaign.plan import HELD_OUT_FROM
from fingertip.campaign.record import reads_board
from fingertip.design import Design
from fingertip.sim import Manipulated, ManipulationFile, manipulations, run_manipulation
from fingertip.sim.jit import compiled
from fingertip.slip.intervals import INCIPIENT_S

FIRST_SEED = HELD_OUT_FROM + 1_000_000
"""Of the first manipulation: none of these was ever tuned on."""
NONE = "no control"
MOVED_M = 1e-4
"""A finger that has closed so much further has reacted. Assumption: well above an encoder's step."""
SLIPPED_S = 0.15
"""A grip so soon after true slip is no false one: the detectors' memory and one period. Assumption."""
_OUTPUTS = ["voltage_v", "force_n", "slip", "closing_m", "object_m"]
"""Of every manipulation; the board's only where the detector reads it."""


@dataclass(frozen=True, eq=False)
class Handled:
    """One manipulation with one detector in the loop, or none."""

    detector: str
    name: str
    """Of the object."""
    seed: int
    held: bool
    onset_s: float | None
    """First true slip of any finger since the pin touched the object; None: it never slipped."""
    reaction_s: float | None
    """From the onset until a finger has moved; None: it never did."""
    grips: int
    false_grips: int
    """Grips without true slip just before."""
    discarded: int
    """Claims without true slip that were discarded, each once."""
    ignored: int
    """Claims in true slip that were discarded, each once, before any grip."""
    seen: Manipulated
    looks: tuple[Look, ...]


def closed_loop(
    design: Design,
    detectors: Sequence[str] = ("analog", "fast"),
    repeats: int = 3,
    first_seed: int = FIRST_SEED,
) -> list[Handled]:
    """Every manipulation without control, then with each detector."""
    out = []
    with compiled():
        for detector in (NONE, *detectors):
            for scene, seed in planned(repeats, first_seed):
                grip = None
                if detector != NONE:
                    if reads_board(detector):
                        scene = scene.model_copy(update={"outputs": [*_OUTPUTS, "envelope_v"]})
                    grip = Grip(design, GripSettings(detector), len(scene.fingers))
                out.append(judged(detector, run_manipulation(design, scene, grip, seed), grip.looks if grip else ()))
    return out


def planned(repeats: int, first_seed: int) -> Iterator[tuple[ManipulationFile, int]]:
    """The manipulations, each object so many times."""
    seen: dict[str, int] = {}
    for scene, seed in manipulations(first_seed):
        seen[scene.scene] = seen.get(scene.scene, 0) + 1
        if seen[scene.scene] <= repeats:
            yield scene.model_copy(update={"outputs": _OUTPUTS}), seed


def judged(detector: str, seen: Manipulated, looks: Sequence[Look]) -> Handled:
    """What came of one manipulation."""
    time_s, closing = seen.time_s, seen.signals["closing_m"]
    slip = slipping_at_all(seen)
    slipping = np.flatnonzero(slip & (time_s >= seen.plan.knock_s))
    onset_s = reaction_s = None
    if slipping.size:
        first = int(slipping[0])
        onset_s = float(time_s[first])
        further = (closing[:, first:] - closing[:, first : first + 1]).max(axis=0)
        moved = np.flatnonzero(further > MOVED_M)
        reaction_s = float(time_s[first + moved[0]]) - onset_s if moved.size else None

    def truly(at_s: float) -> bool:
        recent = (time_s > at_s - SLIPPED_S) & (time_s <= at_s + INCIPIENT_S)
        return bool(slip[recent].any())

    grips = [look.time_s for look in looks if look.gripped]
    begun = [
        look.time_s
        for before, look in zip((None, *looks), looks, strict=False)
        if look.claimed and look.discarded and not (before and before.claimed and before.discarded)
    ]
    real = [at for at in begun if truly(at) and not any(grip < at for grip in grips)]
    return Handled(
        detector,
        seen.scene.scene,
        seen.seed,
        seen.lost_s is None,
        onset_s,
        reaction_s,
        len(grips),
        sum(not truly(at) for at in grips),
        sum(not truly(at) for at in begun),
        len(real),
        seen,
        tuple(looks),
    )


def slipping_at_all(seen: Manipulated) -> NDArray[np.bool_]:
    """Whether any finger slips, sample by sample."""
    slipping: NDArray[np.bool_] = np.logical_or.reduce(seen.signals["slip"], axis=0)
    return slipping


@dataclass(frozen=True)
class LoopTotal:
    """All manipulations with one detector."""

    detector: str
    count: int
    held: int
    slipped: int
    """In how many the object slipped at all."""
    reactions_s: tuple[float, ...]
    """Of those in which it slipped and the hand moved, in order."""
    unanswered: int
    """Slips to which no finger moved."""
    false_grips: int
    discarded: int
    ignored: int


def totals(handled: Sequence[Handled]) -> list[LoopTotal]:
    """By detector."""
    out = []
    for detector in dict.fromkeys(one.detector for one in handled):
        own = [one for one in handled if one.detector == detector]
        slipped = [one for one in own if one.onset_s is not None]
        out.append(
            LoopTotal(
                detector,
                len(own),
                sum(one.held for one in own),
                len(slipped),
                tuple(sorted(one.reaction_s for one in slipped if one.reaction_s is not None)),
                sum(one.reaction_s is None for one in slipped),
                sum(one.false_grips for one in own),
                sum(one.discarded for one in own),
                sum(one.ignored for one in own),
            )
        )
    return out
