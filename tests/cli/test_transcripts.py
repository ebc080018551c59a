"""Transcripts of sessions at a terminal: every line that the commands print, and every file that
they write.

After a change that is meant, `FINGERTIP_APPROVE=1 pytest tests/cli/test_transcripts.py` writes
them; then read the difference. In a transcript, `== ` begins a heading, `--- NAME` the content of a
file, and `$ ` a command. Below it stand its output, what it says on stderr after `! `, the files
that it made (`+`), changed (`~`) or removed (`-`), and its exit code unless that is 0, or 2 after
an error. `... 12` are 12 lines that such a command has printed above too. Ahead of `fingertip`,
`head 9` prints the first lines alone and `json` its data. `cat` prints a file (of JSON, its data),
`edit` replaces a text in one, and `complete` is the tab key.
"""

from __future__ import annotations

import importlib
import io
import itertools
import json
import os
import re
import shlex
from contextlib import redirect_stdout
from difflib import SequenceMatcher
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import patch

import pytest
import typer

from fingertip.cli import app
from fingertip.cli.completion import answer_shell
from tests.approved import check_text, list_data
from tests.conftest import run_fingertip
from tests.sweep.examples import InlineEngine

TRANSCRIPTS = {
    path.stem: path for path in sorted((Path(__file__).parent / "transcripts").glob("*.txt"))
}
SLOW = ("designs", "signals", "sweeps")
"""Transcripts that take seconds, or whose commands others of the first set run too."""
WITHOUT_EXTRAS = ("without_extras", "sweeps")
"""Transcripts of a core installation; a sweep's report has plots otherwise, which take seconds."""
COMMAND: Any = typer.main.get_command(app)


def files_below(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def run(words: list[str]) -> str:
    """Run a command in the working folder, and return what it prints, writes and ends with."""
    program, *words = words
    if program == "cat":
        text = Path(*words).read_text(encoding="utf-8")
        return "\n".join([*list_data(json.loads(text)), ""]) if words[0].endswith(".json") else text
    if program == "edit":
        path, old, new = words
        Path(path).write_text(
            Path(path).read_text(encoding="utf-8").replace(old, new, 1), encoding="utf-8"
        )
        return ""
    if program == "complete":  # what a shell asks for at the tab key
        with (
            patch.dict(os.environ, _TYPER_COMPLETE_ARGS=words[0]),
            redirect_stdout(io.StringIO()) as offered,
        ):
            answer_shell(COMMAND)
        return offered.getvalue()
    count, words = (int(words[0]), words[2:]) if program == "head" else (None, words)
    words = words[1:] if program == "json" else words
    before = files_below(Path())
    done = run_fingertip(*words)
    after = files_below(Path())
    names = sorted(
        name for name in before.keys() | after.keys() if before.get(name) != after.get(name)
    )
    # Of the packages on a board, some dozen.
    names = [name for name in names if ".3dshapes/" not in name]
    files = [
        f"{'-' if name not in after else '~' if name in before else '+'} {name}\n" for name in names
    ]
    said = [f"! {line}\n" for line in done.stderr.splitlines()]
    is_usual = done.returncode == (2 if "error: " in done.stderr else 0)
    code = "" if is_usual else f"[{done.returncode}]\n"
    lines = (
        list_data(json.loads(done.stdout))
        if program == "json"
        else done.stdout.splitlines()[:count]
    )
    return "".join([*(f"{line}\n" for line in lines), *said, *files, code])


def leave_out(text: str, earlier: list[str]) -> str:
    """Replace runs of four lines and more by their number, as the
    most similar of earlier outputs has them.
    """
    new = text.splitlines(keepends=True)
    shortest = text.splitlines(keepends=True)
    for old in earlier:
        lines = list[str]()
        for kind, _, _, first, end in SequenceMatcher(
            None, old.splitlines(True), new, False
        ).get_opcodes():
            lines += (
                [f"... {end - first}\n"] if kind == "equal" and end - first >= 4 else new[first:end]
            )
        shortest = min(shortest, lines, key=len)
    return "".join(shortest)


def replay(transcript: str) -> str:
    """Run the commands of a transcript anew, and return it with what they do now."""
    done = list[str]()
    printed = dict[str, list[str]]()
    for block in re.split(r"^(?=\$ |--- |== )", transcript, flags=re.MULTILINE):
        head, _, body = block.partition("\n")
        if head.startswith("$ "):
            words = shlex.split(head[2:])
            text = run(words)
            earlier = printed.setdefault(" ".join(words[:2]), [])
            block = f"{head}\n{leave_out(text, earlier)}\n"
            earlier.append(text)
        elif head.startswith("--- "):
            path = Path(head[4:])
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(body, encoding="utf-8")
        done.append(block)
    return "".join(done)


@pytest.mark.every_case
@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.full if name in SLOW else ()) for name in TRANSCRIPTS],
)
def test_commands_do_what_the_transcript_shows(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("fingertip.sweep.engines.ProcessEngine", InlineEngine)
    for module in ("sweep", "simulate"):  # each takes two seconds
        clock = SimpleNamespace(perf_counter=itertools.count(0.0, 2.0).__next__)
        monkeypatch.setattr(importlib.import_module(f"fingertip.cli.{module}"), "time", clock)

    if name in WITHOUT_EXTRAS:
        request.getfixturevalue("core")
    found = replay(TRANSCRIPTS[name].read_text(encoding="utf-8"))
    check_text(TRANSCRIPTS[name], found)
