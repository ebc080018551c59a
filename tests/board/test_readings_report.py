"""Report on a board's readings: what feeds the board, the idle level, the current, and the order of the file."""

from __future__ import annotations

import re

import numpy as np
import pytest

from fingertip.board.bringup.bench import TONE_V, list_faults
from fingertip.board.bringup.plan import QUIET_ENVELOPE, SUPPLY_MA, BringUp
from fingertip.board.bringup.prediction import is_tone, predict
from fingertip.board.bringup.readings import Readings, assess_readings, find_sources
from fingertip.board.parts.circuit import VCC
from fingertip.tasks.board import bring_up_files
from tests.board.test_bringup import CONTROLLER, TWO, draw_board, plan_of

pytestmark = pytest.mark.usefixtures("predict_once")

THRESHOLD_V = 0.023


def read_good_board(plan: BringUp, dc: float = 1.0, tone: float = 1.0) -> dict[str, float]:
    """Readings of a good board with its direct voltages, and those of the tone [V], changed by a ratio."""
    good = predict(plan.board, [draw_board(plan, np.random.default_rng(11))])[0]
    return {n: v * (dc if not is_tone(n) else 1.0 if n.startswith("u3_") else tone) for n, v in good.items()}


def verdict(plan: BringUp, values: dict[str, float]) -> str:
    return str(assess_readings(plan, Readings(TONE_V, values), THRESHOLD_V)["verdict"])


@pytest.mark.full
@TWO
@pytest.mark.parametrize("ratio", [0.91, 0.955, 1.09])
def test_readings_that_follow_the_supply_name_it(changes: tuple[str, ...], ratio: float) -> None:
    plan = plan_of(changes)[1]
    nominal_v = plan.board.rails_v[VCC]
    few = ("tp1_open_v", "j1_open_v", "r13_open_v", "tp2_open_v")
    for names in (None, few) if abs(ratio - 1.0) > 0.05 else (None,):
        said = verdict(plan, {n: v for n, v in read_good_board(plan, dc=ratio).items() if names is None or n in names})
        assert said.startswith("No part need be faulty: all direct voltages are")
        found = re.search(rf"would be ([\d.]+) V and has to be {nominal_v:g} V within 2 %", said)
        assert found
        assert float(found[1]) == pytest.approx(ratio * nominal_v, rel=0.02)
    assert "check that the supply is on and not reversed" in verdict(plan, read_good_board(plan, dc=0.0))


@pytest.mark.full
def test_a_fault_beside_a_low_supply_is_not_denied() -> None:
    plan = plan_of(CONTROLLER)[1]
    values = read_good_board(plan, dc=0.9) | {"tp3_134hz_v": 0.02}
    assert verdict(plan, values).startswith("First, all direct voltages are 0.9")


@TWO
def test_readings_that_follow_the_tone_name_it_beside_the_fault(changes: tuple[str, ...]) -> None:
    said = verdict(plan_of(changes)[1], read_good_board(plan_of(changes)[1], tone=0.5))
    tone = re.search(r"the tone would be ([\d.]+) V RMS; check that tone_v = 0.3 is", said)
    assert tone
    assert float(tone[1]) == pytest.approx(0.15, abs=0.011)
    assert "Or: Likely fault, one of these" in said
    assert "R4 has twice its value" in said


@pytest.mark.full
@TWO
def test_no_fault_of_a_part_looks_like_another_supply(changes: tuple[str, ...]) -> None:
    plan = plan_of(changes)[1]
    faults = list(list_faults(plan.board.circuit, plan.board.ends_v))
    assert len(faults) > 100
    for fault, values in zip(faults, predict(plan.board, faults), strict=True):
        said = find_sources(plan.board, plan.levels, values, TONE_V).sentences
        assert not any("supply" in each for each in said), fault.sentence


def hints(plan: BringUp, values: dict[str, float]) -> str:
    return " ".join(assess_readings(plan, Readings(TONE_V, values), THRESHOLD_V)["hints"])


def test_an_offset_of_the_envelope_raises_the_threshold_of_analog_alone() -> None:
    plan = plan_of(CONTROLLER)[1]
    said = hints(plan, {QUIET_ENVELOPE: 0.020})
    noise_v = plan.levels[QUIET_ENVELOPE].expected_v
    assert noise_v > 1e-3
    assert f"`--detector analog --set detector.threshold_v={THRESHOLD_V + 0.020 - noise_v:.3f}`" in said
    assert "Never change it for `digital`" in said
    assert "E minus M at J3" in said
    assert not hints(plan, {QUIET_ENVELOPE: 0.008})


@pytest.mark.full
def test_no_threshold_follows_from_a_reading_that_is_wrong() -> None:
    plan = plan_of(CONTROLLER)[1]
    assert "threshold" not in hints(plan, {QUIET_ENVELOPE: 1.474})
    # Within its limits, but beside a mistake of the measurement.
    good = read_good_board(plan) | {QUIET_ENVELOPE: 0.02}
    assert "threshold" in hints(plan, good)
    values = {n: v - good["tp5_open_v"] * (n.startswith("j3_") and n.endswith("open_v")) for n, v in good.items()}
    assert "at J3 were taken with the black probe at signal ground" in verdict(plan, values)
    assert "threshold" not in hints(plan, values)


@pytest.mark.full
def test_sheet_and_readme_give_the_threshold_to_analog_alone() -> None:
    from fingertip.tasks.board import board_files

    design, plan = plan_of(CONTROLLER)
    sheet = bring_up_files(design)["bringup.md"].decode().split("## 8. Threshold")[1].split("\n## ")[0]
    readme = " ".join(board_files(design)["README.md"].decode().split())
    for text in (sheet, readme):
        assert "--detector analog --set detector.threshold_v=..." in text
        assert "for `digital`, the default" in text
        assert f"({1e3 * plan.levels[QUIET_ENVELOPE].expected_v:.1f} mV)" in text


def test_no_current_is_a_supply_that_is_not_connected() -> None:
    plan = plan_of(CONTROLLER)[1]
    data = assess_readings(plan, Readings(TONE_V, {SUPPLY_MA: 0.0}))
    assert data["verdict"] == "Readings fail: supply_ma. No voltage was entered."
    assert "supply_ma: no current: the supply is reversed or not connected" in data["hints"][0]
    assert "not soldered" not in data["hints"][0]
    little = assess_readings(plan, Readings(TONE_V, {SUPPLY_MA: 1.5, "tp1_open_v": 1.2145}))
    assert "an amplifier is not soldered" in little["hints"][0]
    assert little["verdict"].startswith("The voltages entered are within their limits")


@TWO
def test_file_of_readings_has_the_order_of_the_sheet(changes: tuple[str, ...]) -> None:
    files = bring_up_files(plan_of(changes)[0])
    asked = re.findall(r"(?m)^\| `(\w+)` \|", files["bringup.md"].decode())
    given = re.findall(r"(?m)^(\w+) = nan", files["bringup_readings.toml"].decode())
    assert given == asked
    assert set(plan_of(changes)[1].levels) < set(given)
