"""Detectors run over sources of recordings, on all processors, and what they reach."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Protocol

from benchmarks.slip.competitors import Row, find_competitor
from benchmarks.slip.recordings import Recording
from benchmarks.slip.scores import Tally, assess, pool
from fingertip.design import Design
from fingertip.foundation.workers import call_each


class Source(Protocol):
    """Place from which recordings are read or drawn."""

    @property
    def run(self) -> int:
        """Number by which what is drawn with different seeds is told apart."""

    def read(self) -> Iterator[Recording]: ...


@dataclass(frozen=True)
class Key:
    """What a tally counts: a detector at a factor of its threshold, on one kind of signal."""

    row: Row
    factor: float
    kind: str
    run: int


Found = dict[Key, Tally]


def judge(
    design: Design, rows: Sequence[Row], factors: Sequence[float] | None, source: Source
) -> Found:
    """Run detectors over one source, at the factors given or at their own."""
    found: Found = {}
    for recording in source.read():
        for row in rows:
            if not row.hears(recording):
                continue

            tried = find_competitor(row.name).factors if factors is None else factors
            for factor, on in zip(tried, row.run(design, recording, tried), strict=True):
                key = Key(row, factor, recording.signal.kind, source.run)
                found.setdefault(key, Tally()).add(assess(recording, on))

    return found


def measure(
    design: Design,
    rows: Sequence[Row],
    sources: Iterable[Source],
    factors: Sequence[float] | None = None,
    advance: Callable[[], None] = lambda: None,
) -> Found:
    """Run detectors over sources, side by side, and pool what they find."""
    whole: Found = {}
    for found in call_each(partial(judge, design, rows, factors, source) for source in sources):
        for key, tally in found.items():
            whole.setdefault(key, Tally()).add(tally)

        advance()

    return whole


@dataclass(frozen=True)
class Results:
    """What one detector reached at one factor of its threshold."""

    by_kind: Mapping[tuple[str, int], Tally]

    def of(self, *kinds: str, run: int | None = None) -> Tally:
        """Pool some kinds of signals, of one run or of all."""
        return pool(
            tally
            for (kind, number), tally in self.by_kind.items()
            if kind in kinds and run in (None, number)
        )

    def whole(self) -> Tally:
        return pool(self.by_kind.values())


def select(found: Found, row: Row, factor: float = 1.0) -> Results:
    return Results(
        {
            (key.kind, key.run): tally
            for key, tally in found.items()
            if key.row == row and key.factor == factor
        }
    )


def list_factors(found: Found, row: Row) -> list[float]:
    return sorted({key.factor for key in found if key.row == row})
