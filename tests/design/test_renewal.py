"""Designs of version 0.3: what went is refused at once, in groups,
and `new --from` writes the design anew.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest
import tomlkit

from fingertip.design import Design
from fingertip.design.parameters import PARAMETERS
from fingertip.design.parameters.declaration import load_retired
from fingertip.design.proportions import fill_in
from fingertip.design.rules.ruleset import find_violations
from fingertip.design.search import RULES
from fingertip.fitting.renewal import LEFT_OUT, renew_design
from fingertip.foundation.errors import DesignError
from fingertip.sweep.outputs import check_outputs, load_outputs
from tests.conftest import run_fingertip, some_of

OLD = tomllib.loads((Path(__file__).parent / "old_designs.toml").read_text())
OLD |= {
    "socket": {"bone": {"interface": "socket", "base_length_mm": 32}},
    "flange": {
        "bone": {
            "interface": "flange",
            "base_length_mm": 26,
            "flange_spacing_y_mm": 12,
            "flange_height_mm": 18,
        }
    },
}
SHORT = {"fsr400": "fsr400_short", "fsr402": "fsr402_short"}


def write(name: str, folder: Path) -> Path:
    path = folder / "old.toml"
    path.write_text(tomlkit.dumps(OLD[name]))
    return path


def test_what_went_is_declared_no_more_and_what_takes_its_place_is() -> None:
    assert not load_retired().keys() & (PARAMETERS.keys() | load_outputs().keys())
    named = {
        name
        for instead in load_retired().values()
        for name in re.findall(r"\b[a-z]+\.[a-z_0-9]+", instead)
    }
    assert named - {"toml"} <= PARAMETERS.keys()
    outputs = {
        name
        for instead in load_retired().values()
        for name in re.findall(r"\bmold_\w+|\bknock_safety\w+", instead)
    }
    assert outputs <= load_outputs().keys()


def test_everything_that_went_is_refused_at_once_in_groups() -> None:
    with pytest.raises(DesignError) as caught:
        Design(
            **{
                "mold": {"method": "overmold", "draft_deg": 3.0},
                "sensor": {"tail": "folded"},
                "strength": {"shock_force_n": 60.0},
                "skin": {"widht_mm": 17.0},
            }
        )
    found = {issue.field: issue.message for issue in caught.value.issues}
    assert found["mold.method, mold.draft_deg"].startswith("delete; every skin is cast")
    assert "sensor.model=fsr400_short" in found["sensor.tail"]
    assert "strength.knock_speed_m_s" in found["strength.shock_force_n"]
    assert "`fingertip new NAME --from FILE`" in found["design"]
    assert found["skin.widht_mm"].startswith("there is no such parameter")
    outputs = check_outputs(
        ["fill_time_s", "leak_mm", "shock_safety_factor", "skin_volume_mm3"], is_set=False
    )
    assert [issue.message.partition(": ")[0] for issue in outputs] == [
        "fill_time_s, leak_mm",
        "shock_safety_factor",
    ]


@pytest.mark.parametrize("name", some_of(OLD, "adult_finger", "fsr400", "socket"))
def test_an_old_design_keeps_its_sizes_as_far_as_the_rules_allow(name: str, tmp_path: Path) -> None:
    old = OLD[name]
    renewed = renew_design("mine", write(name, tmp_path))
    design = renewed.made.design
    assert not list(find_violations(RULES, design))
    assert Design(**fill_in(tomllib.loads(renewed.made.text))) == design
    before = old.get("sensor", {}).get("model", "fsr400")
    assert design.sensor.model == (SHORT[before] if old.get("sensor", {}).get("tail") else before)
    assert design.bone.interface == old.get("bone", {}).get("interface", "post")
    assert design.skin.width_mm == pytest.approx(old.get("skin", {}).get("width_mm", 17.0), abs=0.5)
    assert "sensor.tail" not in renewed.changed
    assert all(design.value(path) == now != was for path, (was, now) in renewed.changed.items())


def test_sizes_that_are_left_out_are_those_of_the_bundled_design(tmp_path: Path) -> None:
    renewed = renew_design("mine", write("article", tmp_path), ["skin.width_mm=18"], LEFT_OUT[-1])
    base = Design.load(renewed.made.base)
    design = renewed.made.design
    assert (design.skin.crown_radius_mm, design.skin.width_mm) == (base.skin.crown_radius_mm, 18.0)
    assert design.board.variant == "article"
    twice = run_fingertip(
        "new", "other", "--from", "old.toml", "--sensor", "fsr402", PWD=str(tmp_path)
    )
    assert "--sensor: says otherwise what --from takes" in twice.stderr


@pytest.mark.full
@pytest.mark.parametrize("name", OLD)
def test_the_written_design_passes_its_checks(name: str, tmp_path: Path) -> None:
    done = run_fingertip("new", "mine", "--from", write(name, tmp_path), PWD=str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert run_fingertip("check", "mine.toml", PWD=str(tmp_path)).returncode == 0
