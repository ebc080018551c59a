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
CLOSED_MOLD = FINGER | {"mold"}
MOLD = CLOSED_MOLD | {"printer"}
"""Tables that define the mold around the cavity, whose walls are as thick as the printer needs, and the play in it."""
PARTS = MOLD | {"name", "strength", "silicone"}
"""Tables that the checks of the printed parts read: the mold halves carry the design's name, and the printer's scale
and limits, the loads and the silicone decide on the checks."""
SIMULATION = FINGER | {"board", "detector", "mold", "force_curve", "silicone"}
"""Tables that a simulation can depend on; the pad's form is derived together with the mold's lengths."""


@dataclass(frozen=True)
class OutputGroup:
    """Outputs that one computation gives together."""

    name: str
    reads: frozenset[str]
    """Tables of the design that the outputs can depend on; `scene` stands for the scene."""
    cost: int
    """Rank by computing time. Axes that expensive groups read vary slowest."""
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
        OutputGroup("controller", frozenset({"detector"}), 1),
        OutputGroup("acceptance", frozenset({"board", "detector", "sensor", "custom_sensor", "force_curve"}), 1),
        OutputGroup("noise", frozenset({"board", "detector"}), 1),
        OutputGroup("pad", FINGER | {"silicone", "force_curve"}, 1),
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
"""Simulated trials, which points share that differ in the detector's window or threshold only."""


@dataclass(frozen=True)
class SweepOutput:
    """Number that a sweep can compute for a point."""

    name: str
    """Name with the unit."""
    group: str
    description: str


OUTPUTS = {
    name: SweepOutput(name, group, description)
    for name, group, description in (
        ("finger_length_mm", "lengths", "from the tip to the joint axis, or else to the interface's shoulder"),
        ("sensor_rim_mm", "lengths", "width of flat bone left around the sensor and its rim; 0: just fits"),
        ("mold_width_mm", "lengths", "closed mold, width across the finger"),
        ("mold_height_mm", "lengths", "closed mold, height from the palmar to the dorsal face"),
        ("mold_length_mm", "lengths", "closed mold, length along the finger"),
        ("skin_volume_mm3", "skin", "volume of the silicone skin"),
        ("skin_area_mm2", "skin", "surface area of the skin, inside and outside"),
        ("bone_volume_mm3", "bone", "volume of the printed bone"),
        ("bone_mass_g", "bone", "mass of the printed bone at print_density_g_cm3"),
        ("grip_safety_factor", "strength", "strength of the bone over its stress at strength.grip_force_n"),
        ("shock_safety_factor", "strength", "the same at strength.shock_force_n; below 1 the bone breaks"),
        ("weakest_z_mm", "strength", "height of the bone's weakest cross-section"),
        ("tendon_force_n", "strength", "force of a clevis's tendon at the grip force on the apex"),
        ("pad_share", "pad", "least share of 1 N that reaches the sensor, at tilts of 0 to 10 degrees"),
        ("pad_share_wide", "pad", "the same at tilts of -5 to 15 degrees; 0 also where the bone touches first"),
        ("pad_share_rolled", "pad", "share at a roll of 10 degrees"),
        ("pad_evenness", "pad", "least over largest share, at tilts of 0 to 10 degrees"),
        ("pad_turn_on_n", "pad", "force on the pad at turn-on, worst of -5 to 15 degrees; NaN: not below 20 N"),
        ("pad_stiffness_n_per_mm", "pad", "stiffness of the pad at 1 N"),
        ("pad_strain", "pad", "indentation over thickness at 5 N"),
        ("pad_own_mode_hz", "pad", "lowest resonance of the silicone over the sensor, which simulations leave out"),
        ("min_bone_wall_mm", "walls", "thinnest wall of bone and lid, as their checks measure it"),
        ("mold_palmar_volume_mm3", "mold", "volume of the palmar mold half"),
        ("mold_dorsal_volume_mm3", "mold", "volume of the dorsal mold half"),
        ("mold_mass_g", "mold", "mass of both mold halves at print_density_g_cm3"),
        ("min_skin_thickness_mm", "thickness", "minimum silicone thickness between bone and surface"),
        ("silicone_in_mold_g", "casting", "mass of silicone that fills the mold"),
        ("silicone_g", "casting", "mass of silicone to mix, with waste; never less than can be weighed"),
        ("skin_pull_off_n", "casting", "pull that the groove or a tight sleeve resists, without adhesion"),
        ("fill_time_s", "filling", "time in which the mold fills, at mold.thumb_force_n or by gravity"),
        ("thumb_force_n", "filling", "force on the syringe that fills the mold in 60 s"),
        ("injected_cm3", "filling", "silicone that the syringe must hold"),
        ("trapped_air_mm3", "filling", "largest bubble that no vent lets out"),
        ("gate_pressure_kpa", "filling", "largest pressure in the cavity while the front moves"),
        ("opening_force_n", "filling", "force that opens the mold when the plunger meets full vents"),
        ("leak_mm", "filling", "length along the base over which silicone creeps until it sets"),
        ("retained_over_sensor_percent", "play", "skin left over the sensor if the bone lies off"),
        ("retained_elsewhere_percent", "play", "skin left at the worst other place"),
        ("max_overhang_mm2", "printing", "largest unsupported overhang of all printed parts"),
        ("controller_fingers", "controller", "fingers that a Black Pill F411CE carries while all of them slip"),
        ("controller_load_percent", "controller", "its mean load by five fingers that slip, of its cycles"),
        (
            "controller_peak_percent",
            "controller",
            "the same in the sample that takes most; loop() catches up above 100",
        ),
        ("tactile_open_v", "acceptance", "tactile voltage of an untouched finger"),
        ("tactile_100g_v", "acceptance", "expected tactile voltage with 100 g on the pad"),
        ("tactile_500g_v", "acceptance", "expected tactile voltage with 500 g on the pad"),
        ("tactile_change_ratio", "acceptance", "change of the tactile voltage at 500 g over that at 100 g"),
        ("checks_failed", "checks", "number of failed checks of `fingertip check`, at tolerance_mm"),
        ("checks_warned", "checks", "number of checks that passed but warn, as of a bone that would break"),
        ("checks_run", "checks", "number of checks that were run"),
        ("board.r1_ohm", "board", "preferred value: pole of the first stage"),
        ("board.r2_ohm", "board", "preferred value: Sallen-Key section, feedback resistor"),
        ("board.r3_ohm", "board", "preferred value: Sallen-Key section, resistor to ground"),
        ("board.r4_ohm", "board", "preferred value: gain, resistor to ground"),
        ("board.r5_ohm", "board", "preferred value: gain, feedback resistor"),
        ("board.r_lp_ohm", "board", "preferred value: resistor of the envelope filter; NaN without one"),
        ("board.c_uf", "board", "capacitors of both filter stages, as given or as selected"),
        ("board.c_lp_uf", "board", "capacitor of the envelope filter; NaN without one"),
        ("gain", "board", "achieved passband gain"),
        ("gain_db", "board", "achieved passband gain [dB]"),
        ("first_pole_hz", "board", "achieved pole frequency of the first stage"),
        ("section_hz", "board", "achieved f0 of the Sallen-Key section"),
        ("q", "board", "achieved quality factor of the Sallen-Key section; 1 in a Butterworth filter"),
        ("cutoff_3db_hz", "board", "achieved -3 dB frequency of the whole filter"),
        ("cutoff_error_percent", "board", "achieved -3 dB frequency relative to board.cutoff_hz"),
        ("envelope_pole_hz", "board", "achieved pole frequency of the envelope, on the board or in software"),
        ("envelope_decay_ms", "board", "achieved time constant of the envelope, on the board or in software"),
        ("amplifier_bandwidth_hz", "board", "upper band limit set by the first stage's amplifier"),
        ("upper_cutoff_hz", "board", "achieved upper -3 dB frequency of the whole filter"),
        ("filter_noise_v", "circuit", "RMS noise of the filtered signal"),
        ("max_ripple_v", "circuit", "peak of supply ripple that alone reaches the threshold"),
        ("max_envelope_offset_v", "circuit", "maximum envelope offset; NaN without a precision rectifier"),
        ("vibration_peak_v", "circuit", "largest vibration of the tactile voltage that is not clipped"),
        ("sensor_amplifier_margin_v", "circuit", "margin of the sensor amplifier's voltages to their limits"),
        ("filter_load_ohm", "circuit", "smallest impedance that an amplifier of the filter drives"),
        ("gate_margin", "circuit", "smallest ratio of a required condition to its limit; 1 or more holds"),
        ("output_current_margin", "circuit", "current of the amplifiers' data sheets over that drawn"),
        ("offset_margin", "circuit", "permitted offset of the filter's outputs over their largest"),
        ("gain_bandwidth_margin", "circuit", "gain-bandwidth product of the amplifier over that needed"),
        ("phase_margin_deg", "circuit", "smallest phase margin of an amplifier"),
        ("peaking_db", "circuit", "largest gain beyond the band over that of the passband"),
        ("adc_margin", "circuit", "range of the converter over the highest tactile voltage, or the clamps' rail"),
        ("filter_yield", "circuit", "share of boards within 10 % of the cutoff and of the gain, the smaller"),
        ("board_current_a", "circuit", "supply current of a board of several fingers at rest [A]"),
        ("crosstalk_db", "circuit", "largest crosstalk between the filtered signals of two fingers [dB]"),
        ("unconfirmed_lines", "circuit", "lines to assemble whose order number two documents do not confirm"),
        ("odd_capacitors", "circuit", "number of capacitors off series E12"),
        ("mean_threshold_v", "circuit", "mean of the comparator's threshold; NaN in other variants"),
        ("min_threshold_worst_v", "circuit", "lowest threshold of a comparator, untrimmed, 0 to 50 C"),
        ("max_threshold_worst_v", "circuit", "highest threshold of a comparator, untrimmed, 0 to 50 C"),
        ("noise_level_v", "noise", "mean of the averaged envelope for noise alone"),
        ("min_threshold_v", "noise", "noise_level_v plus six standard deviations (the article's rule)"),
        ("delay_ms", "detection", "median detection delay of all slips; inf: fewer than half detected"),
        ("delay_p90_ms", "detection", "90th percentile of the delay; inf: fewer than 90 % detected"),
        ("motion_delay_ms", "detection", "median delay since the robot moved; encoders at 100 Hz: 0-10 less"),
        ("motion_delay_p90_ms", "detection", "90th percentile of that delay; inf: fewer than 90 % detected"),
        ("found_share", "detection", "share of the slips that were detected, 0 to 1"),
        ("false_alarms_per_min", "detection", "alarms without slip per simulated minute"),
        ("slips", "detection", "number of slips in the trials"),
        ("slip_onset_ms", "detection", "median true onset of slip after the slide starts; NaN: no slip"),
        ("slip_vibration_n", "detection", "median RMS of the normal force above 30 Hz in slip; NaN: no slip"),
        ("out_of_contact_share", "detection", "median share of the slip in which the pad does not touch; NaN: no slip"),
        ("simulation.force_error_mn", "simulation", "largest error of force_n in the first trial, by its time step"),
        ("simulation.voltage_error_mv", "simulation", "the same of voltage_v; resolution: one ADC step"),
        ("simulation.envelope_error_mv", "simulation", "the same of envelope_v"),
        (
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
