"""Sizes of a hand: each has a letter in the drawing, and a guess
for one that is left out suits the others.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.casting.sheet import casting_sheet
from fingertip.design import Design
from fingertip.design.design_file import to_toml
from fingertip.design.fit import LEAST_LOADS
from fingertip.design.hand_sizes import SIZES, complete_hand, list_hands
from fingertip.design.parameters.bone_and_mold import Hand
from fingertip.documents.finger_sheets import draw_hand_sizes, list_steps
from fingertip.fitting.fitting import fit_design, fit_tables
from fingertip.fitting.new_design import write_new_design
from fingertip.foundation.errors import DesignError, join_words
from tests.conftest import ROOT, run_fingertip

BASE = Design.load("adult_finger")
HANDS = {name: tomllib.loads(path.read_text())["hand"] for name, path in list_hands().items()}
HANDS["inmoov"]["tendon_distance_mm"] = (
    0.0  # as its refusal says: its own tendon runs through its fork
)
LEFT_OUT = (
    "axis_height_mm",
    "clearance_radius_mm",
    "tendon_distance_mm",
    "tendon_diameter_mm",
    "travel_deg",
)


def test_every_number_of_a_hand_has_a_letter_in_drawing_and_help() -> None:
    numbers = [name for name, info in Hand.model_fields.items() if info.annotation is float]
    assert sorted(SIZES) == sorted(numbers)
    assert "".join(size["letter"] for size in SIZES.values()) == "ABCDEFGH"[: len(numbers)]
    drawn = draw_hand_sizes(BASE)
    texts = [
        text.text or ""
        for text in ElementTree.fromstring(drawn).iter("{http://www.w3.org/2000/svg}text")
    ]
    shown = run_fingertip("new", "--help").stdout
    for name, size in SIZES.items():
        assert f"hand.{name} = {BASE.value(f'hand.{name}'):g}" in texts
        assert texts.count(size["letter"]) >= 2, "beside its name, and where it is measured"
        assert re.search(
            rf"^  {size['letter']} {name} +{re.escape(size['place'])}$", shown, re.MULTILINE
        )
    assert min(map(float, re.findall(rb"font-size[=:]\"?(\d+)", drawn))) >= 10.0
    assert len(drawn) * 4 / 3 < 15_000, "within a page"
    assert draw_hand_sizes() == (ROOT / "docs/measure_your_hand.svg").read_bytes()


@pytest.mark.parametrize("left_out", LEFT_OUT)
@pytest.mark.parametrize("name", HANDS)
def test_a_hand_of_which_a_size_is_left_out_gets_a_finger_and_keeps_all_others(
    name: str, left_out: str
) -> None:
    given = {key: value for key, value in HANDS[name].items() if key != left_out}
    values, guessed = complete_hand(given, BASE.hand)
    assert set(guessed) == {f"hand.{key}" for key in values.keys() - given.keys()}
    tables = BASE.model_dump()
    fitted = fit_tables(
        tables | {"hand": tables["hand"] | values}, tables, provisional=(*guessed, *LEAST_LOADS)
    )
    assert {key: getattr(fitted.hand, key) for key in given} == given


def test_what_is_guessed_is_marked_and_told_and_what_cannot_be_is_asked_for(tmp_path: Path) -> None:
    hand = tmp_path / "hand.toml"
    design = tmp_path / "mine.toml"
    hand.write_text('[hand]\nknuckle = "tongue"\nwidth_mm = 7.0\npin_diameter_mm = 2.9\n')
    made = write_new_design("mine", hand=hand, changes=["hand.travel_deg=50.0"])
    assert made.guessed == tuple(f"hand.{name}" for name in SIZES if name in LEFT_OUT[:-1])
    design.write_text(made.text)
    design.write_text(to_toml(Design.load(design)))  # as a build copies it
    loaded = Design.load(design)
    assert draw_hand_sizes(loaded).count(b"guessed: measure it") == len(made.guessed)
    assert (
        f" print: {join_words(made.guessed)} are"
        in list_steps(casting_sheet(loaded, MeshEvaluator(0.2)))[0].text
    )
    told = run_fingertip("params", str(design), "--set", "hand.axis_height_mm=5.6").stderr
    assert set(re.findall(r"hand\.\w+", told)) == set(made.guessed) - {"hand.axis_height_mm"}
    with pytest.raises(
        DesignError, match="hand: lacks knuckle and pin_diameter_mm; `fingertip new --help`"
    ):
        complete_hand({"width_mm": 5.0}, BASE.hand)
    with pytest.raises(DesignError, match="width_mm"):
        complete_hand({"width_mm": "wide"}, BASE.hand)


@pytest.mark.full
def test_a_load_that_new_lowered_is_lowered_again_by_a_fit_unless_it_is_given(
    tmp_path: Path,
) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(write_new_design("mine", changes=["strength.min_grip_factor=8"]).text)
    (held,) = re.findall(
        "# Fitted to .*(?:\n[^#].*)*\nstrength.grip_force_n = (\\S+)", file.read_text()
    )
    weaker = "strength.min_grip_factor=16"
    given = f"strength.grip_force_n={held}"
    fitted = fit_design(Design.load(file), [weaker])
    assert fitted.strength.grip_force_n == pytest.approx(float(held) / 2, 0.1)
    with pytest.raises(DesignError, match=r"strength\.grip_force_n: "):
        fit_design(Design.load(file), [weaker, given])
