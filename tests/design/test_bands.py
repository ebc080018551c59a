"""Bands of values that pass: their ends pass, what lies beyond does
not, and other parameters stay as they are.
"""

from __future__ import annotations

import pytest

from fingertip import Design
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import find_bounds
from fingertip.design.rules.ruleset import find_violations
from fingertip.design.search import RULES, describe_bands, find_bands


def passes(design: Design, name: str, value: float) -> bool:
    return next(find_violations(RULES, design.with_values({name: value})), None) is None


@pytest.mark.parametrize(
    "name", ["skin.width_mm", "mold.wall_mm", "hand.length_limit_mm", "bone.platform_mm"]
)
def test_ends_of_bands_pass_and_what_lies_beyond_them_fails(name: str) -> None:
    design = Design.load("adult_thumb")
    bounds = find_bounds(PARAMETERS[name])
    bands = find_bands(design, name)
    present = design.value(name)
    assert any(low <= present <= high for low, high in bands)
    for low, high in bands:
        assert passes(design, name, low)
        assert passes(design, name, high)
        beyond = 0.02 * abs(high) + 0.02
        assert low - beyond < (bounds.minimum or 0.0) or not passes(design, name, low - beyond)
        assert high + beyond > (bounds.maximum or 0.0) or not passes(design, name, high + beyond)


def test_a_band_is_found_from_a_value_that_fails_or_not_at_all() -> None:
    design = Design.load("fsr400")
    assert find_bands(design.with_values({"skin.width_mm": 8.0}), "skin.width_mm") == (
        (16.9, 23.1),
    )
    assert find_bands(design.with_values({"skin.width_mm": 8.0}), "skin.length_mm") == ()


def test_bands_are_described_with_their_unit() -> None:
    assert (
        describe_bands("hand.length_limit_mm", [(0.0, 0.0), (54.0, 150.0)]) == "0 or 54 to 150 mm"
    )
    assert (
        describe_bands("force_curve.conductance_us", [(0.01, 100.0)]) == "above 0, at most 100 uS"
    )


def test_probing_stops_when_nobody_waits() -> None:
    count = 0

    def stop() -> None:
        nonlocal count
        count += 1
        if count == 3:
            raise InterruptedError

    with pytest.raises(InterruptedError):
        find_bands(Design(), "skin.width_mm", still_wanted=stop)
