"""Run of `python -m benchmarks.peers`: what it measures, in which order, and what it
writes of it.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from benchmarks.peers import throughput
from benchmarks.peers.board import measure_board
from benchmarks.peers.contact import measure_contact
from benchmarks.peers.native import compile_solvers
from benchmarks.peers.plots import draw, draw_trials
from benchmarks.peers.trial import measure_trial
from benchmarks.peers.work_precision import describe_machine
from fingertip.foundation.jit import compiled
from fingertip.foundation.progress import Work

SECONDS = 5.0
"""Length of the contact problem at which its targets and the board's are judged [s]."""
STAGES = {
    "contact": 20.0,
    "board": 40.0,
    "start-up": 8.0,
    "a whole trial": 10.0,
    "120 trials": 3.0,
    "12 manipulations": 8.0,
    "many boards": 8.0,
    "fresh process": 30.0,
}
"""Stages with their durations relative to each other, measured with all solvers."""


@dataclass(frozen=True, eq=False)
class BenchResult:
    """All measurements, as data, as text and as files."""

    data: dict[str, Any]
    verdict: list[str]
    """Lines that say which targets are met."""
    text: str
    """The verdict and the details."""
    pictures: tuple[bytes, bytes]
    """The work-precision diagrams and the errors of whole trials, as PNG."""
    misses_target: bool

    def encode(self) -> tuple[bytes, ...]:
        """Contents of the files, in the order of `benchmarks.peers.options.FILES`."""
        whole = json.dumps(self.data, indent=2, allow_nan=False) + "\n"
        return (*self.pictures, whole.encode(), f"{self.text}\n".encode())


def run(
    peers: tuple[str, ...],
    seconds: float,
    boards: int,
    first_run: bool,
    progress: Callable[[str], None],
) -> BenchResult:
    """Measure fingertip and its peers. Units: `seconds` [s] of the contact problem."""
    machine = describe_machine()
    with compiled(), compile_solvers(peers) as native:
        for name, reason in native.missing.items():
            progress(f"{name} is NOT MEASURED: {reason}")

        work = Work("bench", STAGES, progress)
        work.begin("contact")
        diagrams = [measure_contact(seconds, peers, native, work.advance)]
        work.begin("board")
        diagrams.append(measure_board(seconds / 5, peers, native, work.advance))

        if seconds != SECONDS:
            for diagram in diagrams:
                diagram.targets.clear()

        work.begin("start-up")
        start_up = throughput.measure_start_up(peers, native)
        work.begin("a whole trial")
        whole_trial = measure_trial()
        work.begin("120 trials")
        trials = throughput.measure_trials()
        work.begin("12 manipulations")
        manipulations = throughput.measure_manipulations()
        work.begin("many boards")
        many = throughput.measure_boards(boards)

    first = None
    if first_run:
        work.begin("fresh process")
        first = throughput.measure_first_run()

    machine["load_after"] = describe_machine()["load"]
    data: dict[str, Any] = {
        "machine": machine,
        "diagrams": [diagram.as_data() for diagram in diagrams],
        "start_up_cpu_s": start_up,
        "whole_trial": whole_trial.as_data(),
        "trials": trials,
        "manipulations": manipulations,
        "boards": many,
        "first_run": first,
    }
    load = (
        f"{machine['machine']}, {machine['cores']} cores, load {machine['load'][0]} before and "
        f"{machine['load_after'][0]} after"
    )
    picture = draw(
        diagrams,
        f"{load}. CPU time of the integration, without start-up and input. Pale: beaten by "
        "another point of the solver",
    )
    trial_picture = draw_trials(
        whole_trial, f"{load}. A trial of the article with each variant of the board."
    )
    targets = {
        **{diagram.problem: diagram.misses_target for diagram in diagrams},
        "whole trial": whole_trial.misses_target,
        **{
            name: found["cpu_s"] > found["target_s"]
            for name, found in (
                ("trials", trials),
                ("manipulations", manipulations),
                ("boards", many),
            )
        },
    }
    misses = any(targets.values())
    verdict = ["a target is MISSED" if misses else "all targets are met"]
    verdict += [f"  {'MISSED' if missed else 'met   '}  {name}" for name, missed in targets.items()]
    verdict += [
        f"  {diagram.problem}: {solver} takes {found.mean:.1f} times fingertip's CPU time, target "
        f"{found.target:g}"
        for diagram in diagrams
        for solver, found in diagram.comparisons().items()
        if found.is_missed
    ]
    if seconds != SECONDS:
        verdict.append(f"  multiples of CPU time are judged at --seconds {SECONDS:g} alone")

    lines = [load]
    for diagram in diagrams:
        lines += diagram.as_text()

    lines.append("start-up, not part of any point above, CPU time:")
    lines += [f"  {name}: {cpu_s:.2f} s" for name, cpu_s in start_up.items()]
    lines += whole_trial.as_text()
    lines += [
        f"{trials['trials']} trials: {trials['cpu_s']:.2f} s of CPU time, target "
        f"{trials['target_s']:.1f} s",
        f"{manipulations['manipulations']} manipulations of {manipulations['simulated_s']:.0f} s "
        "in total, "
        f"controlled every 10 ms: {manipulations['cpu_s']:.2f} s of CPU time, target "
        f"{manipulations['target_s']:.1f} s",
        f"{many['boards']} boards x {many['samples']} samples: {many['cpu_s']:.2f} s of CPU time, "
        f"target {many['target_s']:.1f} s; the diode conducts in "
        f"{100 * many['conducting_ratio']:.1f} % of the steps",
    ]

    if first:
        lines.append(
            f"fresh process: {first['empty_cache_cpu_s']:.1f} s of CPU time with an empty "
            "compiler cache, then "
            f"{first['full_cache_cpu_s']:.1f} s with a full one"
        )

    return BenchResult(
        data=data,
        verdict=verdict,
        text="\n".join([*verdict, "", *lines]),
        pictures=(picture, trial_picture),
        misses_target=misses,
    )
