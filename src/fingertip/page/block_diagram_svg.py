"""Block diagram of what happens to a sensor's signal (the article's figure 1), as SVG.

The blocks are the stages of the design's circuit: each stands there because the circuit has the net
that it drives. Those behind the converter are the software of the design's detector.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

from fingertip.board.analysis.board_values import BoardValues, board_values
from fingertip.board.analysis.response import RECTIFYING_DIODE, find_rectifier
from fingertip.board.circuits.board_circuit import board_circuit, divider_circuit
from fingertip.board.parts.circuit import Circuit
from fingertip.board.parts.nets import (
    ENVELOPE,
    FILTERED,
    MEAN,
    REFERENCE,
    SENSOR,
    SLIP,
    STAGE1_OUT,
    SUM,
    TACTILE,
)
from fingertip.design import Design
from fingertip.page.html import Markup, element, join
from fingertip.page.svg import figure_svg, legend, line, number, path, text
from fingertip.slip.detectors.registry import find_detector_type, find_second_column

ON_OFF = "ON/OFF"
"""Output of the last block."""
_COLUMNS = 4
_WIDTH = 168.0
_HEIGHT = 92.0
_GAP_X = 28.0
_GAP_Y = 26.0
_LEFT = 6.0
_TOP = 34.0
"""Blocks of a row, size of a block, and distances [px]."""
_LINE = 17.0
_ARROW = 5.0
_BOARD = "var(--series-1)"
_SOFTWARE = "var(--series-2)"


@dataclass(frozen=True)
class Block:
    title: str
    lines: tuple[str, ...]
    """What it does, in numbers and references of the schematic; three lines at most."""
    output: str
    """Net that it drives, or name of the signal in software."""
    is_software: bool = False
    inputs: tuple[str, ...] = ()
    """Nets that it reads; none: the output of the block before it."""

    def follows(self, before: Block) -> bool:
        """True if it reads what the block before it drives."""
        return not self.inputs or before.output in self.inputs


def list_blocks(design: Design) -> list[Block]:
    """List the blocks from the sensor to ON and OFF, in the order of the signal."""
    if design.board.has_filter:
        values = board_values(design)
        circuit = board_circuit(values)
        blocks = [*_list_front_end(design, circuit, values), *_list_stages(circuit, values)]
    else:
        circuit = divider_circuit(design)
        resistor = f"{circuit.component('R1').value} to ground (R1)"
        blocks = [
            Block("Sensor", (design.dimensions.sensor.label,), "the supply"),
            Block("Divider", (resistor,), TACTILE),
        ]

    return [*blocks, _describe_converter(design), *_list_software(design)]


def _list_front_end(design: Design, circuit: Circuit, values: BoardValues) -> Iterator[Block]:
    """Yield the sensor, and what makes a voltage of its resistance."""
    nets = set(circuit.net_by_pin.values())
    yield Block("Sensor", (design.dimensions.sensor.label,), SENSOR)

    if REFERENCE in nets and values.bridge:
        yield Block("Wheatstone bridge", ("R10, R11 and the sensor,", "R12, R13"), REFERENCE)
        gain = f"gain {values.bridge.gain:.0f} (R14)"
        yield Block("Instrum. amplifier", (circuit.component("U2").value, gain), TACTILE)
    elif SUM in nets:
        feedback = f"feedback {circuit.component('R30').value} (R30)"
        yield Block("Transimpedance", ("sensor at a fixed voltage", feedback), TACTILE)


def _list_stages(circuit: Circuit, values: BoardValues) -> Iterator[Block]:
    """Yield the filter's stages, and what follows them on the board."""
    nets = set(circuit.net_by_pin.values())
    response = values.achieved_response
    gain = f"gain {response.passband_gain:.1f} (R4, R5)"
    first_lines = [f"{response.first_pole_hz:.1f} Hz (C1, R1)", gain]
    if values.first_stage_capacitors:
        first_lines.append(f"up to {response.upper_cutoff_hz:.0f} Hz (C20)")

    yield Block("High-pass, 1st order", tuple(first_lines), STAGE1_OUT)
    section = f"{response.section_hz:.1f} Hz, Q {response.section_quality:.2f}"
    yield Block("High-pass, 2nd order", ("Sallen-Key, gain 1", section), FILTERED)

    rectifier = find_rectifier(circuit)
    if rectifier == "software":
        return

    if rectifier == "diode":
        diode = circuit.component(RECTIFYING_DIODE).value
        yield Block("Rectifier", ("half wave", f"{diode} (D1)"), "current of D1")
    else:
        lines = ("half wave (D1, D4)", "in the loop of U3a")
        yield Block("Rectifier", lines, "RECTIFIED")

    pole = f"{response.envelope_pole_hz:.1f} Hz (R6, C4)"
    yield Block("Envelope", (pole, f"decay {1e3 * response.envelope_decay_s:.1f} ms"), ENVELOPE)

    stage = values.comparator_stage
    if MEAN in nets and stage:
        mean_ms = 1e3 * stage.averaging_ohm * stage.averaging_f
        yield Block("Average", (f"{mean_ms:.1f} ms (R18, C17)",), MEAN)
        yield Block("Comparator", ("threshold by RV1", "pin: low in slip (U4)"), SLIP)


def _describe_converter(design: Design) -> Block:
    """Describe the converter, with the signals that the design's detector reads."""
    detector = design.detector
    filtered_or_envelope = ENVELOPE if design.board.has_envelope else FILTERED
    read = {"voltage_v": TACTILE, "envelope_v": filtered_or_envelope, "filtered_v": FILTERED}
    first = find_detector_type(detector.kind, "detector.kind").input_column
    second = find_second_column(design, detector.kind)
    names = tuple(read[column] for column in (first, second) if column)
    lines = (
        f"reads {', '.join(names)}",
        f"{detector.adc_bits} bits, {detector.adc_range_text}",
        f"every {1e3 / detector.sample_rate_hz:g} ms",
    )

    return Block("Converter", lines, "samples", is_software=True, inputs=names)


def _list_software(design: Design) -> Iterator[Block]:
    """Yield the parts of the design's detector."""
    detector = design.detector
    kind = find_detector_type(detector.kind, "detector.kind")
    if not kind.has_design_threshold:
        yield Block(f"Detector {detector.kind}", (kind.words,), ON_OFF, is_software=True)
        return

    if not kind.takes_envelope:
        cutoff = f"{design.board.cutoff_hz:g} Hz"
        yield Block("High-pass, 3rd order", (cutoff,), "filtered", is_software=True)

    if not (kind.takes_envelope and design.board.has_envelope):
        pole = f"{design.board.envelope_cutoff_hz:g} Hz"
        lines = ("half wave", f"low-pass {pole}")
        yield Block("Rectifier, envelope", lines, "envelope", is_software=True)

    window_ms = 1e3 * detector.window_samples / detector.sample_rate_hz
    lines = (f"mean of {window_ms:g} ms", f"L = {detector.window_samples} samples")
    yield Block("Window", lines, "mean", is_software=True)
    limit = f"ON above {1e3 * detector.threshold_v:.3g} mV"
    yield Block("Threshold", (limit,), ON_OFF, is_software=True)


def draw_block_diagram(design: Design) -> Markup:
    """Draw the blocks row by row, each with an arrow to the next that reads it."""
    blocks = list_blocks(design)
    rows = -(-len(blocks) // _COLUMNS)
    width = 2 * _LEFT + _COLUMNS * _WIDTH + (_COLUMNS - 1) * _GAP_X
    height = _TOP + rows * (_HEIGHT + _GAP_Y)
    places = [_place(i) for i in range(len(blocks))]
    pairs = zip(itertools.pairwise(blocks), itertools.pairwise(places), strict=True)
    arrows = (_draw_arrow(*ends) for (before, block), ends in pairs if block.follows(before))
    drawn = (_draw_block(block, place) for block, place in zip(blocks, places, strict=True))
    key = ((_BOARD, "", "circuit"), (_SOFTWARE, "", "converter and software"))

    return figure_svg(
        width,
        height,
        f"Block diagram of {design.name}: from the sensor to ON and OFF",
        legend(_LEFT, 18.0, key),
        join(arrows),
        join(drawn),
    )


def _place(index: int) -> tuple[float, float]:
    """Upper left corner of a block [px]."""
    row, column = divmod(index, _COLUMNS)
    return _LEFT + column * (_WIDTH + _GAP_X), _TOP + row * (_HEIGHT + _GAP_Y)


def _draw_block(block: Block, place: tuple[float, float]) -> Markup:
    left, top = place
    box = element(
        "rect",
        x=number(left),
        y=number(top),
        width=number(_WIDTH),
        height=number(_HEIGHT),
        rx=4,
        fill="var(--raised)",
        stroke=_SOFTWARE if block.is_software else _BOARD,
        stroke_width=1.5,
    )
    middle = left + _WIDTH / 2
    title = text(middle, top + 19.0, block.title, "middle", "600")
    lines = (
        text(middle, top + 19.0 + _LINE * (i + 1), content, "middle")
        for i, content in enumerate(block.lines)
    )

    return join(
        (box, title, *lines, text(middle, top + _HEIGHT - 5.0, f"→ {block.output}", "middle"))
    )


def _draw_arrow(start: tuple[float, float], end: tuple[float, float]) -> Markup:
    """Draw the way from one block to the next, beside it or at the begin of the row below."""
    (left, top), (x, y) = start, end
    level = top + _HEIGHT / 2
    colour = "var(--text)"
    if top == y:
        return join(
            (
                line((left + _WIDTH, level), (x, level), colour, 1.5),
                _draw_head((x, level), is_across=True),
            )
        )

    between = top + _HEIGHT + _GAP_Y / 2
    middle = left + _WIDTH / 2
    to = x + _WIDTH / 2
    way = [(middle, top + _HEIGHT), (middle, between), (to, between), (to, y)]
    drawn = element("path", d=path(way), fill="none", stroke=colour, stroke_width=1.5)

    return join((drawn, _draw_head((to, y), is_across=False)))


def _draw_head(tip: tuple[float, float], *, is_across: bool) -> Markup:
    """Draw the head of an arrow that points to the right, or down."""
    x, y = tip
    if is_across:
        corners = [(x, y), (x - 1.6 * _ARROW, y - _ARROW), (x - 1.6 * _ARROW, y + _ARROW)]
    else:
        corners = [(x, y), (x - _ARROW, y - 1.6 * _ARROW), (x + _ARROW, y - 1.6 * _ARROW)]

    return element("path", d=path(corners) + "Z", fill="var(--text)")
