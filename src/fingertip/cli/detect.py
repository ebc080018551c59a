"""`fingertip detect`: find slip in a trace, and judge it where the trace knows the truth."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fingertip.cli.console import Console, JsonOption, QuietOption, SetOption, command

if TYPE_CHECKING:
    from fingertip.slip import Detection, Interval


@command
def detect(
    trace: Annotated[Path, typer.Argument(help="Trace (CSV): time_s, voltage_v, and force_n and slip where known.")],
    design: Annotated[Path | None, typer.Option("--design", help="Design file; without it, the defaults.")] = None,
    detector: Annotated[
        str, typer.Option("--detector", help="paper (the article's chain), fft (its baseline) or fast (ours).")
    ] = "paper",
    plot: Annotated[Path | None, typer.Option("--plot", help="Picture of the detection to write (PNG).")] = None,
    changes: SetOption = None,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Find slip in a trace, with the article's chain or another detector."""
    from fingertip import slip
    from fingertip.design import Design
    from fingertip.slip.trace_file import read_csv

    console = Console(as_json, quiet)
    loaded = Design.load(*([design] if design else []), changes=changes or ())
    read = read_csv(trace, loaded.detector)
    found = slip.detect(read, loaded, detector)
    if detector == "paper" and found.threshold_v < found.noise.mean_v:
        console.say(
            f"warning: detector.threshold_v of {found.threshold_v:g} V is below the level of the "
            f"noise alone ({found.noise.mean_v:.3g} V); {found.noise.threshold_v:.3g} V stands clear of it."
        )
    if plot is not None:
        from fingertip.files import write_file
        from fingertip.slip.plot import draw

        console.say(f"drawing {plot}")
        write_file(plot, draw(read, found, trace.name), "--plot")
    console.result(_data(found), _text(found))


def _data(found: Detection) -> dict[str, Any]:
    score = found.score
    return {
        "intervals": [_interval(i) for i in found.intervals],
        "slips": None if score is None else [_interval(i) for i in score.slips],
        "delays_s": None if score is None else [None if d is None else round(d, 7) for d in score.delays_s],
        "missed_slips": None if score is None else [_interval(i) for i in score.missed],
        "false_intervals": None if score is None else [_interval(i) for i in score.false_intervals],
        "detector": found.detector,
        "threshold_v": round(found.threshold_v, 6),
        "noise_threshold_v": round(found.noise.threshold_v, 6),
    }


def _interval(interval: Interval) -> dict[str, float]:
    return {"onset_s": round(interval.onset_s, 7), "end_s": round(interval.end_s, 7)}


def _text(found: Detection) -> str:
    lines = [f"ON   {i.onset_s:9.4f} s to {i.end_s:9.4f} s" for i in found.intervals] or ["never ON"]
    if found.score is None:
        return "\n".join(lines)
    score = found.score
    for slip, delay in zip(score.slips, score.delays_s, strict=True):
        verdict = "missed" if delay is None else f"found after {1000 * delay:.1f} ms"
        lines.append(f"slip {slip.onset_s:9.4f} s to {slip.end_s:9.4f} s: {verdict}")
    lines.append(f"false intervals: {len(score.false_intervals)}")
    lines.extend(f"     {i.onset_s:9.4f} s to {i.end_s:9.4f} s" for i in score.false_intervals)
    return "\n".join(lines)
