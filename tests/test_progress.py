"""Progress of long work: shares, the time left, the bar of a terminal, and silence in a log."""

from __future__ import annotations

import io
import sys

import pytest

from fingertip.cli.console import BAR_WIDTH, CLEAR_LINE, Console, format_bar
from fingertip.foundation import progress as progress_module
from fingertip.foundation.errors import FingertipError, Issue
from fingertip.foundation.progress import ShareText, Work, describe_share


class Clock:
    """Clock that a test sets."""

    now_s = 0.0

    def monotonic(self) -> float:
        return self.now_s


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(progress_module, "time", clock)
    return clock


def test_a_message_takes_no_line_of_its_own_for_a_text_of_a_file(
    capsys: pytest.CaptureFixture[str],
) -> None:
    Console(as_json=False, quiet=False).warn(["column 'a\nerror: b\x1b[31m'"])
    assert capsys.readouterr().err == "warning: column 'a\\nerror: b\\x1b[31m'\n"


def test_shares_follow_from_the_durations_of_the_stages(clock: Clock) -> None:
    messages: list[str] = []
    work = Work("bench", {"contact": 30.0, "board": 60.0, "trial": 10.0}, messages.append)
    work.begin("contact")
    clock.now_s = 30.0
    work.begin("board")
    clock.now_s = 60.0
    work.advance(0.5)
    work.advance(0.6)  # a moment later: not reported
    clock.now_s = 90.0
    work.begin("trial")
    assert messages == [
        "bench: contact: 0 % done",
        "bench: board: 30 % done, 70 s left",
        "bench: board: 60 % done, 40 s left",
        "bench: trial: 90 % done, 10 s left",
    ]
    assert [message.share for message in messages if isinstance(message, ShareText)] == [
        0.0,
        0.3,
        0.6,
        0.9,
    ]
    silent = Work("", {"only": 1.0}, None)
    silent.begin("only")
    silent.advance(1.0)
    assert describe_share("x", 0.5, 90.0) == "x: 50 % done, 90 s left"
    assert describe_share("x", 0.5, 600.0) == "x: 50 % done, 10 min left"
    assert describe_share("x", 0.1, 3600.0) == "x: 10 % done, 9.0 h left"
    assert describe_share("x", 0.01, 3600.0) == "x: 1 % done", "too early for an estimate"


def test_work_within_a_stage_counts_as_its_share(clock: Clock) -> None:
    messages: list[str] = []
    outer = Work("fsr400", {"parts": 3.0, "page": 1.0}, messages.append)
    inner = Work("", {"bone": 1.0, "skin": 1.0}, outer.within("parts"))
    inner.begin("bone")
    clock.now_s = 0.5
    inner.begin("skin")  # another stage is reported at once
    inner.advance(0.5)
    outer.within("page")("a note")
    assert messages == [
        "fsr400: parts: 0 % done",
        "fsr400: bone: 0 % done",
        "fsr400: skin: 38 % done, 1 s left",
        "fsr400: page: 75 % done, 0 s left",
        "a note",
    ]


class Terminal(io.StringIO):
    """Text stream that says it is a terminal."""

    def isatty(self) -> bool:
        return True


def test_a_terminal_shows_one_bar_that_messages_replace(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", Terminal())
    monkeypatch.setenv("TERM", "xterm")
    console = Console(False, False)
    console.progress(ShareText("half", 0.5))
    console.progress(ShareText("most", 0.9))
    console.progress("a message")
    shown = sys.stderr.getvalue()  # type: ignore[attr-defined]
    assert shown.count("\n") == 1
    assert shown.endswith(f"{CLEAR_LINE}a message\n")
    assert shown.count(CLEAR_LINE) == 3
    Console(False, False).progress(ShareText("half", 0.5))
    # As the decorator does.
    Console(False, False).print_issues(FingertipError(Issue("field", "is wrong.")))
    assert sys.stderr.getvalue().endswith(f"{CLEAR_LINE}error: field: is wrong.\n")
    message = ShareText("a long stage: " + "x" * 100, 0.25)
    assert format_bar(message, 80).startswith(
        f"[{'#' * (BAR_WIDTH // 4)}{'.' * (BAR_WIDTH - BAR_WIDTH // 4)}] a long"
    )
    assert len(format_bar(message, 80)) == 79


@pytest.mark.parametrize(("stream", "term"), [(io.StringIO(), "xterm"), (Terminal(), "dumb")])
def test_a_log_has_each_note_once_and_no_shares(
    monkeypatch: pytest.MonkeyPatch, stream: io.StringIO, term: str
) -> None:
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setenv("TERM", term)
    console = Console(False, False)
    for share in range(10):
        console.progress(ShareText("stage", share / 10))
        console.progress("note")
    assert stream.getvalue() == "note\n"
