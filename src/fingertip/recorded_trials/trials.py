"""Recorded trials: what a person does in each, their CSV files, and a folder to give away.

The first line of a file holds its labels. The folder's data sheet is the README of a data set as
public collections read it: a block of YAML, then the questions of T. Gebru et al., Datasheets for
datasets, Commun. ACM 64(12), 2021. Nothing is uploaded.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import BaseModel, ValidationError

from fingertip.design import Design
from fingertip.design.design_file import load_tables, to_toml
from fingertip.documents.template import render
from fingertip.foundation.errors import (
    FingertipError,
    InputFileError,
    Issue,
    TraceError,
    raise_issues,
)
from fingertip.foundation.files import write_file
from fingertip.foundation.input_files import RECORDING_LIMIT, TOML_LIMIT, read_input
from fingertip.foundation.output_set import hash_parameters
from fingertip.slip.traces.read import read_raw_trace
from fingertip.slip.traces.trace import ColumnMap, Trace

STROKE_M = 0.04
Kind = Literal["slide", "hold", "tap", "hand"]
_MAX_LABELS = 2**14
_COLUMNS = ("time_s", "voltage_v", "filtered_v", "slip")
"""Longest line of labels [bytes], and columns of a trial."""
KINDS: Mapping[str, Mapping[str, float]] = {
    "slide": {
        "away": 1.5,
        "press": 1.5,
        "wait": 1.0,
        "slide": 2.0,
        "rest": 1.0,
        "release": 1.0,
    },
    "hold": {
        "away": 1.5,
        "press": 1.5,
        "hold": 5.0,
        "release": 1.0,
    },
    "tap": {
        "away": 1.5,
        "press": 1.5,
        "tap": 4.0,
        "release": 1.0,
    },
    "hand": {
        "away": 1.5,
        "press": 1.5,
        "hand": 5.0,
        "release": 1.0,
    },
}
"""Kind of a trial -> its phases and their durations [s]; a slide is the article's trial (III.C)."""
PAUSE_S = 15.0
"""Time before the first trial, and before one with other weights [s]."""
SAID = {
    "away": "touch nothing",
    "press": "set the finger down, and keep still",
    "wait": "keep still",
    "slide": "let the slide go",
    "rest": "keep still",
    "hold": "keep still",
    "release": "lift the finger",
    "tap": "tap the bench beside the finger, once a second",
    "hand": "move as a hand does: wobble, carry, turn",
}
"""Phase -> what to do in it."""
SHEET = "README.md"
CONSENT = "CONSENT.md"
DESIGN = "design.toml"
_OPEN = "FILL IN"
_REQUIRED = {
    SHEET: (
        r"(?m)^license: *\S+",
        "states no licence; write license: cc-by-4.0 into its first block.",
    ),
    CONSENT: (
        r"(?mi)^agrees: *yes\s*$",
        "nobody agrees; ask who was recorded, and write agrees: yes.",
    ),
}
"""File of a folder -> what must stand in it, and the fault without it."""
_ORDER: tuple[Kind, ...] = ("slide", "slide", "slide", "hold", "slide", "slide", "tap", "hand")


def kind_of(number: int) -> Kind:
    """Return the kind of a trial, numbered from 1: of eight, five slide."""
    return _ORDER[(number - 1) % len(_ORDER)]


def trial_path(folder: Path, number: int) -> Path:
    return folder / f"trial_{number:04}.csv"


def list_trials(folder: Path) -> list[Path]:
    return sorted(folder.glob("trial_*.csv"))


class Labels(BaseModel, frozen=True, allow_inf_nan=False):
    """Labels of a trial beside its samples; None for what is not known.

    `phases` holds the start and end of each phase, as the person was told; `force_n` is that by
    weights, `stroke_m` the way of the slide, and `onset_error_s` the error of the contact that
    opens with the motion. `lost` samples did not arrive, and were replaced by the one before.
    """

    trial: int
    kind: Kind
    phases: Mapping[str, tuple[float, float]]
    design: str
    design_hash: str
    surface: str = ""
    force_n: float | None = None
    stroke_m: float | None = None
    onset_error_s: float | None = None
    lost: int
    firmware: str = ""
    temperature_c: float | None = None
    simulated: bool = False
    format: Literal["fingertip-trial 1"] = "fingertip-trial 1"


@dataclass(frozen=True, eq=False)
class TrialFile:
    labels: Labels
    trace: Trace
    """Samples; `slip` is true while the slide moves, None if its contact was not recorded."""


def write_trial(path: Path, labels: Labels, trace: Trace) -> None:
    """Write a trial; the file is whole or not there.

    Raises OutputError.
    """
    columns = {name: getattr(trace, name) for name in _COLUMNS if getattr(trace, name) is not None}
    text = io.StringIO()
    text.write(f"# {labels.model_dump_json()}\n{','.join(columns)}\n")
    np.savetxt(text, np.column_stack([*columns.values()]), "%.7g", ",")
    write_file(path, text.getvalue().encode())


def read_trial(path: Path, below: Path | None = None) -> TrialFile:
    """Read a trial with its labels. Raises TraceError."""
    try:
        first = read_input(
            path,
            limit=RECORDING_LIMIT,
            wanted="a trial",
            length=_MAX_LABELS,
            below=below,
        ).partition(b"\n")[0]
        labels = Labels.model_validate_json(first.decode("utf-8", "replace").removeprefix("#"))
    except InputFileError as error:
        raise TraceError(error.issues) from None
    except ValidationError as error:
        first_fault = error.errors()[0]
        fault = f"{'.'.join(map(str, first_fault['loc']))}: {first_fault['msg'].lower()}"
        message = (
            f"does not begin with the labels of a trial ({fault}); record it with fingertip record."
        )
        raise TraceError(Issue(path.name, message)) from None

    raw = read_raw_trace(path, ColumnMap())
    raise_issues(TraceError, raw.issues)
    return TrialFile(labels, raw.trace)


def prepare_folder(folder: Path, design: Design) -> None:
    """Write the design, the consent form and the data sheet that a folder lacks.

    Raises TraceError for that of another design.
    """
    sheet = {
        DESIGN: to_toml(design, f"{design.name}, as recorded."),
        CONSENT: render("consent.md", open=_OPEN),
        SHEET: render("recordings.md", name=design.name, open=_OPEN),
    }
    design_path = folder / DESIGN

    if design_path.exists() and _hash_design(folder) != hash_parameters(design.identity()):
        raise TraceError(
            Issue(
                str(folder), f"holds another design; give another --out, or record {design_path}."
            )
        )

    for name, text in sheet.items():
        if not (folder / name).exists():
            write_file(folder / name, text.encode())


def _hash_design(folder: Path) -> str:
    return hash_parameters(
        Design.from_tables(load_tables([folder / DESIGN], (), below=folder).tables).identity()
    )


def _read_all(folder: Path) -> tuple[list[TrialFile], list[Issue]]:
    issues = list[Issue]()
    trials = list[TrialFile]()
    for path in list_trials(folder):
        try:
            trials.append(read_trial(path, folder))
        except FingertipError as error:
            issues += error.issues

    return trials, issues


def read_recordings(folder: Path) -> tuple[TrialFile, ...]:
    """Read all trials of a folder, and raise all their faults at once. Raises TraceError."""
    trials, issues = _read_all(folder)
    if not trials and not issues:
        issues = [Issue(str(folder), "holds no trials; record some with fingertip record.")]

    raise_issues(TraceError, issues)
    return tuple(trials)


def check_recordings(folder: Path) -> tuple[int, list[str], list[str]]:
    """Return the number of trials, faults to mend before the folder is given away, and notes."""
    trials, issues = _read_all(folder)
    faults = [f"{issue.field}: {issue.message}" for issue in issues]
    simulated = sum(trial.labels.simulated for trial in trials)
    notes = []
    if simulated:
        notes.append(
            f"{simulated} trials are simulated, as their labels say: no evidence of a built finger"
        )

    return len(list_trials(folder)), [*faults, *_find_faults(folder, trials)], notes


def _find_faults(folder: Path, trials: Sequence[TrialFile]) -> Iterator[str]:
    try:
        expected = _hash_design(folder)
        for trial in trials:
            if trial.labels.design_hash != expected:
                name = trial_path(folder, trial.labels.trial).name
                yield f"{name}: was recorded with another design; give it its own folder."

    except FingertipError as error:
        yield from (f"{DESIGN}: {issue.field} {issue.message}" for issue in error.issues)

    for name, (pattern, message) in _REQUIRED.items():
        try:
            text = read_input(folder / name, TOML_LIMIT, below=folder).decode("utf-8", "replace")
        except (InputFileError, OSError):
            yield (
                f"{name}: is missing; run fingertip record with --out {folder} once more, which "
                "writes it."
            )
            continue

        lines = [str(number) for number, line in enumerate(text.splitlines(), 1) if _OPEN in line]
        if lines:
            yield f"{name}: is open in line {', '.join(lines)}; write over {_OPEN!r}."
        if not re.search(pattern, text):
            yield f"{name}: {message}"
