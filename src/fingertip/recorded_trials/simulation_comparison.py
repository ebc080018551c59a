"""Comparison of recordings with their simulation: delays, false alarms, and a fit.

Each trial is simulated under its own labels: surface, force, and the duration of its slide. Both
sides are scored alike, from the motion of the slide on. Holds, taps and moving hands are compared
with scenes that stand for them.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fingertip.design import Design
from fingertip.design.design_file import to_toml
from fingertip.foundation import jit
from fingertip.foundation.progress import Work
from fingertip.lab.campaign.campaign import (
    HELD_OUT_FROM,
    NEGATIVE_SCENES,
    REPORTED_SEPARATELY,
    Case,
)
from fingertip.lab.campaign.run import DetectorResult, TrialResult, evaluate, simulate_trace
from fingertip.lab.report.results import summarise, to_number
from fingertip.recorded_trials.simulation_fit import Fitted, LevelFit, Pairs, fit_curve, fit_noise
from fingertip.recorded_trials.trials import STROKE_M, TrialFile
from fingertip.sim.contact.surface_files import SURFACES
from fingertip.sim.runs.scene_and_manipulation_files import SceneFile
from fingertip.sim.runs.timeline import TrapezoidalMove

TEXT = "recordings.txt"
DATA = "recordings.json"
FITTED = "fitted.toml"
_UNKNOWN_SURFACE = "medium"
_UNKNOWN_N = 1.0
_SPEEDS_M_S = (0.005, 0.2)
_MAX_N = 4.0
"""Values where no label states one, and limits of what scenes take."""
_CAUSES = {
    "slide": "slip",
    "hold": "hold",
    "tap": "hard tap",
    "hand": "moving hand",
}
ROUNDS = ("level", "level again")
"""Rounds of the fit of noise and level."""


def surface_of(trial: TrialFile) -> str:
    """Return the surface of the simulation that stands for a trial's."""
    return trial.labels.surface if trial.labels.surface in SURFACES else _UNKNOWN_SURFACE


def make_case(trial: TrialFile, levels: dict[str, float]) -> Case:
    """Make the scene for a trial; `levels` holds the fitted roughness of surfaces [um]."""
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

    surface = surface_of(trial)
    scene = SceneFile(
        scene="sliding_finger",
        contact={"surface": surface},
        hold=hold,
        slide=slide,
        surface={"felt_um": levels.get(surface, 0.0)},
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
    results = list[TrialResult]()
    for trial in trials:
        if trial.trace.slip is not None:
            results += evaluate(
                make_case(trial, {}),
                trace=trial.trace,
                detector=detector,
                design=design,
                scales=(1.0,),
            )

    return DetectorResult(1.0, tuple(results))


def _format_line(name: str, cells: Iterable[object]) -> str:
    return f"{name:24}" + "".join(f"{cell!s:>26}" for cell in cells)


@dataclass(frozen=True, eq=False)
class RecordingsReport:
    """Result of a detector on recordings and on their simulation, before and after a fit."""

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
        results = [*self.results.values()]
        lines = [
            f"{self.design.name}, {self.detector}; delays since the slide moves (95 % "
            "intervals; inf: missed)",
            _format_line("", self.results),
            _format_line("slides", (result.slips for result in results)),
        ]
        worse = []

        for name, row in self._rows():
            cells = (f"{value:.3g} ({low:.3g}-{high:.3g})" for value, low, high in row)
            lines.append(_format_line(name, cells))
            measured, before, after = (value for value, *_ in row)
            if abs(after - measured) > abs(before - measured):
                worse.append(
                    f"the fit makes {name} worse: {before:.3g} -> {after:.3g}, measured "
                    f"{measured:.3g}"
                )

        minutes = _format_line(
            "  of minutes", (f"{result.limited_minutes:.1f}" for result in results)
        )
        lines += [f"{minutes}  all trials not apart", *self._format_alarms()]
        lines += ["", "simulation: stated -> recordings (95 % interval)", *map(str, self.figures)]
        return "\n".join([*lines, *worse, *self.notes])

    def _format_alarms(self) -> Iterator[str]:
        """Yield a line for each cause of false alarms."""
        results = [*self.results.values()]
        causes = dict.fromkeys(itertools.chain.from_iterable(map(DetectorResult.alarms, results)))
        for cause in causes:
            if cause == "slip":
                continue

            cells = []
            for result in results:
                minutes = result.minutes()
                duration = minutes.get(cause, minutes.get("slip", 0.0))
                cells.append(f"{result.alarms().get(cause, 0)} in {duration:.1f} min")

            apart = ", apart" if cause in REPORTED_SEPARATELY else ""
            yield _format_line(f"  {cause}{apart}", cells)

    def _rows(self) -> Iterator[tuple[str, list[tuple[float, float, float]]]]:
        """Yield figures of the table, each with its interval for each result."""
        results = self.results.values()
        error_s = self.onset_error_s

        if all(result.slips for result in results):
            shares = [(result.found_share, *result.found_interval) for result in results]
            yield "found [%]", [(100 * share, 100 * low, 100 * high) for share, low, high in shares]
            for name, share in (("median [ms]", 0.5), ("90th percentile [ms]", 0.9)):
                delays = [
                    (result.delay_s(share), *result.delay_interval(share)) for result in results
                ]
                value, low, high = delays[0]
                delays[0] = (value, max(0.0, low - error_s), high + error_s)
                yield name, [(1e3 * value, 1e3 * low, 1e3 * high) for value, low, high in delays]

        yield (
            "alarms/min",
            [(result.alarms_per_minute, *result.alarm_interval) for result in results],
        )

    def as_data(self) -> dict[str, Any]:
        results = {
            name: {
                "slides": result.slips,
                **summarise(result),
                "alarms": result.alarms(),
                "minutes": result.minutes(),
            }
            for name, result in self.results.items()
        }
        fit = []
        for figure in self.figures:
            values = vars(figure).items()
            fit.append(
                {
                    key: to_number(value) if isinstance(value, float) else value
                    for key, value in values
                }
            )

        return {
            "design": self.design.name,
            "detector": self.detector,
            "onset_error_s": self.onset_error_s,
            "results": results,
            "fit": fit,
            "notes": [*self.notes],
        }

    def files(self) -> dict[str, bytes]:
        """Return text, data, fitted design and fitted surfaces, as file name -> content."""
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


@dataclass
class _Fit:
    """Fit of the simulation to slides, round by round."""

    design: Design
    figures: list[Fitted]
    levels: dict[str, LevelFit]
    noise: Fitted | None = None
    moved: dict[str, Fitted] = field(default_factory=dict)
    """Last figure of each surface whose slides show vibration."""

    def add_round(self, stated_noise_v: float, pairs: Pairs) -> None:
        """Fit noise and levels to slides and their simulation under the present fit."""
        self.noise = fit_noise(stated_noise_v, self.design.detector.noise_v, pairs)
        changes = {"detector.noise_v": float(f"{self.noise.value:.4g}")}
        self.design = self.design.with_values(changes)

        for surface, level in self.levels.items():
            figure = level.add_round([pair for pair in pairs if surface_of(pair[0]) == surface])
            if figure:
                self.moved[surface] = figure

    @property
    def levels_um(self) -> dict[str, float]:
        """Roughness for the next round [um], by surface."""
        return {surface: level.um for surface, level in self.levels.items()}

    @property
    def moved_um(self) -> dict[str, float]:
        """Fitted roughness [um], by surface."""
        return {surface: um for surface, um in self.levels_um.items() if surface in self.moved}

    def list_figures(self) -> tuple[Fitted, ...]:
        noise = [self.noise] if self.noise else []
        return (*self.figures, *noise, *self.moved.values())


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
        stage: str, trials: Sequence[TrialFile], design: Design, levels_um: dict[str, float]
    ) -> Pairs:
        work.begin(stage)
        pairs = []
        for number, trial in enumerate(trials, 1):
            pairs.append((trial, simulate(design, trial, detector, levels_um)))
            work.advance(number / len(trials))

        return pairs

    before = simulate_all("simulation", trials, design, {})
    fitted_design, figures, note = fit_curve(design, trials, lambda trial: _sense_n(design, trial))
    notes = [note] if note else []
    stated_um = {surface: SURFACES[surface].felt_um for surface in map(surface_of, slides)}
    levels = {surface: LevelFit(surface, um, um) for surface, um in stated_um.items()}
    fit = _Fit(fitted_design, list(figures), levels)

    for stage in ROUNDS if slides else ():
        pairs = simulate_all(stage, slides, fit.design, fit.levels_um)
        fit.add_round(design.detector.noise_v, pairs)

    after = simulate_all("fitted", trials, fit.design, fit.moved_um)
    results = {
        "measured": judge(design, trials, detector),
        "simulated": judge(design, [simulated for _, simulated in before], detector),
        "fitted": judge(fit.design, [simulated for _, simulated in after], detector),
    }
    errors_s = _list_onset_errors_s(slides)
    known_s = [error_s for error_s in errors_s if error_s is not None]
    return RecordingsReport(
        design=design,
        detector=detector,
        results=results,
        figures=fit.list_figures(),
        fitted=fit.design,
        levels=fit.moved_um,
        notes=(*notes, *_describe_slides(slides)),
        onset_error_s=max(known_s, default=0.0),
    )


def _sense_n(design: Design, trial: TrialFile) -> float:
    """Return the force that a calibrated sensor shows under the weight of a trial [N]."""
    case = make_case(trial, {})
    force_n = np.array([trial.labels.force_n])
    pad = case.scene.draw_pad(design, case.seed)
    return float(pad.sensed_n(force_n, None, is_relative=True)[0])


def _list_onset_errors_s(slides: Sequence[TrialFile]) -> list[float | None]:
    """List the stated errors of the contacts that open with the motion [s]."""
    return [trial.labels.onset_error_s for trial in slides if trial.trace.slip is not None]


def _describe_slides(slides: Sequence[TrialFile]) -> Iterator[str]:
    """Yield notes on what the comparison assumes of slides, or leaves out."""
    unknown = {
        trial.labels.surface or "(none)"
        for trial in slides
        if surface_of(trial) != trial.labels.surface
    }
    if unknown:
        names = ", ".join(sorted(unknown))
        yield f"{names}: no surface of the simulation; {_UNKNOWN_SURFACE} stands for it"

    blind = sum(trial.trace.slip is None for trial in slides)
    if blind:
        yield (
            f"{blind} slides have no contact that opens with the motion: they count for curve and "
            "noise alone"
        )

    without_error = sum(error_s is None for error_s in _list_onset_errors_s(slides))
    if without_error:
        yield (
            f"{without_error} slides state no error of their contact (--onset-error-ms): "
            "intervals of measured delays leave it out"
        )
