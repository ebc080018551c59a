"""Command `python -m tools.accuracy`: measure what docs/accuracy.md
states, and write the page and its pictures.
"""

from __future__ import annotations

import argparse
import itertools
import math
import statistics
from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from benchmarks.peers.board import measure_board
from benchmarks.peers.contact import measure_contact
from benchmarks.peers.native import compile_solvers
from benchmarks.peers.plots import draw
from benchmarks.peers.run import SECONDS
from benchmarks.peers.work_precision import WorkPrecision
from fingertip.design import Design
from fingertip.foundation import display
from fingertip.foundation.jit import compiled
from fingertip.lab.accuracy import accuracy_summary
from fingertip.lab.accuracy.budget import Curve, measure_budget
from fingertip.lab.accuracy.measure import measure_accuracy, measure_steps
from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile
from fingertip.sim.signal.grid import TARGETS
from fingertip.sim.simulation import Simulation, Trial
from fingertip.sim.simulation_summary import has_target
from fingertip.sweep.outputs import load_outputs
from tools.accuracy.stated_errors import try_simulation, try_simulations
from tools.article.steps import generate_trials

DOCS = Path("docs")
TEMPLATE = Path(__file__).with_name("page.md")
DESIGN = "fsr400"
COMPARED = ("fsr400", "article", "first_finger")
TRIALS = 60
STATED = 60
LARGER = 2.0
SOLVERS = ("odeint", "CVODE", "RADAU5", "RADAU", "Rodas5P")


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tools.accuracy", description=__doc__)
    parser.add_argument(
        "--cases", type=int, default=50_000, help="number of extreme cases; 0: keep the table"
    )
    parser.add_argument(
        "--rounds", type=int, default=3, help="number of runs of the comparison with other solvers"
    )
    options = parser.parse_args()
    design = Design.load(DESIGN)
    found = measure_accuracy(design, options.cases or 20)
    curves = measure_budget(design)
    groups = {name: output.group for name, output in load_outputs().items()}
    whole = accuracy_summary.as_text(found).splitlines()
    page = DOCS / "accuracy.md"
    tried = whole if options.cases else page.read_text().splitlines()
    budget = accuracy_summary.budget_text(DESIGN, curves, groups).splitlines()
    peers, picture = _compare_solvers(options.rounds)
    values = {
        "design": DESIGN,
        "cases": f"{options.cases or 50_000}",
        "rounds": f"{options.rounds}",
        "budget": "\n".join([line for line in budget if line.startswith("|")]),
        "steps": "\n".join(_compare_steps()),
        "others": "\n".join(_list_larger(curves)),
        "extremes": "\n".join(_cut(tried, "| family |")),
        "trials": "\n".join(_compare_trials()),
        "stated": "\n".join(_check_stated()),
        "peers": "\n".join(peers),
    }
    text = TEMPLATE.read_text()
    for name, value in values.items():
        text = text.replace(f"{{{{ {name} }}}}", value)

    page.write_text(text)
    (DOCS / "accuracy.png").write_bytes(plot_curves(curves))
    (DOCS / "work_precision.png").write_bytes(picture)


def _cut(lines: list[str], header: str) -> list[str]:
    """Return the table that begins with a header."""
    first = next(i for i, line in enumerate(lines) if line.startswith(header))
    return [
        line
        for line in lines[first : lines.index("", first) if "" in lines[first:] else None]
        if line[:1] == "|"
    ]


def _compare_steps() -> Iterator[str]:
    """Yield the table of the errors by time step, of each design; bold beyond the target."""
    yield "| design | run | step [us] | force [N] | tactile voltage [V] | envelope [V] | CPU [s] |"
    yield "| --- | --- | --- | --- | --- | --- | --- |"
    grasp = ManipulationFile.load("real_manipulation")

    with compiled():
        for name in COMPARED:
            design = Design.load(name)
            for run, scene in (("trial", Trial().scene), ("grasp", grasp)):
                for step in measure_steps(design, run, scene):
                    cells = [
                        f"**{error:.1e}**" if error > TARGETS[signal] else f"{error:.1e}"
                        for signal, error in step.errors.items()
                    ]
                    cells += ["-"] * (len(TARGETS) - len(cells))
                    yield (
                        f"| {name} | {run} | {1e6 * step.step_s:g} | {' | '.join(cells)} | "
                        f"{step.cpu_s:.2f} |"
                    )


def _list_larger(curves: Sequence[Curve]) -> Iterator[str]:
    """Yield the outputs of the other designs whose relative errors at the setting in use are more
    than `LARGER` times those of the first one.
    """
    yield f"| design | output | value | with | error in use | that of `{DESIGN}` |"
    yield "| --- | --- | --- | --- | --- | --- |"
    known = {(curve.source, name): curve for curve in curves for name in curve.errors}

    for design in COMPARED[1:]:
        for curve in measure_budget(Design.load(design)):
            for name in curve.errors:
                first = known.get((curve.source, name))
                if first is None:
                    continue

                error, usual = (_relate(one, name) for one in (curve, first))
                if error > LARGER * usual:
                    yield (
                        f"| {design} | {name} | {curve.values[name]:.4g} | {curve.source} | "
                        f"{error:.1e} | {usual:.1e} |"
                    )


def _relate(curve: Curve, name: str) -> float:
    """Return the error of an output at the setting in use over its value."""
    return curve.errors[name][curve.used] / (abs(curve.values[name]) or 1.0)


def _compare_trials() -> Iterator[str]:
    """Yield the table of the errors of the article's trials, of each design."""
    yield "| design | signal | median | 90th percentile | worst | target |"
    yield "| --- | --- | --- | --- | --- | --- |"

    with compiled():
        for name in COMPARED:
            design = Design.load(name)
            tried = [
                try_simulation(Simulation(design, case.scene, case.seed))
                for case in generate_trials(TRIALS)
            ]
            for signal, limit in TARGETS.items():
                if signal not in tried[0].errors:  # a divider has no envelope
                    continue

                errors = np.array([one.errors[signal] for one in tried])
                median, most, worst = np.quantile(errors, (0.5, 0.9, 1.0))
                yield (
                    f"| {name} | {signal} | {median:.1e} | {most:.1e} | {worst:.1e} | {limit:g} "
                    f"in {np.mean(errors <= limit):.0%} |"
                )


def _check_stated() -> Iterator[str]:
    """Yield the table of how often the errors hold that `simulate` states."""
    with compiled():
        tried = [*try_simulations(STATED)]

    yield "| signal | runs | within the target | within `--verbose` | largest error over that |"
    yield "| --- | --- | --- | --- | --- |"
    for signal, limit in TARGETS.items():
        found = [one for one in tried if signal in one.errors]
        is_held = [
            one.errors[signal] <= limit
            for one in found
            if has_target(one.simulation.design, signal)
        ]
        ratios = [one.errors[signal] / one.bounds[signal] for one in found if one.errors[signal]]
        is_bounded = [ratio <= 1.0 for ratio in ratios]
        yield (
            f"| {signal} | {len(found)} | {sum(is_held)} of {len(is_held)} | {sum(is_bounded)} of "
            f"{len(ratios)} | {max(ratios):.2f} |"
        )


def _compare_solvers(rounds: int) -> tuple[list[str], bytes]:
    """Return the table of other solvers' CPU times, and the diagrams of the last round."""
    ratios: dict[tuple[str, str], list[float]] = defaultdict(list)
    diagrams: list[WorkPrecision] = []

    with compiled(), compile_solvers(SOLVERS) as native:
        for _ in range(rounds):
            diagrams = [
                measure_contact(SECONDS, SOLVERS, native),
                measure_board(SECONDS / 5, SOLVERS, native),
            ]
            for diagram in diagrams:
                for solver, one in diagram.comparisons().items():
                    if one.mean and "fingertip" not in solver:
                        ratios[diagram.problem.partition(",")[0], solver].append(one.mean)

    lines = ["| problem | solver | multiple | range |", "| --- | --- | --- | --- |"]
    for (problem, solver), found in sorted(
        ratios.items(), key=lambda item: (item[0][0], statistics.median(item[1]))
    ):
        lines.append(
            f"| {problem} | {solver} | {statistics.median(found):.1f} | {min(found):.1f} to "
            f"{max(found):.1f} |"
        )

    return lines, draw(diagrams, "CPU time of the integration, without start-up and input.")


def plot_curves(curves: Sequence[Curve]) -> bytes:
    """Plot the relative error of each output at its settings, the one in use filled;
    returns a PNG.
    """
    figure = display.new_figure(14, 8)
    drawn = [curve for curve in curves if any(map(any, curve.errors.values()))]
    styles = list(itertools.product(("-", "--"), display.SERIES))

    for axes, curve in zip(
        figure.subplots(2, -(-len(drawn) // 2), squeeze=False).flat, drawn, strict=False
    ):
        for (dashes, colour), (name, errors) in zip(styles, curve.errors.items(), strict=False):
            relative = [error / (abs(curve.values[name]) or 1.0) for error in errors]
            known = [i for i, error in enumerate(relative) if 0.0 < error < math.inf]
            x = [curve.cpu_s[i] for i in known]
            y = [relative[i] for i in known]
            axes.loglog(x, y, f"o{dashes}", color=colour, markerfacecolor="none", label=name)
            if curve.used in known:
                axes.loglog([curve.cpu_s[curve.used]], [relative[curve.used]], "o", color=colour)

        axes.set(xlabel=f"{curve.source}; CPU time", ylabel="error / value")
        axes.set_xticks([], minor=True)
        ticks = zip(curve.settings, curve.cpu_s, strict=True)
        axes.set_xticks(curve.cpu_s, [f"{setting:g}\n{cpu_s:.2g} s" for setting, cpu_s in ticks])
        axes.set_ylim(top=axes.get_ylim()[1] * 4.0)  # room for the names
        axes.legend(
            frameon=False,
            fontsize=6,
            ncols=2,
            loc="upper right",
        )
        display.style_axes(axes, "both")

    return display.to_png(figure)


if __name__ == "__main__":
    main()
