"""Hands that nobody here drew: each gets a finger at the first try, or a refusal that names what the hand lacks."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from fingertip.cad.verification.verify import check
from fingertip.design.hand_sizes import find_hand, list_hands
from fingertip.design.new_design import NewDesign, write_new_design
from fingertip.design.rules.ruleset import find_violations
from fingertip.design.search import RULES
from fingertip.foundation.errors import DesignError
from tests.conftest import some_of

OTHERS = {
    # nbrookins/danger-finger, danger/finger_params.py at cb9a8411f26963829a02b598136f466a9a4282fc, and its version 4.1.
    "danger_finger": "width_mm = 9.76\naxis_height_mm = 4.75\nclearance_radius_mm = 4.75\npin_diameter_mm = 2.24",
    "danger_finger_4_1": "width_mm = 7.3\naxis_height_mm = 5.5\nclearance_radius_mm = 5.5\npin_diameter_mm = 2.14",
    # e-nable/Assembler, Second_Degree_Hand/V3/Include-HandParameters.scad at 53abd46913d7be68db777fb52358a34f3874df5c,
    # at a scale of 1.
    "second_degree": "width_mm = 4.4\naxis_height_mm = 5.8\nclearance_radius_mm = 5.8\npin_diameter_mm = 5.0\n"
    "tendon_distance_mm = 4.2",
    # e-nable/Assembler, Cyborg_Beast/OpenSCAD Files/cyborgfingermid002.scad at
    # 39725786dcf894dd481cf9bf6a201415a5a3164b.
    "cyborg_beast": "width_mm = 4.4\naxis_height_mm = 5.0\nclearance_radius_mm = 4.9\npin_diameter_mm = 4.0\n"
    "tendon_distance_mm = 3.25",
    # mendenm/flexible_flyer, files/fingerator.scad at f80751be178ace7b6dcbf28eb52dffdd3464664b, at a scale of 1.
    "flexible_flyer_1": "width_mm = 5.6\naxis_height_mm = 5.8\nclearance_radius_mm = 5.4\npin_diameter_mm = 1.6\n"
    "tendon_distance_mm = 4.32\ntravel_deg = 90.0",
    # cannonpr/HumanHand, hand_bearings.scad at 812e928.
    "human_hand": "width_mm = 11.0\npin_diameter_mm = 3.3",
}
"""Hand -> what its files state of the last joint, a tongue on a pin of steel; the rest is guessed."""
REFUSED = {"inmoov": "hand.tendon_distance_mm"}
"""Hand -> size that no finger can have."""
FAILING = {"danger_finger", "human_hand", "cyborg_beast"}
"""Hands whose finger passes all rules and fails a check: the stop of the bent joint or a wall beside its pin."""
HANDS = (*list_hands(), *OTHERS)


def begin(name: str, folder: Path) -> tuple[Path, NewDesign]:
    path = folder / "hand.toml"
    if name in OTHERS:
        path.write_text(f'[hand]\nknuckle = "tongue"\npin = "steel"\n{OTHERS[name]}\n')
    else:
        path = find_hand(name)
    return path, write_new_design("mine", hand=path)


@pytest.mark.parametrize("name", some_of([name for name in HANDS if name not in REFUSED], "orca_hand", "cyborg_beast"))
def test_a_hand_gets_a_finger_at_the_first_try(name: str, tmp_path: Path) -> None:
    path, new = begin(name, tmp_path)
    assert not list(find_violations(RULES, new.design))
    for size, value in tomllib.loads(path.read_text())["hand"].items():
        assert new.design.value(f"hand.{size}") == value
    assert all(new.design.value(move.name) == move.after != move.before for move in new.moves)


@pytest.mark.full
@pytest.mark.parametrize("name", [name for name in HANDS if name not in {*REFUSED, *FAILING}])
def test_the_finger_of_a_hand_passes_the_checks_of_its_build(name: str, tmp_path: Path) -> None:
    checks = check(begin(name, tmp_path)[1].design).checks
    assert [one.name for one in checks if not one.passed] == []


@pytest.mark.parametrize("name", REFUSED)
def test_a_hand_without_room_is_refused_once_with_what_it_lacks(name: str, tmp_path: Path) -> None:
    with pytest.raises(DesignError) as refused:
        begin(name, tmp_path)
    assert [issue.field for issue in refused.value.issues] == [REFUSED[name]]
