"""Signals that judge the detector `fast` and those that it was fitted
to, and what the first say of the second.
"""

from __future__ import annotations

import hashlib
import json
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from benchmarks import held_out_signals, slip_held_out
from benchmarks.slip.mix import MixSummary
from benchmarks.slip_robustness import run_both_points
from fingertip.design import Design
from fingertip.slip.detectors import fast
from fingertip.slip.detectors.fast_coefficients import TABLE, load_model
from tests.designs import ARTICLE
from tools.detector_training import fit
from tools.detector_training.disturbances import KINDS, SLOW_SLIDES, draw_disturbance

FEW = 6
"""Recordings of a kind."""


def judge(row: str, board: str = "S") -> dict[str, MixSummary]:
    outcomes = run_both_points(slip_held_out.DESIGNS[board], slip_held_out.draw(row, board, 7, FEW))
    return {point: MixSummary(tuple(found)) for point, found in outcomes.items()}


def test_the_judge_is_the_one_that_was_frozen() -> None:
    source = Path(held_out_signals.__file__)
    assert hashlib.sha256(source.read_bytes()).hexdigest() == slip_held_out.HASH
    assert "fingertip" not in [
        line.split()[1].split(".")[0]
        for line in source.read_text().splitlines()
        if line.startswith(("import ", "from "))
    ]


@pytest.mark.parametrize("board", ["S", "A"])
def test_a_slide_after_a_load_is_on_as_long_as_it_lasts(board: str) -> None:
    for summary in judge("slide after load", board).values():
        assert summary.found_share == 1.0
        assert summary.smallest_on_share > 0.95


@pytest.mark.parametrize("row", ["servo steps", "set-down", "hand motion 4-8 Hz"])
def test_what_a_hand_does_is_no_slip(row: str) -> None:
    assert judge(row)["on"].alarms <= 1


def test_incipient_slip_is_sooner() -> None:
    found = judge("slip at constant force")
    assert found["incipient"].delay_s(0.5) < found["on"].delay_s(0.5) < 0.035
    line = slip_held_out.describe("slip at constant force", "S", "on", found["on"])
    assert line.startswith("| slip at constant force | S | on | 24 of 24 [85.8, 100.0] % |")


def test_the_table_is_that_of_the_present_training() -> None:
    """Constants of the training that were changed without a fit show here."""
    model = load_model()
    card = json.loads(resources.files(fast.__package__).joinpath(TABLE).read_text())["card"]
    scores = model.threshold, model.noise_rise, model.incipient_threshold
    assert scores == (fit.THRESHOLD, fit.NOISE_RISE, fit.INCIPIENT_THRESHOLD)
    assert (model.trees, card["sizes"]["rounds"]) == (fit.TREES, fit.ROUNDS)
    assert card["first_seeds"] == fit.SEEDS
    assert set(card["versions"]) == {"python", "numpy", "scipy", "scikit-learn"}
    pins = (Path(fit.__file__).with_name("requirements.txt")).read_text().splitlines()
    assert f"scikit-learn=={card['versions']['scikit-learn']}" in pins


@pytest.mark.full
def test_the_signals_of_a_small_fit_are_the_approved_ones() -> None:
    """`.ci/full` fits with scikit-learn to these signals, and compares the whole table."""
    card = json.loads(Path(__file__).with_name("approved").joinpath("small_fit.json").read_text())[
        "card"
    ]
    sizes = {name: card["sizes"][name] for name in ("trials", "events", "disturbances")}
    assert fit.hash_signals(fit.load_signals(None, sizes)) == card["signals_sha256"]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("design", [ARTICLE, Design()], ids=["article", "fsr400"])
def test_drawn_signals_have_their_labels_within_them(design: Design, kind: str) -> None:
    signal, again = (draw_disturbance(design, kind, 5) for _ in range(2))
    assert np.array_equal(signal.voltage_v, again.voltage_v)
    assert (signal.filtered_v is None) == (design is ARTICLE)
    for slide in signal.slides:
        assert 0.5 < slide.motion_s <= slide.onset_s < slide.end_s <= KINDS[kind].duration_s
        first = round(slide.onset_s * signal.rate_hz)
        last = round(slide.end_s * signal.rate_hz)
        inside = signal.voltage_v[first:last]
        quiet = signal.voltage_v[:800]
        # Their vibration may be weaker than noise, their friction is not.
        if kind in (
            SLOW_SLIDES,
            "slide after load",
        ):
            assert inside.std() > quiet.std()
        else:
            assert np.diff(inside).std() > np.diff(quiet).std()
    assert all(0.0 <= event.onset_s < event.end_s for event in signal.events)
