"""Outputs that a sweep can compute for a point, and the groups in which they are computed.

All outputs of a group come from one computation. A group is computed only if the sweep asks for one of its outputs,
and again only if a table that it reads has changed. This module imports nothing heavy; the computations themselves are
in `fingertip.sweep.compute`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from fingertip.design.parameters.declaration import suggest_name
from fingertip.foundation.errors import Issue

FINGER = frozenset({"sensor", "custom_sensor", "bone", "hand", "skin"})
"""Tables that define the shape of the finger."""
CLOSED_MOLD = FINGER | {"mold"}
"""Tables that define the shape of finger and mold."""
MOLD = CLOSED_MOLD | {"printer"}
"""Tables that define the mold around the cavity, whose walls are as thick as the printer needs, and the play in it."""
PARTS = MOLD | {"name", "strength", "silicone"}
"""Tables that the checks of the printed parts read: the mold halves carry the design's name, and the printer's scale
and limits, the loads and the silicone decide on the checks."""
SIMULATION = FINGER | {"board", "detector", "mold", "force_curve"}
"""Tables that a simulation can depend on. It uses the pad's shape, which is derived together with the mold's
lengths."""


@dataclass(frozen=True)
class OutputGroup:
    """Outputs that one computation gives together."""

    name: str
    reads: frozenset[str]
    """Tables of the design that the outputs can depend on; `scene` stands for the scene."""
    cost: int
    """Rank by computing time. Axes that expensive groups read vary slowest, so that neighbouring points share their
    results."""
    ignores: frozenset[str] = frozenset()
    """Parameters of those tables, dotted, that the outputs do not depend on."""

    def depends_on(self, parameter: str) -> bool:
        """Return whether the outputs can change with a parameter, dotted."""
        return parameter.partition(".")[0] in self.reads and parameter not in self.ignores


GROUPS = {
    group.name: group
    for group in (
        OutputGroup("lengths", MOLD, 0),
        OutputGroup("play", MOLD, 1),
        OutputGroup("board", frozenset({"board", "detector", "sensor", "custom_sensor"}), 1),
        OutputGroup("acceptance", frozenset({"board", "detector", "sensor", "custom_sensor", "force_curve"}), 1),
        OutputGroup("noise", frozenset({"board", "detector"}), 1),
        OutputGroup("circuit", frozenset({"board", "detector", "sensor", "custom_sensor"}), 1),
        OutputGroup("detection", SIMULATION | {"scene"}, 2),
        OutputGroup("simulation", SIMULATION | {"scene"}, 3),
        OutputGroup("skin", CLOSED_MOLD, 4),
        OutputGroup("bone", CLOSED_MOLD, 4),
        OutputGroup("mold", MOLD | {"name"}, 4),
        OutputGroup("strength", CLOSED_MOLD | {"strength"}, 4),
        OutputGroup("filling", MOLD | {"silicone"}, 4),
        OutputGroup("walls", MOLD, 5),
        OutputGroup("printing", MOLD | {"name"}, 5),
        OutputGroup("thickness", CLOSED_MOLD, 4),
        OutputGroup("casting", MOLD | {"name", "silicone"}, 5),
        OutputGroup("checks", PARTS, 6),
    )
}
"""Group name -> group, from the cheapest to the most expensive."""

TRACES = OutputGroup(
    "traces", SIMULATION | {"scene"}, 3, frozenset({"detector.window_samples", "detector.threshold_v"})
)
"""Simulated trials that the detection outputs are computed from. They do not depend on the detector's window and
threshold, so points that differ only in those share them."""


@dataclass(frozen=True)
class SweepOutput:
    """Number that a sweep can compute for a point."""

    name: str
    """Name with the unit."""
    group: str
    description: str


OUTPUTS = {
    output.name: output
    for output in (
        SweepOutput(
            "finger_length_mm", "lengths", "from the tip to the joint axis, or else to the interface's shoulder"
        ),
        SweepOutput("sensor_rim_mm", "lengths", "width of flat bone left around the sensor and its rim; 0: just fits"),
        SweepOutput("mold_width_mm", "lengths", "closed mold, width across the finger"),
        SweepOutput("mold_height_mm", "lengths", "closed mold, height from the palmar to the dorsal face"),
        SweepOutput("mold_length_mm", "lengths", "closed mold, length along the finger"),
        SweepOutput("skin_volume_mm3", "skin", "volume of the silicone skin"),
        SweepOutput("skin_area_mm2", "skin", "surface area of the skin, inside and outside"),
        SweepOutput("bone_volume_mm3", "bone", "volume of the printed bone"),
        SweepOutput("bone_mass_g", "bone", "mass of the printed bone at print_density_g_cm3"),
        SweepOutput("grip_safety_factor", "strength", "strength of the bone over its stress at strength.grip_force_n"),
        SweepOutput("shock_safety_factor", "strength", "the same at strength.shock_force_n; below 1 the bone breaks"),
        SweepOutput("filament_grip_safety_factor", "strength", "at the grip, printed upright from the filament PETG"),
        SweepOutput("weakest_z_mm", "strength", "height of the bone's weakest cross-section"),
        SweepOutput("tendon_force_n", "strength", "force of a clevis's tendon at the grip force on the apex"),
        SweepOutput("min_bone_wall_mm", "walls", "thinnest wall of bone and lid, as their checks measure it"),
        SweepOutput("mold_palmar_volume_mm3", "mold", "volume of the palmar mold half"),
        SweepOutput("mold_dorsal_volume_mm3", "mold", "volume of the dorsal mold half"),
        SweepOutput("mold_mass_g", "mold", "mass of both mold halves at print_density_g_cm3"),
        SweepOutput("min_skin_thickness_mm", "thickness", "minimum silicone thickness between bone and surface"),
        SweepOutput("silicone_in_mold_g", "casting", "mass of silicone that fills the mold"),
        SweepOutput("silicone_g", "casting", "mass of silicone to mix, with waste; never less than can be weighed"),
        SweepOutput("skin_pull_off_n", "casting", "pull that the groove or a tight sleeve resists, without adhesion"),
        SweepOutput("fill_time_s", "filling", "time in which the mold fills, at mold.thumb_force_n or by gravity"),
        SweepOutput("thumb_force_n", "filling", "force on the syringe that fills the mold in 60 s"),
        SweepOutput("injected_cm3", "filling", "silicone that the syringe must hold"),
        SweepOutput("trapped_air_mm3", "filling", "largest bubble that no vent lets out"),
        SweepOutput("gate_pressure_kpa", "filling", "largest pressure in the cavity while the front moves"),
        SweepOutput("opening_force_n", "filling", "force that opens the mold when the plunger meets full vents"),
        SweepOutput("leak_mm", "filling", "length along the base over which silicone creeps until it sets"),
        SweepOutput("retained_over_sensor_percent", "play", "skin left over the sensor if the bone lies off"),
        SweepOutput("retained_elsewhere_percent", "play", "skin left at the worst other place"),
        SweepOutput("max_overhang_mm2", "printing", "largest unsupported overhang of all printed parts"),
        SweepOutput("tactile_open_v", "acceptance", "tactile voltage of an untouched finger"),
        SweepOutput("tactile_100g_v", "acceptance", "expected tactile voltage with 100 g on the pad"),
        SweepOutput("tactile_500g_v", "acceptance", "expected tactile voltage with 500 g on the pad"),
        SweepOutput("tactile_drop_ratio", "acceptance", "drop of the tactile voltage at 500 g over that at 100 g"),
        SweepOutput("checks_failed", "checks", "number of failed checks of `fingertip check`, at tolerance_mm"),
        SweepOutput("checks_warned", "checks", "number of checks that passed but warn, as of a bone that would break"),
        SweepOutput("checks_run", "checks", "number of checks that were run"),
        SweepOutput("board.r1_ohm", "board", "preferred value: pole of the first stage"),
        SweepOutput("board.r2_ohm", "board", "preferred value: Sallen-Key section, feedback resistor"),
        SweepOutput("board.r3_ohm", "board", "preferred value: Sallen-Key section, resistor to ground"),
        SweepOutput("board.r4_ohm", "board", "preferred value: gain, resistor to ground"),
        SweepOutput("board.r5_ohm", "board", "preferred value: gain, feedback resistor"),
        SweepOutput("board.r_lp_ohm", "board", "preferred value: resistor of the envelope filter"),
        SweepOutput("board.c_uf", "board", "capacitors of both filter stages, as given or as selected"),
        SweepOutput("board.c_lp_uf", "board", "capacitor of the envelope filter, as given or as selected"),
        SweepOutput("gain", "board", "achieved passband gain"),
        SweepOutput("gain_db", "board", "achieved passband gain [dB]"),
        SweepOutput("first_pole_hz", "board", "achieved pole frequency of the first stage"),
        SweepOutput("section_hz", "board", "achieved f0 of the Sallen-Key section"),
        SweepOutput("q", "board", "achieved quality factor of the Sallen-Key section; 1 in a Butterworth filter"),
        SweepOutput("cutoff_3db_hz", "board", "achieved -3 dB frequency of the whole filter"),
        SweepOutput("cutoff_error_percent", "board", "achieved -3 dB frequency relative to board.cutoff_hz"),
        SweepOutput("envelope_pole_hz", "board", "achieved pole frequency of the envelope filter"),
        SweepOutput("envelope_decay_ms", "board", "achieved time constant of the envelope filter"),
        SweepOutput("amplifier_bandwidth_hz", "board", "upper band limit set by the first stage's amplifier"),
        SweepOutput("upper_cutoff_hz", "board", "achieved upper -3 dB frequency of the whole filter"),
        SweepOutput("filter_noise_v", "circuit", "RMS noise of the board ahead of the rectifier"),
        SweepOutput("max_ripple_v", "circuit", "peak of supply ripple that alone reaches the threshold"),
        SweepOutput("max_envelope_offset_v", "circuit", "maximum envelope offset; NaN in variant article"),
        SweepOutput("vibration_peak_v", "circuit", "largest vibration of the tactile voltage that is not clipped"),
        SweepOutput(
            "bridge_amplifier_margin_v", "circuit", "margin of the bridge amplifier's voltages to their limits"
        ),
        SweepOutput("filter_load_ohm", "circuit", "smallest impedance that an amplifier of the filter drives"),
        SweepOutput("gate_margin", "circuit", "smallest ratio of a required condition to its limit; 1 or more holds"),
        SweepOutput("output_current_margin", "circuit", "current of the amplifiers' data sheets over that drawn"),
        SweepOutput("offset_margin", "circuit", "permitted offset of the filter's outputs over their largest"),
        SweepOutput("gain_bandwidth_margin", "circuit", "gain-bandwidth product of the amplifier over that needed"),
        SweepOutput("phase_margin_deg", "circuit", "smallest phase margin of an amplifier"),
        SweepOutput("peaking_db", "circuit", "largest gain beyond the band over that of the passband"),
        SweepOutput("adc_margin", "circuit", "range of the converter over the idle level, or the clamps' rail"),
        SweepOutput("odd_capacitors", "circuit", "number of capacitors off series E12"),
        SweepOutput("mean_threshold_v", "circuit", "mean of the comparator's threshold; NaN in other variants"),
        SweepOutput("min_threshold_worst_v", "circuit", "lowest threshold of a comparator, untrimmed, 0 to 50 C"),
        SweepOutput("max_threshold_worst_v", "circuit", "highest threshold of a comparator, untrimmed, 0 to 50 C"),
        SweepOutput("noise_level_v", "noise", "mean of the averaged envelope for noise alone"),
        SweepOutput("min_threshold_v", "noise", "noise_level_v plus six standard deviations (the article's rule)"),
        SweepOutput("delay_ms", "detection", "median detection delay of all slips; inf: fewer than half detected"),
        SweepOutput("delay_p90_ms", "detection", "90th percentile of the delay; inf: fewer than 90 % detected"),
        SweepOutput(
            "motion_delay_ms", "detection", "median delay since the robot moved; encoders at 100 Hz: 0-10 less"
        ),
        SweepOutput("motion_delay_p90_ms", "detection", "90th percentile of that delay; inf: fewer than 90 % detected"),
        SweepOutput("found_share", "detection", "share of the slips that were detected, 0 to 1"),
        SweepOutput("false_alarms_per_min", "detection", "alarms without slip per simulated minute"),
        SweepOutput("slips", "detection", "number of slips in the trials"),
        SweepOutput("slip_onset_ms", "detection", "median true onset of slip after the slide starts; NaN: no slip"),
        SweepOutput(
            "slip_vibration_n", "detection", "median RMS of the normal force above 30 Hz in slip; NaN: no slip"
        ),
        SweepOutput(
            "simulation.force_error_mn", "simulation", "largest error of force_n in the first trial, by its time step"
        ),
        SweepOutput("simulation.voltage_error_mv", "simulation", "the same of voltage_v; resolution: one ADC step"),
        SweepOutput("simulation.envelope_error_mv", "simulation", "the same of envelope_v"),
        SweepOutput(
            "simulation.delay_shift_samples",
            "simulation",
            "shift of its delay by the time step; inf: found with one step only, NaN: with none",
        ),
    )
}


def find_groups(outputs: Iterable[str]) -> tuple[OutputGroup, ...]:
    """Find the groups that give these outputs, each once, cheapest first."""
    names = {OUTPUTS[name].group for name in outputs}
    return tuple(group for group in GROUPS.values() if group.name in names)


def find_shareable(outputs: Iterable[str]) -> tuple[OutputGroup, ...]:
    """Find everything that points can share: the groups of these outputs, and the simulated trials."""
    groups = find_groups(outputs)
    return (*groups, TRACES) if any(group.name == "detection" for group in groups) else groups


def check_output_names(outputs: Iterable[str]) -> list[Issue]:
    names = list(outputs)
    issues = []
    for name in dict.fromkeys(names):
        if name not in OUTPUTS:
            suggestion = suggest_name(name.lower(), tuple(OUTPUTS))
            remedy = suggestion if suggestion.startswith("did you mean") else "see fingertip sweep --outputs."
            issues.append(Issue("outputs", f"{name!r} is not an output; {remedy}"))
        elif names.count(name) > 1:
            issues.append(Issue("outputs", f"{name!r} is listed {names.count(name)} times; list it once."))
    return issues
