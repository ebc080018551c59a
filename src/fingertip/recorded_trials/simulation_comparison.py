"""Recordings beside their simulation: delays since the motion, false alarms by kind, and the fit of
what must move.

Each trial is simulated under its own labels: surface, force, and the duration of its slide. Both
sides are scored alike, from the motion of the slide on. Holds, taps and moving hands are compared
with scenes that stand for them.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fingertip.design import Design
from fingertip.design.files import to_toml
from fingertip.foundation import jit
from fingertip.foundation.progress import Work
from fingertip.lab.campaign.plan import HELD_OUT_FROM, NEGATIVE_SCENES, REPORTED_SEPARATELY, Case
from fingertip.lab.campaign.run import DetectorResult, evaluate, simulate_trace
from fingertip.lab.report.results import summarise, to_number
from fingertip.recorded_trials.simulation_fit import Fitted, LevelFit, Pairs, fit_curve, fit_noise
from fingertip.recorded_trials.trials import STROKE_M, TrialFile
from fingertip.sim import SceneFile
from fingertip.sim.contact.materials import SURFACES
from fingertip.sim.runs.timeline import TrapezoidalMove

TEXT = "recordings.txt"
DATA = "recordings.json"
FITTED = "fitted.toml"
_UNKNOWN_SURFACE = "medium"
_UNKNOWN_N = 1.0
_SPEEDS_M_S = (0.005, 0.2)
_MAX_N = 4.0
"""Stand-ins for what no label states, and limits of what scenes take."""
_CAUSES = {
    "slide": "slip",
    "hold": "hold",
    "tap": "hard tap",
    "hand": "moving hand",
}
ROUNDS = ("level", "level again")
"""Rounds of the fit of noise and level."""


def surface_of(trial: TrialFile) -> str:
    return trial.labels.surface if trial.labels.surface in SURFACES else _UNKNOWN_SURFACE


def make_case(trial: TrialFile, levels: dict[str, float]) -> Case:
    """Make the scene that a trial is compared with; `levels` holds
    the fitted roughness of surfaces [um].
    """
    trace = trial.trace
    seed = HELD_OUT_FROM + trial.labels.trial
    labels = trial.labels
    force_n = min(labels.force_n or _UNKNOWN_N, _MAX_N)
    hold = {"min_force_n": force_n, "max_force_n": force_n}
    if labels.kind == "tap":
        return Case(_CAUSES[labels.kind], NEGATIVE_SCENES["hard tap"][0], seed)

    if labels.kind != "slide":
        tremor = {"share": 0.02, "voluntary_share": 0.05} if labels.kind == "hand" else {}
        return Case(
            _CAUSES[labels.kind],
            SceneFile(scene="contact", hold={**hold, "min_s": 5.0}, tremor=tremor),
            seed,
        )

    slide = {"distance_m": labels.stroke_m or STROKE_M}
    if trace.slip is not None and trace.slip.any():
        lasts_s = float(np.ptp(trace.time_s[trace.slip]))
        move = TrapezoidalMove.with_duration(0.0, slide["distance_m"], lasts_s)
        low, high = _SPEEDS_M_S
        slide |= {
            "speed_m_s": min(max(move.peak_m_s, low), high),
            "acceleration_m_s2": move.acceleration_m_s2,
        }

    name = surface_of(trial)
    scene = SceneFile(
        scene="sliding_finger",
        contact={"surface": name},
        hold=hold,
        slide=slide,
        surface={"felt_um": levels.get(name, 0.0)},
    )
    return Case("slip", scene, seed)


def simulate(
    design: Design, trial: TrialFile, detector: str, levels: dict[str, float]
) -> TrialFile:
    """Simulate the counterpart of a trial; its slip is the motion, as in the recording."""
    case = make_case(trial, levels)
    trace = simulate_trace(design, case, (detector,))
    slide = case.scene.slide
    moving = np.zeros(len(trace.time_s), dtype=bool)
    start_s = trace.origin.motion_s

    if start_s is not None:
        move = TrapezoidalMove.with_speed(
            start_s, slide.distance_m, slide.speed_m_s, slide.acceleration_m_s2
        )
        moving = (trace.time_s >= start_s) & (trace.time_s <= move.end_s)

    return TrialFile(
        trial.labels.model_copy(update={"simulated": True}), replace(trace, slip=moving)
    )


def judge(design: Design, trials: Sequence[TrialFile], detector: str) -> DetectorResult:
    """Run a detector on the trials whose motion is known."""
    known = [trial for trial in trials if trial.trace.slip is not None]
    results = (
        evaluate(
            make_case(trial, {}),
            trace=trial.trace,
            detector=detector,
            design=design,
            scales=(1.0,),
        )
        for trial in known
    )
    return DetectorResult(1.0, tuple(result for found in results for result in found))


@dataclass(frozen=True, eq=False)
class RecordingsReport:
    design: Design
    detector: str
    results: dict[str, DetectorResult]
    """measured, simulated, fitted -> result of the detector."""
    figures: tuple[Fitted, ...]
    fitted: Design
    levels: dict[str, float]
    notes: tuple[str, ...]
    onset_error_s: float
    """Largest error of the contact that opens with the motion [s]; 0 if none is known."""

    def as_text(self) -> str:
        def line(name: str, cells: Iterable[object]) -> str:
            return f"{name:24}" + "".join(f"{cell!s:>26}" for cell in cells)

        sides = [*self.results.values()]
        rows = [*self._rows()]
        worse = []
        heading = (
            f"{self.design.name}, {self.detector}; delays since the slide moves (95 % "
            "intervals; inf: missed)"
        )
        lines = [heading, line("", self.results), line("slides", (one.slips for one in sides))]

        for name, row in rows:
            lines.append(
                line(name, (f"{value:.3g} ({low:.3g}-{high:.3g})" for value, low, high in row))
            )
            measured, before, after = (value for value, *_ in row)
            if abs(after - measured) > abs(before - measured):
                worse.append(
                    f"the fit makes {name} worse: {before:.3g} -> {after:.3g}, measured "
                    f"{measured:.3g}"
                )

        lines.append(
            line("  of minutes", (f"{one.limited_minutes:.1f}" for one in sides))
            + "  all trials not apart"
        )
        for cause in dict.fromkeys(
            cause for one in sides for cause in one.alarms() if cause != "slip"
        ):
            apart = ", apart" if cause in REPORTED_SEPARATELY else ""
            cells = (
                (
                    one.alarms().get(cause, 0),
                    one.minutes().get(cause, one.minutes().get("slip", 0.0)),
                )
                for one in sides
            )
            lines.append(
                line(f"  {cause}{apart}", (f"{count} in {time:.1f} min" for count, time in cells))
            )

        lines += ["", "simulation: stated -> recordings (95 % interval)", *map(str, self.figures)]
        return "\n".join([*lines, *worse, *self.notes])

    def _rows(self) -> Iterator[tuple[str, list[tuple[float, float, float]]]]:
        """Yield figures of the table, each with its interval for each side."""
        sides = self.results.values()
        error_s = self.onset_error_s

        if all(one.slips for one in sides):
            found = [(one.found_share, *one.found_interval) for one in sides]
            yield "found [%]", [(100 * share, 100 * low, 100 * high) for share, low, high in found]
            for name, share in (("median [ms]", 0.5), ("90th percentile [ms]", 0.9)):
                delays = [(one.delay_s(share), *one.delay_interval(share)) for one in sides]
                value, low, high = delays[0]
                delays[0] = value, max(0.0, low - error_s), high + error_s
                yield name, [(1e3 * value, 1e3 * low, 1e3 * high) for value, low, high in delays]

        yield "alarms/min", [(one.alarms_per_minute, *one.alarm_interval) for one in sides]

    def as_data(self) -> dict[str, Any]:
        results = {
            name: {
                "slides": one.slips,
                **summarise(one),
                "alarms": one.alarms(),
                "minutes": one.minutes(),
            }
            for name, one in self.results.items()
        }
        fit = [
            {
                key: to_number(value) if isinstance(value, float) else value
                for key, value in vars(one).items()
            }
            for one in self.figures
        ]
        return {
            "design": self.design.name,
            "detector": self.detector,
            "onset_error_s": self.onset_error_s,
            "results": results,
            "fit": fit,
            "notes": [*self.notes],
        }

    def files(self) -> dict[str, bytes]:
        """Return file name -> content: text, data, the fitted
        design, and each surface with its fitted level.
        """
        surfaces = {
            f"surface_{name}.toml": f"[surface]\nfelt_um = {um:.6g}\n"
            for name, um in self.levels.items()
        }
        heading = (
            f"{self.design.name}, with curve and noise of recordings, by `fingertip "
            "validate --recordings`."
        )
        texts = {
            TEXT: self.as_text() + "\n",
            DATA: json.dumps(self.as_data(), indent=2, allow_nan=False) + "\n",
            FITTED: to_toml(self.fitted, heading),
            **surfaces,
        }

        return {name: text.encode() for name, text in texts.items()}


@jit.compiled()
def compare(
    design: Design,
    trials: Sequence[TrialFile],
    detector: str,
    progress: Callable[[str], None] = lambda _: None,
) -> RecordingsReport:
    """Compare recordings with their simulation before and after the fit. Raises FingertipError."""
    slides = [trial for trial in trials if trial.labels.kind == "slide"]
    stages = {
        "simulation": len(trials),
        **dict.fromkeys(ROUNDS, len(slides)),
        "fitted": len(trials),
    }
    work = Work("recordings", stages, progress)

    def simulate_all(
        stage: str, some: Sequence[TrialFile], of: Design, levels: dict[str, float]
    ) -> Pairs:
        work.begin(stage)
        found = []
        for number, trial in enumerate(some, 1):
            found.append((trial, simulate(of, trial, detector, levels)))
            work.advance(number / len(some))

        return found

    def sense_n(trial: TrialFile) -> float:
        case = make_case(trial, {})
        force_n = np.array([trial.labels.force_n])
        return float(
            case.scene.draw_pad(design, case.seed).sensed_n(force_n, None, is_relative=True)[0]
        )

    before = simulate_all("simulation", trials, design, {})
    fitted, figures, note = fit_curve(design, trials, sense_n)
    notes = [note] * bool(note)
    moved = dict[str, Fitted]()
    stated_um = {name: SURFACES[name].felt_um for name in map(surface_of, slides)}
    fits = {name: LevelFit(name, um, um) for name, um in stated_um.items()}

    for stage in ROUNDS if slides else ():
        pairs = simulate_all(stage, slides, fitted, {name: fit.um for name, fit in fits.items()})
        noise = moved["noise"] = fit_noise(design.detector.noise_v, fitted.detector.noise_v, pairs)
        fitted = fitted.with_values({"detector.noise_v": float(f"{noise.value:.4g}")})

        for name, fit in fits.items():
            level = fit.add_round([pair for pair in pairs if surface_of(pair[0]) == name])
            if level:
                moved[name] = level

    levels = {name: fit.um for name, fit in fits.items() if name in moved}
    other = sorted(
        {
            trial.labels.surface or "(none)"
            for trial in slides
            if surface_of(trial) != trial.labels.surface
        }
    )
    if other:
        notes.append(
            f"{', '.join(other)}: no surface of the simulation; {_UNKNOWN_SURFACE} stands for it"
        )

    blind = sum(trial.trace.slip is None for trial in slides)
    if blind:
        notes.append(
            f"{blind} slides have no contact that opens with the motion: they count for curve and "
            "noise alone"
        )

    errors_s = [trial.labels.onset_error_s for trial in slides if trial.trace.slip is not None]
    known_s = [error_s for error_s in errors_s if error_s is not None]
    if len(known_s) < len(errors_s):
        notes.append(
            f"{len(errors_s) - len(known_s)} slides state no error of their contact "
            "(--onset-error-ms): "
            "intervals of measured delays leave it out"
        )

    after = simulate_all("fitted", trials, fitted, levels)
    sides = {
        "measured": (design, trials),
        "simulated": (design, [trial for _, trial in before]),
        "fitted": (fitted, [trial for _, trial in after]),
    }
    results = {name: judge(of, some, detector) for name, (of, some) in sides.items()}
    return RecordingsReport(
        design=design,
        detector=detector,
        results=results,
        figures=(*figures, *moved.values()),
        fitted=fitted,
        levels=levels,
        notes=tuple(notes),
        onset_error_s=max(known_s, default=0.0),
    )
