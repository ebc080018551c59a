"""Tactile voltage of a front end, a board's or a divider's, over the sensor's conductance."""

from __future__ import annotations

import functools
from dataclasses import dataclass

from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.network import build_network
from fingertip.board.components.front_end import MAX_FORCE_N, sensor_conductance_s
from fingertip.board.components.values import SUPPLIES, select_components
from fingertip.board.parts.circuit import SENSOR_CONNECTOR
from fingertip.board.parts.nets import GND, SENSOR, TACTILE, VCC, VEE
from fingertip.design import Design

IDLE_TOLERANCE_V = 0.1
MAX_PRELOAD_V = 0.5
"""Largest offset of an untouched finger; from the second value on it is another board's [V]."""
PRELOAD = "the skin presses on the sensor: pull it on again"


@dataclass(frozen=True)
class TactileResponse:
    """Tactile voltage as a function of the sensor's conductance.

    The front end drives the sensor like a source of voltage with a resistance (Thevenin), and the
    current through the sensor moves the tactile voltage in proportion: down behind a bridge, up
    behind a transimpedance stage.
    """

    open_v: float
    """Tactile voltage with an open sensor, against ground [V]."""
    sensor_v: float
    """Voltage across an open sensor [V]."""
    source_ohm: float
    """Resistance of the front end as the sensor sees it."""
    transfer_ohm: float
    """Tactile voltage lost per current through the sensor; negative where it is gained."""

    @property
    def rises(self) -> bool:
        return self.transfer_ohm < 0.0

    def describe_preload(self, rest_v: float) -> str | None:
        """Warn if the voltage at the least load [V] is that of a sensor under a tight skin."""
        excess_v = rest_v - self.open_v
        if (excess_v > 0.0) != self.rises or not IDLE_TOLERANCE_V < abs(excess_v) <= MAX_PRELOAD_V:
            return None

        return (
            f"at the least load the voltage is {1000 * excess_v:+.0f} mV from the "
            f"{self.open_v:.3g} V of an untouched "
            f"finger; if nothing touches it then, {PRELOAD}."
        )

    def tactile_v(self, conductance_s: float) -> float:
        """Return the tactile voltage [V] at a conductance [S], with an ideal amplifier output."""
        current_a = self.sensor_v * conductance_s / (1.0 + self.source_ohm * conductance_s)
        return self.open_v - self.transfer_ohm * current_a


@functools.lru_cache(maxsize=16)
def find_tactile_response(design: Design) -> TactileResponse:
    """Find the response of a design's front end. The last few designs are remembered."""
    board = design.board
    if not board.has_filter:
        # The supply behind the resistor drives the sensor, whose current is read across that
        # resistor.
        return TactileResponse(0.0, board.supply_v, board.divider_ohm, -board.divider_ohm)

    circuit = board_circuit(select_components(design))
    network = build_network(circuit).restrict(TACTILE, SUPPLIES[board.variant].signal_ground)
    volts = network.operating_point({GND: 0.0, VCC: board.supply_v, VEE: -board.supply_v})
    return TactileResponse(
        open_v=volts[TACTILE],
        sensor_v=volts[SENSOR] - volts[circuit.net_by_pin[SENSOR_CONNECTOR, "2"]],
        source_ohm=network.constant_transfers(SENSOR)[SENSOR],
        transfer_ohm=network.constant_transfers(TACTILE)[SENSOR],
    )


def find_tactile_range_v(design: Design) -> tuple[float, float]:
    """Smallest and largest tactile voltage [V], from an open sensor to its maximum force."""
    response = find_tactile_response(design)
    ends_v = response.open_v, response.tactile_v(sensor_conductance_s(MAX_FORCE_N))
    return min(ends_v), max(ends_v)
