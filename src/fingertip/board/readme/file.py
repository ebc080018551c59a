"""The README of the folder a board is written to."""

from __future__ import annotations

from fingertip.board.circuit import Circuit, by_reference
from fingertip.board.readme.notes import before_power, listed, noise_words, paragraph, rest_and_threshold, signals
from fingertip.board.values.board_values import BoardValues
from fingertip.board.variants import Variant
from fingertip.design import Design

HEADING = "# The slip-filter board\n"

_TEXT = """
{what}
Achieved: gain {gain:.2f} ({gain_db:.2f} dB), 3 dB less at {cutoff:.2f} Hz and {upper:.5g} Hz; Q {quality:.4f}, envelope
decay {decay:.2f} ms.

| file | what it is |
| --- | --- |
| `{name}.kicad_pro` | KiCad 9 project: open this one |
| `{name}.kicad_sch` | schematic |
| `{name}.kicad_pcb` | layout, routed, with ground pour |
| `{name}.net` | the same circuit as a netlist, for other layouts |
| `{name}.cir` | SPICE deck: `ngspice -b {name}.cir` prints the filter's Bode table |
| `bom.csv` | parts to buy: quantities, values, what to look for |
| `values.json` | component values: ideal, preferred (fitted), the response each gives; limits; the article's slips |

`fingertip board DESIGN --out FOLDER` wrote them; the same design gives the same bytes. Change the cutoff, the gain or
the series of resistors in the design file, or on the command line (`--set board.cutoff_hz=80`), and run it again:
values change, places and tracks do not. `--set board.capacitor_series=E6` lets the board choose its capacitors too,
together with the resistors; `--set board.variant=` and `--set board.supply=` make the other boards. `--check` tells
whether a folder is current; `--fab` adds what is sent to a board house: gerbers and drill file in one zip, parts and
placement for the assembly, pictures (needs KiCad 9).

## Connectors

| connector | pin 1 (square) | pin 2 | pin 3 | pin 4 |{fifth_head}
| --- | --- | --- | --- | --- |{fifth_rule}
| J1, sensor | FSR | FSR, {rest} | | |{fifth_empty}
| J2, supply | + {supply:g} V | 0 | {minus} | |{fifth_empty}
| J3, to the converter | T: tactile voltage | E: envelope | 0 | {fourth} |{fifth}

{signals}

## Before you switch it on

{power}
{rest_level}
## Values

| part | value | what it does |
| --- | --- | --- |
{parts}

## What to know before ordering

- The bridge (R10 to R13) takes 0.1 % resistors: 1 % of one of them moves the tactile voltage by about 0.1 V.
- C1 to C4 are in the signal path: take film or C0G parts where the size allows, because X7R capacitors lose value with
  voltage and move the cutoff. `bom.csv` asks for the tolerance the design reckons with
  (`board.capacitor_tolerance_percent`); X7R parts of 5 % are made, but rarely stocked.
- R6 and C4 are the article's R_LP and C_LP; KiCad wants references that end in a digit.
{noise}
- Assembly houses turn some parts otherwise than KiCad: compare their preview with the picture.
- Nobody has built this board yet. Checked so far: KiCad's electrical and design rules, ngspice against the formulas.

## Where the article's figures do not add up

{findings}

## Known to be missing

- A filter for the bridge's supply: what keeps ripple of 30 Hz from it is too large for this board.
- Protection from a supply the wrong way round, and from too high a one.
"""

_WHAT = (
    "Variant `{variant}`, {supplied}: bridge and amplifier for the force-sensing resistor; {summary}; the way to the "
    "converter; the supply. {width:g} x {height:g} mm, two layers, all {count} parts in front."
)


def folder_readme(circuit: Circuit, variant: Variant, values: BoardValues, design: Design) -> bytes:
    """Markdown, UTF-8."""
    bought = sorted((part for part in circuit.parts if part.rating), key=by_reference)
    single, supply_v = values.supply == "single", design.board.supply_v
    what = _WHAT.format(
        variant=values.variant,
        supplied=variant.supply.words,
        summary=variant.kind.summary,
        width=variant.placement.width,
        height=variant.placement.height,
        count=len(bought),
    )
    text = _TEXT.format(
        name=circuit.name,
        what=paragraph(what),
        cutoff=values.achieved.cutoff_hz,
        upper=values.achieved.upper_cutoff_hz,
        gain=values.achieved.passband_gain,
        gain_db=values.achieved.passband_gain_db,
        quality=values.achieved.section_quality,
        decay=1e3 * values.achieved.envelope_decay_s,
        supply=supply_v,
        rest="the middle" if single else "ground",
        minus="" if single else f"- {supply_v:g} V",
        fourth=f"S: low while it slips, else + {supply_v:g} V" if values.decision else "0",
        fifth_head=" pin 5 |" if single else "",
        fifth_rule=" --- |" if single else "",
        fifth_empty=" |" if single else "",
        fifth=" M: where E rests |" if single else "",
        signals=signals(values, design),
        power=before_power(values, design),
        rest_level=rest_and_threshold(values, design),
        noise=listed([noise_words(values, design)]),
        findings="\n".join(
            paragraph(f"{found.subject}: the article says {found.says}. Right: {found.right}.", "- ", "  ")
            for found in values.findings
        ),
        parts="\n".join(f"| {part.reference} | {part.value} | {part.role} |" for part in bought),
    )
    return (HEADING + text).encode()
