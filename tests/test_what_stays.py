"""Features that stay under their present names, whatever else is retired."""

from __future__ import annotations

import re

import pytest

from fingertip.cad.files.part_formats import PART_FORMATS
from fingertip.catalogues.electronics import SENSORS
from fingertip.design import Design
from fingertip.design.formulas.filter import ideal_components
from fingertip.design.parameters import PARAMETERS
from fingertip.models.parts import parts_by_name
from fingertip.slip.detectors.registry import DETECTORS
from tests.conftest import ROOT, run_fingertip


@pytest.mark.parametrize("name", ["fsr400", "fsr402", "article", "first_finger"])
def test_bone_skin_and_two_mold_halves_are_parts_of_every_design(name: str) -> None:
    assert {"bone", "skin", "mold_palmar", "mold_dorsal"} <= set(parts_by_name(Design.load(name)))
    assert {"stl", "step"} <= set(PART_FORMATS)


def test_the_article_s_bone_is_encapsulated_with_its_sensor() -> None:
    assert Design.load("article").skin.made == "encapsulated"
    for name in ("fsr400", "fsr402", "first_finger"):
        assert {"holder", "plug"} <= set(
            parts_by_name(Design.load(name, changes=["skin.made=encapsulated"]))
        )


def test_cable_channel_and_pockets_keep_their_parameters() -> None:
    assert {"bone.channel_diameter_mm", "bone.channel_bend_radius_mm", "sensor.model"} <= set(
        PARAMETERS
    )
    assert {"fsr400", "fsr402"} <= set(SENSORS)


@pytest.mark.parametrize(("folder", "name"), [("pcb", "fsr400"), ("pcb/article", "article")])
def test_netlists_hold_the_values_of_the_butterworth_formulas(folder: str, name: str) -> None:
    text = (ROOT / folder / "slip_filter.net").read_text(encoding="utf-8")
    values = dict(re.findall(r'\(ref "(R[123])"\)\s+\(value "([^"]+)"\)', text))
    ideal = ideal_components(Design.load(name).board)
    for reference, ohm in zip(
        ("R1", "R2", "R3"), (ideal.r1_ohm, ideal.r2_ohm, ideal.r3_ohm), strict=True
    ):
        number, unit = re.fullmatch(r"([\d.]+)(k?)", values[reference]).groups()  # type: ignore[union-attr]
        assert float(number) * (1000.0 if unit else 1.0) == pytest.approx(ohm, rel=0.06), "E24"


def test_commands_detectors_and_ways_into_other_repositories_keep_their_names() -> None:
    page = run_fingertip("--help").stdout
    assert {"build", "board", "validate", "sweep", "check"} <= set(
        re.findall(r"^  (\w+)", page, re.MULTILINE)
    )
    assert {"analog", "digital", "fast", "fft"} <= set(DETECTORS)
    assert "id: fingertip-check" in (ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8")
    action = (ROOT / ".github/actions/check/action.yml").read_text(encoding="utf-8")
    assert "--junit" in action
