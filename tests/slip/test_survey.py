"""Columns by their content: numbers as instruments write them,
proposals, containers, and signals at a limit.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from fingertip.board.analysis.tactile_response import PRELOAD, find_tactile_response
from fingertip.design import Design
from fingertip.detection.warnings import flat_warnings
from fingertip.slip.traces.cells import bare_lines, is_named, parse_number
from fingertip.slip.traces.column_survey import examine
from fingertip.slip.traces.read import read_raw_trace
from fingertip.slip.traces.trace import ColumnMap
from tests.slip.recordings import ONSET, T, V, csv, rows, run, single_onset

NUMBERS = {
    "1.25": 1.25,
    "1,25": 1.25,
    "-1,5E-3": -1.5e-3,
    "1,000.5": 1000.5,
    "1.000,5": 1000.5,
    "1,000,000": 1e6,
    "1.2 V": 1.2,
    "12 mV": 0.012,
    "2 kHz": 2000.0,
    "+.5": 0.5,
    "1.2.3": None,
    "0,5,3": None,
    "OL": None,
    "": None,
    "1 234": None,
    "5 apples": None,
}
# As sketches, plotters and monitors print them -> their values.
NAMED = {
    "FSR1:176,FSR2:12": "176,12",
    "FSR1: 176 FSR2: 12": "176 12",
    "A0=512": "512",
    "A0 = 512": "512",
    "val1: -1.5e-3; val2: 7": "-1.5e-3; 7",
    "x=1 y=2 z=3": "1 2 3",
    "Force: 3.2\tVoltage: 12 mV": "3.2\t12 mV",
    "sensor 1 = 3 , sensor 2 = 2": "3 , 2",
    "Analog reading = 512": "512",
    "12:30:01.123 -> 176": "176",
    "12:30:01.123 -> 176,12": "176,12",
    "12:30:01.123 -> FSR1:176": "176",
    "12:30:01.123 > A0=1.25 V": "1.25 V",
    "2026-11-28 12:30:01.123 -> 17": "17",
    "12:30:01.123 -> 0.5\t0.7": "0.5\t0.7",
    "t_ms:12,a1:+.5": "12,+.5",
}


NUMBERED = ("--column", "time_s=2", "--column", "voltage_v=1")


def test_numbers_are_read_as_instruments_write_them() -> None:
    assert {text: parse_number(text) for text in NUMBERS} == pytest.approx(NUMBERS)


def test_lines_that_name_their_values_leave_these() -> None:
    assert all(map(is_named, NAMED))
    assert dict(zip(NAMED, map(str.strip, bare_lines(NAMED)), strict=True)) == NAMED


@pytest.mark.parametrize("form", ['{{"v": {:.5f}, "at": {{"t": {:.4f}}}}}', "[{:.5f}, [{:.4f}]]"])
def test_json_lines_are_named_with_what_makes_numbers_of_them(form: str, tmp_path: Path) -> None:
    path = tmp_path / "t.txt"
    path.write_text("ready\n" + "\n".join(map(form.format, V, T)) + "\n")
    for said in (
        run("detect", path),
        run("detect", "-", lines=path.read_text()),
        run("detect", path, *NUMBERED),
    ):
        assert "holds JSON lines; pass them through jq" in said.stderr
        assert "--column" not in said.stderr
    command = re.search("(jq .*?), which", said.stderr)[1]
    if shutil.which("jq"):
        subprocess.run(
            f"tail -n +2 t.txt | {command} > t.csv", shell=True, cwd=tmp_path, check=True
        )
        assert single_onset(run("detect", tmp_path / "t.csv", *NUMBERED, "--json")) == ONSET


@pytest.mark.parametrize(
    ("kind", "values"),
    [
        ("signal", V),
        ("time", T),
        ("time", T - 0.5),
        ("time", np.floor(T * 1000)),
        ("counter", np.arange(2000.0)),
        ("time", np.cumsum(np.random.default_rng(0).exponential(5e-4, 2000))),
        ("constant", np.full(2000, 2.0)),
        ("text", np.full(2000, np.nan)),
        ("signal", (T > 0.5) * 1.0),
        ("time", np.delete(T, [50, 90, 91])),
    ],
)
def test_content_tells_what_a_column_can_be(kind: str, values: np.ndarray) -> None:
    assert examine("c", values).kind == kind


def test_a_time_is_no_voltage_in_any_kind_of_file(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text(csv(T, T))
    np.savez(tmp_path / "t.npz", time_s=T, voltage_v=np.floor(T * 1000) / 1000)
    for name in ("t.csv", "t.npz"):
        said = run("detect", tmp_path / name).stderr
        assert re.search(
            r"voltage_v: rises by 0.000\d+ per sample: it is a time or a counter", said
        )


def test_seconds_and_nanoseconds_are_joined(tmp_path: Path) -> None:
    start = 1_717_199_999_700_000_000
    stamps = [start + 500_000 * i for i in range(len(T))]
    text = "".join(
        f"{n // 10**9},{n % 10**9},finger,{v:.6f}\n" for n, v in zip(stamps, V, strict=True)
    )
    (tmp_path / "t.csv").write_text(text)
    assert "--column time_s=1+2 --column voltage_v=4" in run("detect", tmp_path / "t.csv").stderr
    options = ("--column", "time_s=1+2", "--column", "voltage_v=4", "--json")
    assert single_onset(run("detect", tmp_path / "t.csv", *options)) - start / 1e9 == pytest.approx(
        ONSET, abs=1e-6
    )
    live = json.loads(run("detect", "-", *options, lines=text).stdout)["transitions"][0]
    assert live["time_s"] - start / 1e9 == pytest.approx(ONSET, abs=1e-6)


@pytest.mark.second
def test_containers_list_what_they_hold_and_take_group_and_channel(tmp_path: Path) -> None:
    savemat = pytest.importorskip("scipy.io").savemat
    other = 2.0 + 1e-4 * np.random.default_rng(0).normal(size=len(T))
    savemat(
        tmp_path / "t.mat",
        {name: {"time_s": T, "voltage_v": v} for name, v in (("a", other), ("b", V))},
    )
    np.savez(tmp_path / "t.npz", a=np.column_stack([T, other]), b=np.column_stack([T, V]))
    for name, time, voltage in (("t.mat", "b/time_s", "b/voltage_v"), ("t.npz", "b/1", "b/2")):
        said = run("detect", tmp_path / name).stderr
        assert f"2 columns can be the voltage, {voltage.replace('b', 'a', 1)} (" in said
        assert "--column voltage_v=NAME" in said
        trace = read_raw_trace(
            tmp_path / name, ColumnMap({"time_s": time, "voltage_v": voltage})
        ).trace
        assert np.array_equal(trace.voltage_v, V)


@pytest.mark.second
@pytest.mark.parametrize("plugin", ["MCAP", "SQLITE3"])
def test_a_bag_lists_its_topics_and_takes_a_field_of_one(plugin: str, tmp_path: Path) -> None:
    rosbag2 = pytest.importorskip("rosbags.rosbag2")
    typesys = pytest.importorskip("rosbags.typesys")
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    known = store.types
    begin = 1_717_199_999_700_000_000
    with rosbag2.Writer(
        tmp_path / "bag", version=9, storage_plugin=rosbag2.StoragePlugin[plugin]
    ) as bag:
        both = {
            each: bag.add_connection(f"/{each}", "std_msgs/msg/Float64", typestore=store)
            for each in ("fsr", "arm")
        }
        stamped = bag.add_connection("/clock", "std_msgs/msg/Header", typestore=store)
        for i, volts in enumerate(V):
            at = begin + 500_000 * i
            for each, value in (("fsr", volts), ("arm", np.sin(i))):
                message = known["std_msgs/msg/Float64"](float(value))
                bag.write(both[each], at, store.serialize_cdr(message, "std_msgs/msg/Float64"))
            stamp = known["builtin_interfaces/msg/Time"](at // 10**9, at % 10**9)
            header = store.serialize_cdr(
                known["std_msgs/msg/Header"](stamp, "x"), "std_msgs/msg/Header"
            )
            bag.write(stamped, at, header)
    [path] = [file for file in (tmp_path / "bag").iterdir() if file.suffix != ".yaml"]
    said = run("detect", path).stderr
    assert "2 columns can be the voltage, /fsr.data (" in said
    assert "--column time_s=/fsr.bag_time --column voltage_v=/fsr.data" in said
    for time, start in (
        ("/fsr.bag_time", 0.0),
        ("/clock.stamp.sec+/clock.stamp.nanosec", begin / 1e9),
    ):
        done = run(
            "detect",
            path,
            "--column",
            f"time_s={time}",
            "--column",
            "voltage_v=/fsr.data",
            "--json",
        )
        assert single_onset(done) - start == pytest.approx(ONSET, abs=1e-6)


def test_a_finger_that_is_pressed_at_rest_is_pressed_in_a_file_and_live(tmp_path: Path) -> None:
    response = find_tactile_response(Design())
    for excess_v, is_pressed in ((0.356, True), (0.05, False), (0.8, False), (-0.08, False)):
        text = csv(T, V - 2.3 + response.open_v + excess_v + 0.5 * (T > 0.3))
        (tmp_path / "t.csv").write_text(text)
        for said in (
            run("detect", tmp_path / "t.csv").stderr,
            run("detect", "-", lines=text).stderr,
        ):
            assert (f"{1000 * excess_v:+.0f} mV from the 0.143 V" in said) == is_pressed
            assert said.count(PRELOAD) == is_pressed


def test_runs_at_a_limit_are_told_from_steps_and_noise() -> None:
    noise = np.random.default_rng(0).normal(0, 4e-4, 8000)
    press = 1.0 + np.clip(np.arange(8000) / 4000 - 0.5, 0, 1)
    assert "of 8000 samples" in next(flat_warnings(np.minimum(press + noise, 1.8), Design()))
    assert "the smallest voltage" in next(
        flat_warnings(np.maximum(-press - noise, -1.8) + 3.0, Design())
    )
    assert not list(flat_warnings(press + noise, Design()))
    assert not list(flat_warnings(np.round(press / 0.02) * 0.02, Design())), (
        "a held press of a coarse converter"
    )
    limited = np.tile(np.minimum(press + noise, 1.8), 2)
    for volts in (limited, limited[4100:8000]):
        live = run(
            "detect",
            "-",
            lines="time_s,voltage_v\n" + rows(np.arange(len(volts)) / 2000, volts=volts),
        )
        assert live.stderr.count("are flat at 1.8 V, the largest voltage") == 1
