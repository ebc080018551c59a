"""Trials of a bench: what a person does in each, one CSV file per trial, and a folder of them to give away.

The first line of a file holds its labels. The folder's data sheet is the README of a data set as public collections
read it: a block of YAML, then the questions of T. Gebru et al., Datasheets for datasets, Commun. ACM 64(12), 2021.
Nothing is uploaded.
"""

from __future__ import annotations

import io
import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np

from fingertip.design import Design
from fingertip.design.files import load_tables, to_toml
from fingertip.documents.template import render
from fingertip.foundation.errors import FingertipError, InputFileError, Issue, TraceError, quote_value, raise_issues
from fingertip.foundation.files import write_file
from fingertip.foundation.input_files import RECORDING_LIMIT, TOML_LIMIT, read_input
from fingertip.foundation.output_set import hash_parameters
from fingertip.slip.traces.read import read_raw_trace
from fingertip.slip.traces.trace import ColumnMap, Trace

FORMAT, STROKE_M = "fingertip-trial 1", 0.04
_MAX_LABELS = 2**14
"""Longest line of labels [bytes]."""
_NUMBERS = ("force_n", "stroke_m", "onset_error_s", "temperature_c")
KINDS: Mapping[str, Mapping[str, float]] = {
    "slide": {"away": 1.5, "press": 1.5, "wait": 1.0, "slide": 2.0, "rest": 1.0, "release": 1.0},
    "hold": {"away": 1.5, "press": 1.5, "hold": 5.0, "release": 1.0},
    "tap": {"away": 1.5, "press": 1.5, "tap": 4.0, "release": 1.0},
    "hand": {"away": 1.5, "press": 1.5, "hand": 5.0, "release": 1.0},
}
"""Kind of a trial -> its phases and their durations [s]; a slide is the article's trial (III.C)."""
PAUSE_S = 15.0
"""Time before the first trial, and before one with other weights [s]."""
SAID = {
    "away": "touch nothing", "press": "set the finger down, and keep still", "wait": "keep still",
    "slide": "let the slide go", "rest": "keep still", "hold": "keep still", "release": "lift the finger",
    "tap": "tap the bench beside the finger, once a second", "hand": "move as a hand does: wobble, carry, turn",
}  # fmt: skip
"""Phase -> what to do in it."""
SHEET, CONSENT, DESIGN = "README.md", "CONSENT.md", "design.toml"
_OPEN = "FILL IN"
_REQUIRED = {
    SHEET: (r"(?m)^license: *\S+", "states no licence; write license: cc-by-4.0 into its first block."),
    CONSENT: (r"(?mi)^agrees: *yes\s*$", "nobody agrees; ask who was recorded, and write agrees: yes."),
}
"""File of a folder -> what must stand in it, and the fault without it."""
_ORDER = ("slide", "slide", "slide", "hold", "slide", "slide", "tap", "hand")


def kind_of(number: int) -> str:
    """Return the kind of a trial, numbered from 1: of eight, five slide."""
    return _ORDER[(number - 1) % len(_ORDER)]


def trial_path(folder: Path, number: int) -> Path:
    return folder / f"trial_{number:04}.csv"


def list_trials(folder: Path) -> list[Path]:
    return sorted(folder.glob("trial_*.csv"))


@dataclass(frozen=True)
class Labels:
    """What is known of a trial beside its samples."""

    trial: int
    kind: str
    phases: Mapping[str, tuple[float, float]]
    """Phase -> its start and end, as the person was told [s]."""
    design: str
    design_hash: str
    surface: str = ""
    force_n: float | None = None
    """Force by weights [N]; None if it is not known."""
    stroke_m: float | None = None
    """Way of the slide [m]."""
    onset_error_s: float | None = None
    """Error of the contact that opens with the motion [s]; None if it is not known."""
    lost: int = 0
    """Samples that did not arrive, and were replaced by the one before."""
    firmware: str = ""
    temperature_c: float | None = None
    simulated: bool = False
    format: str = field(default=FORMAT, kw_only=True)

    def find_issues(self, name: str) -> Iterator[Issue]:
        ends = (end for pair in self.phases.values() for end in pair)
        numbers = (*(getattr(self, key) for key in _NUMBERS), *ends)
        if self.format != FORMAT:
            yield Issue(name, f"has the format {quote_value(str(self.format))}; record it again as {FORMAT!r}.")
        if self.kind not in KINDS:
            yield Issue(name, f"has the kind {quote_value(str(self.kind))}; give one of {', '.join(KINDS)}.")
        if any(number is not None and not math.isfinite(number) for number in numbers):
            yield Issue(name, "holds a label that is not finite; correct its first line.")


@dataclass(frozen=True, eq=False)
class TrialFile:
    labels: Labels
    trace: Trace
    """Samples; `slip` is true while the slide moves, and None where its contact was not recorded."""


def write_trial(path: Path, labels: Labels, trace: Trace) -> None:
    """Write a trial under another name and rename it: the file is whole or not there. Raises OutputError."""
    columns = {"time_s": trace.time_s, "voltage_v": trace.voltage_v, "filtered_v": trace.filtered_v, "slip": trace.slip}
    known = {name: values for name, values in columns.items() if values is not None}
    text = io.StringIO()
    text.write(f"# {json.dumps(asdict(labels))}\n{','.join(known)}\n")
    np.savetxt(text, np.column_stack([*known.values()]), "%.7g", ",")
    write_file(path, text.getvalue().encode())


def read_trial(path: Path, below: Path | None = None) -> TrialFile:
    """Read a trial with its labels. Raises TraceError."""
    try:
        first = read_input(path, RECORDING_LIMIT, "a trial", _MAX_LABELS, below).partition(b"\n")[0]
        found = json.loads(first.decode().removeprefix("#"))
        known: dict[str, Any] = {each.name: found[each.name] for each in fields(Labels) if each.name in found}
        told: dict[str, Any] = known["phases"]
        phases = {name: (float(start), float(end)) for name, (start, end) in told.items()}
        numbers = {key: float(known[key]) for key in _NUMBERS if known.get(key) is not None}
        labels = Labels(**{**known, **numbers, "phases": phases})
        raise_issues(TraceError, labels.find_issues(path.name))
    except InputFileError as error:
        raise TraceError(error.issues) from None
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        message = "does not begin with the labels of a trial; record it with fingertip record."
        raise TraceError(Issue(path.name, message)) from None
    raw = read_raw_trace(path, ColumnMap())
    raise_issues(TraceError, raw.issues)
    return TrialFile(labels, raw.trace)


def prepare_folder(folder: Path, design: Design) -> None:
    """Write what the folder lacks of data sheet, consent and design. Raises TraceError for that of another design."""
    sheet = {
        DESIGN: to_toml(design, f"{design.name}, as recorded."),
        SHEET: render("recordings.md", name=design.name, open=_OPEN),
        CONSENT: render("consent.md", open=_OPEN),
    }
    kept = folder / DESIGN
    if kept.exists() and _hash_design(folder) != hash_parameters(design.identity()):
        message = f"holds recordings of another design; choose another folder with --out, or record {kept}."
        raise TraceError(Issue(str(folder), message))
    for name, text in sheet.items():
        if not (folder / name).exists():
            write_file(folder / name, text.encode())


def _hash_design(folder: Path) -> str:
    loaded = load_tables([folder / DESIGN], (), below=folder)
    return hash_parameters(Design.from_tables(loaded.tables).identity())


def is_recordings(folder: Path) -> bool:
    return bool(list_trials(folder)) and (folder / DESIGN).exists()


def _read_all(folder: Path) -> tuple[list[TrialFile], list[Issue]]:
    issues, found = list[Issue](), list[TrialFile]()
    for path in list_trials(folder):
        try:
            found.append(read_trial(path, folder))
        except FingertipError as error:
            issues += error.issues
    return found, issues


def read_recordings(folder: Path) -> tuple[TrialFile, ...]:
    """Read all trials of a folder, whose faults are found at once. Raises TraceError."""
    found, issues = _read_all(folder)
    if not found and not issues:
        issues.append(Issue(str(folder), "holds no trials; record some with fingertip record."))
    raise_issues(TraceError, issues)
    return tuple(found)


def check_recordings(folder: Path) -> tuple[int, list[str], list[str]]:
    """Return the number of trials, what keeps the folder from being given away, and what to know of it."""
    found, issues = _read_all(folder)
    faults = [f"{issue.field}: {issue.message}" for issue in issues]
    simulated = sum(trial.labels.simulated for trial in found)
    notes = [f"{simulated} trials are simulated, as their labels say: no evidence of a built finger"] * (simulated > 0)
    return len(list_trials(folder)), [*faults, *_find_faults(folder, found)], notes


def _find_faults(folder: Path, trials: Sequence[TrialFile]) -> Iterator[str]:
    try:
        expected = _hash_design(folder)
        others = [each.labels.trial for each in trials if each.labels.design_hash != expected]
        yield from (f"trial {number}: was recorded with another design than {DESIGN}; keep it in a folder of its own."
                    for number in others)  # fmt: skip
    except FingertipError as error:
        yield from (f"{DESIGN}: {issue.field} {issue.message}" for issue in error.issues)
    for name, (pattern, message) in _REQUIRED.items():
        try:
            text = read_input(folder / name, TOML_LIMIT, below=folder).decode("utf-8", "replace")
        except (InputFileError, OSError):
            yield f"{name}: is missing; run fingertip record with --out {folder} once more, which writes it."
            continue
        if lines := [str(number) for number, line in enumerate(text.splitlines(), 1) if _OPEN in line]:
            yield f"{name}: is open in line {', '.join(lines)}; write over {_OPEN!r}."
        if not re.search(pattern, text):
            yield f"{name}: {message}"
