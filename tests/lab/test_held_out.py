"""Signals that judge the detector `fast` and those that it was fitted to."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from benchmarks import held_out_signals
from benchmarks.slip import bench, own_sets
from benchmarks.slip.competitors import Row
from benchmarks.slip.mix_signals import LabelledSignal, Slide
from benchmarks.slip.recordings import Recording
from benchmarks.slip.scores import Tally
from fingertip.design import Design
from fingertip.foundation.jit import compiled
from fingertip.slip.detectors import fast
from fingertip.slip.detectors.fast_table import TABLE, load_table, read_table, write_table
from fingertip.slip.traces.truth import Interval
from tools.detector_training import fit, rows, signals

FEW = 6
"""Recordings of a kind."""
SEED = 7
"""Seed of the generators: no training, no tuning and no report has it."""
FLAGS = {"incipient": Row("incipient"), "on": Row("fast")}
FROZEN = "9371229ee4c0b150df7c10b6b293174df17830ae7076f6cf56f54430193bb584"
"""SHA-256 of the generators before any detector had run on their signals."""


def judge(row: str, board: str = "S") -> dict[str, Tally]:
    """Judge both flags of `fast` on a few recordings of a kind."""
    share = FEW / held_out_signals.COUNTS[row]
    source = own_sets.Generated(row, board, SEED, share)
    with compiled():
        found = bench.judge(Design.load("article"), [*FLAGS.values()], (1.0,), source)

    return {name: bench.select(found, flag).whole() for name, flag in FLAGS.items()}


def test_the_judge_is_the_one_that_was_frozen() -> None:
    source = Path(held_out_signals.__file__)
    assert hashlib.sha256(source.read_bytes()).hexdigest() == FROZEN
    assert "fingertip" not in [
        line.split()[1].split(".")[0]
        for line in source.read_text().splitlines()
        if line.startswith(("import ", "from "))
    ]


@pytest.mark.parametrize("board", ["S", "A"])
def test_a_slide_after_a_load_is_on_as_long_as_it_lasts(board: str) -> None:
    found = judge("slide after load", board)
    assert found["on"].found_share == 1.0
    for tally in found.values():
        # Incipient slip may be ON since the load, which is no new find.
        assert min(tally.on_shares) > 0.95


@pytest.mark.parametrize("row", ["servo steps", "set-down", "hand motion 4-8 Hz"])
def test_what_a_hand_does_is_no_slip(row: str) -> None:
    assert judge(row)["on"].counted <= 1


def test_incipient_slip_is_sooner() -> None:
    found = judge("slip at constant force")
    assert [(tally.slips, tally.found_share) for tally in found.values()] == [(24, 1.0)] * 2
    assert found["incipient"].quantile_ms(0.5) < found["on"].quantile_ms(0.5) < 35.0


def test_no_seed_trains_and_judges() -> None:
    trained = {seed for draw in signals.SEEDS for seed in draw}
    tuned = set(own_sets.SEEDS[own_sets.TUNING])
    judged = {*own_sets.SEEDS[own_sets.JUDGING], SEED}
    assert not trained & judged
    assert not tuned & judged
    assert not trained & tuned


def test_the_table_is_that_of_the_present_training() -> None:
    """Constants of the training that were changed without a fit show here."""
    table = load_table()
    card = json.loads(resources.files(fast.__package__).joinpath(TABLE).read_text())["card"]
    assert table.trees in [trees for trees, _ in fit.PLAN.values()]
    assert card["numbers"] == table.numbers
    assert tuple(card["seeds"]) in signals.SEEDS
    assert card["share"] == signals.SHARE
    assert all(one["is_stated"] for one in card["files"].values())
    pins = (Path(fit.__file__).with_name("requirements.txt")).read_text().splitlines()
    assert f"scikit-learn=={card['versions']['scikit-learn']}" in pins


def test_a_table_is_read_as_it_was_written() -> None:
    table = load_table()
    again = read_table(json.loads(write_table(table, {})))
    assert np.array_equal(again.features, table.features)
    assert np.array_equal(again.leaves, table.leaves)


@dataclass(frozen=True)
class Node:
    """Tree of one comparison, as scikit-learn stores it."""

    def __getitem__(self, number: int) -> dict[str, float | bool]:
        return (
            {"is_leaf": False, "feature_idx": 3, "num_threshold": 0.5, "left": 1, "right": 2},
            {"is_leaf": True, "value": -1.0},
            {"is_leaf": True, "value": 2.0},
        )[number]


def test_a_leaf_further_up_fills_the_branch_below_it() -> None:
    tree = fit.complete(Node())
    assert (tree.features[0], tree.thresholds[0]) == (3, 0.5)
    assert tree.thresholds[1:].min() == fit.ALWAYS_LEFT
    half = len(tree.leaves) // 2
    assert tree.leaves.tolist() == [-1.0] * half + [2.0] * half


@dataclass(frozen=True)
class Bursting:
    """Two seconds of noise with a burst, that is slip or is not."""

    is_slip: bool
    run: int = 0

    def read(self) -> Iterator[Recording]:
        rng = np.random.default_rng(3)
        volts = 1.0 + 4e-4 * rng.standard_normal(4000)
        volts[2000:3000] += 0.01 * rng.standard_normal(1000)
        slides = (Slide(1.0, 1.0, 1.5),) if self.is_slip else ()
        events = () if self.is_slip else (Interval(1.0, 1.5),)
        kind = "burst above 60 Hz" if self.is_slip else "tap"
        signal = LabelledSignal(kind, 2000.0, volts, slides, events, 0.5)
        yield Recording(signal, (), design=Design.load("article"))


def test_rows_are_labelled_by_what_is_known() -> None:
    slip = rows.collect(Bursting(is_slip=True))
    tap = rows.collect(Bursting(is_slip=False))
    assert slip.is_slip.all()
    assert not tap.is_slip.any()
    # Late ticks of slip are thinned out, those of a blow are not.
    assert 20 < len(slip.is_slip) < 100 < len(tap.is_slip)
    both = rows.join([slip, tap])
    assert set(both.group) == {"burst", "tap"}
    assert not set(both.event[: len(slip.event)]) & set(both.event[len(slip.event) :])
    weights = rows.weigh(both)
    ratio = weights[both.is_slip].sum() / weights[~both.is_slip].sum()
    assert ratio == pytest.approx(rows.SLIP_WEIGHTS["burst"] / rows.WEIGHTS["tap"])


@pytest.mark.parametrize(
    ("kind", "is_slip", "group"),
    [
        ("slide half", True, "slide half"),
        ("slide half", False, "grasp"),
        ("slide after load", True, "other"),
        ("vibration with the grasp", False, "vibration"),
        ("isolated step with gear vibration", False, "isolated step"),
        ("servo steps on grasp", False, rows.ON_GRASP),
        ("trials fsr400, hertz", True, "trials"),
    ],
)
def test_each_kind_of_signal_has_its_weight(kind: str, is_slip: bool, group: str) -> None:
    assert rows.find_group(kind, is_slip) == group


def test_a_real_slide_on_a_board_begins_after_its_rest() -> None:
    slide = np.random.default_rng(2).standard_normal(6600)
    for name in ("fsr400", "article"):
        made = signals.slide_on_board(Design.load(name), slide, np.random.default_rng(1))
        at = round(signals.REST_S * made.signal.rate_hz)
        volts = made.signal.voltage_v
        assert (made.signal.filtered_v is None) == (name == "article")
        assert made.signal.slides[0].onset_s == signals.REST_S
        assert np.diff(volts[:at]).std() < 0.7 * np.diff(volts[at:]).std()
