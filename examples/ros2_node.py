"""ROS 2 node of a built finger: its force as a wrench, its slip as a Bool, on topics that other
nodes subscribe to.

Needs ROS 2 (rclpy, geometry_msgs, std_msgs, diagnostic_msgs), fingertip in the same Python, and a
finger whose controller streams (`slip_lamp.ino` with STREAM = true, or `slip_stream.ino`). Source
ROS 2, and run from a clone:

    python3 examples/ros2_node.py --ros-args -p port:=/dev/ttyACM0 -p design:=first_finger \\
        -r __ns:=/index
    ros2 topic echo /index/wrench

It ran with stand-ins for the classes of ROS (`tests/recorded_trials/test_driver.py`), without ROS.

| topic | message |
| --- | --- |
| `wrench` | geometry_msgs/WrenchStamped, force along -z of `frame_id`; NaN without a known curve |
| `slip` | std_msgs/Bool, true if it slipped since the last message |
| `slip_incipient` | std_msgs/Bool, earlier and less sure; on a divider the same |
| `/diagnostics` | diagnostic_msgs/DiagnosticArray, each second: lost samples, interval of force |

`frame_id` is the frame of the sensor in the model that `fingertip robot --format urdf` writes. It
presses along -z.

Next: let a controller of the hand subscribe to `slip`, and tighten its grip. A subscriber needs the
QoS of sensors (best effort), as `qos_profile_sensor_data`; a reliable one gets nothing.
"""

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import WrenchStamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import Bool

from fingertip.drivers import Finger, Reading, Slip
from fingertip.foundation.errors import TraceError

DIAGNOSTICS_S = 1.0


class FingerNode(Node):
    """Publishes what a finger feels, `rate_hz` times a second;
    the driver reads every sample in between.
    """

    def __init__(self) -> None:
        super().__init__("fingertip")
        self.declare_parameter("port", "/dev/ttyACM0")
        self.declare_parameter("design", "first_finger")
        self.declare_parameter("frame_id", "first_finger_sensor")
        self.declare_parameter("rate_hz", 200.0)
        values = {
            name: self.get_parameter(name).value
            for name in ("port", "design", "frame_id", "rate_hz")
        }
        self.frame_id = values["frame_id"]
        self.port = values["port"]
        self.finger = Finger(self.port, values["design"])
        self.wrenches = self.create_publisher(WrenchStamped, "wrench", qos_profile_sensor_data)
        self.slips = self.create_publisher(Bool, "slip", qos_profile_sensor_data)
        self.early_slips = self.create_publisher(Bool, "slip_incipient", qos_profile_sensor_data)
        self.diagnostics = self.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self.last: Reading | None = None
        self.create_timer(1.0 / values["rate_hz"], self.publish)
        self.create_timer(DIAGNOSTICS_S, self.diagnose)

    def publish(self) -> None:
        """Publish the newest sample.

        Its time is ROS's, a few milliseconds after the controller took it.
        """
        self.last = reading = self.finger.read()
        wrench = WrenchStamped()
        wrench.header.stamp = self.get_clock().now().to_msg()
        wrench.header.frame_id = self.frame_id
        wrench.wrench.force.z = -reading.force_n
        self.wrenches.publish(wrench)
        self.slips.publish(Bool(data=reading.slip == Slip.ON))
        self.early_slips.publish(Bool(data=reading.slip >= Slip.INCIPIENT))

    def diagnose(self) -> None:
        """Publish how well the stream arrives."""
        if self.last is None:
            return

        level = DiagnosticStatus.WARN if self.last.lost else DiagnosticStatus.OK
        status = DiagnosticStatus(
            name=f"{self.get_name()}: stream", hardware_id=self.port, level=level
        )
        status.message = (
            f"{self.last.lost} samples lost" if self.last.lost else "all samples arrived"
        )
        low_n, high_n = self.last.force_interval_n
        interval = f"{low_n:.2f} to {high_n:.2f} N"
        status.values = [
            KeyValue(key="force interval", value=interval),
            KeyValue(key="lost", value=str(self.last.lost)),
        ]
        message = DiagnosticArray(status=[status])
        message.header.stamp = self.get_clock().now().to_msg()
        self.diagnostics.publish(message)

    def destroy_node(self) -> None:
        self.finger.close()
        super().destroy_node()


def main() -> None:
    """Run the node until Ctrl-C, or until the port ends."""
    rclpy.init()
    node = None

    try:
        node = FingerNode()
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except TraceError as error:
        rclpy.logging.get_logger("fingertip").fatal(str(error))
    finally:
        if node:
            node.destroy_node()

        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
