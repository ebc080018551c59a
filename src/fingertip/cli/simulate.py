"""`fingertip simulate`: one sliding-finger trial of the article, as the voltage a converter would have
sampled."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fingertip.cli.console import Console, JsonOption, QuietOption, SetOption, command


@command
def simulate(
    design: Annotated[Path | None, typer.Argument(help="Design file; without it, the defaults.")] = None,
    out: Annotated[Path, typer.Option("--out", "-o", help="Trace to write (CSV).")] = Path("trace.csv"),
    seed: Annotated[int, typer.Option(help="Seed of force, surface and noise.")] = 0,
    speed_m_s: Annotated[
        float, typer.Option("--speed-m-s", help="Peak sliding velocity; the article's: 0.04, 0.06, 0.08.")
    ] = 0.04,
    surface: Annotated[str, typer.Option(help="smooth, medium, gross, wood, paper or plastic.")] = "medium",
    force_n: Annotated[
        float | None, typer.Option("--force-n", help="Holding force; 0.2 to 2 N by the seed if left out.")
    ] = None,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Simulate one sliding-finger trial and write its trace."""
    from fingertip import sim
    from fingertip.design import Design
    from fingertip.errors import Fault, FingertipError
    from fingertip.files import write_file
    from fingertip.slip.intervals import intervals
    from fingertip.slip.trace_file import to_csv

    console = Console(as_json, quiet)
    faults: list[Fault] = []
    loaded = trial = None
    try:
        loaded = Design.load(*([design] if design else []), changes=changes or ())
    except FingertipError as error:
        faults.extend(error.faults)
    try:
        trial = sim.Trial(surface, speed_m_s, force_n, seed)
    except FingertipError as error:
        faults.extend(error.faults)
    if loaded is None or trial is None:
        raise FingertipError(faults)

    trace = sim.simulate(loaded, trial)
    write_file(out, to_csv(trace))
    console.say(f"wrote {out}")
    slips = intervals(trace.time_s, trace.slip) if trace.slip is not None else ()
    data = {
        "trace": out.as_posix(),
        "samples": len(trace.time_s),
        "sample_rate_hz": loaded.detector.sample_rate_hz,
        "duration_s": round(float(trace.time_s[-1]), 7),
        "surface": trial.surface,
        "speed_m_s": trial.speed_m_s,
        "force_n": round(trial.holding_force_n, 6),
        "seed": trial.seed,
        "slips": [{"onset_s": round(s.onset_s, 7), "end_s": round(s.end_s, 7)} for s in slips],
    }
    lines = [
        f"{sim.SURFACES[trial.surface].label}, {trial.speed_m_s:g} m/s, "
        f"{trial.holding_force_n:.2f} N, seed {trial.seed}: "
        f"{len(trace.time_s)} samples, {trace.time_s[-1]:.2f} s",
        *(f"gross slip from {s.onset_s:.4f} s to {s.end_s:.4f} s" for s in slips),
    ]
    console.result(data, "\n".join(lines))
