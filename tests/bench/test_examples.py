"""Examples of hands that listen, on the terminal on which a process plays the firmware.

ROS and LeRobot are not installed here: what the examples take of them is replaced by the least that their pages state.
"""

from __future__ import annotations

import runpy
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from tests.bench.test_driver import simulate
from tests.bench.test_record import DESIGN, playing
from tests.conftest import ROOT

pytestmark = pytest.mark.full


class Anything:
    """A module, class, message or clock: it has every name, and keeps what it is given."""

    def __init__(self, *_: Any, **values: Any) -> None:
        self.__dict__.update(values)

    def __getattr__(self, name: str) -> Any:
        return self.__dict__.setdefault(name, Anything())

    def __call__(self, *_: Any, **values: Any) -> Any:
        return Anything(**values)


class Node(Anything):
    port, destroy_node = "", Anything()

    def declare_parameter(self, name: str, value: Any) -> None:
        self.__dict__[f"its {name}"] = Anything(value=self.port if name == "port" else value)

    def get_parameter(self, name: str) -> Any:
        return self.__dict__[f"its {name}"]

    def create_publisher(self, kind: type, topic: str, qos: Any) -> Anything:
        return Anything(publish=self.__dict__.setdefault(topic, []).append)


class Arm(Anything):
    observation_features, is_connected = {"gripper.pos": float}, True
    connect = disconnect = Anything()

    def get_observation(self) -> dict[str, float]:
        return {"gripper.pos": 1.0}


def run_example(name: str, monkeypatch: pytest.MonkeyPatch, **modules: Anything) -> dict[str, Any]:
    for module, stand_in in modules.items():
        monkeypatch.setitem(sys.modules, module.replace("__", "."), stand_in)
    return runpy.run_path(str(ROOT / "examples" / name))


def test_a_node_of_ros_publishes_force_and_slip(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    names = ["rclpy", "rclpy__executors", "rclpy__qos", "diagnostic_msgs__msg", "geometry_msgs__msg", "std_msgs__msg"]
    modules = {name: Anything() for name in names} | {"rclpy__node": Anything(Node=Node)}
    example = run_example("ros2_node.py", monkeypatch, **modules)
    with playing(tmp_path, simulate(DESIGN)[4500:8500, 0]) as port:
        monkeypatch.setattr(Node, "port", port)
        node = example["FingerNode"]()
        for _ in range(120):
            time.sleep(0.02)
            node.publish()
        node.diagnose()
        node.destroy_node()
    forces_n = [message.wrench.force.z for message in node.wrench]
    assert (len(forces_n), max(forces_n) < 0.0, min(forces_n)) == (120, True, pytest.approx(-1.0, rel=0.5))
    assert {message.data for message in node.slip} == {True, False}
    assert vars(node)["/diagnostics"][0].status[0].message == "all samples arrived"


def test_an_arm_of_lerobot_observes_force_and_slip(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    example = run_example(
        "lerobot_sensor.py", monkeypatch, lerobot=Anything(),
        lerobot__robots=Anything(RobotConfig=Anything(register_subclass=lambda name: lambda kind: kind)),
        lerobot__robots__so_follower=Anything(SO101Follower=Arm, SO101FollowerConfig=object),
    )  # fmt: skip
    with playing(tmp_path, simulate(DESIGN)[4500:8500, 0]) as port:
        arm = example["SO101Fingertip"](example["SO101FingertipConfig"](fingertip_port=port))
        with pytest.raises(ConnectionError, match="call connect"):
            arm.get_observation()
        arm.connect()
        seen = [(time.sleep(1 / 30), arm.get_observation())[1] for _ in range(75)]
    assert {*seen[0]} == {*arm.observation_features} == {"gripper.pos", "fingertip.force", "fingertip.slip"}
    assert {each["fingertip.slip"] for each in seen} == {0.0, 2.0}
    with pytest.raises(TimeoutError, match="has ended"):
        [arm.get_observation() for _ in range(9)]
    assert not arm.is_connected
