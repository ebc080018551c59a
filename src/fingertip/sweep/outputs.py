"""What a sweep can compute of a point: each output with its meaning, and the stage that gives it.

A stage is asked only where one of its outputs is wanted, and again only where one of the tables it reads has changed.
Nothing is imported here; `fingertip.sweep.compute` holds the computing.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from fingertip.design.issues import suggest_name
from fingertip.errors import Issue

FINGER = frozenset({"sensor", "custom_sensor", "bone", "skin"})
"""Tables that give the finger's form."""
CLOSED_MOLD = FINGER | {"mold"}
PARTS = CLOSED_MOLD | {"name", "printer"}
"""The halves carry the design's name, the printer's scale and limits decide on the checks."""
SIGNAL = FINGER | {"board", "detector", "mold"}
"""The pad's form counts in a simulation; lengths that follow from the mold are derived along with it."""


@dataclass(frozen=True)
class Stage:
    """A computation that gives one or several outputs at once."""

    name: str
    reads: frozenset[str]
    """Tables of the design that its outputs can depend on; `scene` for the scene."""
    cost: int
    """Order of cost: axes of dear stages vary slowest, so that neighbouring points share them."""
    but: frozenset[str] = frozenset()
    """Parameters of those tables that it does not read, dotted."""

    def depends_on(self, parameter: str) -> bool:
        """Whether its outputs can change with a parameter, dotted."""
        return parameter.partition(".")[0] in self.reads and parameter not in self.but


STAGES = {
    stage.name: stage
    for stage in (
        Stage("lengths", CLOSED_MOLD, 0),
        Stage("board", frozenset({"board", "detector", "sensor", "custom_sensor"}), 1),
        Stage("noise", frozenset({"board", "detector"}), 1),
        Stage("trials", SIGNAL | {"scene"}, 2),
        Stage("skin", CLOSED_MOLD, 4),
        Stage("bone", CLOSED_MOLD, 4),
        Stage("halves", CLOSED_MOLD | {"name"}, 4),
        Stage("thickness", CLOSED_MOLD, 4),
        Stage("casting", CLOSED_MOLD | {"name"}, 5),
        Stage("checks", PARTS, 6),
    )
}


DECISION = frozenset({"detector.window_samples", "detector.threshold_v"})
TRACES = Stage("traces", SIGNAL | {"scene"}, 3, DECISION)
"""Within the trials: what is simulated does not depend on how the detector decides."""


@dataclass(frozen=True)
class Output:
    """One figure of a point."""

    name: str
    """Carries its unit."""
    stage: str
    meaning: str


OUTPUTS = {
    output.name: output
    for output in (
        Output("sensor_rim_mm", "lengths", "flat bone left around sensor and rim; 0: just fits"),
        Output("mold_width_mm", "lengths", "closed mold, across the finger"),
        Output("mold_height_mm", "lengths", "closed mold, from palm to back"),
        Output("mold_length_mm", "lengths", "closed mold, along the finger"),
        Output("skin_volume_mm3", "skin", "silicone skin"),
        Output("skin_area_mm2", "skin", "surface of the skin, inside and outside"),
        Output("bone_volume_mm3", "bone", "printed bone"),
        Output("bone_mass_g", "bone", "printed bone, at print_density_g_cm3"),
        Output("mold_palmar_volume_mm3", "halves", "palmar half of the mold"),
        Output("mold_dorsal_volume_mm3", "halves", "dorsal half of the mold"),
        Output("mold_mass_g", "halves", "both halves, at print_density_g_cm3"),
        Output("thinnest_skin_mm", "thickness", "thinnest silicone between bone and surface"),
        Output("silicone_in_mold_g", "casting", "what fills the mold, of the sweep's silicone"),
        Output("silicone_g", "casting", "what is mixed: with waste, and never less than can be weighed"),
        Output("checks_failed", "checks", "checks of `fingertip check` that fail, at tolerance_mm; 0: can be made"),
        Output("checks_made", "checks", "checks that were asked"),
        Output("board.r1_ohm", "board", "preferred value: first stage's pole"),
        Output("board.r2_ohm", "board", "preferred value: Sallen-Key, feedback"),
        Output("board.r3_ohm", "board", "preferred value: Sallen-Key, to ground"),
        Output("board.r4_ohm", "board", "preferred value: gain, to ground"),
        Output("board.r5_ohm", "board", "preferred value: gain, feedback"),
        Output("board.r_lp_ohm", "board", "preferred value: envelope"),
        Output("board.c_uf", "board", "capacitors of both filters, as given or as chosen"),
        Output("board.c_lp_uf", "board", "capacitor of the envelope, as given or as chosen"),
        Output("gain", "board", "achieved passband gain"),
        Output("gain_db", "board", "achieved passband gain"),
        Output("first_pole_hz", "board", "achieved pole of the first stage"),
        Output("section_hz", "board", "achieved f0 of the Sallen-Key section"),
        Output("q", "board", "achieved quality of the Sallen-Key section; 1 in a Butterworth filter"),
        Output("cutoff_3db_hz", "board", "achieved overall -3 dB frequency"),
        Output("cutoff_error_percent", "board", "achieved -3 dB frequency against board.cutoff_hz"),
        Output("envelope_pole_hz", "board", "achieved pole of the envelope"),
        Output("envelope_decay_ms", "board", "achieved time constant of the envelope"),
        Output("amplifier_bandwidth_hz", "board", "where the amplifier ends the first stage's passband"),
        Output("noise_level_v", "noise", "mean of the article's window in noise alone"),
        Output("min_threshold_v", "noise", "noise level and six deviations: the article's rule"),
        Output("delay_ms", "trials", "median delay over all true slips; inf: fewer than half were found"),
        Output("delay_p90_ms", "trials", "delay by which nine in ten slips are found; inf: fewer were"),
        Output("found_share", "trials", "slips found, of all"),
        Output("false_alarms_per_min", "trials", "alarms without slip, per simulated minute"),
        Output("slips", "trials", "true slips in the trials"),
    )
}


def stages_of(outputs: Iterable[str]) -> tuple[Stage, ...]:
    """The stages that give these outputs, each once, cheapest first."""
    names = {OUTPUTS[name].stage for name in outputs}
    return tuple(stage for stage in STAGES.values() if stage.name in names)


def shared_of(outputs: Iterable[str]) -> tuple[Stage, ...]:
    """Everything that points can share: the stages, and what they are made of."""
    stages = stages_of(outputs)
    return (*stages, TRACES) if any(stage.name == "trials" for stage in stages) else stages


def unknown(outputs: Iterable[str]) -> list[Issue]:
    """Faults of names that are no output, or stand twice."""
    listed = list(outputs)
    issues = []
    for name in dict.fromkeys(listed):
        if name not in OUTPUTS:
            close = suggest_name(name.lower(), tuple(OUTPUTS))
            remedy = close if close.startswith("did you mean") else "see fingertip sweep --outputs."
            issues.append(Issue("outputs", f"{name!r} is no output; {remedy}"))
        elif listed.count(name) > 1:
            issues.append(Issue("outputs", f"{name!r} is named {listed.count(name)} times; name it once."))
    return issues
