"""Section on the envelope offset, in the README of a board, and how to trim the threshold."""

from __future__ import annotations

from fingertip.amplifiers import CATALOGUE
from fingertip.board.analysis.figures import format_figure
from fingertip.board.analysis.offsets import OutputOffset
from fingertip.board.analysis.thresholds import ComparatorLevels
from fingertip.board.board_values import BoardValues
from fingertip.board.readme_parts.connectors import has_mid_supply, slip_pin
from fingertip.board.readme_parts.text import paragraph
from fingertip.design import Design
from fingertip.design.comparator_data import COMPARATOR_OFFSET_V, MAX_COMPARATOR_OFFSET_V


def offset_section(values: BoardValues, design: Design) -> str:
    """Section on the envelope offset, with the trimming procedure of variant comparator. Empty for variant article."""
    if values.output_offset is None:
        return ""
    offset = paragraph(_describe_offset(values.output_offset, values, design))
    if values.comparator_levels:
        title, procedure = (
            "Envelope offset and threshold",
            trimming_procedure(values.comparator_levels, values, design),
        )
    else:
        is_single = has_mid_supply(values)
        title = "Envelope offset"
        procedure = paragraph(
            "Measure the idle level of the envelope at pin E of J3, with the ADC connected and nothing touching the "
            f"sensor: the mean of E against {'M' if is_single else 'ground'}. (TP4 lies ahead of R7, in which the "
            "reverse current of D2 shifts E.) This level consists of the envelope offset, the shift in R7 and the "
            f"mean due to noise ({1e3 * (values.noise.mean_envelope_v or 0.0):.1f} mV), for which the threshold "
            f"allows. The detector `analog` compares the envelope reading {'(E minus M) ' if is_single else ''}with "
            "`detector.threshold_v` and subtracts no offset: take the mean due to noise off the measured level, and "
            "subtract the rest from the readings, or add it to the threshold for `analog` alone (`--detector analog "
            "--set detector.threshold_v=...`). Never change the threshold for `digital`, the default: its envelope is "
            "computed from T and has no offset of the board."
        )
    return f"\n## {title}\n\n{offset}\n\n{procedure}\n"


def _describe_offset(offset: OutputOffset, values: BoardValues, design: Design) -> str:
    amplifier = CATALOGUE[values.amplifier]
    text = (
        f"The offset voltages of U1 and U3 appear in the envelope. With {1e3 * amplifier.max_offset_v:g} mV each, the "
        f"maximum of a {amplifier.order_name}, the envelope offset lies between "
        f"{round(1e3 * offset.min_v, 1) + 0.0:.1f} and "
        f"+{1e3 * offset.max_v:.1f} mV (typical offsets cause {format_figure(1e3 * offset.typical_v, 2)} mV, "
        f"the root of the sum of their squares). The design's threshold is {1e3 * design.detector.threshold_v:g} mV."
    )
    if offset.max_v <= offset.max_low_offset_v:
        return text
    return (
        f"{text} With an {offset.low_offset_amplifier} (`board.amplifier`), which has the same pins, the envelope "
        f"offset stays below {1e3 * offset.max_low_offset_v:.1f} mV."
    )


def trimming_procedure(levels: ComparatorLevels, values: BoardValues, design: Design) -> str:
    """Describe how to trim the threshold of variant comparator, as a Markdown paragraph and numbered steps."""
    reference_point = "M or TP5, not against ground" if has_mid_supply(values) else "ground (TP5)"
    slip = slip_pin(values)
    threshold = f"{1e3 * design.detector.threshold_v:g} mV"
    introduction = (
        f"With RV1 at its midpoint, {slip} goes low when the mean of E rises above {1e3 * levels.on_v:.1f} mV, and "
        f"high again when it falls below {1e3 * levels.off_v:.1f} mV. The range of RV1 ends at "
        f"{1e3 * levels.max_on_v:.0f} mV. The comparator adds its own errors: its input current raises the mean by "
        f"{1e3 * levels.bias_v:.1f} mV in R18 (at most {1e3 * levels.max_bias_v:.1f} mV), of which "
        f"{1e3 * levels.threshold_bias_v:.1f} mV are compensated at the threshold if both inputs draw the same "
        f"current, and its offset voltage is {1e3 * COMPARATOR_OFFSET_V:g} mV (at most "
        f"{1e3 * MAX_COMPARATOR_OFFSET_V:g} mV). "
        "One procedure compensates the envelope offset and these errors:"
    )
    steps = (
        "Make sure that nothing touches the sensor. Measure the threshold with a voltmeter at RV1's wiper, the pin "
        f"alone on its side, against {reference_point}.",
        f"Turn RV1 anticlockwise, towards the pin beside R19, until {slip} is high. The reading rises if you turn in "
        "the right direction.",
        f"Turn RV1 back slowly until {slip} goes low. Note the last reading before that: it is the idle level "
        f"(envelope offset and noise) as the comparator sees it. If {slip} is still high at the end stop, this level "
        "is negative: note the reading at the end stop, about 0. The board is then less sensitive than intended, by as "
        "much as the level lies below that reading.",
        f"Turn RV1 anticlockwise until {slip} is high again, and on until the reading is the noted level + "
        f"{threshold}. Read the voltmeter only while {slip} is high: while {slip} is low, the hysteresis lowers the "
        f"reading by about {1e3 * (levels.on_v - levels.off_v):.0f} mV.",
        f"If the noted level + {threshold} exceeds the range of RV1, choose a higher `detector.threshold_v` for the "
        "board, or better amplifiers.",
    )
    numbered = "\n".join(paragraph(step, f"{i}. ", "   ") for i, step in enumerate(steps, start=1))
    return f"{paragraph(introduction)}\n\n{numbered}"
