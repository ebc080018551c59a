"""Calls side by side: results in their order and with the same bits, errors, and no process that stays."""

from __future__ import annotations

import itertools
import os
import time
from collections.abc import Callable, Iterator
from functools import partial

import pytest

from fingertip.design import Design
from fingertip.foundation import jit
from fingertip.foundation import side_by_side as module
from fingertip.foundation.errors import FingertipError
from fingertip.foundation.side_by_side import call_each, side_by_side
from fingertip.lab.campaign.closed_loop import run_closed_loop
from fingertip.lab.campaign.mix import MixSize, generate_mix
from fingertip.lab.campaign.plan import CampaignPlan
from fingertip.lab.campaign.run import run_campaign


def test_results_of_several_processes_come_in_the_order_of_the_calls() -> None:
    with side_by_side(2):
        assert list(call_each(partial(divmod, number, 7) for number in range(40))) == [divmod(n, 7) for n in range(40)]
        pids = set(call_each([os.getpid] * 40))
        assert os.getpid() not in pids
        with side_by_side(1):
            assert list(call_each([os.getpid])) == [os.getpid()]
        assert set(call_each([os.getpid])) <= pids
    assert list(call_each([os.getpid])) == [os.getpid()]
    with side_by_side(1):
        assert list(call_each([os.getpid])) == [os.getpid()]
    for pid in pids:
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)


def test_calls_are_made_ahead_of_the_results_that_are_taken_and_no_farther(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_AHEAD", 3)
    asked: list[int] = []

    def calls() -> Iterator[Callable[[], int]]:
        for number in itertools.count():
            asked.append(number)
            yield partial(abs, -number)

    with side_by_side(2):
        results = call_each(calls())
        assert [next(results), next(results)] == [0, 1]
        assert asked == [0, 1, 2, 3, 4]


def test_an_error_of_a_call_is_raised_here_and_ends_no_worker() -> None:
    with side_by_side(2):
        with pytest.raises(FingertipError) as caught:
            list(call_each([partial(Design.load, "fsr4")]))
        assert caught.value.issues[0].field == "fsr4"
        assert list(call_each([partial(print, "what a library prints is no part of the answer")] * 4)) == [None] * 4


def test_a_worker_that_ends_by_itself_is_reported_with_a_remedy() -> None:
    with side_by_side(2):
        for call in (partial(os._exit, 3), partial(len, 1_000_000 * "x")):  # which no dead worker reads
            for _ in range(3):
                with pytest.raises(FingertipError, match=r"jobs: .* ended by itself.*choose jobs=1"):
                    list(call_each([call]))


def test_calls_whose_results_nobody_takes_are_not_made() -> None:
    with side_by_side(2):
        begun = time.monotonic()
        results = call_each([os.getpid, *[partial(time.sleep, 1.0)] * 60])
        next(results)
        results.close()
        list(call_each([os.getpid]))
        assert time.monotonic() - begun < 20.0


def test_every_loop_runs_compiled() -> None:
    assert list(call_each([lambda: jit._always_compile])) == [jit.available()]
    with side_by_side(1):
        assert jit._always_compile == jit.available()
    assert not jit._always_compile


@pytest.mark.full
def test_campaign_closed_loop_and_mix_have_the_same_bits_side_by_side() -> None:
    design, size = Design(), MixSize(4, 2)

    def run() -> list[object]:
        trials = run_closed_loop(design, ("fast",), 1)
        closing = [trial.manipulation.signals.closing_m.tobytes() for trial in trials]
        signals = [(signal.kind, signal.voltage_v.tobytes()) for signal in generate_mix(design, size, 5_500_000)]
        return [run_campaign(design, CampaignPlan(6, 1.0)), [trial.decisions for trial in trials], closing, signals]

    one_by_one = run()
    with side_by_side(3):
        assert run() == one_by_one
