"""Sabotage of what holds the mold's halves together and lets them close in one way only."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from fingertip.cad.shapes import mold
from fingertip.cad.solids import Cone
from fingertip.design import Design
from tests.cad.measured import SLEEVE, failures, measured

Solids = tuple[object, ...]


def moved(original: Callable[..., Solids], z: float, x: float, which: int = 0) -> Callable[..., Solids]:
    """The same solids, one of them shifted along z and x."""

    def changed(*given: object) -> Solids:
        solids = list(original(*given))
        one = solids[which]
        assert isinstance(one, Cone)
        solids[which] = replace(one, centre=(one.centre[0] + z, one.centre[1] + x))
        return tuple(solids)

    return changed


@pytest.mark.parametrize("changes", [[], SLEEVE])
def test_nothing_is_wrong_with_the_default(changes: list[str]) -> None:
    found = measured(*changes)
    assert found["mold_dorsal.keys"].value == 2
    assert found["mold.in_the_way_turned_round"].value > 20.0
    assert found["mold.wall.bolts_to_outside"].value > 2.0


def test_a_bolt_at_the_outside(monkeypatch: pytest.MonkeyPatch) -> None:
    layout = mold.lay_out(Design(), Design().dimensions)
    bolt = mold.bolts(Design(), layout)[0]
    assert isinstance(bolt, Cone)
    outwards = layout.half_width - abs(bolt.centre[1]) - Design().mold.bolt_diameter_mm / 2 - 0.05
    shift = outwards if bolt.centre[1] > 0 else -outwards
    monkeypatch.setattr(mold, "bolts", moved(mold.bolts, 0.0, shift))
    assert failures() == {"mold.wall.bolts_to_outside"}


def test_a_key_at_the_outside(monkeypatch: pytest.MonkeyPatch) -> None:
    m = mold.lay_out(Design(), Design().dimensions)
    x, _, root = m.keys[0]
    outwards = m.half_width - abs(x) - root / 2 - Design().mold.key_clearance_mm - 0.2
    monkeypatch.setattr(mold, "keys", moved(mold.keys, 0.0, outwards if x > 0 else -outwards))
    assert failures() == {"mold.wall.keys_to_outside"}


def test_a_key_in_a_bolts_way(monkeypatch: pytest.MonkeyPatch) -> None:
    m = mold.lay_out(Design(), Design().dimensions)
    x, z, root = m.keys[0]
    bolt_z = min((b[1] for b in m.bolts if b[0] * x > 0), key=lambda at: abs(at - z))
    reach = abs(bolt_z - z) - root / 2 - Design().mold.bolt_diameter_mm / 2 - Design().mold.key_clearance_mm - 0.3
    monkeypatch.setattr(mold, "keys", moved(mold.keys, reach if bolt_z > z else -reach, 0.0))
    assert "mold.wall.keys_to_bolts" in failures()


def test_a_key_that_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    original = mold.keys
    monkeypatch.setattr(mold, "keys", lambda *given: original(*given)[:1])
    assert failures() == {"mold_dorsal.keys"}


def test_keys_that_fit_turned_round(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both alike, and each where the other would come to lie."""
    original = mold.keys

    def alike(design: Design, m: mold.MoldLayout, gap_mm: float = 0.0) -> Solids:
        first = original(design, m, gap_mm)[0]
        assert isinstance(first, Cone)
        z, x = first.centre
        return first, replace(first, centre=(m.proximal_z + m.distal_z - z, -x))

    monkeypatch.setattr(mold, "keys", alike)
    assert failures() == {"mold.in_the_way_turned_round"}
