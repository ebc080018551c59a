"""LeRobot with a finger: force and slip join the observations of any arm, and so every data set
that it records.

Needs LeRobot (pip install lerobot), fingertip in the same Python, and a finger whose controller
streams (`slip_lamp.ino` with STREAM = true, or `slip_stream.ino`). See what the sensor gives, from
a clone of the repository:

    .venv/bin/python examples/lerobot_sensor.py /dev/ttyACM0

Its verbs are those of LeRobot's cameras: connect, is_connected, read, async_read, read_latest,
disconnect. LeRobot has no class of tactile sensors yet;
https://github.com/huggingface/lerobot/pull/4469 proposes one with these verbs.

Next: copy this file as `lerobot_robot_so101_fingertip/__init__.py` into a package of that name,
whose prefix LeRobot looks for, and `pip install -e` it. Then record, with port and design of your
finger:

    lerobot-record --robot.type=so101_fingertip --robot.port=/dev/ttyACM1 \\
        --robot.fingertip_port=/dev/ttyACM0 ...

`observation.state` then ends with `fingertip.force` [N] and `fingertip.slip`: 0, 1 incipient, or 2
ON, the surest since the frame before, so that a slip of a few milliseconds is seen at 30 frames a
second. For another arm, change the bases of the last two classes. This ran with the classes of
LeRobot 0.4.4, with stand-ins for torch and the motors of the arm.
"""

import sys
from dataclasses import dataclass
from typing import Any

from lerobot.robots import RobotConfig
from lerobot.robots.so_follower import SO101Follower, SO101FollowerConfig

from fingertip.drivers import Finger, Port, Reading
from fingertip.foundation.errors import TraceError

TIMEOUT_MS = 200.0


@dataclass
class FingertipSensorConfig:
    """Where the finger is, and which design its firmware was
    written for: a name, or the path of a file.
    """

    port: str = "/dev/ttyACM0"
    design: str = "first_finger"
    name: str = "fingertip"


class FingertipSensor:
    """A tactile sensor with the verbs of LeRobot's cameras; a reading is a dict of floats."""

    def __init__(self, config: FingertipSensorConfig) -> None:
        self.config = config
        self._finger = None

    @property
    def features(self) -> dict[str, type]:
        """Names and types of what a reading holds, for
        `observation_features`; known before `connect`.
        """
        return {f"{self.config.name}.force": float, f"{self.config.name}.slip": float}

    @property
    def is_connected(self) -> bool:
        return self._finger is not None

    def connect(self, warmup: bool = True) -> None:
        """Open the port and, with `warmup`, wait for the first sample."""
        if self._finger is not None:
            raise ConnectionError(f"{self.config.name} is connected; disconnect it first.")

        try:
            self._finger = Finger(
                Port(self.config.port, TIMEOUT_MS / 1000 + 1.0), self.config.design
            )
        except TraceError as error:
            raise ConnectionError(str(error)) from error

        if warmup:
            self.read()

    def read_sample(self) -> Reading:
        """Return the newest reading of the driver, with voltage, interval and samples lost."""
        if self._finger is None:
            raise ConnectionError(f"{self.config.name} is not connected; call connect() first.")

        try:
            return self._finger.read()
        except TraceError as error:
            self.disconnect()
            raise TimeoutError(str(error)) from error

    def read(self) -> dict[str, float]:
        """Return the newest force [N] and the surest slip since the last call."""
        reading = self.read_sample()
        return dict(zip(self.features, (reading.force_n, float(reading.slip)), strict=True))

    def async_read(self, timeout_ms: float = TIMEOUT_MS) -> dict[str, float]:
        """Return what `read` does: a thread of the driver reads
        the port, and a sample comes every 0.5 ms.
        """
        return self.read()

    def read_latest(self) -> dict[str, float]:
        """Return what `read` does, because a sample is never older than the time to the next."""
        return self.read()

    def disconnect(self) -> None:
        """Close the port."""
        if self._finger is not None:
            self._finger.close()

        self._finger = None


class WithFingertip:
    """Adds the finger to a robot: `class MyArm(WithFingertip,
    SomeArm)`, whose config has the two fields below.
    """

    def __init__(self, config: Any) -> None:
        super().__init__(config)
        self.fingertip = FingertipSensor(
            FingertipSensorConfig(config.fingertip_port, config.fingertip_design)
        )

    @property
    def observation_features(self) -> dict[str, Any]:
        return {**super().observation_features, **self.fingertip.features}

    @property
    def is_connected(self) -> bool:
        return super().is_connected and self.fingertip.is_connected

    def connect(self, calibrate: bool = True) -> None:
        # first: an arm that is connected, as it calibrates itself, counts as a whole
        self.fingertip.connect()
        try:
            super().connect(calibrate)
        except BaseException:
            self.fingertip.disconnect()
            raise

    def get_observation(self) -> dict[str, Any]:
        return {**super().get_observation(), **self.fingertip.async_read()}

    def disconnect(self) -> None:
        super().disconnect()
        self.fingertip.disconnect()


@RobotConfig.register_subclass("so101_fingertip")
@dataclass(kw_only=True)
class SO101FingertipConfig(SO101FollowerConfig):
    """Config of an arm SO-101 with a finger."""

    fingertip_port: str = "/dev/ttyACM0"
    fingertip_design: str = "first_finger"


class SO101Fingertip(WithFingertip, SO101Follower):
    config_class = SO101FingertipConfig
    name = "so101_fingertip"


if __name__ == "__main__":
    sensor = FingertipSensor(FingertipSensorConfig(*sys.argv[1:3]))
    sensor.connect()
    for _ in range(100):
        print(sensor.async_read())
    sensor.disconnect()
