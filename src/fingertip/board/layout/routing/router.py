"""A grid router for two layers: finds the tracks of a board that is then kept as a template.

Nets are routed one by one, cheapest way first, through what other nets hold at a price that rises from round to round
until nobody trespasses (negotiated congestion). It takes a minute or two and runs when a placement changes, never when
a board is written: tracks depend on places and nets alone, not on values.

Ground is not routed as a net: each of its pads in front gets a way to a via of its own, into the pour behind.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from fingertip.board.layout.names import Box
from fingertip.board.layout.placement import PlacedPad
from fingertip.board.layout.routing.grid import Grid, Rules
from fingertip.board.layout.routing.paths import Path, Tracks, gathered
from fingertip.board.layout.routing.search import connect

POUR = "GND"


def route(
    width: float, height: float, pads: list[PlacedPad], rules: Rules, no_vias: Iterable[Box] = (), rounds: int = 60,
    progress: Callable[[str], None] = lambda _words: None,
) -> dict[str, Tracks]:  # fmt: skip
    """Net -> tracks that join all its pads, no via within the boxes `no_vias`.

    RuntimeError if nets still trespass after all rounds.
    """
    grid = Grid(width, height, pads, rules, no_vias)
    jobs = _jobs(pads)
    held: dict[str, list[Path]] = {}
    price = 0.6
    bad: list[str] = []
    for turn in range(rounds):
        for name, groups in jobs:
            if name in held and not grid.trespasses(held[name]):
                continue
            if name in held:
                grid.hold(held.pop(name), -1.0)
            held[name] = connect(grid, name, groups, price)
            grid.hold(held[name])
        bad = [name for name in held if grid.trespasses(held[name])]
        progress(f"round {turn + 1}: {len(bad)} nets trespass")
        if not bad:
            return gathered(held)
        for name in bad:
            grid.remember(held[name])
        price *= 1.5
    raise RuntimeError(f"nets still trespass after {rounds} rounds: {', '.join(bad)}; move parts apart")


def _jobs(pads: list[PlacedPad]) -> list[tuple[str, list[PlacedPad]]]:
    """What is to be joined: each net's pads, and each of the pour's pads in front alone; short ones first."""
    nets: dict[str, list[PlacedPad]] = {}
    for pad in pads:
        if pad.net == POUR and not pad.pad.drill:
            nets[f"{POUR} {pad.reference}.{pad.pad.number}"] = [pad]
        elif pad.net and pad.net != POUR:
            nets.setdefault(pad.net, []).append(pad)

    def span(group: list[PlacedPad]) -> float:
        return max(p.x for p in group) - min(p.x for p in group) + max(p.y for p in group) - min(p.y for p in group)

    return sorted(nets.items(), key=lambda item: (span(item[1]), item[0]))
