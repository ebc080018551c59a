"""Constant voltages of the bridge and its amplifier, from the network."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from fingertip.board.circuit import Circuit
from fingertip.board.nets import SENSOR, TACTILE
from fingertip.board.network import build_network


@dataclass(frozen=True)
class TactileResponse:
    """Tactile voltage as a function of the sensor's conductance.

    The bridge drives the sensor like a source of voltage with a resistance (Thevenin), and the current through the
    sensor lowers the tactile voltage in proportion.
    """

    open_v: float
    """Tactile voltage with an open sensor, against ground [V]."""
    sensor_v: float
    """Voltage across an open sensor [V]."""
    source_ohm: float
    """Resistance of the bridge as the sensor sees it."""
    transfer_ohm: float
    """Tactile voltage lost per current through the sensor."""

    def tactile_v(self, conductance_s: float) -> float:
        """Tactile voltage [V] for a sensor of this conductance [S], without the limits of the amplifier's output."""
        current_a = self.sensor_v * conductance_s / (1.0 + self.source_ohm * conductance_s)
        return self.open_v - self.transfer_ohm * current_a


def compute_tactile_response(circuit: Circuit, rails: Mapping[str, float], signal_ground: str) -> TactileResponse:
    """Compute the tactile response of a board.

    Parameters
    ----------
    circuit
        Circuit of the board.
    rails
        Voltages of the rails [V].
    signal_ground
        Net at the sensor's other end.
    """
    network = build_network(circuit).restrict(TACTILE, signal_ground)
    volts = network.operating_point(rails)
    return TactileResponse(
        open_v=volts[TACTILE],
        sensor_v=volts[SENSOR] - volts[signal_ground],
        source_ohm=network.constant_transfers(SENSOR)[SENSOR],
        transfer_ohm=network.constant_transfers(TACTILE)[SENSOR],
    )
