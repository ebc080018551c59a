"""`fingertip accuracy`: errors of the simulation against run time, and extreme cases."""

from __future__ import annotations

from pathlib import Path

import typer

from fingertip.cli.console import Console
from fingertip.cli.options import JOBS, OPTIONAL_DESIGN, command, load_design, parse_design, refuse


@command
def accuracy(
    console: Console,
    design: Path | None = OPTIONAL_DESIGN,
    of: Path | None = typer.Argument(
        None, parser=parse_design, metavar="DESIGN", help="Design, after the word budget."
    ),
    cases: int = typer.Option(5000, help="Number of extreme cases, 1 to 1000000."),
    jobs: int | None = JOBS,
    out: Path = typer.Option(
        Path("out/accuracy"), "--out", "-o", help="Folder for accuracy.txt and .json."
    ),
) -> None:
    """Measure the errors of simulated traces against run time, and try extreme cases. Exit code 1:
    one is wrong.

    A trial and a grasp of the design run with the program's time step, a half and a quarter of it;
    the reference has steps 16 times as short. Extreme and stiff cases of contact and board are
    held, refused with a reason, or wrong.

    After the word budget: errors of 25 named outputs at three settings of steps, grids, meshes and
    samples each, with their CPU time.
    """
    from fingertip.foundation.errors import Issue
    from fingertip.foundation.output_set import SetWriter, hash_parameters
    from fingertip.lab.accuracy import accuracy_summary
    from fingertip.lab.accuracy.budget import measure_budget
    from fingertip.lab.accuracy.measure import measure_accuracy
    from fingertip.sweep.outputs import load_outputs

    outside = Issue("--cases", f"{cases} is out of bounds; choose 1 to 1000000.")
    refuse([] if 1 <= cases <= 1_000_000 else [outside])
    is_budget = design == Path("budget")
    extra = Issue("DESIGN", f"{of} is one design too many; name one, or write budget ahead of it.")
    refuse([extra] if of and not is_budget else [])
    loaded = load_design(of if is_budget else design, None, console)

    if is_budget:
        curves = measure_budget(loaded, console.progress)
        groups = {name: output.group for name, output in load_outputs().items()}
        data = accuracy_summary.budget_data(loaded.name, curves, groups)
        console.result(data, accuracy_summary.budget_text(loaded.name, curves, groups))
        return

    writer = SetWriter(out, "accuracy", loaded.name, hash_parameters(loaded.identity()))
    writer.check(accuracy_summary.FILES)
    errors = measure_accuracy(loaded, cases, console.progress, jobs)
    writer.write(accuracy_summary.as_files(errors))
    text = f"{accuracy_summary.as_text(errors)}\ndetails: {out / accuracy_summary.FILES[0]}"
    passed = all(extreme.is_passed for extreme in errors.extremes)
    console.result(accuracy_summary.as_data(errors), text, passed)
