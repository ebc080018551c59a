"""Folder of recordings to give away: trials, the design, a data sheet, and the consent of whoever was recorded.

The data sheet is the README of a data set as public collections read it: a block of YAML, then the questions of
T. Gebru et al., Datasheets for datasets, Commun. ACM 64(12), 2021. Nothing is uploaded.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from fingertip.bench.trials import TrialFile, list_trials, read_trial
from fingertip.design import Design
from fingertip.design.files import load_tables, to_toml
from fingertip.documents.template import render
from fingertip.foundation.errors import FingertipError, InputFileError, Issue, TraceError
from fingertip.foundation.files import write_file
from fingertip.foundation.input_files import TOML_LIMIT, read_input
from fingertip.foundation.output_set import hash_parameters

SHEET, CONSENT, DESIGN = "README.md", "CONSENT.md", "design.toml"
_OPEN = "FILL IN"
_LICENCE = re.compile(r"^license: *\S+", re.MULTILINE)
_AGREED = re.compile(r"^agrees: *yes\s*$", re.MULTILINE | re.IGNORECASE)


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


def read_recordings(folder: Path) -> tuple[TrialFile, ...]:
    """Read all trials of a folder, whose faults are found at once. Raises TraceError."""
    issues, found = list[Issue](), list[TrialFile]()
    for path in list_trials(folder):
        try:
            found.append(read_trial(path, folder))
        except FingertipError as error:
            issues += error.issues
    if not found and not issues:
        issues.append(Issue(str(folder), "holds no trials; record some with fingertip record."))
    if issues:
        raise TraceError(issues)
    return tuple(found)


def check_recordings(folder: Path) -> tuple[int, list[str]]:
    """Return the number of trials, and what keeps the folder from being given away, in sentences."""
    return len(list_trials(folder)), [*_find_faults(folder)]


def _find_faults(folder: Path) -> Iterator[str]:
    try:
        expected = _hash_design(folder)
    except FingertipError as error:
        expected = ""
        yield from (f"{DESIGN}: {issue.field} {issue.message}" for issue in error.issues)
    for path in list_trials(folder):
        try:
            labels = read_trial(path, folder).labels
        except FingertipError as error:
            yield from (f"{issue.field}: {issue.message}" for issue in error.issues)
            continue
        if expected and labels.design_hash != expected:
            yield f"{path.name}: was recorded with another design than {DESIGN}; keep it in a folder of its own."
    texts = dict[str, str]()
    for name in (SHEET, CONSENT):
        try:
            texts[name] = read_input(folder / name, TOML_LIMIT, below=folder).decode("utf-8", "replace")
        except (InputFileError, OSError):
            yield f"{name}: is missing; run fingertip record with --out {folder} once more, which writes it."
    for name, text in texts.items():
        lines = [number for number, line in enumerate(text.splitlines(), 1) if _OPEN in line]
        if lines:
            yield f"{name}: is open in line {', '.join(map(str, lines))}; write over {_OPEN!r}."
    if SHEET in texts and not _LICENCE.search(texts[SHEET]):
        yield f"{SHEET}: states no licence; write license: cc-by-4.0 into its first block."
    if CONSENT in texts and not _AGREED.search(texts[CONSENT]):
        yield f"{CONSENT}: nobody agrees; ask who was recorded, and write agrees: yes."
