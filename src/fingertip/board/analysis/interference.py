"""Interference on a board: aliasing, ripple of the supply, and crosstalk between fingers.

The signal's content beyond the band, noise and the skirt of a resonance, is small. A higher
sampling rate with subsequent averaging moves the aliases away.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np

from fingertip.board.analysis.loads import signal_band_hz
from fingertip.board.analysis.response import (
    RECTIFYING_DIODE,
    decibel,
    find_envelope_pin,
    find_rectifier,
)
from fingertip.board.circuits.channels import leave_out_empty, list_pins, name_net
from fingertip.board.circuits.network import build_network
from fingertip.board.circuits.spice import HOST_GROUND, HOST_SUPPLY
from fingertip.board.components import front_end
from fingertip.board.parts.circuit import Circuit, Component, Net, parse_component_value
from fingertip.board.parts.nets import (
    ADC_FILTERED,
    ADC_TACTILE,
    ENVELOPE,
    FILTERED,
    GND,
    POWER_IN,
    SENSOR,
    TACTILE,
    VCC,
    VEE,
    VMID,
)
from fingertip.board.parts.symbols import C_0603, CAPACITOR, R_0603, RESISTOR
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import BAND_CUTOFFS
from fingertip.design.parameters.board_and_detector import Board

_POINTS = 40


@dataclass(frozen=True)
class AliasAttenuation:
    band_hz: float
    """Upper end of the vibrations' band."""
    nyquist_hz: float
    alias_hz: float
    """Lowest frequency that aliases into the band: the sampling rate less `band_hz`."""
    tactile_band_db: float
    """Gain of the tactile voltage's two poles at `band_hz`."""
    tactile_nyquist_db: float
    tactile_alias_db: float
    output_nyquist_db: float
    """Gain from the rectifier (in variant article from the envelope) to the pin at `nyquist_hz`; on
    a board without an envelope that from the filtered signal to its pin.
    """
    filtered_gain: float | None
    """Largest gain from the tactile voltage to the filtered signal's pin; None without such a pin.
    """
    filtered_alias_db: float | None
    """Gain at `alias_hz` over that at `band_hz`, from the tactile voltage to that pin."""


def compute_alias_attenuation(circuit: Circuit, design: Design) -> AliasAttenuation:
    detector = design.detector
    nyquist_hz = detector.sample_rate_hz / 2.0
    band_hz = min(BAND_CUTOFFS * design.board.cutoff_hz, nyquist_hz)
    alias_hz = detector.sample_rate_hz - band_hz
    rectifier = find_rectifier(circuit)
    network = build_network(circuit, conducting=[RECTIFYING_DIODE])
    source = ENVELOPE if rectifier == "diode" else FILTERED
    pin = find_envelope_pin(circuit)

    def gains(source: str, pin: str, *f_hz: float) -> list[complex]:
        """Return the gains from a net to a pin at frequencies, over the constant gain."""
        path = network.drive(source).restrict(pin)
        constant, *values = path.response(np.array([0.0, *f_hz]), {source: 1.0}, pin)[:, 0].tolist()
        return [value / constant for value in values]

    tactile = gains(TACTILE, ADC_TACTILE, band_hz, nyquist_hz, alias_hz)
    (output_nyquist,) = gains(source, pin, nyquist_hz)
    filtered_gain = filtered_alias_db = None

    if ADC_FILTERED in circuit.net_by_pin.values():
        f_hz = np.array([*np.geomspace(design.board.cutoff_hz, band_hz, _POINTS), alias_hz])
        path = network.drive(TACTILE).restrict(ADC_FILTERED)
        levels = np.abs(path.response(f_hz, {TACTILE: 1.0}, ADC_FILTERED)[:, 0])
        filtered_gain = float(levels[:-1].max())
        filtered_alias_db = decibel(float(levels[-1] / levels[-2]))

    return AliasAttenuation(
        band_hz=band_hz,
        nyquist_hz=nyquist_hz,
        alias_hz=alias_hz,
        tactile_band_db=decibel(tactile[0]),
        tactile_nyquist_db=decibel(tactile[1]),
        tactile_alias_db=decibel(tactile[2]),
        output_nyquist_db=decibel(output_nyquist),
        filtered_gain=filtered_gain,
        filtered_alias_db=filtered_alias_db,
    )


# Effect of ripple on the supply.
#
# A bridge that is connected to the supply follows it: the tactile voltage by its own ratio to the
# supply, and by a little more where C7 delays the sensor's arm against the other one. On a board
# for 3.3 V only what remains of the ripple in VMID and in the sensor's bias counts. The filter
# amplifies ripple in its passband like slip. Variant article has no low-pass: there ripple of some
# kilohertz, as a switching converter has it, is amplified most.

DEAD_ZONE_V = 0.45
"""Voltage at which variant article's diode starts to conduct. Its output is zero below it."""
_MAX_LOW_HZ = 30.0
RIPPLE_END_HZ = 100e3
"""Ends of the band in which ripple counts [Hz]: mains, harmonics and converters."""
_FREQUENCIES_PER_DECADE = 28


@dataclass(frozen=True)
class SupplyRipple:
    """Effect of ripple on the positive supply in the worst case of the sensor."""

    low_hz: float
    high_hz: float
    """Ends of the band that is searched: half the cutoff, at most 30 Hz, and 100 kHz."""
    worst_hz: float
    gain: float
    """Largest gain from the supply to the filtered signal in this band [V/V]."""
    max_v: float
    """Peak of the ripple [V] that alone brings the envelope's mean to the detector's threshold, or
    in variant article makes the diode conduct.
    """
    force_n: float = 0.0
    """Force on the sensor in the worst case [N]; 0 if it is open, as with any bridge."""


def compute_supply_ripple(
    circuit: Circuit,
    gain_bandwidth_hz: float,
    cutoff_hz: float,
    signal_ground: str,
    threshold_v: float,
    envelope_gain: float | None,
) -> SupplyRipple:
    band_hz = min(_MAX_LOW_HZ, cutoff_hz / 2.0), RIPPLE_END_HZ
    # A transimpedance stage amplifies what is left in its bias, the more the lower the sensor's
    # resistance.
    forces_n = (0.0, front_end.MAX_FORCE_N) if signal_ground == VMID else (0.0,)
    gain, worst_hz, force_n = max(
        (
            *_find_largest_gain(
                circuit,
                gain_bandwidth_hz=gain_bandwidth_hz,
                signal_ground=signal_ground,
                band_hz=band_hz,
                force_n=force_n,
            ),
            force_n,
        )
        for force_n in forces_n
    )
    # The mean of a half-wave rectified sine is 1/pi of its peak.
    peak_v = DEAD_ZONE_V if envelope_gain is None else math.pi * threshold_v / envelope_gain

    return SupplyRipple(
        *band_hz,
        worst_hz=worst_hz,
        gain=gain,
        max_v=peak_v / gain,
        force_n=force_n,
    )


def _find_largest_gain(
    circuit: Circuit,
    gain_bandwidth_hz: float,
    signal_ground: str,
    band_hz: tuple[float, float],
    force_n: float,
) -> tuple[float, float]:
    """Find the largest gain from supply to filtered signal at a force [N], and where [Hz]."""
    network = build_network(
        circuit, gain_bandwidth_hz, sensor_s=front_end.sensor_conductance_s(force_n)
    )
    network = network.restrict(FILTERED, signal_ground)
    nets = [FILTERED] if signal_ground in network.inputs else [FILTERED, signal_ground]
    worst_hz = 0.0
    gain = 0.0
    low_hz, high_hz = band_hz

    for _ in range(2):  # the second time around the largest gain
        f = np.geomspace(
            low_hz, high_hz, math.ceil(_FREQUENCIES_PER_DECADE * math.log10(high_hz / low_hz)) + 9
        )
        volts = network.response(f, {VCC: 1.0}, *nets)
        gains = np.abs(volts[:, 0] - (volts[:, 1] if len(nets) > 1 else 0.0))
        worst = int(gains.argmax())
        worst_hz = float(f[worst])
        gain = float(gains[worst])
        low_hz = float(f[max(worst - 1, 0)])
        high_hz = float(f[min(worst + 1, len(f) - 1)])

    return gain, worst_hz


def describe_sensor(ripple: SupplyRipple) -> str:
    return f"with {ripple.force_n:g} N on the sensor" if ripple.force_n else "with the sensor open"


# Channels of a board for several fingers: their supply current, and how much slip at one finger
# appears at the others.
#
# Four ways couple channels: the references, the supply, whose voltage falls when an amplifier draws
# more current, the ground of the cables, over which that current returns, and the capacitance
# between wires. All amplifiers draw their output current from the supply alone, which doubles what
# a push-pull stage would draw.

MAX_CROSSTALK_DB = -60.0
"""Crosstalk above which a board warns: a firm slip then reaches the noise of other fingers."""
WIRE_OHM_PER_M = 0.22
CONTACT_OHM = 0.02
"""Resistance of a wire of AWG 28 [ohm/m], and of one contact of a plug [ohm]."""
WIRE_F_PER_M = 60e-12
"""Capacitance of touching wires of neighbouring channels; a ground between them lowers it [F/m]."""
REGULATOR_OHM = 0.5
"""Assumed output resistance of the controller's 3.3 V supply at these frequencies [ohm]."""
_FORCES_N = (0.3, 8.0)
_FREQUENCIES = 12


@dataclass(frozen=True)
class SharedFigures:
    supply_current_a: float
    """Typical current at rest, with open sensors [A]."""
    crosstalk_db: float
    """Largest ratio of the signal of a finger at rest to that of the slipping finger."""
    crosstalk_hz: float
    """Frequency of that ratio, in the band of the vibrations."""


def compute_shared_figures(
    circuit: Circuit, gain_bandwidth_hz: float, board: Board
) -> SharedFigures:
    """Compute supply current and crosstalk of the fitted channels."""
    fitted = leave_out_empty(circuit)
    crosstalk_db, hz = find_crosstalk(fitted, board, gain_bandwidth_hz)
    return SharedFigures(compute_supply_current_a(fitted, board.supply_v), crosstalk_db, hz)


def compute_supply_current_a(circuit: Circuit, supply_v: float) -> float:
    """Return the typical current at rest [A]: of amplifiers, and of resistors at the supply."""
    chips_a = {"AD623ARMZ": front_end.AD623_SUPPLY_A, "LMV331": front_end.COMPARATOR_SUPPLY_A}
    for name, amplifier in front_end.AMPLIFIERS.items():
        chips_a[name] = amplifier.supply_current_a * len(amplifier.units)

    parts_a = [chips_a.get(part.symbol.name, 0.0) for part in circuit.components]
    resistors = []

    for part in circuit.components:
        ends = [circuit.net_by_pin.get((part.reference, pin), "") for pin in "12"]
        if part.symbol.name == "R" and VCC in ends:
            far_end = ends[1] if ends[0] == VCC else ends[0]
            resistors.append((far_end, parse_component_value(part.value)))

    network = build_network(circuit).restrict(*(net for net, _ in resistors))
    volts = network.operating_point({VCC: supply_v, VEE: -supply_v})
    parts_a += [(supply_v - volts[net]) / ohm for net, ohm in resistors]
    return sum(parts_a)


def crosstalk_warning(shared: SharedFigures, board: Board) -> str:
    """Return a warning if the channels couple too much, or "".

    The wires' capacitance makes most of it.
    """
    if shared.crosstalk_db <= MAX_CROSSTALK_DB:
        return ""

    # The supply and the ground add a little to what is in proportion to the length.
    length_m = 0.98 * board.cable_m * 10.0 ** ((MAX_CROSSTALK_DB - shared.crosstalk_db) / 20.0)
    return (
        f"slip at one finger shows at others with {shared.crosstalk_db:.0f} dB, above "
        f"{MAX_CROSSTALK_DB:g} dB; give "
        f"board.cable_m of {math.floor(100.0 * length_m) / 100.0:g} or less, or keep the cables "
        "of the fingers apart"
    )


def connect_cables(circuit: Circuit, board: Board) -> Circuit:
    """Add the wires to controller and sensors to a circuit: resistance and capacitance."""
    *grounds, _ = list_pins(GND)  # no wire leads to the mounting pads
    moved = {("J3", *list_pins(POWER_IN)): HOST_SUPPLY, ("J3", grounds[-1]): HOST_GROUND}
    nets = [
        Net(net.name, tuple(node for node in net.nodes if node not in moved))
        for net in circuit.nets
    ]
    nets += [Net(name, ((reference, pin),)) for (reference, pin), name in moved.items()]
    cabled = replace(circuit, nets=tuple(nets))
    wire_ohm = board.cable_m * WIRE_OHM_PER_M + 2.0 * CONTACT_OHM
    ends = [
        (HOST_SUPPLY, POWER_IN, wire_ohm + REGULATOR_OHM),
        (HOST_GROUND, GND, wire_ohm / len(grounds)),
    ]

    for number, (host_end, board_end, ohm) in enumerate(ends, start=91):
        part = Component(
            reference=f"R{number}",
            value=f"{ohm:.10g}",
            symbol=RESISTOR,
            footprint=R_0603,
            role="wire of the supply",
        )
        cabled = cabled.connect(part, {"1": host_end, "2": board_end})

    pairs = [(SENSOR, SENSOR), *itertools.product((ADC_TACTILE, ADC_FILTERED), repeat=2)]
    neighbours = itertools.product(range(1, board.channels), pairs)
    for number, (channel, (net, next_net)) in enumerate(neighbours, start=41):
        part = Component(
            reference=f"C{number}",
            value=f"{WIRE_F_PER_M * board.cable_m:.10g}",
            symbol=CAPACITOR,
            footprint=C_0603,
            role="wires side by side",
        )
        cabled = cabled.connect(
            part, {"1": name_net(net, channel), "2": name_net(next_net, channel + 1)}
        )

    return cabled


def compute_cable_crosstalk(circuit: Circuit, board: Board) -> tuple[float, float]:
    """Compute what 1 V of T adds to S, and 1 V of S to T, at the controller of one finger [V].

    Their wires lie side by side and touch in a cable of `board.cable_m`; the largest below 1 kHz
    counts.
    """
    part = Component(
        reference="C41",
        value=f"{WIRE_F_PER_M * board.cable_m:.10g}",
        symbol=CAPACITOR,
        footprint=C_0603,
        role="wires side by side",
    )
    cabled = circuit.connect(part, {"1": ADC_TACTILE, "2": ADC_FILTERED})
    network = build_network(cabled).drive(TACTILE, FILTERED)
    f = np.geomspace(1.0, 1e3, 5 * _FREQUENCIES)
    tactile, filtered = (
        float(np.abs(network.restrict(pin).response(f, {source: 1.0}, pin)).max())
        for source, pin in ((TACTILE, ADC_FILTERED), (FILTERED, ADC_TACTILE))
    )

    return tactile, filtered


def find_crosstalk(circuit: Circuit, board: Board, gain_bandwidth_hz: float) -> tuple[float, float]:
    """Find the largest crosstalk [dB] and its frequency [Hz], for light and firm touch."""
    # For a signal the source of the supply is a short: both of its ends are one net.
    nets: dict[str, tuple[tuple[str, str], ...]] = {}
    cabled = connect_cables(circuit, board)

    for net in cabled.nets:
        name = HOST_GROUND if net.name == HOST_SUPPLY else net.name
        nets[name] = (*nets.get(name, ()), *net.nodes)

    joined = replace(cabled, nets=tuple(Net(name, nodes) for name, nodes in nets.items()))
    f = np.geomspace(*signal_band_hz(board.cutoff_hz), _FREQUENCIES)
    worst = (0.0, 0.0)

    for force_n in _FORCES_N:
        network = build_network(
            joined,
            gain_bandwidth_hz,
            sensor_s=front_end.sensor_conductance_s(force_n),
            is_supply_resistive=True,
        )
        sources = [network.nets.index(name_net(SENSOR, k + 1)) for k in range(board.channels)]
        ground = network.transfers(f, HOST_GROUND)[:, sources]
        pins = [
            network.transfers(f, name_net(ADC_FILTERED, k + 1))[:, sources] - ground
            for k in range(board.channels)
        ]

        for slips, rests in itertools.permutations(range(board.channels), 2):
            ratios = np.abs(pins[rests][:, slips] / pins[slips][:, slips])
            worst = max(worst, (float(ratios.max()), float(f[ratios.argmax()])))

    return decibel(worst[0]), worst[1]
