"""Sensors and controllers by the names that people write: found, or refused with the reason and
what to do.
"""

from __future__ import annotations

import os
import re
import shlex
from pathlib import Path

import pytest

from fingertip.cad.verification.skin import check_rest_force
from fingertip.catalogues import electronics
from fingertip.catalogues.electronics import spell_sensor
from fingertip.design import Design
from fingertip.firmware.controller_fit import find_warnings
from fingertip.firmware.fingers import plan_fingers
from fingertip.firmware.measured_costs import read_costs
from fingertip.foundation.errors import DesignError, FingertipError
from fingertip.foundation.tables import read_rows
from tests.conftest import ROOT, run_fingertip

ROWS = list(read_rows(Path(electronics.__file__).with_name("sensors.csv")))
HOW = {"yes": "`--sensor {model}`", "custom": "as `custom`: {reason}"}
MANUAL = ROOT / "docs/sensor.md"


def test_the_manual_lists_the_sensors_of_the_catalogue() -> None:
    rows = [
        f"| {{maker}} {{label}} | {HOW[row['fits']]} | {{order_number}} | {{source}} |".format(
            **row
        )
        for row in ROWS
        if row["fits"] != "never"
    ]
    table = "\n".join(
        ["| sensor | fits | order number | source |", "| --- | --- | --- | --- |", *rows, ""]
    )
    table = (
        table.replace("Ohmite Ohmite", "Ohmite")
        .replace("[D]", "Interlink")
        .replace("[O]", "Ohmite, FSR Series,")
    )
    text = MANUAL.read_text(encoding="utf-8")
    if os.environ.get("FINGERTIP_APPROVE"):
        text = re.sub(r"(?m)(?:^\|.*\n)+", lambda found: table, text, count=1)
        MANUAL.write_text(text, encoding="utf-8")
    assert f"\n\n{table}\n" in text


def test_names_of_sensors_are_read_as_people_write_them() -> None:
    written = (
        "FSR-400 fsr402 FSR_402_Short rp-c7.6 RP-C7.6-ST rp_c7.6_lt Ohmite-FSR07 interlink-fsr400"
    )
    known = "fsr400 fsr402 fsr402_short rp_c7.6 rp_c7.6_short rp_c7.6 fsr07 fsr400"
    assert [spell_sensor(word) for word in written.split()] == known.split()
    assert Design.load("fsr402", changes=["sensor.model=FSR-402 Short"]) == Design.load("fsr402")


@pytest.mark.second
@pytest.mark.parametrize(
    "row", [row for row in ROWS if row["fits"] != "yes"], ids=lambda row: row["model"]
)
def test_a_sensor_that_does_not_fit_is_refused_with_its_reason_and_what_does(
    row, tmp_path: Path
) -> None:
    for word in (row["model"], *row["names"].split()):
        with pytest.raises(DesignError, match=re.escape(row["reason"][:30])):
            Design.load("fsr402", changes=[f"sensor.model={word}"])
    told = run_fingertip("new", "mine", "--sensor", row["model"].upper(), PWD=str(tmp_path)).stderr
    remedy = re.search(
        re.escape(row["reason"][:30]) + r".*(?:take (\w+)|`fingertip (new .*)`)", told
    )
    assert remedy
    done = run_fingertip(
        *shlex.split(remedy[2] or f"new NAME --sensor {remedy[1]}"), PWD=str(tmp_path)
    )
    assert done.returncode == 0, done.stderr
    assert check_rest_force(Design.load(tmp_path / "NAME.toml")).passed


def test_another_material_is_answered_with_what_to_state_of_ones_own() -> None:
    with pytest.raises(DesignError, match="'asa' is not known") as caught:
        Design.load(changes=["strength.print_material=asa"])
    stated = {
        "own_label": "ASA",
        "own_source": "data sheet",
        "own_process": "fdm",
        "own_strength_mpa": 20.0,
    }
    stated |= {"own_modulus_mpa": 1900.0}
    assert set(re.findall(r"strength\.(own_\w+)", str(caught.value))) == set(stated)
    Design.load(changes={"strength": {"print_material": "own", **stated}})


TICK_MS = 1.5 * read_costs()["targets"]["Cortex-M0+"]["instructions"]["quiet"] / 16e3
REFUSED = {
    "uno nano ATmega328P": rf"least {TICK_MS:.1f} ms at 16 MHz.* after 0\.5 ms; give controller "
    rf"pico_2",
    "esp32": r"0\.15 to 2\.45 V, and a board gives up to 3\.3 V; .*board\.variant.*divider",
    "nano33iot": "conversions for 0",
    "generic: generic:240MHz,A0 generic:12bit,9MHz": "or your own such as generic:240MHz",
    "generic:16MHz,12bit,A0,A1": "cycles while all slip for 0 at 2000 Hz, not for 1",
}


def test_controllers_are_known_by_the_names_of_chips_and_boards_and_refused_with_the_figure() -> (
    None
):
    board = Design.load("fsr400")
    divider = Design.load("first_finger")
    known = {
        "nucleo-f446re": "nucleo_f446re",
        "F446RE": "nucleo_f446re",
        "Teensy 4.1": "teensy40",
        "rp2040": "pico",
    }
    known |= {
        "pico2": "pico_2",
        "RP2350": "pico_2",
        "nano33": "nano_33_ble",
        "Arduino Nano 33 BLE": "nano_33_ble",
    }
    lamps = {"ESP32-S3": "esp32_s3", "esp32-devkit": "esp32", "esp32c3": "esp32_c3", "Pico": "pico"}
    for design, words in ((board, known), (divider, lamps)):
        assert [plan_fingers(design, controller=word).controller.key for word in words] == [
            *words.values()
        ]
    for words, reason in REFUSED.items():
        for word in words.split():
            with pytest.raises(FingertipError, match=reason):
                plan_fingers(board, controller=word)
    with pytest.raises(FingertipError, match="no timer in the sketch"):
        plan_fingers(divider, controller="due")


def test_a_controller_of_ones_own_is_judged_by_clock_bits_and_pins() -> None:
    design = Design.load("fsr400")
    planned = plan_fingers(design, "2", "generic: 240 MHz, 12 bits, A0, A1, A2, 34")
    assert planned.inputs == (("A0", "A1"), ("A2", "34"))
    assert not list(find_warnings(design, planned.controller))
    warned = " ".join(
        find_warnings(design, plan_fingers(design, "1", "generic:60MHz,10bit,5V,A0,A1").controller)
    )
    assert {"detector.adc_range_v=5", "detector.adc_bits=10"} <= set(warned.split())
