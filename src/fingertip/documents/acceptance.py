"""Acceptance sheet: what to measure on sensor and finger, the limits, and what each failure means."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

from fingertip.board.components.bridge import MAX_FORCE_N, sensor_conductance_s
from fingertip.casting.hardware import WEIGHTS_G, describe_plug_wires, size_wires
from fingertip.casting.uses import OPEN_OHM, PRESSED_OHM
from fingertip.design import Design
from fingertip.design.formulas.filter import signal_ground_ratio
from fingertip.sim.signal.bridge import Bridge
from fingertip.slip.detection import Detection
from fingertip.slip.report import DETECTED, INTERVAL

# Expected readings of a finger: resistance and tactile voltage under weights.


SPREAD = 4.0
"""Factor by which the conductance of a good sensor may differ from the data sheet's curve, up or down.

Single force-sensing resistors differ by a factor of two to eight at the same force, and a skin spreads the load.
"""
_RATIO_SPREAD = 1.3
"""Factor by which the exponent of single sensors and the place of the disc change the ratio. An assumption."""
_GRAVITY = 9.81


@dataclass(frozen=True)
class WeightReading:
    """Expected reading of a weight on the pad."""

    mass_g: float
    sensor_ohm: float
    tactile_v: float
    limits_v: tuple[float, float]
    """Lowest and highest voltage of a good finger."""
    spread: float
    """Factor by which the conductance may differ from the expected one within these limits."""


@dataclass(frozen=True)
class DropRatio:
    """Drop of the tactile voltage below that of the untouched finger: the heaviest weight's over the lightest's."""

    expected: float
    limits: tuple[float, float]


def expect_open_v(design: Design) -> float:
    """Expect the tactile voltage of an untouched finger [V]."""
    return Bridge.of_board(design).response.open_v


def expect_pressed_v(design: Design) -> float:
    """Expect the tactile voltage at `MAX_FORCE_N` [V], far more than any weight of the sheet: less is a short circuit.

    The data sheet's sensor gives it, as the README of the board states, or the calibrated one if that gives less.
    """
    bridge = Bridge.of_board(design)
    conductance = max(sensor_conductance_s(MAX_FORCE_N), bridge.curve.conductance_s(MAX_FORCE_N))
    return max(_find_lowest_v(design), bridge.response.tactile_v(conductance))


def expect_readings(design: Design) -> tuple[WeightReading, ...]:
    """Expect the readings of `WEIGHTS_G`, with limits that cover sensors within `find_spread` of the curve.

    No limit is below `expect_pressed_v`, so that a short circuit fails.
    """
    pressed_v = expect_pressed_v(design)
    return tuple(
        replace(reading, limits_v=(max(pressed_v, reading.limits_v[0]), reading.limits_v[1]))
        for reading in _spread_readings(design)
    )


def _spread_readings(design: Design) -> Iterator[WeightReading]:
    """Compute the readings with the limits that follow from the spread alone."""
    bridge, lowest_v = Bridge.of_board(design), _find_lowest_v(design)
    for mass in WEIGHTS_G:
        force_n = mass / 1000.0 * _GRAVITY
        conductance, spread = bridge.curve.conductance_s(force_n), find_spread(design, force_n)
        low, high = (
            max(lowest_v, bridge.response.tactile_v(conductance * factor)) for factor in (spread, 1.0 / spread)
        )
        expected = bridge.response.tactile_v(conductance)
        yield WeightReading(mass, 1.0 / conductance, expected, (low, high), spread)


def _find_lowest_v(design: Design) -> float:
    """Find the lowest voltage of a board [V]: on a single supply, none below its ground."""
    return 0.0 if signal_ground_ratio(design.board.supply) else -math.inf


def find_spread(design: Design, force_n: float) -> float:
    """Find the factor by which the conductance of a good sensor may differ from the curve of the design at a force.

    A calibrated curve is as uncertain as its calibration, in the range of its forces. Beyond it, and without a
    calibration, the factor is that of single sensors.
    """
    curve = design.force_curve
    if curve.curve == "calibrated" and curve.min_force_n <= force_n <= curve.max_force_n:
        return min(curve.interval_factor, SPREAD)
    return SPREAD


def expect_drop_ratio(design: Design) -> DropRatio:
    """Expect the ratio of the drops under the heaviest and the lightest weight.

    Sensors that differ by a factor at every force have nearly the same ratio, so its limits are much closer than those
    of the voltages. They cover the same factors for both weights, and `_RATIO_SPREAD` besides.
    """
    open_v = expect_open_v(design)
    light, *_, heavy = _spread_readings(design)
    drops = [
        (open_v - of_light, open_v - of_heavy)
        for of_light, of_heavy in (
            (light.tactile_v, heavy.tactile_v), *zip(light.limits_v, heavy.limits_v, strict=True)
        )
    ]  # fmt: skip
    expected, *others = (of_heavy / of_light for of_light, of_heavy in drops)
    return DropRatio(expected, (min(expected, *others) / _RATIO_SPREAD, max(expected, *others) * _RATIO_SPREAD))


IDLE_TOLERANCE_V = 0.1
"""Largest difference of an untouched finger from its expected voltage [V]. An assumption."""
_STILL_S = 60


def acceptance_data(design: Design, detection: Detection) -> dict[str, Any]:
    """Collect the figures of the acceptance sheet."""
    wires, idle, ratio = size_wires(design), expect_open_v(design), expect_drop_ratio(design)
    return {
        "design": design.name,
        "sensor": design.dimensions.sensor.label,
        "tail": design.sensor.tail,
        "method": design.mold.method,
        "detector": detection.detector,
        "slide": {"delay_ms": _find_delay_ms(detection), "ends_after_ms": round(1000 * detection.memory_s)},
        "wires": {
            "max_diameter_mm": round(wires.max_diameter_mm, 2),
            "conductor_awg": [wires.conductor_awg, wires.thinnest_awg],
            "slack_mm": round(wires.slack_mm),
            "plug": describe_plug_wires(design, wires),
        },
        "open_ohm": OPEN_OHM,
        "pressed_ohm": PRESSED_OHM,
        "idle": {"tactile_v": round(idle, 2), "tolerance_v": IDLE_TOLERANCE_V},
        "pressed": {"force_n": MAX_FORCE_N, "tactile_v": round(expect_pressed_v(design), 2)},
        "curve": design.force_curve.curve,
        "board": design.board.variant,
        "drop_ratio": {
            "expected": round(ratio.expected, 2),
            "limits": [round(limit, 1) for limit in ratio.limits],
        },
        "weights": [
            {
                "mass_g": reading.mass_g,
                "sensor_ohm": round(reading.sensor_ohm, -1),
                "tactile_v": round(reading.tactile_v, 2),
                "limits_v": [round(limit, 2) for limit in reading.limits_v],
                "factor": round(reading.spread, 2),
            }
            for reading in expect_readings(design)
        ],
        "still_s": _STILL_S,
    }


def _find_delay_ms(detection: Detection) -> float | None:
    """Longest delay of the detector in the simulated trial [ms]; None if it missed a slip, or none is known."""
    delays = detection.score.delays_s if detection.score else ()
    found = [delay for delay in delays if delay is not None]
    return round(1000 * max(found), 1) if found and len(found) == len(delays) else None


def render_acceptance(data: dict[str, Any]) -> str:
    """Render the data as a Markdown page."""
    idle, wires, slide, ratio = data["idle"], data["wires"], data["slide"], data["drop_ratio"]
    plug = f"{wires['plug']} " if wires["plug"] else ""
    light, heavy = (f"{data['weights'][i]['mass_g']:g} g" for i in (0, -1))
    when = "while it slides" if slide["delay_ms"] is None else f"some {slide['delay_ms']:g} ms after it begins to slide"
    low, high = idle["tactile_v"] - idle["tolerance_v"], idle["tactile_v"] + idle["tolerance_v"]
    outlet = "window of the base" if data["tail"] == "folded" else "cable channel"
    before, after, when_to_test = _describe_stages(data["method"])
    weights = [
        (
            f"{entry['mass_g']:g} g", f"{entry['sensor_ohm'] / 1000:.3g} kohm", f"{entry['tactile_v']:.2f} V",
            f"{entry['limits_v'][0]:.2f} to {entry['limits_v'][1]:.2f} V", f"{entry['factor']:g}",
        )
        for entry in data["weights"]
    ]  # fmt: skip
    masses, pressed = [row[0] for row in weights], data["pressed"]
    open_mohm, press_kohm = data["open_ohm"] / 1e6, data["pressed_ohm"] / 1e3
    sections = [
        f"# Acceptance sheet: {data['design']}",
        "Tests of the sensor before and after casting, and of the finished finger on its board. The voltages follow "
        f"from the design's bridge and from {_describe_curve(data)}.",
        "## Wires",
        f"Two insulated wires of at most {wires['max_diameter_mm']:g} mm over the insulation: a conductor of AWG "
        f"{wires['conductor_awg'][0]} to {wires['conductor_awg'][1]}. {plug}Leave a loop of {wires['slack_mm']} mm "
        "between the finger and the first place at which the wires are fixed.",
        f"## Sensor, {before}",
        f"Connect an ohmmeter to both wires. {when_to_test}",
        _table(
            ("test", "must read", "if it does not"),
            [
                (
                    "untouched", f"above {open_mohm:g} Mohm",
                    "The head is bent or dented, or the pocket is not flat: lift the sensor and file the pocket. A "
                    "steady reading of some ohm is a solder bridge.",
                ),
                (
                    "head pressed with a finger", f"below {press_kohm:g} kohm, and steady",
                    "Open circuit: a tab or a joint is broken. A jumping value: a cold joint.",
                ),
                (
                    "released", f"above {open_mohm:g} Mohm within 1 s",
                    "A slow return means that the air vent is closed: adhesive or sealant stands in the slot, or the "
                    f"{outlet} is blocked.",
                ),
            ],
        ),
        f"## Sensor, {after}",
        "Repeat these tests. Then connect the finger to its powered board, and measure the tactile voltage: red probe "
        "at T of the board's output connector, black probe at supply ground, not at the signal ground to which the "
        f"readings of the bring-up sheet refer. Untouched, it must lie between {low:.2f} and {high:.2f} V. Press the "
        "pad for 10 s and let go: it must return there within 1 s.",
        _table(
            ("reading", "meaning"),
            [
                (
                    f"below {low:.2f} V, untouched",
                    "The skin presses on the sensor: silicone has crept under the tape or into the slot, or the skin "
                    "shrank. Wait a day and measure again. If it stays, the sensor still works from this offset on, "
                    "with less range.",
                ),
                (f"above {high:.2f} V", "The sensor is not connected as the board expects, or the supply is high."),
                ("returns slowly", f"The air vent is closed. Open the {outlet}."),
            ],
        ),
        "## Finished finger",
        "Clamp the finger with its pad up and level. Lay a disc of 8 mm, cut from cork or felt, on the pad above the "
        "sensor, and put the weight on it without a push. A weight on so small a disc tips: hold it upright in a "
        "loose guide, such as a tube of paper that carries none of it, or turn the finger over and press the pad on "
        f"the disc, on a kitchen scale, until it reads {' or '.join(masses)} steadily. Read after 5 s.",
        _table(("weight on the pad", "sensor", "tactile voltage expected", "accept", "factor"), weights),
        "The limits allow the sensor's conductance to differ by the factor, either way: "
        + (
            "the 95 % interval of the calibration in the range of its forces, and beyond it what single sensors differ "
            "by."
            if data["curve"] == "calibrated"
            else "single sensors differ that much at the same force. `fingertip calibrate sensor` narrows it."
        )
        + f" Less than {pressed['tactile_v']:.2f} V, the voltage at {pressed['force_n']:g} N, is a short circuit of "
        "sensor or wires, or a far greater force than the weight.",
        _table(
            ("test", "must happen", "if it does not"),
            [
                (
                    "heavier weight", "a lower voltage than the lighter one",
                    "The disc does not stand above the sensor, or sensor or wires are shorted.",
                ),
                (
                    f"drop below the untouched voltage: that of {heavy} over that of {light}",
                    f"{ratio['expected']:g}; accept {ratio['limits'][0]:g} to {ratio['limits'][1]:g}",
                    "Less: the disc stands beside the sensor, or the skin carries the weight. More: the sensor hardly "
                    "feels the lighter weight; its slot or tape is stiff.",
                ),
                (
                    "strip of copy paper under the pad, pressed with some 2 N and pulled away at about 100 mm/s",
                    f"SLIP {when} (detector `{data['detector']}`, simulated trial), and none 1 s after it stops",
                    "No SLIP: record the trial and look at it with `fingertip detect FILE --plot slip.png`; a pad "
                    "that is still shiny from mold release slides without vibration, so wipe it with isopropanol. "
                    "SLIP that does not end: the wires are touched by the paper.",
                ),
                (
                    f"held still with 500 g for {data['still_s']} s", "no SLIP",
                    "Noise on the wires or the supply: shorten and twist the wires, and measure the noise with the "
                    "weight on (the board's README says how much is normal).",
                ),
            ],
        ),
        "SLIP appears, while it lasts, " + _describe_slip(data["board"]),
        "## Record",
        "A finger that passes differs from another one; only its own readings tell later whether it has changed.",
        _table(
            ("date", "untouched", *(row[0] for row in weights), "ratio of drops", "SLIP on paper", "held still"),
            [("&nbsp;",) * (5 + len(data["weights"]))],
        ),
    ]  # fmt: skip
    return "\n\n".join(sections) + "\n"


def _describe_curve(data: dict[str, Any]) -> str:
    """Name the curve of the sensor on which the voltages rest."""
    if data["curve"] == "calibrated":
        return f"the calibrated curve of this {data['sensor']} (`force_curve`): they hold for no other one"
    return f"the data sheet's curve of the {data['sensor']}"


def _describe_slip(variant: str) -> str:
    """Say where SLIP is seen: on the board, on the controller, and in what `fingertip detect` prints."""
    places = [
        "on the controller with the example `slip_pin` of `fingertip firmware` as its pin `SLIP_PIN`, high: the LED, "
        "except on a Blue Pill and a Pico W, where another pin must be set (see the README of its library)",
        f"in a recording as the lines `{DETECTED} {INTERVAL.format(onset='...', end='...')}` that `fingertip detect "
        "FILE` prints, and for a stream as `ON` and `OFF` of `fingertip detect -`",
    ]
    if variant == "comparator":
        places.insert(0, "on the board as the pin SLIP of the output connector, low")
    return "; ".join(places) + "."


def _describe_stages(method: str) -> tuple[str, str, str]:
    """Name the stages before and after the skin is on, and say when to test the sensor."""
    if method == "sleeve":
        return (
            "before the skin is pulled on", "after the skin is pulled on",
            "Do all three tests after mounting, and once more when the tape covers the sensor.",
        )  # fmt: skip
    return (
        "before the skin is cast", "after the skin is cast",
        "Do all three tests after mounting and once more when sensor and passage are sealed. In the closed mold the "
        "head cannot be pressed: the untouched sensor must still read the same.",
    )  # fmt: skip


def _table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    lines = [tuple(head), *(tuple(row) for row in rows)]
    rule = tuple("---" for _ in lines[0])
    return "\n".join("| " + " | ".join(cells) + " |" for cells in (lines[0], rule, *lines[1:]))
