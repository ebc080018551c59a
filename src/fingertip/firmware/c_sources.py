"""C sources of the library: the files of `c/`, with the constants of a design."""

from __future__ import annotations

import math
import struct
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import replace
from importlib import resources
from string import Template
from types import ModuleType
from typing import Any

import numpy as np

from fingertip import __version__
from fingertip.board.analysis.tactile_response import find_tactile_response
from fingertip.catalogues.electronics import HYSTERESIS
from fingertip.catalogues.output_files import BUFFER, HAND, SCAN, TIMER
from fingertip.design import Design
from fingertip.firmware.fingers import CONVERSIONS, GENERIC, TASK_CONVERSIONS, Fingers
from fingertip.sim.runs.grip import HISTORY, LONGEST_STEP_S, GripSettings
from fingertip.sim.signal.finger_curve import MIN_PRESENT_N, FingerCurve
from fingertip.slip.detectors import (
    fast_decision,
    fast_features,
    fast_inputs,
    fast_settings,
    fast_table,
)
from fingertip.slip.detectors.analog_and_digital import FirstOrder
from fingertip.slip.detectors.fast_decision import DecisionConstants, Floors, state_floors
from fingertip.slip.detectors.fast_features import AGE, LOUD, PRODUCT, log2_steps
from fingertip.slip.detectors.fast_inputs import smoother
from fingertip.slip.detectors.fast_settings import FastSettings, FilteredSignal, design_filters
from fingertip.slip.detectors.fast_table import NODES, BlowTable, load_table
from fingertip.slip.force import ForceScale


def single(value: float | np.floating[Any]) -> str:
    """Write a number in single precision as a constant of C, with all its digits."""
    return "INFINITY" if math.isinf(value) else f"{np.float32(value)!s}f"


def _write(value: Any) -> str:
    """Write a constant of C: a number, or braces around several."""
    if isinstance(value, (tuple, list, np.ndarray)):
        return f"{{{', '.join(_write(each) for each in value)}}}"

    return single(value) if isinstance(value, (float, np.floating)) else str(value)


def _render_constants(design: Design) -> str:
    """Render a design's constants as lines of C: its detector and its converter."""
    settings = library_settings(design, in_codes=True)
    converter = design.detector
    values = {
        **_constants_of(fast_inputs, fast_decision, fast_features, fast_table),
        **_input_constants(settings),
        **_filter_constants(settings),
        **_decision_constants(settings),
        **_code_constants(settings, converter.adc_low_v, converter.adc_step_v),
        "HAS_FILTERED": int(settings.filtered is not None),
        "FEATURES": len(fast_features.FEATURES),
        "TREES": load_table().trees,
        "OFFSET": load_table().offset,
        "SAMPLE_RATE_HZ": converter.sample_rate_hz,
        "SAMPLE_RATE_MILLIHZ": f"{1000 * converter.sample_rate_hz:.0f}u",
        "ADC_BITS": converter.adc_bits,
        "ADC_LOW_V": converter.adc_low_v,
        "ADC_STEP_V": converter.adc_step_v,
        "VERSION": __version__,
    }
    texts = {name: _write(value) for name, value in values.items()}
    return Template(read_template("slip_constants.h").rstrip()).substitute(texts)


def _constants_of(*modules: ModuleType) -> dict[str, Any]:
    """Constants of modules, by their names."""
    return {
        name: value for module in modules for name, value in vars(module).items() if name.isupper()
    }


def _input_constants(settings: FastSettings) -> dict[str, Any]:
    """Constants of the checks, of both inputs and of their sums."""
    filtered = settings.filtered or NO_FILTERED
    lowest_v, highest_v = settings.possible_v
    jumps_v = {
        "JUMP_LIMIT_V": fast_settings.JUMP_RATIO * settings.noise_v,
        "FILTERED_JUMP_LIMIT_V": fast_settings.FILTERED_JUMP_RATIO
        * settings.noise_v
        * filtered.gain,
    }
    return {
        **jumps_v,
        **_first_order("MOVE", smoother(settings, fast_settings.MOVE_S)),
        **_first_order("LEVEL", smoother(settings, fast_settings.STILL_S)),
        "NUMBER_LIMIT_V": settings.number_limit_v,
        "GAP_SAMPLES": settings.samples(fast_settings.GAP_S),
        "FAULT_SAMPLES": settings.samples(fast_settings.FAULT_S),
        "BLOCKED_SAMPLES": settings.samples(fast_settings.BLOCKED_S),
        "LAG_SAMPLES": settings.samples(fast_settings.LAG_S),
        "LIMITED_SAMPLES": settings.samples(fast_settings.LIMITED_S),
        "STILL_SAMPLES": settings.samples(fast_settings.STILL_S),
        "FILTERED_SHARE": 1 / filtered.gain,
        "FILTERED_LIMIT_V": filtered.limit_v,
        "LOWEST_V": lowest_v,
        "HIGHEST_V": highest_v,
        "TICK_SAMPLES": settings.tick_samples,
        "TICK_SHARE": 1 / settings.tick_samples,
    }


NO_FILTERED = FilteredSignal(gain=1.0, range_v=1.0)
"""Stands for the signal that a board does not give: its constants are not used."""


def _code_constants(settings: FastSettings, low_v: float, step_v: float) -> dict[str, Any]:
    """Constants that count in the converter's codes."""
    filtered = settings.filtered or NO_FILTERED
    lowest_v, highest_v = settings.possible_v
    return {
        "LOWEST_CODE": math.ceil((lowest_v - low_v) / step_v),
        "HIGHEST_CODE": math.floor((highest_v - low_v) / step_v),
        "REST_CODE": ((filtered.rest_v or 0.0) - low_v) / step_v,
        "REST_CODES": fast_settings.REST_SHARE * filtered.range_v / step_v,
    }


def _first_order(name: str, section: FirstOrder) -> dict[str, float]:
    """Share of a sample in a filter of first order, and factor of what it held."""
    return {f"{name}_SHARE": section.b0, f"{name}_KEEP": -section.a1}


def _filter_constants(settings: FastSettings) -> dict[str, Any]:
    filters = design_filters(settings.sample_rate_hz, settings.cutoff_hz)
    sections = {"HIGH": filters.high_2, "SLOW": filters.slow}
    terms = {
        f"{name}_{term}": value
        for name, section in sections.items()
        for term, value in (("B", section.b0), ("A1", section.a1), ("A2", section.a2))
    }
    return {
        **terms,
        **_first_order("STAGE", filters.high_1),
        **_first_order("LEAK", filters.leak),
        "BANDS": len(filters.bands),
        "BAND_FILTERS": [(band.b0, band.a1, band.a2) for band in filters.bands],
    }


def _decision_constants(settings: FastSettings) -> dict[str, Any]:
    """Constants of the floor and the flags."""
    constants = DecisionConstants.for_settings(settings)
    return {
        **{name.upper(): value for name, value in vars(constants).items()},
        "STEP_ENERGIES": _write_energies(constants.step_energies.tolist()),
        "LEAST_ENERGIES": _write_energies(constants.least_energies.tolist()),
        "STATED_FLOORS": _write_floors(state_floors(settings, with_filtered=False)),
        "FILTERED_STATED_FLOORS": _write_floors(state_floors(settings, with_filtered=True)),
    }


def _write_energies(energies: Sequence[float]) -> str:
    """Write energies as a struct of C, in which the bands stand together."""
    slow, *bands, wide = energies
    return f"{{{single(slow)}, {_write([float(band) for band in bands])}, {single(wide)}}}"


def _write_floors(floors: Floors) -> str:
    return f"{{{single(floors.level_v)}, {_write_energies(floors.energies_v2)}}}"


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


_WIDTH = 119
_INDENT = "    "


def render_trees(table: BlowTable) -> str:
    """Render the three tables.

    Each tree has `NODES` + 1 entries, of which nodes leave the first one unused.
    """
    features = [str(feature) for feature in table.features.ravel().tolist()]
    keys = [
        str(find_key(int(feature), threshold))
        for feature, threshold in zip(table.features.flat, table.thresholds.flat, strict=True)
    ]
    leaves = [single(leaf) for leaf in table.leaves.flat]
    tables = (
        ("Number of the feature that each node compares.", "uint8_t slip_features", _pad(features)),
        (
            "Key of the greatest number for which a node's first branch is taken.",
            "int32_t slip_thresholds",
            _pad(keys),
        ),
        ("Log odds that a leaf adds.", "float slip_leaves", leaves),
    )

    blocks = ["enum { LEAVES = 1 << SLIP_DEPTH };"]
    for comment, name, values in tables:
        opening = f"static const {name}[SLIP_TREES * LEAVES] = {{"
        blocks.append("\n".join([f"/* {comment} */", opening, *_rows(values), "};"]))

    return "\n\n".join(blocks)


LARGEST_KEY = 0x7F7FFFFF
"""Key of the largest finite number."""


def find_key(feature: int, threshold: np.float32) -> int:
    """Key of a threshold: of the number itself or, where Python compares the logarithm of a ratio,
    of the greatest ratio whose logarithm is not above it.
    """
    if feature in (AGE, PRODUCT, LOUD):
        return float_key(threshold)

    low = 0
    high = LARGEST_KEY
    while low < high:
        middle = (low + high + 1) // 2
        ratio = np.array([middle], dtype=np.uint32).view(np.float32)
        if log2_steps(ratio)[0] <= threshold:
            low = middle
        else:
            high = middle - 1

    return low


def float_key(value: np.float32) -> int:
    """Return the bits of a float32 as an integer in the order of these numbers."""
    (bits,) = struct.unpack("<i", struct.pack("<f", value + np.float32(0.0)))
    return int(bits ^ 0x7FFFFFFF if bits < 0 else bits)


def _pad(values: list[str]) -> list[str]:
    """Put the unused entry ahead of the nodes of each tree."""
    padded = []
    for i in range(0, len(values), NODES):
        padded += ["0", *values[i : i + NODES]]

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
            *(f"#define SLIP_GRIP_{name} {single(value)}" for name, value in values.items()),
        )
    )


def _render_curves(curves: Sequence[FingerCurve], designs: Sequence[Design]) -> str:
    """Render the distinct curves and pads, and which of them each finger has."""
    scales = [
        ForceScale.of(design, curve.volts, curve.forces_n)
        for design, curve in zip(designs, curves, strict=True)
    ]
    ranges = ", ".join(f"{{{', '.join(map(single, scale.known_n))}}}" for scale in scales)
    factors = ", ".join(single(scale.factor) for scale in scales)
    numbers = [
        (tuple(curve.volts.tolist()), tuple(curve.forces_n.tolist()), curve.pad.hertz_m_per_n23)
        for curve in curves
    ]
    distinct = list(dict.fromkeys(numbers))
    of_finger = ", ".join(str(distinct.index(curve_numbers)) for curve_numbers in numbers)
    pads = ", ".join(single(pad) for _, _, pad in distinct)
    blocks = [
        f"enum {{ SLIP_CURVES = {len(distinct)}, SLIP_CURVE = {len(distinct[0][0])} }};",
        "/* Curve of each finger. */\nstatic const uint8_t slip_curve_of[SLIP_FINGERS] = "
        f"{{{of_finger}}};",
        "/* Forces where it is known [N]. */\nstatic const float "
        f"slip_known_n[SLIP_FINGERS][2] = {{{ranges}}};",
        "/* Factor within which a force lies. */\nstatic const float "
        f"slip_factors[SLIP_FINGERS] = {{{factors}}};",
        "/* By which a falling force reads too high. */\n#define SLIP_HYSTERESIS_FACTOR "
        f"{single(1 + HYSTERESIS)}",
        "/* Indentation of its pad under 1 N [m]. */\nstatic const float "
        f"slip_pads_m_per_n23[] = {{{pads}}};",
    ]
    tables = (
        ("Ascending tactile voltages [V].", "slip_curves_v", [volts for volts, _, _ in distinct]),
        ("Forces that they mean [N].", "slip_curves_n", [forces_n for _, forces_n, _ in distinct]),
    )

    for comment, name, columns in tables:
        rows = []
        for values in columns:
            rows += ["{", *_rows([single(value) for value in values]), "},"]

        opening = f"static const float {name}[SLIP_CURVES][SLIP_CURVE] = {{"
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
    backing = f"#define SLIP_BACKING_N_PER_M {single(curves[0].pad.backing.stiffness_n_per_m)}"
    header = _insert(header, "slip_grip_backing.h", backing)
    command = f"#define SLIP_GRIP_MAX_COMMAND_M_S {single(settings.max_command_m_s)}"
    files = {
        HEADER: _insert(read_template(HEADER), "slip_constants.h", constants),
        SOURCE: _insert(read_template(SOURCE), "slip_trees.h", render_trees(load_table())),
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
