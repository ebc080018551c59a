"""Notes before ordering, in the README of a board: parts, rotations, noise."""

from __future__ import annotations

from dataclasses import replace

from fingertip.board.analysis.noise import noise_warning
from fingertip.board.analysis.supply_ripple import DEAD_ZONE_V
from fingertip.board.board_values import BoardValues
from fingertip.board.circuit import Circuit
from fingertip.board.fabrication.assembly import find_rotation, is_assembled, load_rotations, missing_numbers_note
from fingertip.board.fabrication.bom import purchased_components
from fingertip.board.kicad.symbols import CAPACITOR, RESISTOR
from fingertip.board.parts.table import load_sources
from fingertip.design import Design

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
