"""Markdown page of a validation: failures, assumptions beside each figure, and what was not tested."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fingertip.catalogues.sensors import PART_TO_PART
from fingertip.lab.campaign import CampaignResult, surface
from fingertip.lab.closed_loop import NO_CONTROL, ClosedLoopTrial
from fingertip.lab.plan import REPORTED_SEPARATELY
from fingertip.lab.report import robustness
from fingertip.lab.report.tables import ASSUMPTIONS, StudyResults

FIGURE_ASSUMPTIONS = {
    "delays.png, surfaces.png, surfaces_digital.png": (
        "Figures 14 and 15. Friction; the roughness of wood, paper and plastic; the acceleration of 1 m/s2; and a "
        "force drawn uniformly from 0.2 to 2 N. The two objects are assumed to have the smooth and the plastic surface."
    ),
    "comparison.png": (
        "False alarms come from scenes of contact, release, load change and drift in a mix that this project chose; "
        "another mix gives another rate. The bound knows the spectrum and strength of each slip in advance, and uses "
        "the shear ahead of gross slip as information, although a load change looks the same. With less noise the "
        "bound is therefore less meaningful."
    ),
    "spectra.png": (
        "Figure 2. The pad's resonance is set to where the article's spectra end: 90 Hz embedded, 230 Hz bare. This "
        "figure therefore verifies the simulation and does not predict."
    ),
    "windows.png, window_trial.png": (
        "Figure 5, with the digital chain, because the bare diode of variant article does not respond to contacts. The "
        "threshold follows the noise in each window. The trial is selected: it is the first in which a window of 10 ms "
        "reports the contact as slip."
    ),
    "trial.png, trials_surfaces.png, trials_objects.png": (
        "Figures 9, 12 and 13: the first held-out seeds, not selected ones. The robot's axes are not drawn; the normal "
        "force stands for the axis along Z."
    ),
    "closed_loop_power.png, closed_loop_pinch.png": (
        "Figures 16 and 17. The manipulation is selected: it is the first one of the object, or else of another in "
        "the same grasp, that is held with control and lost without. The table counts all of them. Delay, lag and "
        "velocity of the hand, stiffness and stroke of the pin, and the margin of the grip are assumptions of "
        "fingertip.sim; the object neither rotates nor bends. The constants of the grip law were chosen on the tuning "
        "seeds."
    ),
    "table of board variants": (
        "One diode, 1N4148 at 27 degrees Celsius, and nominal values; `fingertip board --analysis` gives tolerances. "
        "The noise of the amplifiers is that of the noise budget (typical values), as white noise on the simulation's "
        "grid, ahead of the filter. The noise of the ADC is added behind the board. False alarms are counted in 2 "
        "minutes without slip."
    ),
    "table of the article's protocol": (
        "The phase of the encoders' readings is drawn for each trial. The article states neither its threshold, nor "
        "its diode, nor the smallest motion that counts as the robot's start; here its trials have forces drawn "
        "evenly. Nothing was tuned to its figures."
    ),
    "table of accelerations": (
        "The article gives no acceleration; 4 cm at 4 cm/s in one second is compatible with all of these."
    ),
    "table of sampling rates": (
        "Noise of the ADC only, with the same strength at every conversion; pink noise of sensor and amplifier is left "
        "out here. The grid of the simulation is the same at every rate. The anti-aliasing poles ahead of the ADC are "
        "those that the board would have for each rate."
    ),
    "table of knocks": (
        "A knock is a force that rises and falls as a smooth step, on a pad that resonates at 90 Hz. Every detector "
        "here reports weak knocks as slip: a single force axis cannot distinguish them."
    ),
    "table of assumptions": (
        "One change at a time, on the same trials. Pink noise has the same power in every decade, and vibration of a "
        "hand is noise from 30 to 90 Hz while the finger touches; thresholds remain those for the white noise of the "
        "ADC. The patch average weights heights with the pressure of a Hertzian contact, on a surface that does not "
        "change across the line. Stick-slip follows from friction that was chosen to cause it. A converter is as noisy "
        "as the design's ADC, and the thresholds follow its step."
    ),
    "table of the time step": (
        "Trials spread over the article's surfaces and speeds, with the default effects only. The finer grid stands "
        "for the limit of vanishing steps."
    ),
    "table of motor tones": (
        "The motor is a tone of 45 Hz and its second harmonic, of constant frequency. A motor that changes speed is "
        "distinguished from slip even later."
    ),
}
"""Figure or table -> its assumptions."""
NOT_TESTED = (
    "A real finger, board or hand: everything here is simulated.",
    "Skins that wear, sweat or warm up; sensors that differ from the design's curve, as real ones do by a factor of "
    f"{PART_TO_PART[0]:g} to {PART_TO_PART[1]:g} from the data sheet's.",
    "Levels and spectra of real noise: pink noise, mains hum and vibration of a hand are tested at assumed levels, one "
    "at a time, and not in the closed loop.",
    "Boards at the limits of their tolerances; mains hum that enters through the supply instead of the tactile "
    "voltage; crosstalk between fingers.",
    "Stick-slip with elasto-plastic bristles, and vibration that acts back on friction.",
    "Slip that starts with less than 0.5 m/s2, creeps, or rotates the object about the finger.",
    "A knock on an object that is held too firmly to slip, in the closed loop: the hand would respond to a weak one.",
    "A deformable bottle, objects that roll, grasps in which the palm carries weight.",
)


def as_markdown(
    result: CampaignResult,
    missed: Sequence[str],
    closed_loop: Sequence[ClosedLoopTrial],
    studies: StudyResults,
    detector: str,
) -> str:
    """Write the page."""
    lines = ["# Omissions: failures, assumptions and what was not tested", "", "## Requirements missed", ""]
    lines += [f"- {message}" for message in missed] or ["None."]
    lines += ["", "## Missed slips and false alarms", ""]
    for name in result.detectors:
        lines += list(_list_failures(result, name))
    lines += ["", "## Manipulations", "", *_list_manipulations(closed_loop)]
    remarks = robustness.realism_remarks(studies.variations, detector, studies.patch_radius_m)
    lines += ["", "## Effects of real fingers that the trials leave out", "", *(f"- {text}" for text in remarks)]
    lines += ["", "## Time step", "", *(f"- {text}" for text in robustness.step_remarks(studies.steps))]
    lines += ["", "## Assumptions of all results", "", *(f"- {text}" for text in ASSUMPTIONS)]
    lines += ["", "## Assumptions of each figure and table", ""]
    lines += [f"- {name}: {text}" for name, text in FIGURE_ASSUMPTIONS.items()]
    lines += ["", "## Not tested", "", *(f"- {text}" for text in NOT_TESTED)]
    return "\n".join(lines) + "\n"


def _list_failures(result: CampaignResult, name: str) -> Iterator[str]:
    nominal = result.at_nominal_threshold(name)
    groups: dict[str, list[int]] = {}
    for trial in nominal.trials:
        if trial.slips:
            group = groups.setdefault(surface(trial), [0, 0])
            group[0] += trial.slips - len(trial.delays_s)
            group[1] += trial.slips
    missed = [f"{count} of {total} on {where}" for where, (count, total) in groups.items() if count]
    yield f"- {name}: slips missed: {', '.join(missed) if missed else 'none'}."
    minutes = nominal.minutes()
    alarms = [
        f"{cause} {count} in {minutes[cause]:.1f} min{' (reported separately)' if cause in REPORTED_SEPARATELY else ''}"
        if cause in minutes
        else f"{cause} {count}"
        for cause, count in nominal.alarms().items()
        if count
    ]
    yield f"  False alarms: {', '.join(alarms) if alarms else 'none'}."


def _list_manipulations(closed_loop: Sequence[ClosedLoopTrial]) -> Iterator[str]:
    for trial in closed_loop:
        failures = []
        if not trial.held:
            failures.append("object lost")
        if trial.detector != NO_CONTROL:
            if trial.onset_s is not None and trial.reaction_s is None:
                failures.append("no reaction to slip")
            if trial.false_grips:
                failures.append(f"{trial.false_grips} grip increases without slip")
            if trial.suppressed_true:
                failures.append(f"{trial.suppressed_true} true detections suppressed before the first grip increase")
        if failures:
            yield f"- {trial.detector}, {trial.name}, seed {trial.seed}: {'; '.join(failures)}."
    if all(trial.held for trial in closed_loop):
        yield "- No object was lost, even without control: this campaign does not show what the control adds."
