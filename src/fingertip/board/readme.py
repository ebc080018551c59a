"""README of the folder that a board is written to."""

from __future__ import annotations

from fingertip.board.analysis.figures import format_figure
from fingertip.board.board_values import BoardValues
from fingertip.board.circuit import Circuit
from fingertip.board.fabrication.bom import purchased_components
from fingertip.board.kicad.models import MODEL_FOLDER, MODEL_FOLDER_OF_KICAD, MODEL_VARIABLE
from fingertip.board.kicad.project import IGNORED_IN_SCHEMATIC, IGNORED_ON_BOARD
from fingertip.board.kicad.symbols import TEST_POINT
from fingertip.board.layout.template import load_template
from fingertip.board.readme_parts.cables import cable_notes, cable_table
from fingertip.board.readme_parts.connectors import connector_table
from fingertip.board.readme_parts.offset import offset_section
from fingertip.board.readme_parts.order_form import order_form
from fingertip.board.readme_parts.ordering import ordering_notes
from fingertip.board.readme_parts.power import limitation_notes, power_notes
from fingertip.board.readme_parts.signals import signal_notes
from fingertip.board.readme_parts.text import bullet_list, capitalize, paragraph
from fingertip.board.variants import BoardConfiguration
from fingertip.design import Design

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
