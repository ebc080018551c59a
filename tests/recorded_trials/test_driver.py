"""Driver of a finger: states, forces, lost samples, refusals, a port
that is read meanwhile, and its examples.
"""

from __future__ import annotations

import os
import re
import runpy
import sys
import threading
import time
from pathlib import Path
from typing import Any, ClassVar
from unittest.mock import MagicMock

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.detection.recordings import find_force_scale
from fingertip.drivers import Finger, Port, Slip
from fingertip.foundation.errors import TraceError
from fingertip.sim.runs.scene import run_scene
from fingertip.slip.detectors.fast import FastDetector
from tests.conftest import ROOT
from tests.recorded_trials.player import slide_scene
from tests.recorded_trials.test_record import DESIGN, playing


def simulate(design: Design) -> np.ndarray:
    """Signals of a slide (rows of samples), as the sketches write them."""
    signals = ("voltage_v", "sampled_filtered_v")[: 1 + design.board.has_filter]
    trace = run_scene(
        design, slide_scene("paper", 1.0, 0.06).model_copy(update={"outputs": signals}), 3
    ).trace
    return np.column_stack(
        [each.round(6) for each in (trace.voltage_v, trace.filtered_v) if each is not None]
    )


@pytest.mark.full
def test_states_and_forces_are_those_of_detector_and_curve_and_lost_samples_count() -> None:
    """Three lines are lost, one is damaged, 100 ms are lost, and the controller is reset."""
    design = Design.load("adult_finger")
    samples = simulate(design)
    lines = [
        f"{number / 2000:.6f},{volts:.6f},{filtered:.6f}"
        for number, (volts, filtered) in enumerate(samples)
    ]
    lines[4000] = "2.0x,1.0,1.0"
    kept = [*range(3000), *range(3003, 5000), *range(5200, 6000), *range(4500, 9000)]
    found = [*Finger(["time_s,voltage_v,filtered_v", *(lines[number] for number in kept)], design)]
    samples[[3000, 3001, 3002, 4000]] = np.nan
    gap = np.full((41, 2), np.nan)
    given = np.concatenate([samples[:5000], gap, samples[5200:6000], gap, samples[4500:9000]])
    output = FastDetector.for_design(design).process(*given.T)
    expected = np.where(output.on, Slip.ON, output.incipient)[np.isfinite(given[:, 0])]
    assert [reading.slip for reading in found] == expected.tolist()
    assert {*expected} == {*Slip}
    assert [found[at].lost for at in (2999, 3000, 3997, 5100, -1)] == [0, 3, 4, 204, 204]
    scale = find_force_scale(design)
    held = found[3990]
    assert scale
    force = scale.read(float(samples[3900:3994, 0].mean()))
    assert (held.force_n, *held.force_interval_n) == pytest.approx(
        (force.force_n, force.low_n, force.high_n), rel=0.05
    )


@pytest.mark.full
def test_a_finger_on_a_terminal_gives_the_newest_sample_and_the_surest_slip_since_the_last(
    tmp_path: Path,
) -> None:
    """The process that plays the firmware streams a slide over a divider; a hand reads
    every 20 ms.
    """
    volts = simulate(DESIGN)[4500:8500, 0]
    with playing(tmp_path, volts) as port, Finger(Path(port)) as finger:
        found = [next(iter(finger))]
        while found[-1].time_s < found[0].time_s + 2.5:
            time.sleep(0.02)
            found.append(finger.read())
    first, *ends = (round(2000 * reading.time_s) for reading in found)
    on = (
        FastDetector.for_design(DESIGN)
        .process(volts[np.arange(first, ends[-1] + 1) % len(volts)])
        .on
    )
    parts = zip([first, *ends], ends, strict=False)
    expected = [bool(on[start + 1 - first : end + 1 - first].any()) for start, end in parts]
    assert [reading.slip == Slip.ON for reading in found[1:]] == expected
    assert (any(expected), all(expected), found[-1].lost) == (True, False, 0)
    assert ends[-1] - first > 20 * len(ends), "what has arrived in 20 ms is taken at once"
    with pytest.raises(TraceError, match="has ended"):
        [finger.read() for _ in range(9)]


SLOW = ["time_s,voltage_v", *(f"{number / 1000},1" for number in range(30))]


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        (SLOW, "sends 1000 samples a second, not 2000"),
        ("/dev/no_such", "plug the controller in"),
        (
            ["time_s,voltage_v,filtered_v", "0,1,1"],
            "first_finger has no filter board; name the finger's design",
        ),
        (["0,1", "0.0005,1"], "stream, line 1: '0,1' is not the header"),
        (["force_n:1.23 volts:0.81 slip:0"], "set STREAM = true in slip_lamp.ino"),
    ],
)
def test_another_stream_is_refused_with_a_remedy(lines: list[str] | str, said: str) -> None:
    with pytest.raises(TraceError, match=re.escape(said)) as refused:
        list(Finger(lines))
    change = re.search(r'"detector.sample_rate_hz": (\d+)', str(refused.value))
    if change:
        assert [*Finger(lines, DESIGN.replace({"detector.sample_rate_hz": int(change[1])}))][
            -1
        ].lost == 0


def test_a_port_keeps_the_newest_lines_and_closes_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fingertip.drivers._MOST_BLOCKS", 3)
    read, write = os.pipe()
    port = Port(os.fdopen(read))
    threads = threading.active_count()
    begin_s = time.monotonic()
    for number in range(9):
        os.write(write, b"%d\n" % number)
        time.sleep(0.02)
    port.close()
    port.close()
    assert (time.monotonic() - begin_s < 1.0, threading.active_count()) == (True, threads - 1)
    assert [*port] == [b"6", b"7", b"8"]


class Base(MagicMock):
    """What the examples inherit of ROS and of LeRobot, which are not
    installed here: a mock that takes any argument.
    """

    observation_features: ClassVar = {"gripper.pos": float}
    is_connected = True
    connect = MagicMock()
    disconnect = MagicMock()
    destroy_node = MagicMock()
    get_observation = MagicMock(return_value={"gripper.pos": 1.0})

    def __init__(self, *_: Any) -> None:
        super().__init__()

    def _get_child_mock(self, **names: Any) -> Any:
        return MagicMock(**names)


@pytest.mark.full
def test_examples_give_force_and_slip_to_ros_and_lerobot(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    modules = {
        name: MagicMock(Node=Base, SO101Follower=Base, SO101FollowerConfig=object)
        for name in (
            "rclpy",
            "rclpy.executors",
            "rclpy.node",
            "rclpy.qos",
            "diagnostic_msgs.msg",
            "geometry_msgs.msg",
            "std_msgs.msg",
            "lerobot",
            "lerobot.robots",
            "lerobot.robots.so_follower",
        )
    }
    modules["lerobot.robots"].RobotConfig.register_subclass.return_value = lambda kind: kind
    for name, module in modules.items():
        monkeypatch.setitem(sys.modules, name, module)
    ros, arms = (
        runpy.run_path(str(ROOT / "examples" / name))
        for name in ("ros2_node.py", "lerobot_sensor.py")
    )
    with playing(tmp_path, simulate(DESIGN)[4500:8500, 0]) as port:
        ros["FingerNode"].__init__.__globals__["Finger"] = lambda *_: Finger(port)
        node = ros["FingerNode"]()
        forces_n = []
        for _ in range(110):
            time.sleep(0.02)
            node.publish()
            forces_n.append(modules["geometry_msgs.msg"].WrenchStamped().wrench.force.z)
        node.destroy_node()
        arm = arms["SO101Fingertip"](arms["SO101FingertipConfig"](fingertip_port=port))
        with pytest.raises(ConnectionError, match=r"call connect\(\) first"):
            arm.get_observation()
        arm.connect()
        seen = [arm.get_observation() for _ in range(200)]
    assert (max(forces_n) < 0.0, min(forces_n)) == (True, pytest.approx(-1.0, rel=0.5))
    assert {call.kwargs["data"] for call in modules["std_msgs.msg"].Bool.call_args_list} == {
        True,
        False,
    }
    assert (
        {*seen[0]}
        == {*arm.observation_features}
        == {"gripper.pos", "fingertip.force", "fingertip.slip"}
    )
    with pytest.raises(TimeoutError, match="has ended"):
        [arm.get_observation() for _ in range(99)]
    assert not arm.is_connected
