"""Run of `python -m benchmarks.slip`: its options, the recordings, and the report."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from benchmarks import held_out_signals
from benchmarks.slip.competitors import COMPETITORS, Competitor, load_own
from benchmarks.slip.public_sets import LAYOUTS, read_layout
from benchmarks.slip.recordings import Recording, count_held_out, draw_held_out, read_folder
from benchmarks.slip.report import FILES, Report
from benchmarks.slip.scores import measure
from fingertip.design import Design
from fingertip.detection.warnings import hum_warnings
from fingertip.firmware.measured_costs import read_costs
from fingertip.foundation import extras
from fingertip.foundation.errors import FingertipError, Issue, gather
from fingertip.foundation.progress import Work

__all__ = ["FILES", "Source", "read_options", "run"]


DEFAULT_SHARE = 0.25
"""Share of the project's own signals that is drawn unless another one is given."""


@dataclass(frozen=True)
class Source:
    """Detectors that are compared, and on which recordings."""

    folder: Path | None
    layout: str | None
    competitors: Mapping[str, Competitor]
    share: float


def read_options(
    folder: Path | None,
    layout: str | None,
    detectors: str | None,
    own: Path | None,
    share: float,
) -> Source:
    """Check the options, before any work. Raises FingertipError with all faults."""
    issues = list[Issue]()
    names = (
        tuple(COMPETITORS)
        if detectors is None
        else tuple(name.strip() for name in detectors.split(","))
    )

    for name in names:
        if name not in COMPETITORS:
            issues.append(
                Issue(
                    "--detectors", f"{name!r} is not known; choose among {', '.join(COMPETITORS)}."
                )
            )

    if layout is not None and layout not in LAYOUTS:
        known = "; ".join(f"{name} ({one.words})" for name, one in LAYOUTS.items())
        issues.append(Issue("--layout", f"{layout!r} is not known; choose among {known}."))

    if layout is not None and folder is None:
        issues.append(Issue("--layout", "describes a folder; give the folder that holds the set."))
    if folder is not None and not folder.is_dir():
        issues.append(
            Issue(str(folder), "is not a folder; give the one that holds the recordings.")
        )
    if not 0.05 <= share <= 1.0:
        issues.append(Issue("--share", f"{share:g} is out of bounds; choose 0.05 to 1."))

    competitors = {name: COMPETITORS[name] for name in names if name in COMPETITORS}
    if own is not None:
        with gather(issues):
            competitors[own.stem] = load_own(own)

    if folder is not None and share != DEFAULT_SHARE:
        issues.append(
            Issue(
                "--share",
                "draws from the project's own signals; leave it out, or leave out the folder.",
            )
        )
    if issues:
        raise FingertipError(issues)

    extras.require("python -m benchmarks.slip", "scipy", "numba", "matplotlib")
    return Source(folder, layout, competitors, share)


def run(
    design: Design,
    source: Source,
    progress: Callable[[str], None],
    warn: Callable[[list[str]], None] = lambda _: None,
) -> Report:
    """Read or draw the recordings, warn of hum in those of a folder, and run the detectors over
    them.

    Raises TraceError.
    """
    recordings: Iterable[Recording]
    if source.folder is None:
        title = f"Signals of benchmarks/held_out_signals.py, for the board of {design.name}"
        recordings = draw_held_out(design, source.share, 1)
        count = sum(count_held_out(row, source.share) for row in held_out_signals.ROWS)
    else:
        found = (
            read_folder(source.folder)
            if source.layout is None
            else read_layout(source.layout, source.folder)
        )
        title, recordings, count = found.title, found.recordings, len(found.recordings)
        signals = [recording.signal for recording in recordings]
        warn(
            [
                f"{one.kind}: {text}"
                for one in signals
                for text in hum_warnings(one.voltage_v, one.rate_hz)
            ]
        )

    work = Work("slip detectors", {"detectors": 1.0}, progress)
    work.begin("detectors")
    done = 0

    def advance(_: Recording) -> None:
        nonlocal done
        done += 1
        work.advance(done / count)

    points = measure(design, recordings, source.competitors, advance)
    return Report(title, points, source.competitors, _read_instructions(design))


def _read_instructions(design: Design) -> int | None:
    """Instructions a sample in slip, measured by the emulator of a Cortex-M4F; None for another
    sampling rate.
    """
    measured = read_costs()
    if not math.isclose(design.detector.sample_rate_hz, measured["sample_rate_hz"]):
        return None

    return int(measured["targets"]["Cortex-M4F"]["instructions"]["slip"])
