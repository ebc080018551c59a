"""Corpus of forms (tests/slip/forms.py): each is read right or
answered by what to do, none read wrong in silence.
"""

from __future__ import annotations

import itertools
import json
import re
import shlex
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.slip.forms import COUNT, NAMES, SLIP_S, START_NS, make_forms
from tests.slip.recordings import run

_OPTION = re.compile(r"--(?:column|rate-hz|time-scale|scale|offset) (?:'[^']*'|[^\s';]*[^\s';.,])+")
STARTS_S = (0.0, -1.0, START_NS / 1e9)
"""Times of the first sample: zero, a second ahead of the trigger, or a date.
An option keeps the file's own zero.
"""
_MOST = 3
"""Largest number of proposals that are followed one after another."""


_LISTED = re.compile(r"(?:^|, | and )(\S.*?)(?: '[^']*')? \([-+.\de]+ to [-+.\de]+\)")


def judge(path: Path, options: Sequence[str] = (), left: int = _MOST) -> str:
    """Do what the messages say: 'right', 'wrong' without a warning, 'warned', or 'refused' where
    none is left.

    'answered' is right once the person has given what the file does not tell: its rate, or which of
    the columns.
    """
    done = run("detect", path, "--detector", "fast", "--json", *options)
    if done.exit_code == 0:
        found = json.loads(done.stdout)["intervals"]
        is_right = len(found) == 1 and any(
            abs(found[0]["onset_s"] - start_s - SLIP_S[0]) < 0.06
            and abs(found[0]["end_s"] - start_s - SLIP_S[1]) < 0.15
            for start_s in STARTS_S
        )
        if is_right:
            return "right"
        if "warning" in done.stderr:
            return "warned"
        return "wrong"
    assert done.exit_code in (1, 2), (done.exit_code, done.stderr)
    assert "error: " in done.stderr, done.stderr
    proposed = [word for option in _OPTION.findall(done.stderr) for word in shlex.split(option)]
    if not proposed or not left or proposed == options[-len(proposed) :]:
        return "refused"
    answers = list(itertools.product(*(_answer(word, done.stderr) for word in proposed)))
    results = [judge(path, [*options, *answer], left - 1) for answer in answers]
    if answers == [tuple(proposed)]:
        return results[0]
    if "right" in results:
        return "answered"
    return "refused"


def _answer(word: str, said: str) -> list[str]:
    """List what a person may put in place of what a proposal leaves open."""
    column, _, name = word.partition("=")
    if name not in ("NAME", "NUMBER"):
        return ["2000" if word == "HZ" else word]
    listed = re.search(rf"columns can be the {column.partition('_')[0]}, (.*?\))\. ", said)
    return [f"{column}={each}" for each in _LISTED.findall(listed[1])] if listed else []


def test_the_corpus_has_two_hundred_forms() -> None:
    forms = make_forms()
    assert list(forms) == NAMES
    assert len(forms) == COUNT
    assert len({form.content for form in forms.values()}) >= 0.8 * COUNT


@pytest.mark.parametrize("name", NAMES)
def test_no_form_is_read_wrong_in_silence(name: str, tmp_path: Path) -> None:
    assert judge(make_forms()[name].write(tmp_path)) != "wrong"
