"""README of the folder that a board is written to."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable

from fingertip.amplifiers import ARTICLE_AMPLIFIER, CATALOGUE
from fingertip.board.analysis.figures import format_figure
from fingertip.board.analysis.limits import describe_adc_range
from fingertip.board.analysis.loads import signal_band_hz
from fingertip.board.analysis.noise import noise_warning
from fingertip.board.analysis.offsets import OutputOffset
from fingertip.board.analysis.supply_ripple import DEAD_ZONE_V, describe_sensor
from fingertip.board.analysis.thresholds import ComparatorLevels
from fingertip.board.analysis.touches import describe_touches
from fingertip.board.board_values import BoardValues
from fingertip.board.circuit import Circuit
from fingertip.board.circuits.front_end_and_supply import CABLE_OHM
from fingertip.board.components.anti_aliasing import CLAMP_A, LOW_LEAKAGE_CLAMP, MAX_CLAMP_A, MAX_LOW_LEAKAGE_A
from fingertip.board.components.bridge import VREF_RATIO
from fingertip.board.components.comparator import PULL_UP_OHM
from fingertip.board.fabrication.assembly import find_rotation, is_assembled, load_rotations
from fingertip.board.fabrication.bom import purchased_components
from fingertip.board.kicad.models import MODEL_FOLDER, MODEL_FOLDER_OF_KICAD, MODEL_VARIABLE
from fingertip.board.kicad.project import IGNORED_IN_SCHEMATIC, IGNORED_ON_BOARD
from fingertip.board.kicad.symbols import CAPACITOR, RESISTOR, TEST_POINT
from fingertip.board.parts.table import load_sources
from fingertip.board.spice import MAX_SWITCH_OHM
from fingertip.board.supplies import SUPPLIES
from fingertip.board.variants import BoardConfiguration
from fingertip.design import Design
from fingertip.design.amplifier_stages import DIODE_V
from fingertip.design.comparator_data import COMPARATOR_OFFSET_V, MAX_COMPARATOR_OFFSET_V
from fingertip.design.rules.board import SUPPLY_RANGES_V

_NO_DIRECTION = (RESISTOR, CAPACITOR)
"""Symbols of components that may be turned by 180 degrees."""
HEADING = "# The slip-filter board\n"
"""First line of the README."""

_TEMPLATE = """
{summary}

## Files

| file | content |
| --- | --- |
| `{name}.kicad_pro` | KiCad 9 project; open this file |
| `{name}.kicad_sch` | schematic |
| `{name}.kicad_pcb` | layout, routed, with ground pour |
| `{name}.net` | netlist of the same circuit, for other PCB tools |
| `{name}.cir` | SPICE deck, see below |
| `bom.csv` | bill of materials: quantities, values, ratings, part numbers with their sources, or why one is missing |
| `bringup.md`, `bringup_readings.toml` | with `--bringup`: how to test a soldered board, and a file for the readings |
| `values.json` | component values: ideal and preferred; target and achieved response; voltage limits; errata |
| `{models}/` | 3D models of the packages: boxes with the outline and the height of each |

`ngspice -b {name}.cir` prints the levels at TACTILE, STAGE1_OUT and FILTERED [dBV] over frequency, for an AC
current of 1 uA into the sensor. The difference of two levels is the gain between their nets [dB].

`fingertip board DESIGN --out FOLDER` wrote these files. The same design gives the same bytes. To change the cutoff, the
gain or the resistor series, edit the design file or set a parameter on the command line (`--set board.cutoff_hz=80`),
and run the command again. This changes component values but neither placement nor tracks. A schematic or layout that
you edited in KiCad keeps your edits: values and part numbers that the design changes are entered into it, and nothing
else. If parts, footprints or nets change, nothing is written; `--force` overwrites your edits.

- `--set board.capacitor_series=E6` selects the capacitors too, together with the resistors; `preferred` selects only
  values that the parts table has.
- `--set board.variant=...` and `--set board.supply=...` write the other boards.
- `--bringup` adds `bringup.md`, how to test a soldered board, and `wiring.svg`, how to connect it.
- `--check` tells whether a folder is up to date.
- `--fab` adds the fabrication files: gerbers and drill files in one zip, renderings, and parts and placement for the
  assembly: `bom_assembly.csv` and `placement_assembly.csv` in the columns and with the rotations of JLCPCB,
  `{name}_placement.csv` with KiCad's rotations for any other house. It needs KiCad 9.

## 3D models

KiCad shows the parts, and `kicad-cli pcb export step` exports them, as the boxes in `{models}`. The text variable
`{model_variable}` of the project names this folder. Where KiCad's own models are installed, set it to
`{kicad_models}` in Schematic Setup or Board Setup, Text Variables, or for one command:

```sh
kicad-cli pcb export step -D '{model_variable}={kicad_models}' {name}.kicad_pcb -o board.step
```

## Checks that are off

The project switches off five comparisons with KiCad's libraries. All other rules of ERC and DRC are on, and the board
as written passes them.

{ignored}

With KiCad's libraries installed, the two mismatches report every symbol and footprint, and the other three report
nothing. To switch a check on, set its severity in Schematic Setup or Board Setup, Violation Severity.

## Connectors

{connectors}

## Test points

| test point | net | signal |
| --- | --- | --- |
{test_points}

## Signals

{signals}

## Before you apply power

{power}
{offset}
## Components

| component | value | function |
| --- | --- | --- |
{components}

## Before you order

{ordering}

## Errata of the article

{errata}

## Known limitations

{limitations}
"""

MAX_PIN_LEAK_V = 1e-3
"""Shift by an ADC's leakage current for which that current is stated [V]."""
_TEST_POINT_SIGNALS = {
    "TACTILE": "tactile voltage: output of the bridge's amplifier",
    "STAGE1_OUT": "output of the first filter stage",
    "FILTERED": "output of the second filter stage, ahead of the rectifier",
    "ENVELOPE": "envelope, ahead of its anti-aliasing filter",
    "GND": "signal ground: supply ground (0 V)",
    "VMID": "signal ground: VMID (buffered mid-supply)",
}
"""Signals at the test points, by net."""


def folder_readme(circuit: Circuit, configuration: BoardConfiguration, values: BoardValues, design: Design) -> bytes:
    """Content of the README, Markdown in UTF-8."""
    components = purchased_components(circuit)
    text = _TEMPLATE.format(
        name=circuit.name,
        models=MODEL_FOLDER,
        model_variable=MODEL_VARIABLE,
        kicad_models=MODEL_FOLDER_OF_KICAD,
        ignored=_bullet_list(
            f"{rules}, `{name}`: {reason}."
            for rules, checks in (("ERC", IGNORED_IN_SCHEMATIC), ("DRC", IGNORED_ON_BOARD))
            for name, reason in checks.items()
        ),
        summary=_summary(configuration, values, len(components)),
        connectors=_connector_table(values, design),
        test_points="\n".join(
            f"| {c.reference} | {c.value} | {_TEST_POINT_SIGNALS[c.value]} |"
            for c in circuit.components
            if c.symbol == TEST_POINT
        ),
        signals=_bullet_list(_signal_notes(values, design)),
        power=_bullet_list(_power_notes(values, design)),
        offset=_offset_section(values, design),
        components="\n".join(f"| {c.reference} | {c.value} | {c.role} |" for c in components),
        ordering=_bullet_list(_ordering_notes(circuit, values, design)),
        limitations=_bullet_list(_limitations(values)),
        errata=_bullet_list(
            f"{_capitalize(e.subject)}. Article: {e.statement}. Correct: {e.correction}." for e in values.errata
        ),
    )
    return (HEADING + text).encode()


def _summary(configuration: BoardConfiguration, values: BoardValues, component_count: int) -> str:
    placement, response = configuration.placement, values.achieved_response
    supply = configuration.supply.description.replace("buffered mid-supply", "VMID (buffered mid-supply)")
    what = (
        f"Variant `{values.variant}`, {supply}: bridge and amplifier for the force-sensing "
        f"resistor; {configuration.variant.summary}; interface to the ADC (analog-to-digital converter); supply. "
        f"{placement.width:g} x {placement.height:g} mm, two layers, all {component_count} components on the front. "
        "The back lists the values of resistors and capacitors"
    )
    unlabelled = [ref for ref in placement.positions if ref[0] in "RC" and ref not in placement.reference_labels]
    what += (
        f"; {len(unlabelled)} of them have no reference on the front, so look them up in the layout."
        if unlabelled
        else "."
    )
    upper = format_figure(response.upper_cutoff_hz)
    achieved = (
        f"Achieved response: gain {response.passband_gain:.2f} ({response.passband_gain_db:.2f} dB), -3 dB at "
        f"{response.cutoff_hz:.2f} Hz and {upper} Hz, Q {response.section_quality:.4f}, "
        f"envelope time constant {1e3 * response.envelope_decay_s:.2f} ms."
    )
    return f"{_paragraph(what)}\n\n{_paragraph(achieved)}"


def _connector_table(values: BoardValues, design: Design) -> str:
    supply_v, is_single = design.board.supply_v, _is_single(values)
    if SUPPLIES[values.supply].is_for_controller:
        return _controller_connector_table(values, supply_v)
    slip = (
        f"S: slip output, low (asserted) while slip is detected, else +{supply_v:g} V"
        if values.comparator_levels
        else "0 (ground)"
    )
    rows = [
        ("connector", "pin 1 (square)", "pin 2", "pin 3", "pin 4", "pin 5"),
        ("---",) * 6,
        ("J1, sensor", "FSR", f"FSR, {'signal ground' if is_single else 'ground'}", "", "", ""),
        ("J2, supply", f"+{supply_v:g} V", "0 (ground)", "" if is_single else f"-{supply_v:g} V", "", ""),
        ("J3, to the ADC", "T: tactile voltage", "E: envelope", "0 (ground)", slip, "M: VMID (signal ground)"),
    ]
    # Only boards with a single supply have a fifth pin.
    return "\n".join("| " + " | ".join(row if is_single else row[:-1]) + " |" for row in rows)


def _controller_connector_table(values: BoardValues, supply_v: float) -> str:
    slip = (
        f"SLIP: low (asserted) while slip is detected, else +{supply_v:g} V" if values.comparator_levels else "ground"
    )
    rows = [
        ("connector", "type", "pins"),
        ("---",) * 3,
        ("J1, sensor", "JST SH, 2 pins", "1, 2: FSR. Pin 2 is at signal ground."),
        ("J2, supply", "JST PH, 2 pins", f"1: +{supply_v:g} V; 2: 0 (ground)"),
        (
            "J3, to the controller",
            "JST SH, 10 pins",
            "1, T: tactile voltage; 3, S: filtered signal; 5, E: envelope; 7, M: VMID, the reference of all signals; "
            f"9, {slip}; 2, 4, 6, 8, 10: ground",
        ),
    ]
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def _is_single(values: BoardValues) -> bool:
    """Return whether the signals have a quiescent level of half the supply."""
    return bool(SUPPLIES[values.supply].signal_ground_ratio)


def _slip_pin(values: BoardValues) -> str:
    """Name of the slip output. On a board for a controller S is the filtered signal."""
    return "SLIP" if SUPPLIES[values.supply].is_for_controller else "S"


def _signal_notes(values: BoardValues, design: Design) -> list[str]:
    """Signal levels, clipping and the interface to the ADC."""
    limits, supply_v = values.voltage_limits, design.board.supply_v
    amplifier = CATALOGUE[values.amplifier].order_name
    vibration_mv = 1e3 * limits.vibration_peak_v
    if _is_single(values):
        signal_ground = (
            f"Signal ground is VMID (buffered mid-supply), {limits.signal_ground_v:.2f} V above supply ground, at pin "
            "M. The envelope is the voltage between E and M. The sensor's second pin is at signal ground too: connect "
            "it neither to supply ground nor to grounded metal."
        )
    else:
        signal_ground = "Signal ground is supply ground (0 V)."
    if values.amplifier == ARTICLE_AMPLIFIER:
        swing = (
            f"U1 is a {amplifier}: the article's {ARTICLE_AMPLIFIER} in a grade with at most "
            f"{1e3 * CATALOGUE[values.amplifier].max_offset_v:g} mV of offset. The filtered signal can swing "
            f"{limits.filter_peak_v:.1f} V up but only {limits.filter_trough_v:.1f} V down (typical, into 10 kohm; "
            f"{limits.filter_guaranteed_trough_v:.1f} V down guaranteed), where the input common-mode range of the "
            f"second stage ends. A vibration of {vibration_mv:.0f} mV (peak, where the gain is largest) in the tactile "
            "voltage reaches this limit. Below it the output jumps up (phase reversal), and E jumps with it for some "
            f"milliseconds. A fast press or a knock causes this: {describe_touches()}. The amplifiers of the variants "
            "`precision` and `comparator` do not do this."
        )
    else:
        swing = (
            f"The amplifiers are {amplifier}, with rail-to-rail inputs and outputs. The filtered signal swings "
            f"{limits.filter_peak_v:.1f} V up and down (typical, into 10 kohm): it clips vibrations of more than "
            f"{vibration_mv:.0f} mV (peak, where the gain is largest) in the tactile voltage."
        )
    adc_range = describe_adc_range(limits)
    notes = [
        signal_ground,
        f"{_capitalize(adc_range)}.",
        f"T lies between {limits.min_tactile_v:.2f} V (20 N) and {limits.max_tactile_v:.2f} V (no force) above supply "
        f"ground. E rises to about {limits.max_envelope_v:.1f} V above signal ground: the rectifier's diode takes "
        f"{DIODE_V:g} V of the amplifier's typical swing.",
        swing,
        _load_note(values, design),
        f"D3 clamps T and D2 clamps E to within a diode drop of ground and +{supply_v:g} V. R7 to R9 limit the clamp "
        "current.",
        f"R8, C9, R9 and C19 (T) and R7 and C8 (E) are anti-aliasing filters for {design.detector.sample_rate_hz:g} "
        f"samples per second. In T they attenuate frequencies that alias to {values.aliasing.band_hz:.0f} Hz, the "
        f"upper end of the vibration band, by {-values.aliasing.tactile_alias_db:.0f} dB. For another sampling rate "
        "set `detector.sample_rate_hz`.",
        _source_note(values),
        _leak_note(values),
    ]
    return [*notes, *_controller_notes(values, design)] if SUPPLIES[values.supply].is_for_controller else notes


def _source_note(values: BoardValues) -> str:
    """State the source resistances of the pins, and what an ADC may draw from them."""
    limits, part = values.voltage_limits, values.by_reference
    pins = f"T {limits.tactile_pin_ohm / 1e3:.3g}k, E {limits.envelope_pin_ohm / 1e3:.3g}k"
    if SUPPLIES[values.supply].is_for_controller:
        pins += f", S {part['R27'] / 1e3:.3g}k, M {CABLE_OHM / 1e3:g}k"
    largest_ohm = max(limits.tactile_pin_ohm, limits.envelope_pin_ohm)
    return (
        f"Source resistances at the pins: {pins}. C8 and C19 lie at the pins and feed the sampling capacitor of an "
        f"ADC; it may be some pF. A leakage current of {1e9 * MAX_PIN_LEAK_V / largest_ohm:.0f} nA into a pin shifts "
        f"it by {1e3 * MAX_PIN_LEAK_V:g} mV, and an input resistance of 10 Mohm by {100 * largest_ohm / 1e7:.1f} %: "
        "look up both in the ADC's data sheet."
    )


def _leak_note(values: BoardValues) -> str:
    """Describe the shifts that the reverse currents of the clamps cause."""
    pins_ohm = values.voltage_limits.envelope_pin_ohm, values.voltage_limits.tactile_pin_ohm
    beginning = (
        "The reverse currents of the clamps flow through the resistors ahead of them: D2 shifts E in R7"
        f"{' and R6' if values.output_offset is None else ''}, and D3 shifts T in R8 and R9."
    )
    if SUPPLIES[values.supply].is_for_controller:
        worst = [1e3 * ohm * MAX_LOW_LEAKAGE_A for ohm in pins_ohm]
        return (
            f"{beginning} With {1e9 * MAX_LOW_LEAKAGE_A:g} nA (maximum of a {LOW_LEAKAGE_CLAMP}; unverified) these "
            f"shifts are {worst[0]:.2f} mV and {worst[1]:.2f} mV. {_leak_directions(values)}"
        )
    leaks = [[1e3 * ohm * current for ohm in pins_ohm] for current in (CLAMP_A, MAX_CLAMP_A)]
    return (
        f"{beginning} With the "
        f"{1e6 * CLAMP_A:g} uA of the SPICE model these shifts are at most {leaks[0][0]:.1f} mV and "
        f"{leaks[0][1]:.1f} mV, with {1e6 * MAX_CLAMP_A:g} uA (maximum of a BAT54; unverified) {leaks[1][0]:.0f} mV "
        f"and {leaks[1][1]:.0f} mV. {_leak_directions(values)}"
    )


def _controller_notes(values: BoardValues, design: Design) -> list[str]:
    """Describe what a controller reads beside tactile voltage and envelope."""
    supply_v, detector, aliasing = design.board.supply_v, design.detector, values.aliasing
    filtered_gain = aliasing.filtered_gain or 1.0
    return [
        f"S is the filtered signal ahead of the rectifier, centred at M ({values.voltage_limits.signal_ground_v:.2f} "
        f"V), with the pole of R27 and C25 and the clamp D5. From T to S the gain is {filtered_gain:.1f} at most: a "
        f"step of the ADC ({1e3 * detector.adc_step_v:.2g} mV) is {1e6 * detector.adc_step_v / filtered_gain:.2g} uV "
        f"of the tactile voltage there. What aliases to {aliasing.band_hz:.0f} Hz is "
        f"{-(aliasing.filtered_alias_db or 0.0):.0f} dB below what is there itself.",
        f"All amplifiers are supplied from 0 and +{supply_v:g} V, so T, S, E and M cannot leave this range, whatever "
        "the sensor does: while the supply rises, with the sensor open or shorted, and in a hard press.",
        f"T and M are fixed ratios of the supply (VREF, which feeds the bridge, is {VREF_RATIO:g} of it, M is "
        f"{SUPPLIES[values.supply].signal_ground_ratio:.3g} of it). If the ADC's reference is not the supply, read M "
        "and use the ratio T / M.",
    ]


def _leak_directions(values: BoardValues) -> str:
    """Describe where the reverse currents of both diodes of a clamp oppose each other."""
    if _is_single(values):
        return "Both diodes of each clamp block, and their currents oppose each other."
    return (
        "E, which lies near ground, is shifted upwards. At T both diodes block, and their currents oppose each other."
    )


def _load_note(values: BoardValues, design: Design) -> str:
    """Describe the loads of the amplifiers and their peak currents."""
    low_hz, high_hz = signal_band_hz(design.board.cutoff_hz)
    loads = ", ".join(
        f"{load.amplifier} {format_figure(load.min_ohm, 3)} ohm ({format_figure(1e3 * load.max_current_a, 2)} mA)"
        for load in values.amplifier_loads
    )
    if values.output_offset is None:
        rectifier = (
            "U1b also charges C4 through D1 while the diode conducts: its figures include this as an upper bound."
        )
    else:
        rectifier = "U3a drives R16 and R17 through D1; U3b drives R6 and C4, and its voltage falls as its load does."
    return (
        f"Between {low_hz:.4g} Hz and {high_hz:.4g} Hz, the band of the vibrations, the amplifiers drive at least "
        f"these loads, with these peak currents for the largest vibrations that are not clipped: {loads}. {rectifier} "
        "The output swing stated above holds for a lighter load, so the amplifiers may clip somewhat earlier."
        f"{_buffers_note(values)}"
    )


def _buffers_note(values: BoardValues) -> str:
    """Name the buffers whose load is not stated."""
    if SUPPLIES[values.supply].is_for_controller:
        return " The loads of U5 and U6, which buffer VMID and VREF, are not included."
    return " The load of U5, which buffers VMID, is not included." if _is_single(values) else ""


def _power_notes(values: BoardValues, design: Design) -> list[str]:
    """Requirements on the supply and, for variant comparator, on the input that S is connected to."""
    ripple, supply_v = values.supply_ripple, design.board.supply_v
    if SUPPLIES[values.supply].is_for_controller:
        return _controller_power_notes(values, design)
    effect = "makes the diode conduct" if values.output_offset is None else "counts as slip at the design's threshold"
    notes = [
        "The board has no reverse polarity protection: a reversed supply destroys it. Check the polarity of the plug "
        "for J2 with a meter before you connect the board.",
        f"The bridge is fed from +{supply_v:g} V. Ripple on this supply reaches the rectifier amplified up to "
        f"{ripple.gain:.0f} times, most at {format_figure(ripple.worst_hz, 2)} Hz (sensor open). Between "
        f"{ripple.low_hz:.3g} Hz and {ripple.high_hz / 1e3:g} kHz its peak must stay below {1e3 * ripple.max_v:.2g} "
        f"mV: more {effect}. Use a low-noise linear regulator near the board, and supply nothing else from it.",
    ]
    if values.comparator_levels:
        notes.append(
            f"S is an active-low logic output: low while slip is detected, and pulled up to +{supply_v:g} V by R21 "
            f"({PULL_UP_OHM / 1e3:g}k) otherwise. A 3.3 V input needs a divider or a level shifter."
        )
    return notes


def _controller_power_notes(values: BoardValues, design: Design) -> list[str]:
    """Describe protection and ripple of a board for a controller, and its slip output."""
    ripple, supply_v = values.supply_ripple, design.board.supply_v
    low_v, high_v = SUPPLY_RANGES_V[values.supply]
    effect = "makes the diode conduct" if values.output_offset is None else "counts as slip at the design's threshold"
    notes = [
        f"Supply {low_v:g} to {high_v:g} V at J2. Q1 blocks a reversed supply. It costs {1e3 * MAX_SWITCH_OHM:.0f} uV "
        f"per mA at most ({1e3 * MAX_SWITCH_OHM:g} mohm).",
        "The plugs of J1, J2 and J3 differ in size, and each fits one way round only.",
        "A divider, C23 and U6 feed the bridge with VREF, which follows the supply below 0.7 Hz only. Ripple on the "
        f"supply reaches the rectifier multiplied by {ripple.gain:.2f} at most, at "
        f"{format_figure(ripple.worst_hz, 2)} Hz ({describe_sensor(ripple)}). Between "
        f"{ripple.low_hz:.3g} Hz and "
        f"{ripple.high_hz / 1e3:g} kHz its peak must stay below {format_figure(1e3 * ripple.max_v, 2)} mV: more "
        f"{effect}. The supply rejection of the amplifiers themselves is not part of these figures.",
        "After power-up VMID and VREF rise with a time constant of a quarter of a second: wait 2 s.",
        "Feed the controller from the same 3.3 V. Then no signal exceeds its supply, and both go on and off together. "
        "The clamps lead to the supply of this board: they do not protect a controller that is off, or on less.",
    ]
    if values.comparator_levels:
        notes.append(
            f"SLIP is an active-low open collector with a pull-up to +{supply_v:g} V (R21, {PULL_UP_OHM / 1e3:g}k), "
            "which the hysteresis needs. Do not join the SLIP lines of two boards: each would change the threshold of "
            "the other."
        )
    return notes


def _limitations(values: BoardValues) -> list[str]:
    if SUPPLIES[values.supply].is_for_controller:
        return [
            "There is no protection against an excessive supply voltage.",
            "The filtered signal has less headroom than on the boards for 5 V: a fast press clips it for some "
            "milliseconds.",
        ]
    return [
        "There is no filter for the bridge's supply. A filter that rejects ripple at 30 Hz does not fit on this board.",
        "There is no protection against a reversed supply or an excessive supply voltage.",
    ]


def _offset_section(values: BoardValues, design: Design) -> str:
    """Section on the envelope offset, with the trimming procedure of variant comparator. Empty for variant article."""
    if values.output_offset is None:
        return ""
    offset = _paragraph(_describe_offset(values.output_offset, values, design))
    if values.comparator_levels:
        title, procedure = (
            "Envelope offset and threshold",
            trimming_procedure(values.comparator_levels, values, design),
        )
    else:
        is_single = _is_single(values)
        title = "Envelope offset"
        procedure = _paragraph(
            "Measure the idle level of the envelope at pin E of J3, with the ADC connected and nothing touching the "
            f"sensor: the mean of E against {'M' if is_single else 'ground'}. (TP4 lies ahead of R7, in which the "
            "reverse current of D2 shifts E.) This level consists of the envelope offset, the shift in R7 and the "
            f"mean due to noise ({1e3 * (values.noise.mean_envelope_v or 0.0):.1f} mV). The detector compares the "
            f"envelope reading {'(E minus M) ' if is_single else ''}with `detector.threshold_v` and subtracts no "
            "offset: subtract the measured level from the readings, or add it to `detector.threshold_v`."
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
    reference_point = "M or TP5, not against ground" if _is_single(values) else "ground (TP5)"
    slip = _slip_pin(values)
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
    numbered = "\n".join(_paragraph(step, f"{i}. ", "   ") for i, step in enumerate(steps, start=1))
    return f"{_paragraph(introduction)}\n\n{numbered}"


def _ordering_notes(circuit: Circuit, values: BoardValues, design: Design) -> list[str]:
    return [
        "Use 0.1 % resistors in the bridge (R10 to R13): an error of 1 % in one of them shifts the tactile voltage by "
        "about 0.1 V.",
        "C1 to C4 are in the signal path, and their capacitances set the cutoffs. `bom.csv` specifies C0G up to 100 nF "
        "and X7R above, because C0G capacitors of size 1206 end there, and the tolerance that is sold or that "
        "`board.capacitor_tolerance_percent` states. X7R capacitors of 5 %, as the article's, are rarely in stock; "
        "`--analysis` reports what 10 % cost. X7R also loses capacitance with direct voltage, which raises the cutoff. "
        "A film capacitor of the same value does not, if it fits the pads of size 1206.",
        "R6 and C4 are the article's R_LP and C_LP. KiCad requires references that end in a digit.",
        _noise_note(values, design),
        "Part numbers are copied from the sources that `bom.csv` names, and nobody checked what is in stock. Those of "
        "resistors without an LCSC number follow the maker's ordering code; whether every value is made was not "
        "checked. Compare the assembly house's preview of each part with its rating in `bom.csv`.",
        _rotation_note(circuit),
        "Nobody has built this board yet. It passes KiCad's electrical and design rules checks, and ngspice "
        "simulations agree with the formulas.",
    ]


def _rotation_note(circuit: Circuit) -> str:
    """State which packages the assembly house turns, and which its table of rotations does not have."""
    has_direction = [c for c in purchased_components(circuit) if is_assembled(c) and c.symbol not in _NO_DIRECTION]
    unknown = [c.reference for c in has_direction if find_rotation(c.footprint) is None]
    source = load_sources()[load_rotations()[0].source]
    return (
        f"Assembly houses rotate some components differently from KiCad. `placement_assembly.csv` has the offsets of "
        f"{source.title} ({source.address}). Packages that it lacks keep KiCad's rotation: {', '.join(unknown)}. "
        "Compare the house's preview with the rendering, above all the cathodes and pins 1."
    )


def _noise_note(values: BoardValues, design: Design) -> str:
    """Noise of the board, and the mean envelope due to it, compared with the threshold."""
    noise, capacitors = values.noise, values.first_stage_capacitors
    source = (
        f"The bridge's amplifier contributes {1e3 * noise.tactile_v:.1f} mV of noise (RMS, typical, against supply "
        "ground)."
    )
    analysis = "`--analysis` reports noise, offsets and tolerances of this board, and what"
    if noise.mean_envelope_v is None or capacitors is None:
        return (
            f"{source} The filters raise it to {1e3 * noise.filtered_without_limit_v:.2g} mV. The diode conducts "
            f"only from {DEAD_ZONE_V:g} V. This noise therefore does not reach the envelope, and neither does weak "
            f"slip. {analysis} a low-pass or a quieter amplifier would change."
        )
    threshold_v = design.detector.threshold_v
    note = (
        f"{source} The filters alone would raise it to {1e3 * noise.filtered_without_limit_v:.2g} mV. C20, the "
        f"low-pass of the first stage at {capacitors.limit_hz:.0f} Hz, reduces this to {1e3 * noise.filtered_v:.2g} "
        f"mV. The mean envelope due to noise is {1e3 * noise.mean_envelope_v:.1f} mV; the threshold is "
        f"{1e3 * threshold_v:g} mV. {analysis} a quieter amplifier would change."
    )
    warning = noise_warning(noise, threshold_v)
    return f"{note} **Warning: {warning}**" if warning else note


def _paragraph(text: str, first_indent: str = "", indent: str = "") -> str:
    """Wrap a text to lines of 120 characters."""
    return textwrap.fill(text, 120, initial_indent=first_indent, subsequent_indent=indent, break_on_hyphens=False)


def _capitalize(text: str) -> str:
    """Begin a text with a capital letter, and leave the rest as it is."""
    return text[:1].upper() + text[1:]


def _bullet_list(notes: Iterable[str]) -> str:
    return "\n".join(_paragraph(note, "- ", "  ") for note in notes)
