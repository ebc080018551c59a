"""What failed, what was taken for granted beside each figure, and what was not tried at all: a page of Markdown."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fingertip.campaign.closed_loop.manipulations import NONE, Handled
from fingertip.campaign.plan import APART
from fingertip.campaign.report.tables import ASSUMPTIONS
from fingertip.campaign.requirements import Check
from fingertip.campaign.study import Study, surface

GROUNDS = {
    "delays.png, surfaces.png, surfaces_digital.png": (
        "Figures 14 and 15. Friction, the roughness of wood, paper and plastic, the 1 m/s2 of the start and a force "
        "drawn evenly from 0.2 to 2 N. The two objects are taken for the smooth and the plastic surface."
    ),
    "comparison.png": (
        "Alarms come from scenes of contact, release, load change and drift whose mix is ours; another mix gives "
        "another rate. The bound knows the spectrum and strength of each slip beforehand, and takes the shear ahead "
        "of gross slip for news, though a change of grip looks like it: the quieter the samples, the less it says."
    ),
    "spectra.png": (
        "Figure 2. The pad's resonance is put where the article's spectra end: 90 Hz embedded, 230 Hz bare. So this "
        "figure checks the simulation and does not predict."
    ),
    "windows.png, window_trial.png": (
        "Figure 5, by the digital chain: our board's bare diode lets no contact through. The threshold follows each "
        "window's noise. The trial is chosen: the first in which a window of 10 ms takes the contact for slip."
    ),
    "trial.png, trials_surfaces.png, trials_objects.png": (
        "Figures 9, 12 and 13: the first held-out seeds, not chosen ones. The robot's axes are not drawn; normal "
        "force stands for the one along Z."
    ),
    "closed_loop_power.png, closed_loop_pinch.png": (
        "Figures 16 and 17: the first held-out manipulation of the object. Delay, lag and velocity of the hand, "
        "stiffness and stroke of the pin, and the margin of the grip are assumptions of fingertip.sim; the object "
        "neither turns nor bends. The grip law's constants were chosen on the tuning seeds."
    ),
    "table of boards": (
        "One diode, 1N4148 at 27 degree Celsius, and nominal values; `fingertip board --analysis` has tolerances. The "
        "amplifiers' noise is the noise budget's, typical figures, all of it brought into the band of the samples; the "
        "converter's stands behind the board. Alarms are those of 2 quiet minutes."
    ),
    "table of starts": (
        "The article gives no acceleration; 4 cm at 4 cm/s in one second leaves all of these possible."
    ),
    "table of readings": (
        "Noise of the converter alone, as much at every reading; what the sensor itself adds is not in it. The board's "
        "poles ahead of the converter are those it would have for each rate."
    ),
    "table of knocks": (
        "A knock is a force that rises and falls as a smooth step, on a pad that rings at 90 Hz. Weak ones are slip to "
        "every detector here: nothing on one force axis tells them apart."
    ),
    "table of tones": (
        "The motor is a tone of 45 Hz and its second harmonic, of steady frequency. One that changes speed is told "
        "from slip later still."
    ),
}
NOT_TRIED = (
    "A real finger, board or hand: everything here is simulated.",
    "Skins that wear, sweat or warm up; sensors that differ from the data sheet's curve.",
    "Boards at the ends of their tolerances; mains hum of the supply; crosstalk between fingers.",
    "Slip that begins slower than 0.5 m/s2, creeps, or turns the object about the finger.",
    "A knock on an object that is held too firmly to slip, with the loop closed: a weak one would be answered.",
    "A deformable bottle, objects that roll, grasps in which the palm carries weight.",
)


def as_markdown(study: Study, checked: Sequence[Check], handled: Sequence[Handled]) -> str:
    """The page.

    Parameters
    ----------
    study
        The open-loop campaign, every detector at its own threshold.
    checked
        The requirements.
    handled
        The manipulations.
    """
    lines = ["# What failed, and what was taken for granted", "", "## Requirements missed", ""]
    lines += [f"- {check.message}" for check in checked if not check.passed] or ["None."]
    lines += ["", "## Slips not found, and alarms without slip", ""]
    for name in study.totals:
        lines += list(_failures(study, name))
    lines += ["", "## Manipulations", "", *_manipulations(handled)]
    lines += ["", "## Assumed in all of it", "", *(f"- {sentence}" for sentence in ASSUMPTIONS)]
    lines += ["", "## Assumed beside each figure and table", ""]
    lines += [f"- {name}: {sentence}" for name, sentence in GROUNDS.items()]
    lines += ["", "## Not tried", "", *(f"- {sentence}" for sentence in NOT_TRIED)]
    return "\n".join(lines) + "\n"


def _failures(study: Study, name: str) -> Iterator[str]:
    total = study.at_design(name)
    groups: dict[str, list[int]] = {}
    for verdict in total.verdicts:
        if verdict.slips:
            group = groups.setdefault(surface(verdict), [0, 0])
            group[0] += verdict.slips - len(verdict.delays_s)
            group[1] += verdict.slips
    missed = [f"{lost} of {count} on {where}" for where, (lost, count) in groups.items() if lost]
    yield f"- {name}: not found {', '.join(missed) if missed else 'none'}."
    minutes = total.minutes()
    alarms = [
        f"{cause} {count} in {minutes[cause]:.1f} min{' (apart)' if cause in APART else ''}"
        if cause in minutes
        else f"{cause} {count}"
        for cause, count in total.alarms().items()
        if count
    ]
    yield f"  False alarms: {', '.join(alarms) if alarms else 'none'}."


def _manipulations(handled: Sequence[Handled]) -> Iterator[str]:
    for one in handled:
        issues = []
        if not one.held:
            issues.append("lost")
        if one.detector != NONE:
            if one.onset_s is not None and one.reaction_s is None:
                issues.append("slip without any answer")
            if one.false_grips:
                issues.append(f"gripped {one.false_grips} times without slip")
            if one.ignored:
                issues.append(f"{one.ignored} true claims discarded before the first grip")
        if issues:
            yield f"- {one.detector}, {one.name}, seed {one.seed}: {'; '.join(issues)}."
    if all(one.held for one in handled):
        yield "- No object was lost, even without control: the grip was not what held it."
