"""What the README says of one board's signals, supply, rest level and threshold."""

from __future__ import annotations

import textwrap

from fingertip.board.values.amplifiers import AMPLIFIERS, PAPERS
from fingertip.board.values.board_values import BoardValues
from fingertip.board.values.converter import CLAMP_A, MAX_CLAMP_A
from fingertip.board.values.decision import PULL_UP_OHM, Decision
from fingertip.board.values.limits import converter_line
from fingertip.board.values.rest import Rest
from fingertip.board.values.ripple import RIPPLE_BAND_HZ
from fingertip.board.values.white_noise import noise_warning
from fingertip.design import Design
from fingertip.design.comparator_parts import COMPARATOR_OFFSET_V, MAX_COMPARATOR_OFFSET_V

_SPLIT = "Signals rest at ground; {converter}."
_SINGLE = (
    "Signals rest at the supply's buffered middle, {rest:.2f} V, so the envelope is E less M; {converter}. The "
    "sensor's second pin is at the middle too: let it touch neither ground nor metal that is grounded."
)
_SIGNALS = (
    " T lies between {minimum:.2f} V (20 N) and {maximum:.2f} V (no force), E rises by {envelope:.1f} V at most. {swing} "
    "D2 and D3 keep T and E between ground and + {supply:g} V (and a diode's drop beyond), R7 to R9 limit what flows "
    "then. R8, C9, R9 and C19 (and R7, C8) fit a converter of {rate:g} samples per second: they take {alias:.0f} dB "
    "off what would fold onto {band:.0f} Hz, the upper end of slip's vibrations. For another rate set "
    "`detector.sample_rate_hz`. A converter's inputs should have 10 Mohm or more: R7 to R9 divide with them. D2's "
    "reverse current flows through R7: E reads {leak:.0f} mV too high with the {micro:g} uA of the deck's model, and "
    "up to {leaks:.0f} mV with the {micros:g} uA that a BAT54 may have."
)
_REACHES = (
    "The amplifiers are {name}, whose inputs and outputs reach both rails; a vibration of more than {vibration:.0f} mV "
    "in the tactile voltage is cut off in the filter."
)
_ENDS = (
    "U1 is the article's {name}: behind the filter it follows {up:.1f} V up but only {down:.1f} V down ({sure:.1f} V "
    "to be sure), a vibration of {vibration:.0f} mV in the tactile voltage. Its inputs end there, and below, its "
    "output jumps up: an ordinary press (1.5 N within 0.2 s) does that for about a millisecond, and E jumps with it. "
    "Variants `precision` and `comparator` have amplifiers without that end."
)

_NOISE = "The bridge's amplifier leaves {tactile:.1f} mV of noise (rms, typical). "
_NOISE_HIDDEN = _NOISE + (
    "The filters make {open:.2g} mV of it. The diode's dead zone hides it, and weak slip with it. `--analysis` gives "
    "noise, offsets and tolerances of this board, and what a low-pass or a quieter amplifier would do."
)
_NOISE_LIMITED = _NOISE + (
    "The filters would make {open:.2g} mV of it; C20, which ends the first stage's gain at {limit:.0f} Hz, leaves "
    "{filtered:.2g} mV, and the envelope rests at {rest:.1f} mV, {beside}. `--analysis` gives noise, offsets and "
    "tolerances of this board, and what a quieter amplifier would do."
)
_WELL_BELOW = 0.5
"""Of the threshold."""


def noise_words(values: BoardValues, design: Design) -> str:
    """How much noise there is, and where it lets the envelope rest beside the threshold."""
    noise, first = values.noise, values.first_stage
    tactile, open_, filtered = (1e3 * v for v in (noise.tactile_v, noise.open_v, noise.filtered_v))
    if noise.rest_v is None or first is None:
        return _NOISE_HIDDEN.format(tactile=tactile, open=open_)
    words = _NOISE_LIMITED.format(
        tactile=tactile, open=open_, filtered=filtered, limit=first.limit_hz, rest=1e3 * noise.rest_v,
        beside=_beside(noise.rest_v, design.detector.threshold_v),
    )  # fmt: skip
    warning = noise_warning(noise, design.detector.threshold_v)
    return f"{words} **Mind: {warning}**" if warning else words


def _beside(rest_v: float, threshold_v: float) -> str:
    where = "above" if rest_v >= threshold_v else "well below" if rest_v < _WELL_BELOW * threshold_v else "below"
    return f"{where} the threshold of {1e3 * threshold_v:g} mV"


def signals(values: BoardValues, design: Design) -> str:
    """How far the signals go, and what the converter sees."""
    limits, supply_v = values.limits, design.board.supply_v
    name = AMPLIFIERS[values.amplifier].buy
    swing = (_ENDS if values.amplifier == PAPERS else _REACHES).format(
        name=name,
        up=limits.filter_peak_v,
        down=limits.filter_trough_v,
        sure=limits.filter_sure_trough_v,
        vibration=1e3 * limits.vibration_peak_v,
    )
    words = (_SINGLE if values.supply == "single" else _SPLIT) + _SIGNALS
    text = words.format(
        rest=limits.rest_v,
        converter=converter_line(limits),
        supply=supply_v,
        minimum=limits.min_tactile_v,
        maximum=limits.max_tactile_v,
        envelope=limits.max_envelope_v,
        swing=swing,
        rate=design.detector.sample_rate_hz,
        alias=-values.alias.raw_alias_db,
        band=values.alias.band_hz,
        leak=1e3 * values.converter.envelope_ohm * CLAMP_A,
        leaks=1e3 * values.converter.envelope_ohm * MAX_CLAMP_A,
        micro=1e6 * CLAMP_A,
        micros=1e6 * MAX_CLAMP_A,
    )
    return paragraph(text)


def before_power(values: BoardValues, design: Design) -> str:
    """What the supply must be, as a list; for variant comparator also what its pin carries."""
    low, high = RIPPLE_BAND_HZ
    ripple, supply_v = values.ripple, design.board.supply_v
    harm = "more makes the diode conduct" if values.rest is None else "more is a slip to the threshold of the design"
    notes = [
        "Nothing protects the board from a supply the wrong way round: it dies of it. Check J2 with a meter before the "
        "board is in it.",
        f"The bridge hangs on + {supply_v:g} V, whose ripple comes to the rectifier {ripple.gain:.0f} times as large: "
        f"between {low:g} Hz and {high:g} Hz its peak must stay below {1e3 * ripple.max_v:.2g} mV ({harm}). Use a "
        "linear regulator of low noise, near the board, and nothing else on it.",
    ]
    if values.decision:
        notes.append(
            f"S rests at + {supply_v:g} V, through R21 ({PULL_UP_OHM / 1e3:g}k), and goes to ground for slip. An input "
            "for 3.3 V needs a divider or a level shifter."
        )
    return listed(notes)


def rest_and_threshold(values: BoardValues, design: Design) -> str:
    """The section on the rest level; for variant comparator with its trimmer's procedure. Empty for variant article."""
    if values.rest is None:
        return ""
    rest = paragraph(_rest_words(values.rest, values, design))
    if values.decision is None:
        how = (
            "So measure the rest, nothing touching the sensor: E against {zero} (TP4 against TP5). Take it off what "
            "the converter reads, or add it to `detector.threshold_v`: the threshold counts from the rest."
        )
        steps = paragraph(how.format(zero="M" if values.supply == "single" else "ground"))
    else:
        steps = _trimming(values.decision, values, design)
    return f"\n## The rest level{' and the threshold' if values.decision else ''}\n\n{rest}\n\n{steps}\n"


def _rest_words(rest: Rest, values: BoardValues, design: Design) -> str:
    amplifier = AMPLIFIERS[values.amplifier]
    return (
        f"Offsets of U1 and U3 are in the envelope: with {1e3 * amplifier.max_offset_v:g} mV each, the most a "
        f"{amplifier.buy} has, E rests anywhere between {1e3 * rest.min_v:.1f} and + {1e3 * rest.max_v:.1f} mV "
        f"(with typical ones within {1e3 * rest.typical_v:.0f} mV), and the design's threshold is "
        f"{1e3 * design.detector.threshold_v:g} mV. An {rest.finer_name} has the same pins and lets it rest below "
        f"{1e3 * rest.max_finer_v:.1f} mV."
    )


def _trimming(decision: Decision, values: BoardValues, design: Design) -> str:
    zero = "M or TP5, not against ground" if values.supply == "single" else "ground (TP5)"
    threshold = f"{1e3 * design.detector.threshold_v:g} mV"
    words = (
        f"With RV1 in its middle S goes low where E's mean rises above {1e3 * decision.on_v:.1f} mV and high again "
        f"below {1e3 * decision.off_v:.1f} mV; RV1 reaches {1e3 * decision.max_on_v:.0f} mV. The comparator adds its "
        f"own errors: its input current lifts the mean by {1e3 * decision.bias_v:.1f} mV in R18 "
        f"({1e3 * decision.max_bias_v:.1f} mV at most), its offset is {1e3 * COMPARATOR_OFFSET_V:g} mV "
        f"({1e3 * MAX_COMPARATOR_OFFSET_V:g} mV at most). One procedure takes all of them in, rest and comparator:"
    )
    steps = (
        f"Nothing touching the sensor, measure the threshold at RV1's middle pin, the one alone on its side, against "
        f"{zero}.",
        "Turn RV1 up until S is high: counterclockwise, towards the pin beside R19; the meter tells.",
        "Turn it down slowly until S goes low; what the meter showed last before is the rest, as the comparator sees "
        "it.",
        f"Turn it up until S is high again, and on to that reading + {threshold}. S must be high while you read: low, "
        "it lowers the reading by a quarter of the design's threshold.",
        f"Where that rest and {threshold} are more than RV1 reaches, choose a higher `detector.threshold_v` for the "
        "board, or better amplifiers.",
    )
    numbered = "\n".join(paragraph(step, f"{i}. ", "   ") for i, step in enumerate(steps, start=1))
    return f"{paragraph(words)}\n\n{numbered}"


def paragraph(words: str, first: str = "", rest: str = "") -> str:
    """Lines of 120 characters."""
    return textwrap.fill(words, 120, initial_indent=first, subsequent_indent=rest, break_on_hyphens=False)


def listed(notes: list[str]) -> str:
    """A list of these."""
    return "\n".join(paragraph(note, "- ", "  ") for note in notes)
