"""Recordings beside their simulation: delays since the motion, false alarms by kind, and the fit of what must move.

Each trial is simulated under its own labels: surface, force, and the duration of its slide. Both sides are scored
alike, from the motion of the slide on. Holds, taps and moving hands are compared with scenes that stand for them.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fingertip.bench.fit import Fitted, LevelFit, Pairs, fit_curve, fit_noise
from fingertip.bench.trials import STROKE_M, TrialFile
from fingertip.design import Design
from fingertip.design.files import to_toml
from fingertip.foundation import jit
from fingertip.foundation.progress import Work
from fingertip.lab.campaign.plan import HELD_OUT_FROM, NEGATIVE_SCENES, REPORTED_SEPARATELY, Case
from fingertip.lab.campaign.run import DetectorResult, evaluate, simulate_trace
from fingertip.lab.report.results import format_interval, format_ms, summarise, to_number
from fingertip.sim import SceneFile
from fingertip.sim.contact.materials import SURFACES
from fingertip.sim.runs.timeline import TrapezoidalMove

TEXT, DATA, FITTED = "recordings.txt", "recordings.json", "fitted.toml"
_UNKNOWN_SURFACE, _UNKNOWN_N, _SPEEDS_M_S, _MAX_N = "medium", 1.0, (0.005, 0.2), 4.0
"""Stand-ins for what no label states, and limits of what scenes take."""
_CAUSES = {"slide": "slip", "hold": "hold", "tap": "hard tap", "hand": "moving hand"}
ROUNDS = ("level", "level again")
"""Rounds of the fit of noise and level."""
_BIN_MS, _LAST_MS = 5, 100
"""Bins of the histogram, centred on multiples as in the article's figure 14, and the last one [ms]."""


def surface_of(trial: TrialFile) -> str:
    return trial.labels.surface if trial.labels.surface in SURFACES else _UNKNOWN_SURFACE


def make_case(trial: TrialFile, levels: dict[str, float]) -> Case:
    """Make the scene that a trial is compared with; `levels` holds the fitted roughness of surfaces [um]."""
    labels, trace, seed = trial.labels, trial.trace, HELD_OUT_FROM + trial.labels.trial
    force_n = min(labels.force_n or _UNKNOWN_N, _MAX_N)
    hold = {"min_force_n": force_n, "max_force_n": force_n}
    if labels.kind == "tap":
        return Case(_CAUSES[labels.kind], NEGATIVE_SCENES["hard tap"][0], seed)
    if labels.kind != "slide":
        tremor = {"share": 0.02, "voluntary_share": 0.05} if labels.kind == "hand" else {}
        return Case(_CAUSES[labels.kind], SceneFile(scene="contact", hold={**hold, "min_s": 5.0}, tremor=tremor), seed)
    slide = {"distance_m": labels.stroke_m or STROKE_M}
    if trace.slip is not None and trace.slip.any():
        lasts_s = float(np.ptp(trace.time_s[trace.slip]))
        move = TrapezoidalMove.with_duration(0.0, slide["distance_m"], lasts_s)
        low, high = _SPEEDS_M_S
        slide |= {"speed_m_s": min(max(move.peak_m_s, low), high), "acceleration_m_s2": move.acceleration_m_s2}
    name = surface_of(trial)
    scene = SceneFile(scene="sliding_finger", contact={"surface": name}, hold=hold, slide=slide,
                      surface={"felt_um": levels.get(name, 0.0)})  # fmt: skip
    return Case("slip", scene, seed)


def simulate(design: Design, trial: TrialFile, detector: str, levels: dict[str, float]) -> TrialFile:
    """Simulate the counterpart of a trial; its slip is the motion, as in the recording."""
    case = make_case(trial, levels)
    trace, slide = simulate_trace(design, case, (detector,)), case.scene.slide
    moving = np.zeros(len(trace.time_s), dtype=bool)
    if (start_s := trace.origin.motion_s) is not None:
        move = TrapezoidalMove.with_speed(start_s, slide.distance_m, slide.speed_m_s, slide.acceleration_m_s2)
        moving = (trace.time_s >= start_s) & (trace.time_s <= move.end_s)
    return TrialFile(replace(trial.labels, simulated=True), replace(trace, slip=moving))


def judge(design: Design, trials: Sequence[TrialFile], detector: str) -> DetectorResult:
    """Run a detector on the trials whose motion is known."""
    known = [trial for trial in trials if trial.trace.slip is not None]
    results = (evaluate(make_case(trial, {}), trial.trace, detector, design, (1.0,)) for trial in known)
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

    def as_text(self) -> str:
        return "\n".join([*self._table(), "", *self._histogram(), "", *self._fit()])

    def _table(self) -> Iterator[str]:
        yield f"{self.design.name}, detector {self.detector}; delays since the slide moves (95 % intervals)"
        columns = [*self.results.values()]

        def row(name: str, cells: Iterable[str]) -> str:
            return f"{name:24}" + "".join(f"{cell:>26}" for cell in cells)

        def delay(one: DetectorResult, share: float) -> str:
            return f"{format_ms(one.delay_s(share), unit='')} ({format_interval(one.delay_interval(share))})"

        def found(one: DetectorResult) -> str:
            low, high = one.found_interval
            return f"{100 * one.found_share:.1f} ({100 * low:.1f}-{100 * high:.1f})"

        def alarms(one: DetectorResult) -> str:
            low, high = one.alarm_interval
            return f"{one.alarms_per_minute:.2f} ({low:.2f}-{high:.2f})"

        yield row("", self.results)
        yield row("slides", (str(one.slips) for one in columns))
        if all(one.slips for one in columns):
            yield row("found [%]", map(found, columns))
            yield row("median [ms]", (delay(one, 0.5) for one in columns))
            yield row("90th percentile [ms]", (delay(one, 0.9) for one in columns))
        yield row("alarms/min", map(alarms, columns))
        for cause in dict.fromkeys(cause for one in columns for cause in one.alarms() if cause != "slip"):
            minutes = [one.minutes().get(cause, one.minutes().get("slip", 0.0)) for one in columns]
            apart = ", apart" if cause in REPORTED_SEPARATELY else ""
            yield row(f"  {cause}{apart}", [f"{one.alarms().get(cause, 0)} in {time:.1f} min"
                                            for one, time in zip(columns, minutes, strict=True)])  # fmt: skip

    def _histogram(self) -> Iterator[str]:
        """Histogram of the delays, as in the article's figure 14."""
        yield "delay [ms]   slides, m measured, s simulated, f fitted"
        counts = {name[0]: [min(_LAST_MS, _BIN_MS * math.floor(200 * delay + 0.5)) for delay in one.delays_s]
                  for name, one in self.results.items()}  # fmt: skip
        for at in range(0, _LAST_MS + 1, _BIN_MS):
            bars = [letter * found.count(at) for letter, found in counts.items()]
            if any(bars):
                yield f"{at:7}{'+' if at == _LAST_MS else ' '}     {' '.join(filter(None, bars))}"

    def _fit(self) -> Iterator[str]:
        yield "what in the simulation must move: stated -> recordings (95 % interval)"
        yield from map(str, self.figures)
        yield from self.notes

    def as_data(self) -> dict[str, Any]:
        return {
            "design": self.design.name, "detector": self.detector,
            "results": {
                name: {
                    "slides": one.slips, **summarise(one), "alarms": one.alarms(),
                    "minutes": {cause: to_number(time) for cause, time in one.minutes().items()},
                    "delays_s": [to_number(delay) for delay in one.delays_s],
                }
                for name, one in self.results.items()
            },
            "fit": [{key: to_number(value) if isinstance(value, float) else value for key, value in vars(one).items()}
                    for one in self.figures],
            "notes": [*self.notes],
        }  # fmt: skip

    def files(self) -> dict[str, bytes]:
        """Return file name -> content: text, data, the fitted design, and each surface with its fitted level."""
        surfaces = {f"surface_{name}.toml": f"[surface]\nfelt_um = {um:.6g}\n" for name, um in self.levels.items()}
        heading = f"{self.design.name}, with curve and noise of recordings, by `fingertip validate --recordings`."
        texts = {TEXT: self.as_text() + "\n", DATA: json.dumps(self.as_data(), indent=2, allow_nan=False) + "\n",
                 FITTED: to_toml(self.fitted, heading), **surfaces}  # fmt: skip
        return {name: text.encode() for name, text in texts.items()}


@jit.compiled()
def compare(
    design: Design, trials: Sequence[TrialFile], detector: str, progress: Callable[[str], None] = lambda _: None
) -> RecordingsReport:
    """Compare recordings with their simulation before and after the fit. Raises FingertipError."""
    slides = [trial for trial in trials if trial.labels.kind == "slide"]
    work = Work(
        "recordings", {"simulation": len(trials), **dict.fromkeys(ROUNDS, len(slides)), "fitted": len(trials)}, progress
    )

    def simulate_all(stage: str, some: Sequence[TrialFile], of: Design, levels: dict[str, float]) -> Pairs:
        work.begin(stage)
        found = []
        for number, trial in enumerate(some, 1):
            found.append((trial, simulate(of, trial, detector, levels)))
            work.advance(number / len(some))
        return found

    before = simulate_all("simulation", trials, design, {})

    def sense_n(trial: TrialFile) -> float:
        case = make_case(trial, {})
        force_n = np.array([trial.labels.force_n])
        return float(case.scene.draw_pad(design, case.seed).sensed_n(force_n, None, is_relative=True)[0])

    fitted, figures, note = fit_curve(design, trials, sense_n)
    notes = [note] if note else []
    moved, names = dict[str, Fitted](), dict.fromkeys(map(surface_of, slides))
    fits = {name: LevelFit(name, SURFACES[name].felt_um, SURFACES[name].felt_um) for name in names}
    for stage in ROUNDS if slides else ():
        pairs = simulate_all(stage, slides, fitted, {name: fit.um for name, fit in fits.items()})
        noise = moved["noise"] = fit_noise(design.detector.noise_v, fitted.detector.noise_v, pairs)
        fitted = fitted.with_values({"detector.noise_v": float(f"{noise.value:.4g}")})
        for name, fit in fits.items():
            if level := fit.add_round([pair for pair in pairs if surface_of(pair[0]) == name]):
                moved[name] = level
    levels = {name: fit.um for name, fit in fits.items() if name in moved}
    other = sorted({trial.labels.surface or "(none)" for trial in slides if surface_of(trial) != trial.labels.surface})
    if other:
        notes.append(f"{', '.join(other)}: no surface of the simulation; {_UNKNOWN_SURFACE} stands for it")
    blind = sum(trial.trace.slip is None for trial in slides)
    if blind:
        notes.append(
            f"{blind} slides have no column slip, recorded without a contact that opens with the motion: "
            "they count for curve and noise alone"
        )
    after = simulate_all("fitted", trials, fitted, levels)
    results = {
        "measured": judge(design, trials, detector),
        "simulated": judge(design, [trial for _, trial in before], detector),
        "fitted": judge(fitted, [trial for _, trial in after], detector),
    }
    return RecordingsReport(design, detector, results, (*figures, *moved.values()), fitted, levels, tuple(notes))
