"""Manipulations as pictures like the article's figures 16 and 17: forces, claims of slip, positions of the fingers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fingertip.campaign.closed_loop.manipulations import NONE, Handled, slipping_at_all
from fingertip.campaign.report.pictures import COLORS, NOTE
from fingertip.drawing import plain, png, sheet
from fingertip.slip.intervals import intervals

_FINGERS = {"thumb": "#1f4e79", "index": "#b03a2e", "middle": "#d98c2b", "ring": "#2e7d5b", "little": "#8a5aa0"}
_TRUTH, _GREY = "#7fb3a6", "#b0b7bf"
SHOWN = {"closed_loop_power.png": "parallelepiped", "closed_loop_pinch.png": "cylinder"}
"""File -> object, as in the article's figures 16 and 17."""


def files(handled: Sequence[Handled], detector: str) -> dict[str, bytes]:
    """File name -> picture of the first manipulation of its object, without control beside it."""
    found = {}
    for name, shown in SHOWN.items():
        own = [one for one in handled if one.name == shown]
        with_it = next((one for one in own if one.detector == detector), None)
        without = next((one for one in own if one.detector == NONE), None)
        if with_it and without:
            found[name] = manipulation(with_it, without)
    return found


def manipulation(one: Handled, without: Handled) -> bytes:
    """Forces, claims, closing of the fingers and the object's way of one manipulation: a PNG."""
    figure = sheet(10, 9)
    force, claim, closing, way = figure.subplots(4, 1, sharex=True, height_ratios=(2.2, 0.9, 2.2, 1.4))
    seen = one.seen
    t = seen.time_s
    for i, finger in enumerate(seen.fingers):
        force.plot(t, seen.signals["force_n"][i], color=_FINGERS[finger], linewidth=0.8, label=finger)
        closing.plot(t, 1000 * seen.signals["closing_m"][i], color=_FINGERS[finger], linewidth=1.1, label=finger)
    force.set_ylabel("normal force [N]")
    force.legend(frameon=False, ncols=5, fontsize=9, loc="lower right")
    closing.set_ylabel("closing [mm]")
    # The last millimetres are where the hand answers; how it closed before is the same every time.
    low = 1000 * float(min(signal[np.searchsorted(t, seen.plan.closed_s)] for signal in seen.signals["closing_m"]))
    closing.set_ylim(bottom=max(0.0, 0.85 * low))
    looks = np.array([(look.claimed, look.discarded) for look in one.looks], dtype=np.bool_)
    at = np.array([look.time_s for look in one.looks])
    rows = (
        ("believed", intervals(at, looks[:, 0] & ~looks[:, 1]), COLORS.get(one.detector, "#555555")),
        ("discarded", intervals(at, looks[:, 0] & looks[:, 1]), _GREY),
        ("true slip", intervals(t, slipping_at_all(seen)), _TRUTH),
    )
    for row, (_, parts, color) in enumerate(rows):
        bars = [(p.onset_s, max(p.end_s - p.onset_s, 0.01)) for p in parts]
        claim.broken_barh(bars, (row - 0.35, 0.7), color=color, linewidth=0)
    claim.set_yticks(range(len(rows)), [name for name, _, _ in rows])
    claim.set_ylim(len(rows) - 0.4, -0.6)
    claim.set_ylabel(f"{one.detector}'s\nclaims")
    for look in one.looks:
        if look.gripped:
            for axes in (force, claim, closing, way):
                axes.axvline(look.time_s, color="#4a5157", linestyle=":", linewidth=1)
    way.plot(t, 1000 * seen.signals["object_m"], color="#1f4e79", label="with control")
    end = "lost" if not without.held else "held"
    other = without.seen
    way.plot(other.time_s, 1000 * other.signals["object_m"], color=_GREY, label=f"without control: {end}")
    way.set_ylabel("object's way [mm]")
    way.set_xlabel(f"time [s]; dotted: told to grip harder ({NOTE})")
    way.legend(frameon=False, fontsize=9, loc="upper left")
    for axes in (force, claim, closing, way):
        plain(axes)
    way.set_xlim(float(t[0]), float(t[-1]))
    reacted = "the hand never moved" if one.reaction_s is None else f"reaction {1000 * one.reaction_s:.0f} ms"
    held = "held" if one.held else "lost"
    grasp = f"{seen.scene.grasp.kind} grasp of {one.name.replace('_', ' ')}, {1000 * seen.scene.object.mass_kg:g} g"
    force.set_title(f"{grasp}, {one.detector} in the loop: {held}, {reacted}", loc="left", fontsize=10)
    figure.align_ylabels()
    return png(figure)
