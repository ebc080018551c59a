"""Hands that nobody here drew: each gets a finger at the first try,
or a refusal that names what the hand lacks.
"""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from fingertip.cad.verification.verify import check
from fingertip.design.hand_sizes import find_hand, list_hands
from fingertip.design.rules.ruleset import find_violations
from fingertip.design.search import RULES
from fingertip.fitting.new_design import NewDesign, write_new_design
from fingertip.foundation.errors import DesignError
from tests.conftest import some_of

SIZES = (
    "width_mm",
    "pin_diameter_mm",
    "axis_height_mm",
    "clearance_radius_mm",
    "tendon_distance_mm",
    "travel_deg",
)
OTHERS = {
    # nbrookins/danger-finger, danger/finger_params.py at cb9a8411f26963829a02b598136f466a9a4282fc,
    # and its version 4.1.
    "danger_finger": (9.76, 2.24, 4.75, 4.75),
    "danger_finger_4_1": (7.3, 2.14, 5.5, 5.5),
    # e-nable/Assembler, Second_Degree_Hand/V3/Include-HandParameters.scad at
    # 53abd46913d7be68db777fb52358a34f3874df5c, at a scale of 1, and Cyborg_Beast/OpenSCAD
    # Files/cyborgfingermid002.scad at 39725786dcf894dd481cf9bf6a201415a5a3164b.
    "second_degree": (4.4, 5.0, 5.8, 5.8, 4.2),
    "cyborg_beast": (4.4, 4.0, 5.0, 4.9, 3.25),
    # mendenm/flexible_flyer, files/fingerator.scad at f80751be178ace7b6dcbf28eb52dffdd3464664b, at
    # a scale of 1.
    "flexible_flyer_1": (5.6, 1.6, 5.8, 5.4, 4.32, 90.0),
    # cannonpr/HumanHand, hand_bearings.scad at 812e928.
    "human_hand": (11.0, 3.3),
}
"""Hand -> what its files state of the last joint, a tongue on a pin of steel; the rest
is guessed.
"""
REFUSED = {"inmoov": "hand.tendon_distance_mm"}
"""Hand -> size that no finger can have."""
HANDS = (*list_hands(), *OTHERS)


def begin(name: str, folder: Path) -> tuple[Path, NewDesign]:
    path = folder / "hand.toml"
    if name in OTHERS:
        sizes = (f"{size} = {value}" for size, value in zip(SIZES, OTHERS[name], strict=False))
        path.write_text("\n".join(["[hand]", 'knuckle = "tongue"', 'pin = "steel"', *sizes]))
    else:
        path = find_hand(name)
    return path, write_new_design("mine", hand=path)


@pytest.mark.parametrize(
    "name", some_of([name for name in HANDS if name not in REFUSED], "orca_hand", "cyborg_beast")
)
def test_a_hand_gets_a_finger_at_the_first_try(name: str, tmp_path: Path) -> None:
    path, new = begin(name, tmp_path)
    assert not list(find_violations(RULES, new.design))
    for size, value in tomllib.loads(path.read_text())["hand"].items():
        assert new.design.value(f"hand.{size}") == value
    assert all(new.design.value(move.name) == move.after != move.before for move in new.moves)


@pytest.mark.full
@pytest.mark.parametrize("name", [name for name in HANDS if name not in REFUSED])
def test_the_finger_of_a_hand_passes_the_checks_of_its_build(name: str, tmp_path: Path) -> None:
    checks = check(begin(name, tmp_path)[1].design).checks
    assert [one.name for one in checks if not one.passed] == []


@pytest.mark.parametrize("name", REFUSED)
def test_a_hand_without_room_is_refused_once_with_what_it_lacks(name: str, tmp_path: Path) -> None:
    with pytest.raises(DesignError) as refused:
        begin(name, tmp_path)
    assert [issue.field for issue in refused.value.issues] == [REFUSED[name]]


@pytest.mark.second
def test_a_tail_that_a_joint_has_no_room_for_names_the_short_one() -> None:
    with pytest.raises(
        DesignError, match=r"38 mm long, the RP-C7.6-ST 20 mm\); set sensor.model=rp_c7.6_short$"
    ):
        write_new_design("mine", "rp_c7.6", hand="flexible_flyer")
