"""C sources of the library: the files of `c/`, with the constants of a design in place of two of their includes."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from importlib import resources

from fingertip.design import Design
from fingertip.slip.detectors import fast_loop
from fingertip.slip.detectors.fast import FastDetector, FastSettings
from fingertip.slip.detectors.fast_coefficients import DEPTH, NODES, FastModel, load_model

Group = tuple[str, dict[str, str]]
"""Comment, and definitions that stand below it: name -> value in C."""


def render_constants(design: Design) -> str:
    """Render all definitions as lines of C."""
    blocks = []
    for comment, definitions in (*_detector_groups(design), *_converter_groups(design)):
        lines = [f"#define SLIP_{name} {value}" for name, value in definitions.items()]
        blocks.append("\n".join([f"/* {comment} */", *lines]))
    return "\n\n".join(blocks)


def real(value: float) -> str:
    """Write a number with all its digits as a constant of the library's type."""
    return f"((slip_real){'INFINITY' if math.isinf(value) else repr(value)})"


def _detector_groups(design: Design) -> Iterator[Group]:
    detector, both = _start(design, None), _start(design, 0.0)
    model, c, state = load_model(), detector.coefficients, detector.state
    rate = c.sample_rate_hz
    for name, section, text in (
        ("board_1", c.board_1, "Board's high-pass filter for a gain of 1: its section of first order,"),
        ("board", c.board, "and that of second order."),
        ("restore_1", c.restore_1, "Filter that moves its cutoff down: section of first order,"),
        ("restore", c.restore, "and of second order."),
        ("edge", c.edge, "Low-pass filter at the upper edge of both bands, behind it."),
        ("upper", c.upper, "High-pass filter at the lower edge of the upper band, behind that."),
        ("wide", c.wide, "High-pass filter at the lower edge of the wide band, behind that."),
        ("slow", c.slow, "Low-pass filter of the slow voltage, from the tactile voltage."),
    ):
        # The first section's numerator is b (1 - 1/z).
        terms = {"b": c.board_1.b0, "a1": c.board_1.a1} if name == "board_1" else section._asdict()
        yield text, {f"{name}_{key}".upper(): real(value) for key, value in terms.items()}
    yield (
        "Filtered signal: factor to a voltage at the filter's input, limit [V]; samples of recovery, and of no change.",
        {
            "FILTERED_GAIN": real(both.coefficients.filtered_gain),
            "FILTERED_LIMIT": real(both.coefficients.filtered_limit),
            "LIMITED_SAMPLES": f"{c.limited_samples:.0f}",
            "STILL_SAMPLES": f"{c.still_samples:.0f}",
        },
    )
    yield (
        "Smoothing factors of 6 and 20 ms, per sample.",
        {
            "SHORT": real(c.short_smoothing),
            "LONG": real(c.long_smoothing),
        },
    )
    yield (
        "Samples of a tick; ticks of a slot of the peaks; entries of the ring of slow voltages.",
        {
            "TICK_SAMPLES": f"{c.tick_samples:.0f}",
            "SLOT_TICKS": f"{c.slot_ticks:.0f}",
            "RING": str(fast_loop.RING),
        },
    )
    yield (
        "Ticks: OFF at the start; settling of the filters; averaging of the floors, at most and after a change; ON.",
        {
            "SETTLING_TICKS": f"{state[fast_loop.SETTLING]:.0f}",
            "SETTLE_TICKS": real(-state[fast_loop.FLOOR_TICKS]),
            "MAX_FLOOR_TICKS": real(c.max_floor_ticks),
            "HELD_TICKS": real(fast_loop.HELD_TICKS),
            "TONE_TICKS": real(c.tone_ticks),
        },
    )
    yield (
        "Ticks: change of force that casts doubt on an ON; time after it; ON of which doubt lets the floors adapt.",
        {
            "MOVED_TICKS": f"{fast_loop.MOVED_TICKS:.0f}",
            "MOVED_WITHIN_TICKS": real(fast_loop.MOVED_WITHIN_TICKS),
            "DOUBTED_TICKS": real(fast_loop.DOUBTED_TICKS),
        },
    )
    yield (
        "Energies of the stated noise in both bands, those of unit noise, and the lowest floors [V^2].",
        {
            "STATED_WIDE": real(state[fast_loop.FLOOR]),
            "STATED_UPPER": real(state[fast_loop.UPPER_FLOOR]),
            "STATED_INPUT": real(state[fast_loop.INPUT_FLOOR]),
            "WIDE_SHARE": real(c.wide_share),
            "UPPER_SHARE": real(c.upper_share),
            "MIN_FLOOR": real(c.min_floor),
            "MIN_UPPER_FLOOR": real(c.min_upper_floor),
            "MIN_INPUT_FLOOR": real(c.min_input_floor),
        },
    )
    yield (
        "The same where the filtered signal is read.",
        {
            "FILTERED_STATED_WIDE": real(both.state[fast_loop.FLOOR]),
            "FILTERED_STATED_UPPER": real(both.state[fast_loop.UPPER_FLOOR]),
            "FILTERED_MIN_FLOOR": real(both.coefficients.min_floor),
            "FILTERED_MIN_UPPER_FLOOR": real(both.coefficients.min_upper_floor),
        },
    )
    yield (
        "Factors of slopes and movements, which make them compare with voltages, and the least denominator.",
        {
            "SLOPE_GAIN": real(fast_loop.SLOPE_S * fast_loop.SLOPE_S * rate * rate),
            "MOVE_GAIN": real(fast_loop.MOVE_S * fast_loop.MOVE_S * rate * rate),
            "TINY": real(fast_loop.TINY),
        },
    )
    yield (
        "Ratios that decide: trees are evaluated, vibration lasts, unstated noise, floors adapt, a tone, an end.",
        {
            "LOUD": real(fast_loop.UPPER_LOUD),
            "LOUD_20": real(fast_loop.UPPER_LOUD_20),
            "LASTING_RATIO": real(fast_loop.LASTING_RATIO),
            "NOISY_RATIO": real(fast_loop.NOISY_RATIO),
            "MOVING_RATIO": real(fast_loop.MOVING_RATIO),
            "CLIP_RATIO": real(fast_loop.CLIP_RATIO),
            "UNLEARNED_RATIO": real(fast_loop.UNLEARNED_RATIO),
            "UNLEARNING": real(c.unlearning),
            "STAY_RATIO": real(c.stay_ratio),
            "DECAY_RATIO": real(fast_loop.DECAY_RATIO),
        },
    )
    yield (
        "Scores: before the first tree; of confidence 0; for ON, and its rise in noise; for staying ON; smoothing.",
        {
            "OFFSET": real(c.offset),
            "LOWEST_SCORE": real(c.lowest_score),
            "ON_SCORE": real(c.threshold),
            "NOISE_RISE": real(c.noise_rise),
            "STAY_SCORE": real(c.stay_threshold),
            "SCORE_SMOOTHING": real(c.score_smoothing),
            "INCIPIENT_CONFIDENCE": real(detector.incipient_confidence),
        },
    )
    yield "Features, trees, and comparisons of a tree from its root to a leaf.", _tree_sizes(model)


def _start(design: Design, filtered_v: float | None) -> FastDetector:
    """Make the detector, and give it one sample, with the filtered signal [V] or without: floors stand still in it."""
    detector = FastDetector(FastSettings.from_design(design))
    detector.step(0.0, filtered_v)
    return detector


def _tree_sizes(model: FastModel) -> dict[str, str]:
    return {"COUNT": str(fast_loop.COUNT), "TREES": str(model.trees), "DEPTH": str(DEPTH)}


def _converter_groups(design: Design) -> Iterator[Group]:
    d = design.detector
    yield (
        "Sampling rate for which all this was computed [Hz, mHz].",
        {
            "SAMPLE_RATE_HZ": real(d.sample_rate_hz),
            "SAMPLE_RATE_MILLIHZ": f"{1000 * d.sample_rate_hz:.0f}u",
        },
    )
    yield (
        "Converter of the design: bits, lower end of its range [V], step [V].",
        {
            "ADC_BITS": str(d.adc_bits),
            "ADC_LOW_V": real(d.adc_low_v),
            "ADC_STEP_V": real(d.adc_step_v),
        },
    )


_WIDTH, _INDENT = 119, "    "


def render_trees(model: FastModel) -> str:
    """Render the three tables. Each tree has `NODES` + 1 entries, of which nodes leave the first one unused."""
    features = [f"{feature:.0f}" for feature in model.features.tolist()]
    thresholds = [f"KEY({value!r}, 0x{float_key(value):08X})" for value in model.thresholds.tolist()]
    leaves = [f"R({value!r})" for value in model.leaves.tolist()]
    tables = (
        ("Number of the feature that each node compares.", "uint8_t slip_features", _pad(features, "0")),
        (
            "Value above which a node's second branch is taken, and its key as a float.",
            "slip_key slip_thresholds",
            _pad(thresholds, "KEY(0.0, 0)"),
        ),
        ("Values of the leaves.", "slip_real slip_leaves", leaves),
    )
    return "\n\n".join(
        "\n".join([f"/* {comment} */", f"static const {name}[SLIP_TREES * LEAVES] = {{", *_rows(values), "};"])
        for comment, name, values in tables
    )


def float_key(value: float) -> int:
    """Bits of a number in single precision, as an integer in the order of these numbers."""
    (bits,) = struct.unpack("<I", struct.pack("<f", value))
    return int(~bits & 0xFFFFFFFF if bits & 0x80000000 else bits | 0x80000000)


def _pad(values: list[str], unused: str) -> list[str]:
    """Put the unused entry ahead of the nodes of each tree."""
    rows = (values[i : i + NODES] for i in range(0, len(values), NODES))
    return [entry for row in rows for entry in (unused, *row)]


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


HEADER, SOURCE = "slip_detector.h", "slip_detector.c"


def read_template(name: str) -> str:
    """Read a file of the folder `c/`."""
    return resources.files(__package__).joinpath("c", name).read_text(encoding="utf-8")


def library_sources(design: Design) -> dict[str, bytes]:
    """Header and source of the detector of a design, by name."""
    header = _insert(read_template(HEADER), "slip_constants.h", render_constants(design))
    source = _insert(read_template(SOURCE), "slip_trees.h", render_trees(load_model()))
    return {HEADER: header.encode(), SOURCE: source.encode()}


def _insert(template: str, include: str, text: str) -> str:
    """Replace the line that includes a file by a text."""
    line = f'#include "{include}"'
    assert template.count(line) == 1, f"{line} must stand once in its template"
    return template.replace(line, text)
