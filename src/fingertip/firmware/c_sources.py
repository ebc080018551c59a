"""C sources of the library: the files of `c/`, with the constants of a design."""

from __future__ import annotations

import math
import struct
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import replace
from importlib import resources
from string import Template
from typing import Any

from fingertip import __version__
from fingertip.board.analysis.tactile_response import find_tactile_response
from fingertip.catalogues.electronics import HYSTERESIS
from fingertip.catalogues.output_files import BUFFER, HAND, SCAN, TIMER
from fingertip.design import Design
from fingertip.design.formulas.filter import filtered_range_v, signal_ground_ratio
from fingertip.firmware.fingers import CONVERSIONS, GENERIC, TASK_CONVERSIONS, Fingers
from fingertip.sim.runs.grip import HISTORY, LONGEST_STEP_S, GripSettings
from fingertip.sim.signal.finger_curve import MIN_PRESENT_N, FingerCurve
from fingertip.slip.detectors import fast_decision_and_floors, fast_state
from fingertip.slip.detectors.fast import FastDetector
from fingertip.slip.detectors.fast_coefficients import NODES, FastModel, load_model
from fingertip.slip.detectors.fast_settings import REST_SHARE, STILL_S, FastSettings, FilteredSignal
from fingertip.slip.force import ForceScale

_COUNTS = (
    "limited_samples still_samples trusted_samples gap_samples fault_samples restart_ticks "
    "tick_samples slot_ticks"
)
"""Coefficients that count samples or ticks: constants without decimals."""
_TICKS = "LOW_TICKS STEADY_ON_TICKS AFTER_TICKS STANDING_TICKS UNHEARD_TICKS"
"""The same among the limits of the loop."""


def real(value: float) -> str:
    """Write a number with all its digits as a constant of the library's type."""
    return f"((slip_real){'INFINITY' if math.isinf(value) else repr(value)})"


def _render_constants(design: Design) -> str:
    """Render a design's constants as lines of C: its detector and its converter."""
    converter = design.detector
    detector = _start(design, None)
    both = _start(design, 0.0)
    coefficients = detector.coefficients
    state = detector.state
    rate = detector.coefficients.sample_rate_hz
    step_v = converter.adc_step_v
    sections: dict[str, Any] = {
        name: value for name, value in coefficients._asdict().items() if isinstance(value, tuple)
    }
    terms = {}
    for name, section in sections.items():
        for key, term in section._asdict().items():
            terms[f"{name}_{key}".upper()] = term

    limits = {**vars(fast_state), **vars(fast_decision_and_floors)}
    low_v = converter.adc_low_v
    values: dict[str, Any] = {
        **limits,
        **{name.upper(): value for name, value in coefficients._asdict().items()},
        **terms,
        "FILTERED_GAIN": both.coefficients.filtered_gain,
        "FILTERED_LIMIT": both.coefficients.filtered_limit,
        **{name.upper(): round(getattr(coefficients, name)) for name in _COUNTS.split()},
        "LOWEST_CODE": math.ceil(
            (coefficients.middle_input - coefficients.half_range - low_v) / step_v
        ),
        "HIGHEST_CODE": math.floor(
            (coefficients.middle_input + coefficients.half_range - low_v) / step_v
        ),
        "REST_CODE": (signal_ground_ratio(design.board) * design.board.supply_v - low_v) / step_v,
        "REST_CODES": REST_SHARE
        * (filtered_range_v(design.board, converter.adc_range_v) or math.inf)
        / step_v,
        "LEVEL_SHARE": 1 / (STILL_S * rate),
        "SETTLING_TICKS": round(state[fast_state.SETTLING]),
        "SETTLE_TICKS": -state[fast_state.FLOOR_TICKS],
        **{name: round(limits[name]) for name in _TICKS.split()},
        "STEADY_COUNT": round(limits["STEADY_TICKS"]),
        "STATED_WIDE": state[fast_state.FLOOR],
        "STATED_UPPER": state[fast_state.UPPER_FLOOR],
        "STATED_INPUT": state[fast_state.INPUT_FLOOR],
        "FILTERED_STATED_WIDE": both.state[fast_state.FLOOR],
        "FILTERED_STATED_UPPER": both.state[fast_state.UPPER_FLOOR],
        "FILTERED_MIN_FLOOR": both.coefficients.min_floor,
        "FILTERED_MIN_UPPER_FLOOR": both.coefficients.min_upper_floor,
        "FILTERED_NOISY_FLOOR": both.coefficients.noisy_floor,
        "SLOPE_GAIN": fast_state.SLOPE_S * fast_state.SLOPE_S * rate * rate,
        "TREES": load_model().trees,
        "SAMPLE_RATE_HZ": converter.sample_rate_hz,
        "SAMPLE_RATE_MILLIHZ": f"{1000 * converter.sample_rate_hz:.0f}u",
        "ADC_BITS": converter.adc_bits,
        "ADC_LOW_V": low_v,
        "ADC_STEP_V": converter.adc_step_v,
        "VERSION": __version__,
    }
    texts = {
        name: real(value) if isinstance(value, float) else value for name, value in values.items()
    }

    return Template(read_template("slip_constants.h").rstrip()).substitute(texts)


OPEN_SHARE = 0.5
"""Possible error of an open sensor's voltage, over its distance to the range's end."""
SHORTED_SHARE = 0.02
"""Share of the range by which less than a shorted sensor's voltage counts as one."""


def library_settings(design: Design, in_codes: bool = False) -> FastSettings:
    """Return a finger's detector settings, with possible voltages, and the rest of S for codes."""
    converter = design.detector
    response = find_tactile_response(design)
    lowest = converter.adc_low_v
    highest = converter.adc_range_v
    shorted_v = response.open_v - response.transfer_ohm * response.sensor_v / response.source_ohm
    shorted_v = min(max(shorted_v, lowest), highest)
    margin_v = SHORTED_SHARE * (highest - lowest)

    if design.board.tactile_rises:
        possible = (response.open_v - OPEN_SHARE * (response.open_v - lowest), shorted_v - margin_v)
    else:
        possible = (
            shorted_v + margin_v,
            response.open_v + OPEN_SHARE * (highest - response.open_v),
        )

    filtered = FilteredSignal.from_design(design, in_codes)
    return replace(FastSettings.from_design(design), possible_v=possible, filtered=filtered)


def _start(design: Design, filtered_v: float | None) -> FastDetector:
    """Return the detector after one sample, with or without the filtered signal [V]."""
    detector = FastDetector(library_settings(design))
    detector.step(0.0, filtered_v)
    return detector


_WIDTH = 119
_INDENT = "    "


def render_trees(model: FastModel) -> str:
    """Render the three tables.

    Each tree has `NODES` + 1 entries, of which nodes leave the first one unused.
    """
    features = [f"{feature:.0f}" for feature in model.features.tolist()]
    thresholds = [
        f"KEY({value!r}, 0x{float_key(value):08X})" for value in model.thresholds.tolist()
    ]
    leaves = [f"R({value!r})" for value in model.leaves.tolist()]
    tables = (
        (
            "Number of the feature that each node compares.",
            "uint8_t slip_features",
            _pad(features, "0"),
        ),
        (
            "Value above which a node's second branch is taken, and its key as a float.",
            "slip_key slip_thresholds",
            _pad(thresholds, "KEY(0.0, 0)"),
        ),
        ("Values of the leaves.", "slip_real slip_leaves", leaves),
    )

    blocks = []
    for comment, name, values in tables:
        opening = f"static const {name}[SLIP_TREES * LEAVES] = {{"
        blocks.append("\n".join([f"/* {comment} */", opening, *_rows(values), "};"]))

    return "\n\n".join(blocks)


def float_key(value: float) -> int:
    """Return the bits of a float32 as an integer in the order of these numbers."""
    (bits,) = struct.unpack("<I", struct.pack("<f", value))
    return int(~bits & 0xFFFFFFFF if bits & 0x80000000 else bits | 0x80000000)


def _pad(values: list[str], unused: str) -> list[str]:
    """Put the unused entry ahead of the nodes of each tree."""
    padded = []
    for i in range(0, len(values), NODES):
        padded += [unused, *values[i : i + NODES]]

    return padded


def _rows(values: list[str]) -> Iterator[str]:
    """Yield the lines of a table; each tree begins a new one, and none ends within an entry."""
    for i in range(0, len(values), NODES + 1):
        line = _INDENT
        for value in values[i : i + NODES + 1]:
            if len(line) + len(value) > _WIDTH:
                yield line.rstrip()
                line = _INDENT

            line += f"{value}, "

        yield line.rstrip()


def _render_fingers(fingers: Fingers, has_divider: bool) -> str:
    """Render the number of fingers; for several or dividers also inputs and names."""
    lines = ["#ifndef SLIP_FINGERS", f"#define SLIP_FINGERS {fingers.count}", "#endif"]
    if fingers.is_hand or has_divider:
        count = 1 if has_divider else 2
        inputs = ", ".join(f"{{{', '.join(pins[:count])}}}" for pins in fingers.inputs)
        prefixes = [f"{name}_" if fingers.count > 1 else "" for name in fingers.names]
        names = ", ".join(f'"{name}"' for name in (prefixes if has_divider else fingers.names))
        lines += [
            "#ifndef SLIP_INPUTS",
            f"#define SLIP_INPUTS {{{inputs}}}",
            "#endif",
            f"#define SLIP_NAMES {{{names}}}",
        ]

    return "\n".join(
        (
            "/* Fingers that one controller reads; of several, inputs of T and S, and names. */",
            *lines,
        )
    )


def _render_grip(settings: GripSettings) -> str:
    times = {"WINDOW": settings.growth_window_s, "SUPPRESSION": settings.suppression_s}
    times |= {
        "REFRACTORY": settings.refractory_s,
        "WATCHDOG": settings.watchdog_s,
        "LONGEST_STEP": LONGEST_STEP_S,
    }
    values = {"MIN_PRESENT_N": MIN_PRESENT_N} | {
        name.upper(): getattr(settings, name)
        for name in (
            "max_growth_n_s",
            "max_closing_m_s",
            "force_ratio",
            "max_force_n",
            "max_added_m",
        )
    }
    return "\n".join(
        (
            "/* Times [us], moments of the window, and limits of forces, closings and their "
            "speeds. */",
            *(
                f"#define SLIP_GRIP_{name}_US {round(1e6 * time_s)}u"
                for name, time_s in times.items()
            ),
            f"#define SLIP_GRIP_HISTORY {HISTORY}u",
            *(f"#define SLIP_GRIP_{name} {real(value)}" for name, value in values.items()),
        )
    )


def _render_curves(curves: Sequence[FingerCurve], designs: Sequence[Design]) -> str:
    """Render the distinct curves and pads, and which of them each finger has."""
    scales = [
        ForceScale.of(design, curve.volts, curve.forces_n)
        for design, curve in zip(designs, curves, strict=True)
    ]
    ranges = ", ".join(f"{{{', '.join(map(real, scale.known_n))}}}" for scale in scales)
    factors = ", ".join(real(scale.factor) for scale in scales)
    numbers = [
        (tuple(curve.volts.tolist()), tuple(curve.forces_n.tolist()), curve.pad.hertz_m_per_n23)
        for curve in curves
    ]
    distinct = list(dict.fromkeys(numbers))
    of_finger = ", ".join(str(distinct.index(curve_numbers)) for curve_numbers in numbers)
    pads = ", ".join(real(pad) for _, _, pad in distinct)
    blocks = [
        f"enum {{ SLIP_CURVES = {len(distinct)}, SLIP_CURVE = {len(distinct[0][0])} }};",
        "/* Curve of each finger. */\nstatic const uint8_t slip_curve_of[SLIP_FINGERS] = "
        f"{{{of_finger}}};",
        "/* Forces where it is known [N]. */\nstatic const slip_real "
        f"slip_known_n[SLIP_FINGERS][2] = {{{ranges}}};",
        "/* Factor within which a force lies. */\nstatic const slip_real "
        f"slip_factors[SLIP_FINGERS] = {{{factors}}};",
        "/* By which a falling force reads too high. */\n#define SLIP_HYSTERESIS_FACTOR "
        f"{real(1 + HYSTERESIS)}",
        "/* Indentation of its pad under 1 N [m]. */\nstatic const slip_real "
        f"slip_pads_m_per_n23[] = {{{pads}}};",
    ]
    tables = (
        ("Ascending tactile voltages [V].", "slip_curves_v", [volts for volts, _, _ in distinct]),
        ("Forces that they mean [N].", "slip_curves_n", [forces_n for _, forces_n, _ in distinct]),
    )

    for comment, name, columns in tables:
        rows = []
        for values in columns:
            rows += ["{", *_rows([f"R({value!r})" for value in values]), "},"]

        opening = f"static const slip_real {name}[SLIP_CURVES][SLIP_CURVE] = {{"
        blocks.append("\n".join([f"/* {comment} */", opening, *rows, "};"]))

    return "\n\n".join(blocks)


HEADER = "slip_detector.h"
SOURCE = "slip_detector.c"
GRIP_HEADER = "slip_grip.h"
GRIP_SOURCE = "slip_grip.c"
LAMP = "slip_lamp.ino"


def read_template(name: str) -> str:
    """Read a file of the folder `c/`."""
    return resources.files(__package__).joinpath("c", name).read_text(encoding="utf-8")


def library_sources(design: Design, fingers: Fingers) -> dict[str, bytes]:
    """Return headers and sources by name: detector, forces, and the grip law of a hand."""
    has_divider = not design.board.has_filter
    constants = f"{_render_fingers(fingers, has_divider)}\n\n{_render_constants(design)}"
    designs = fingers.designs or (design,) * fingers.count
    settings = GripSettings()
    curves = [FingerCurve.from_design(finger) for finger in designs]
    header = _insert(read_template(GRIP_HEADER), "slip_grip_constants.h", _render_grip(settings))
    backing = f"#define SLIP_BACKING_N_PER_M {real(curves[0].pad.backing.stiffness_n_per_m)}"
    header = _insert(header, "slip_grip_backing.h", backing)
    command = f"#define SLIP_GRIP_MAX_COMMAND_M_S {real(settings.max_command_m_s)}"
    files = {
        HEADER: _insert(read_template(HEADER), "slip_constants.h", constants),
        SOURCE: _insert(read_template(SOURCE), "slip_trees.h", render_trees(load_model())),
        GRIP_HEADER: _insert(header, "slip_grip_command.h", command),
        GRIP_SOURCE: _insert(
            read_template(GRIP_SOURCE), "slip_grip_curve.h", _render_curves(curves, designs)
        ),
        **{name: read_template(name) for name in (BUFFER, HAND, TIMER)},
        **({SCAN: read_template(SCAN)} if fingers.is_hand and not has_divider else {}),
    }

    return {name: text.encode() for name, text in files.items()}


def lamp_sketch(design: Design, fingers: Fingers) -> dict[str, bytes]:
    """Return the sketch for dividers, with what to wire and how far to trust its forces."""
    board = fingers.controller
    converter = board.converter if board and board.key == GENERIC else "12 bits, 0 to 3.3 V"
    bits, *_, range_v, _ = converter.split()
    reliability = dict.fromkeys(
        finger.force_curve.describe(finger.sensor.model) for finger in fingers.designs or (design,)
    )
    values = {
        "supply": f"{design.board.supply_v:g}",
        "resistor": f"{design.board.divider_ohm / 1000:g} kohm",
        "forces": "\n// ".join(
            textwrap.wrap("; ".join(f"F{text[1:]}." for text in reliability), _WIDTH - 3)
        ),
        "conversions": CONVERSIONS,
        "task_conversions": TASK_CONVERSIONS,
        "bits": bits,
        "range_v": range_v,
    }
    line = "slip_line.h"
    sketch = Template(read_template(f"examples/{LAMP}")).substitute(values)

    return {LAMP: sketch.encode(), line: read_template(f"examples/{line}").encode()}


def _insert(template: str, include: str, text: str) -> str:
    """Replace the line that includes a file by a text."""
    line = f'#include "{include}"'
    assert template.count(line) == 1, f"{line} must stand once in its template"
    return template.replace(line, text)
