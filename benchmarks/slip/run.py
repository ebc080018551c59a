"""Run of `python -m benchmarks.slip`: its options, the recordings, and the report."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.slip.bench import Source, measure
from benchmarks.slip.competitors import COMPETITORS, find_competitor, list_rows
from benchmarks.slip.own_sets import JUDGING, SEEDS, list_generated
from benchmarks.slip.public_sets import LAYOUTS, read_layout
from benchmarks.slip.recordings import Recording, RecordingSet, read_folder
from benchmarks.slip.report import FILES, Report
from fingertip.design import Design
from fingertip.detection.warnings import hum_warnings
from fingertip.foundation import extras
from fingertip.foundation.errors import FingertipError, Issue, gather
from fingertip.foundation.progress import Work
from fingertip.foundation.workers import count_processors, side_by_side

__all__ = ["FILES", "Options", "read_options", "run"]


DEFAULT_SHARE = 0.1
"""Share of the project's own signals that each seed draws unless another one is given."""


@dataclass(frozen=True)
class Options:
    """Detectors that are compared, and on which recordings."""

    folder: Path | None
    layout: str | None
    names: tuple[str, ...]
    share: float


@dataclass(frozen=True, eq=False)
class ReadSet:
    """Recordings that were read already."""

    recordings: Sequence[Recording]
    run: int = 0

    def read(self) -> Iterator[Recording]:
        return iter(self.recordings)


def read_options(
    folder: Path | None,
    *,
    layout: str | None,
    detectors: str | None,
    own: Path | None,
    share: float,
) -> Options:
    """Check the options, before any work. Raises FingertipError with all faults."""
    issues = list[Issue]()
    names = [name.strip() for name in (detectors or ",".join(COMPETITORS)).split(",")]
    known = ", ".join(COMPETITORS)
    issues += [
        Issue("--detectors", f"{name!r} is not known; choose among {known}.")
        for name in names
        if name not in COMPETITORS
    ]

    if layout is not None and layout not in LAYOUTS:
        layouts = "; ".join(f"{name} ({one.words})" for name, one in LAYOUTS.items())
        issues.append(Issue("--layout", f"{layout!r} is not known; choose among {layouts}."))
    if layout is not None and folder is None:
        issues.append(Issue("--layout", "describes a folder; give the folder that holds the set."))
    if folder is not None and not folder.is_dir():
        issues.append(
            Issue(str(folder), "is not a folder; give the one that holds the recordings.")
        )
    if not 0.05 <= share <= 1.0:
        issues.append(Issue("--share", f"{share:g} is out of bounds; choose 0.05 to 1."))
    if folder is not None and share != DEFAULT_SHARE:
        message = "draws from the project's own signals; leave it out, or leave out the folder."
        issues.append(Issue("--share", message))

    if own is not None:
        with gather(issues):
            find_competitor(str(own))
            names.append(str(own))

    if issues:
        raise FingertipError(issues)

    extras.require("python -m benchmarks.slip", "scipy", "numba")
    return Options(folder, layout, tuple(names), share)


def run(
    design: Design,
    options: Options,
    progress: Callable[[str], None],
    warn: Callable[[list[str]], None] = lambda _: None,
) -> Report:
    """Read or draw the recordings, warn of hum in those of a folder, and run the detectors.

    Raises TraceError.
    """
    sources = list[Source]()
    if options.folder is None:
        title = "Signals of benchmarks/held_out_signals.py, both boards"
        sources += list_generated(SEEDS[JUDGING], options.share)
    else:
        found = _read(options.folder, options.layout)
        warn(_find_hum(found.recordings))
        title = found.title
        sources += [ReadSet([one]) for one in found.recordings]

    work = Work("slip detectors", {"detectors": 1.0}, progress)
    work.begin("detectors")
    done = 0

    def advance() -> None:
        nonlocal done
        done += 1
        work.advance(done / len(sources))

    rows = list_rows(options.names, has_rest=options.folder is not None)
    with side_by_side(count_processors() if options.folder is None else 1):
        measured = measure(design, rows, sources, advance=advance)

    return Report(title, measured, rows)


def _read(folder: Path, layout: str | None) -> RecordingSet:
    return read_folder(folder) if layout is None else read_layout(layout, folder)


def _find_hum(recordings: Sequence[Recording]) -> list[str]:
    signals = [recording.signal for recording in recordings]
    return [
        f"{one.kind}: {text}"
        for one in signals
        for text in hum_warnings(one.voltage_v, one.rate_hz)
    ]
