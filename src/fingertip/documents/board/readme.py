"""README of the folder that a board is written to."""

from __future__ import annotations

from dataclasses import replace

from fingertip.board.analysis.board_values import BoardValues
from fingertip.board.analysis.interference import DEAD_ZONE_V
from fingertip.board.analysis.noise import noise_warning
from fingertip.board.fabrication.bom import (
    find_rotation,
    is_assembled,
    load_rotations,
    missing_numbers_note,
    purchased_components,
)
from fingertip.board.kicad.footprints import FOOTPRINTS
from fingertip.board.kicad.models import MODEL_FOLDER, MODEL_FOLDER_OF_KICAD, MODEL_VARIABLE
from fingertip.board.kicad.placement import Placement, Template, load_template
from fingertip.board.kicad.project import (
    BOARD_THICKNESS_MM,
    CLEARANCE_MM,
    COPPER_OZ,
    IGNORED_IN_SCHEMATIC,
    IGNORED_ON_BOARD,
    VIA_DRILL_MM,
    VIA_MM,
)
from fingertip.board.kicad.variants import BoardConfiguration
from fingertip.board.parts.circuit import Circuit
from fingertip.board.parts.mating import (
    MatingPart,
    count_wires,
    group_plug_wires,
    list_connectors,
    list_mating_parts,
)
from fingertip.board.parts.select_part import NO_LCSC
from fingertip.board.parts.symbols import CAPACITOR, RESISTOR, TEST_POINT
from fingertip.board.parts.table import load_sources
from fingertip.design import Design
from fingertip.documents.board.connectors import bullet_list, capitalize, connector_table, paragraph
from fingertip.documents.board.signals import limitation_notes, offset_section, power_notes, signal_notes
from fingertip.foundation.files import format_figure

# Notes before ordering, in the README of a board: parts, rotations, noise.


_NO_DIRECTION = (RESISTOR, CAPACITOR)
"""Symbols of components that may be turned by 180 degrees."""


def ordering_notes(circuit: Circuit, values: BoardValues, design: Design) -> list[str]:
    """Notes on what to buy, and on what nobody has checked."""
    return [
        *_precision_notes(circuit, values, design.board.supply_v),
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
        *filter(None, [missing_numbers_note(circuit)]),
        _rotation_note(circuit),
        "Nobody has built this board yet. It passes KiCad's electrical and design rules checks, and ngspice "
        "simulations agree with the formulas.",
    ]


def _precision_notes(circuit: Circuit, values: BoardValues, supply_v: float) -> list[str]:
    """Say what an error of the bridge's resistors does, and why others are as precise."""
    bridge = values.bridge
    names = ("sensor_top_ohm", "sensor_shunt_ohm", "reference_top_ohm", "reference_bottom_ohm")
    idle_v = bridge.tactile_v(0.0, supply_v)
    changed = [replace(bridge, **{name: 1.01 * getattr(bridge, name)}) for name in names]
    largest_v = max(abs(each.tactile_v(0.0, supply_v) - idle_v) for each in changed)
    notes = [
        "Use 0.1 % resistors in the bridge (R10 to R13): an error of 1 % in one of them shifts the tactile voltage by "
        f"up to {largest_v:.2f} V."
    ]
    reasons = {
        "R14": "sets the gain of the bridge's amplifier",
        "R22": "sets signal ground with R23",
        "R25": "sets the bridge's supply with R26",
    }
    precise = {c.reference for c in circuit.components if c.requirement and c.requirement.tolerance_percent <= 0.1}
    listed = [f"{reference} {reason}" for reference, reason in reasons.items() if reference in precise]
    if listed:
        notes.append(
            f"These are 0.1 % too, because T is calibrated once and must not drift with them: {'; '.join(listed)}."
        )
    return notes


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


# Cables of a board, in its README: plugs, contacts or finished leads to buy, and the wires they take.


def cable_table(circuit: Circuit) -> str:
    """Table of what to buy for each connector's cable, in Markdown."""
    rows = [("for", "count", "part", "number", "LCSC", "source, or why a number is missing"), ("---",) * 6]
    for connector in list_connectors(circuit):
        wires = count_wires(connector)
        for mating in list_mating_parts(connector):
            rows.append((connector.reference, str(mating.count(wires)), mating.item, *_describe_numbers(mating)))
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def cable_notes(circuit: Circuit) -> list[str]:
    """Notes on the wires and on the making of the cables."""
    found = group_plug_wires(circuit)
    if not found:
        return ["The socket's maker states which wires it takes. The sensor's must fit the finger too: its "
                "`acceptance.md` states which do."]  # fmt: skip
    sources = load_sources()
    return [
        *(
            f"Wires of {' and '.join(references)} ({wire.series}): {wire.description} ({sources[wire.source].title})."
            for wire, references in found.items()
        ),
        "The wires of the sensor must fit the finger too: its `acceptance.md` states which fit both.",
        "A lead with a contact at each end, cut in two, gives two wires. All leads are black: mark them at the far "
        "end. Contacts are crimped with a tool made for them, not soldered.",
        "Where a field is empty, no document that was read gives the number. Nobody checked what is in stock.",
    ]


def _describe_numbers(mating: MatingPart) -> tuple[str, str, str]:
    if mating.part is None:
        return "", "", mating.reason
    source = load_sources()[mating.part.source].title
    missing = "" if mating.part.lcsc else f"; {NO_LCSC}"
    return f"{mating.part.manufacturer} {mating.part.number}", mating.part.lcsc, f"{source}{missing}"


# Order form of a board, in its README: what the forms of board house and assembly house ask for.


def order_form(circuit: Circuit, placement: Placement, template: Template) -> str:
    """Table of the figures that an order asks for, in Markdown."""
    components = purchased_components(circuit)
    narrowest_mm = min(width for tracks in template.tracks.values() for *_, width in tracks.segments)
    unplated_mm = sorted(
        {p.drill for c in circuit.components for p in FOOTPRINTS[c.footprint].pads if p.drill and not p.is_plated}
    )
    through_hole = [c.reference for c in components if _is_through_hole(c.footprint)]
    by_house = [r for r in through_hole if is_assembled(circuit.component(r))]
    by_hand = [r for r in through_hole if r not in by_house]
    assembled = sum(map(is_assembled, components))
    rows = [
        ("files", f"`fab/{circuit.name}_gerbers.zip`"),
        ("layers", "2"),
        ("size", f"{placement.width:g} x {placement.height:g} mm, one board, no panel"),
        ("thickness", f"{BOARD_THICKNESS_MM:g} mm"),
        ("copper", f"{COPPER_OZ:g} oz (35 um) outside"),
        ("narrowest track, least clearance", f"{narrowest_mm:g} mm, {CLEARANCE_MM:g} mm"),
        ("vias", f"{VIA_MM:g} mm, drill {VIA_DRILL_MM:g} mm"),
        ("unplated holes", ", ".join(f"{mm:g} mm" for mm in unplated_mm)),
        ("finish", "lead-free HASL or ENIG"),
        ("colours of mask and print", "any"),
        ("assembly", f"front only, {assembled} components, with a stencil for the front"),
        ("parts and placement", "`fab/bom_assembly.csv`, `fab/placement_assembly.csv`"),
    ]
    if by_house:
        rows.append(
            ("through hole", f"{', '.join(by_house)}: a service that costs extra at most houses; or solder it yourself")
        )
    if by_hand:
        rows.append(("through hole", f"{', '.join(by_hand)}: not in the files for assembly; solder them yourself"))
    table = [("what the form asks", "this board"), ("---", "---"), *rows]
    return "\n".join("| " + " | ".join(row) + " |" for row in table)


def _is_through_hole(footprint: str) -> bool:
    return any(pad.drill and pad.is_plated for pad in FOOTPRINTS[footprint].pads)


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
and run the command again. Unless variant or supply change, only component values do, neither placement nor tracks. A
schematic or layout that you edited in KiCad keeps your edits: values and part numbers that the design changes are
entered into it, and nothing else. If parts, footprints or nets change, nothing is written; `--force` overwrites your
edits.

- `--set board.capacitor_series=E6` selects the capacitors too, together with the resistors; `preferred` selects only
  values that the parts table has.
- `--set board.variant=...` and `--set board.supply=...` write the other boards: to a folder that `--out` names, or over
  the board in the default folder with `--force`.
- `--bringup` adds `bringup.md`, how to test a soldered board, and `wiring.svg`, how to connect it.
- `--check` tells whether a folder is up to date.
- `--fab` adds the fabrication files: gerbers and drill files in one zip, renderings, and parts and placement for the
  assembly: `bom_assembly.csv` and `placement_assembly.csv` in the columns and with the rotations of JLCPCB,
  `{name}_placement.csv` with KiCad's rotations for any other house; `{name}_assembly.pdf`, the place of every part by
  its reference. It needs KiCad 9.

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

## What else to buy

Plugs and wires for the connectors. Nothing of this is on the board, so `bom.csv` does not list it.

{cables}

{cable_notes}

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

## Order form

{order_form}

## Before you order

{ordering}

## Errata of the article

{errata}

## Known limitations

{limitations}
"""

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
        ignored=bullet_list(
            f"{rules}, `{name}`: {reason}."
            for rules, checks in (("ERC", IGNORED_IN_SCHEMATIC), ("DRC", IGNORED_ON_BOARD))
            for name, reason in checks.items()
        ),
        summary=_summary(configuration, values, len(components)),
        connectors=connector_table(values, design),
        cables=cable_table(circuit),
        cable_notes=bullet_list(cable_notes(circuit)),
        test_points="\n".join(
            f"| {c.reference} | {c.value} | {_TEST_POINT_SIGNALS[c.value]} |"
            for c in circuit.components
            if c.symbol == TEST_POINT
        ),
        signals=bullet_list(signal_notes(values, design)),
        power=bullet_list(power_notes(values, design)),
        offset=offset_section(values, design),
        components="\n".join(f"| {c.reference} | {c.value} | {c.role} |" for c in components),
        order_form=order_form(
            circuit,
            configuration.placement,
            load_template(configuration.name, circuit, configuration.placement),
        ),
        ordering=bullet_list(ordering_notes(circuit, values, design)),
        limitations=bullet_list(limitation_notes(values)),
        errata=bullet_list(
            f"{capitalize(e.subject)}. Article: {e.statement}. Correct: {e.correction}." for e in values.errata
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
        f"; {len(unlabelled)} of them have no reference on the front, so look them up in the assembly drawing "
        "(`--fab`) or the layout."
        if unlabelled
        else "."
    )
    upper = format_figure(response.upper_cutoff_hz)
    achieved = (
        f"Achieved response: gain {response.passband_gain:.2f} ({response.passband_gain_db:.2f} dB), -3 dB at "
        f"{response.cutoff_hz:.2f} Hz and {upper} Hz, Q {response.section_quality:.4f}, "
        f"envelope time constant {1e3 * response.envelope_decay_s:.2f} ms."
    )
    return f"{paragraph(what)}\n\n{paragraph(achieved)}"
