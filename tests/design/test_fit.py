"""Fit: presets need none, hands get one, and what does not fit is refused with the rule."""

from __future__ import annotations

import random
import re
import tomllib

import pytest

from fingertip.design import Design
from fingertip.design.files import load_tables
from fingertip.design.fit import DERIVED, fit_design
from fingertip.design.geometry import DesignTables
from fingertip.design.hand_sizes import find_hand, list_hands
from fingertip.design.new_design import PRESETS, write_new_design
from fingertip.design.proportions import fill_in
from fingertip.design.rules.ruleset import find_violations
from fingertip.design.search import PART_RULES, RULES
from fingertip.foundation.errors import DesignError, TomlFileError
from tests.conftest import design_file

SHAPE = (
    "skin.width_mm", "skin.length_mm", "skin.semi_axis_palmar_mm", "skin.semi_axis_dorsal_mm",
    "hand.width_mm", "hand.axis_height_mm", "hand.pin_diameter_mm", "hand.clearance_radius_mm",
)  # fmt: skip
"""What is measured on a finger and on a hand."""


def tables(name: str, **values: float) -> DesignTables:
    return DesignTables(**load_tables([design_file(name)], []).tables).with_values(values)


@pytest.mark.full
@pytest.mark.parametrize("hand", sorted(set(list_hands()) - {"inmoov"}))
def test_bundled_hand_gets_a_tip_of_its_own_sizes(hand: str) -> None:
    new = write_new_design("mine", hand=hand)
    design = Design(**fill_in(tomllib.loads(new.text)))
    given = tomllib.loads(find_hand(hand).read_text())["hand"]
    for name, value in given.items():
        assert getattr(design.hand, name) == value
    assert "Not tried on the real hand." in " ".join(find_hand(hand).read_text().replace("#", "").split())
    assert {move.name for move in new.moves} <= {
        *DERIVED,
        "skin.length_mm",
        "skin.semi_axis_palmar_mm",
        "skin.thickness_palmar_mm",
    }


def test_a_tendon_that_runs_through_the_hands_fork_is_refused() -> None:
    with pytest.raises(DesignError, match=r"hand\.tendon_distance_mm: 3\.3 mm leaves no room for its strands"):
        write_new_design("mine", hand="inmoov")


@pytest.mark.full
def test_fit_is_reproducible_and_passes_all_rules() -> None:
    begin = tables(
        "adult_finger", **{"skin.width_mm": 20.0, "skin.semi_axis_dorsal_mm": 9.0, "hand.clearance_radius_mm": 5.6}
    )
    given = ["skin.length_mm"]
    first, second = fit_design(begin, given), fit_design(begin, given)
    assert first == second
    assert first.moves
    assert not list(find_violations(RULES, first.tables))
    kept = {name: begin.value(name) for name in ("skin.width_mm", "skin.semi_axis_dorsal_mm", "skin.length_mm")}
    assert all(first.tables.value(name) == value for name, value in kept.items())
    for name, before in ((move.name, move.before) for move in first.moves):  # each move is needed
        assert list(find_violations(PART_RULES, first.tables.with_values({name: before}))), name


@pytest.mark.full
def test_given_lengths_stay_and_a_limit_shortens_the_skin() -> None:
    assert all(fit_design(tables(name)).moves == () for name in PRESETS), "presets need no fit"
    limited = fit_design(tables("adult_finger", **{"hand.length_limit_mm": 38.5})).tables
    assert limited.skin.length_mm + limited.bone.base_length_mm <= 38.5
    begin = tables("adult_finger", **{"hand.clearance_radius_mm": 7.0})
    assert "bone.base_length_mm" in [move.name for move in fit_design(begin).moves]
    with pytest.raises(DesignError, match=r"bone\.base_length_mm"):
        fit_design(begin.with_values({"bone.base_length_mm": 9.0}), given=["bone.base_length_mm"])


@pytest.mark.full
def test_remedy_for_a_narrow_finger_passes_and_keeps_its_joint() -> None:
    preset = tables("child_finger")
    with pytest.raises(DesignError) as refused:
        fit_design(preset.with_values({"skin.width_mm": 10.0}), ["skin.width_mm"], before=preset)
    assert "bone.interface" not in str(refused.value)
    (width,) = re.findall(r"at least ([0-9.]+) mm\.", str(refused.value))
    assert fit_design(preset.with_values({"skin.width_mm": float(width)}), ["skin.width_mm"]).moves == ()


def test_a_file_that_is_no_hand_is_refused(tmp_path) -> None:
    path = tmp_path / "h.toml"
    for hand, text, message in (
        ("nobody", "", r"is neither a file nor the name of a bundled"),
        (tmp_path, "", "is a folder; give the path of a hand file"),
        (path, "[hand]\nwidth_mm = 5,5\n", "with a decimal point, not with a comma"),
        (path, "[hand]\nwidth_mm = 5.0\n[skin]\nwidth_mm = 17.0\n", r"holds skin besides \[hand\]"),
    ):
        path.write_text(text)
        with pytest.raises(TomlFileError, match=message):
            find_hand(hand)


@pytest.mark.full
def test_half_of_the_fingers_near_a_preset_are_accepted() -> None:
    """All that is measured on finger and hand is drawn within 20 % of a preset; the rest is fitted."""
    rng, accepted, count = random.Random(11), 0, 12
    for i in range(count):
        base = tables(PRESETS[i % len(PRESETS)])
        drawn = {name: round(base.value(name) * rng.uniform(0.8, 1.2), 2) for name in SHAPE}
        try:
            fit_design(base.with_values(drawn), SHAPE)
            accepted += 1
        except DesignError:
            pass
    assert accepted >= count / 2
