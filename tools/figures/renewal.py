"""Renewal of an entry: run its commands, correct its pages, and record what they rest on."""

from __future__ import annotations

import datetime
import json
import os
import resource
import shlex
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import tomlkit

from fingertip.documents.template import render_text
from tools.figures.manifest import FILE, ROOT, Entry, find_text, replace_text

PROGRAMS = {"python": [sys.executable], "fingertip": [sys.executable, "-m", "fingertip"]}
"""First word of a command -> program that it stands for."""


class RenewalError(Exception):
    """A command that failed, or a page that does not hold what is to be corrected."""


def renew(entry: Entry, root: Path = ROOT, file: Path = FILE) -> None:
    """Run the commands of an entry, correct its pages, and write the manifest.

    Raises RenewalError.
    """
    if not entry.commands:
        raise RenewalError(f"{entry.name}: no command renews it; {file.name} says what does")

    _check_pages(entry, root)
    sha256 = entry.hash_now(root)
    begin_s = _children_s()
    outputs = {name: _run(command, root) for name, command in entry.commands.items()}
    seconds = round(_children_s() - begin_s)

    texts = [lay_out(render_text(quote.template, **outputs)) for quote in entry.quotes]

    for quote, text in zip(entry.quotes, texts, strict=True):
        page = root / quote.page
        page.write_text(
            replace_text(page.read_text(encoding="utf-8"), quote.text, text), encoding="utf-8"
        )

    for path in entry.writes:
        if not (root / path).is_file():
            raise RenewalError(f"{entry.name}: its commands wrote no {path}")

    manifest = tomlkit.parse(file.read_text(encoding="utf-8"))
    record(
        manifest,
        entry=entry,
        texts=texts,
        sha256=sha256,
        seconds=seconds,
    )
    file.write_text(tomlkit.dumps(manifest), encoding="utf-8")


def record(
    manifest: Any,
    entry: Entry,
    texts: Sequence[str],
    sha256: str,
    seconds: int,
) -> None:
    """Record texts, hash, date and CPU time of an entry that was renewed in a manifest."""
    table = manifest["figures"][entry.name]
    for quote, text in zip(table.get("quotes", ()), texts, strict=True):
        quote["text"] = tomlkit.string(text, multiline="\n" in text)

    table["sha256"] = sha256
    table["renewed"] = datetime.date.today()
    table["seconds"] = seconds
    table.pop("is_old", None)


def lay_out(rendered: str) -> str:
    """Lay out a rendered text: a table in its lines, a sentence in
    one, as the page's own lines break elsewhere.
    """
    return rendered.strip() if rendered.lstrip().startswith("|") else " ".join(rendered.split())


def _check_pages(entry: Entry, root: Path) -> None:
    """Raise RenewalError before the work if a page does not hold a text that is to be replaced."""
    for quote in entry.quotes:
        if not find_text(quote.text, (root / quote.page).read_text(encoding="utf-8")):
            raise RenewalError(
                f"{entry.name}: {quote.page} does not hold {quote.text!r}; correct it first"
            )


def _run(command: str, root: Path) -> Any:
    """Run a command in the clone; returns its JSON, or its text."""
    first, *others = shlex.split(command)
    paths = [str(ROOT / "src"), str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
    done = subprocess.run(
        [*PROGRAMS.get(first, [first]), *others],
        cwd=root,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
        stdout=subprocess.PIPE,
        text=True,
        check=False,
    )

    # 1: a requirement failed, which is a result too.
    if done.returncode > (1 if first == "fingertip" else 0):
        raise RenewalError(f"{command}: exit status {done.returncode}\n{done.stdout}")
    if done.stdout.startswith(("{", "[")):
        return json.loads(done.stdout)

    return done.stdout


def _children_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
