"""The README of the folder a board is written to."""

from __future__ import annotations

from fingertip.board.circuit import Circuit, by_reference
from fingertip.board.values import BoardValues
from fingertip.board.variants import Variant

HEADING = "# The slip-filter board\n"

_TEXT = """
Variant `{variant}`: bridge and amplifier for the force-sensing resistor; {summary};
the way to the converter; the supply. {width:g} x {height:g} mm, two layers, all {count} parts in front.
Achieved: -3 dB at {cutoff:.2f} Hz, gain {gain:.2f} ({gain_db:.2f} dB), Q {quality:.4f}, envelope decay {decay:.2f} ms.

| file | what it is |
| --- | --- |
| `{name}.kicad_pro` | KiCad 9 project: open this one |
| `{name}.kicad_sch` | schematic |
| `{name}.kicad_pcb` | layout, routed, with ground pour |
| `{name}.net` | the same circuit as a netlist, for other layouts |
| `{name}.cir` | SPICE deck: `ngspice -b {name}.cir` prints the filter's Bode table |
| `bom.csv` | parts to buy: quantities, values, what to look for |
| `values.json` | component values: ideal, preferred (fitted), the response each gives; the article's slips |

`fingertip board DESIGN --out FOLDER` wrote them; the same design gives the same bytes. Change the cutoff, the gain or
the series of resistors in the design file, or on the command line (`--set board.cutoff_hz=80`), and run it again:
values change, places and tracks do not. `--check` tells whether a folder is current; `--fab` adds what is sent to a
board house: gerbers and drill file in one zip, parts and placement for the assembly, pictures (needs KiCad 9).

## Connectors

| connector | pin 1 (square) | pin 2 | pin 3 | pin 4 |
| --- | --- | --- | --- | --- |
| J1, sensor | FSR | FSR, ground | | |
| J2, supply | + {supply:g} V | 0 | - {supply:g} V | |
| J3, to the converter | T: tactile voltage | E: envelope | 0 | {fourth} |

A converter for plus and minus 10 V sees the signals as they are. D2 and D3 keep them between ground and + {supply:g} V
(and a diode's drop beyond), R7 and R8 limit what flows then.

## Values

| part | value | what it does |
| --- | --- | --- |
{parts}

## What to know before ordering

- The bridge (R10 to R13) takes 0.1 % resistors: 1 % of one of them moves the tactile voltage by about 0.1 V.
- C1 to C4 are in the signal path: take film or C0G parts where the size allows, because X7R capacitors lose value with
  voltage and move the cutoff.
- R6 and C4 are the article's R_LP and C_LP; KiCad wants references that end in a digit.
- `--analysis` gives noise, offsets and tolerances. With the default values the bridge's amplifier alone leaves 0.3 mV
  of noise (rms, typical), which the filters make 19 mV. Variant `paper` does not see it for its diode's dead zone, nor
  weak slip; the mean of the other variants' rectifier then rests at 8 mV, below the threshold of 17 mV.
- Assembly houses turn some parts otherwise than KiCad: compare their preview with the picture.
- Nobody has built this board yet. Checked so far: KiCad's electrical and design rules, ngspice against the formulas.
"""


def folder_readme(circuit: Circuit, variant: Variant, values: BoardValues, supply_v: float) -> bytes:
    """Markdown, UTF-8."""
    bought = sorted((part for part in circuit.parts if part.rating), key=by_reference)
    text = _TEXT.format(
        name=circuit.name,
        variant=variant.name,
        summary=variant.summary,
        width=variant.placement.width,
        height=variant.placement.height,
        count=len(bought),
        cutoff=values.achieved.cutoff_hz,
        gain=values.achieved.passband_gain,
        gain_db=values.achieved.passband_gain_db,
        quality=values.achieved.section_quality,
        decay=1e3 * values.achieved.envelope_decay_s,
        supply=supply_v,
        fourth="S: low while it slips" if any(part.reference == "U4" for part in circuit.parts) else "0",
        parts="\n".join(f"| {part.reference} | {part.value} | {part.role} |" for part in bought),
    )
    return (HEADING + text).encode()
