"""Report of the studies with known results: text, page and figures are the approved ones."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.lab.campaign.closed_loop import summarise
from fingertip.lab.campaign.plan import Case
from fingertip.lab.campaign.run import DetectorResult, TrialResult
from tests.approved import check_figures, check_text
from tests.figures import describe_figure, keep_figures
from tests.lab.test_report import SCENES, closed_loop
from tests.tools import require_module
from tools.article.boards import BoardResult
from tools.article.previous_works import PlainFftResult, PlateResult, PreviousWorks
from tools.article.protocol import DEVICES, MOVED_M, ProtocolResult, ProtocolStudy, Spectrum, WindowResult
from tools.article.sensitivity import (
    BOTH,
    ELASTO_PLASTIC,
    PATCH_AVERAGE,
    STICK_SLIP,
    AccelerationResult,
    VariationResult,
)
from tools.article.steps import DelayShift, SamplingRateResult, SignalError, StepSensitivity
from tools.article.studies import Studies
from tools.article.tables import StudyResults

APPROVED = Path(__file__).with_name("approved")


def protocol(summary: Any) -> ProtocolStudy:
    results = [
        ProtocolResult(
            device, 0.01 + i / 1000, moved_m, 4, 4 - i, 3 - i, 4 - i, 0.03 - 100 * moved_m, 0.03, 0.05, 0.07, 0.012
        )
        for i, device in enumerate(DEVICES)
        for moved_m in MOVED_M
    ]
    results[3] = replace(results[3], found=0, mean_s=math.nan, worst_object_s=math.nan)
    return ProtocolStudy(results, {"article's board": summary, "precision board": replace(summary, unanswered=0)})


def variation(label: str, shift_s: float, is_realistic: bool = True, found: float = 1.0) -> VariationResult:
    figures = (24, found, 0.015 + shift_s, shift_s, 0.25, 0.0045, 0.001 * len(label), 0.04 + shift_s, 0.05)
    return VariationResult(label, is_realistic, False, *figures, 0.0987, 0.1234)


def results() -> StudyResults:
    unknown = (math.inf, math.nan, 0.0, math.nan, math.nan, math.inf, math.inf, math.nan, math.nan)
    lost = VariationResult(STICK_SLIP, True, False, 30, 0.25, *unknown)
    hz = np.arange(0.0, 500.0, 50.0)
    shifts = (DelayShift("fast", 20, 1, 0, 0.0, 0.0, 0.001), DelayShift("digital", 20, 4, 1, 0.0, 0.008, math.inf))
    delays_s = [(0.03,)] * 30 + [(0.05,)] * 9 + [()]  # in 20 minutes, with three alarms
    slips = [TrialResult(Case("slip", SCENES[0], i), 30.0, 1, delay_s, 0.9, ("contact",) * (i < 3), 0.01)
             for i, delay_s in enumerate(delays_s)]  # fmt: skip
    return StudyResults(
        bounds_s=[0.009, 0.012, math.inf, 0.004],
        variations=[
            variation("unchanged", 0.0, False), variation("half the force", 0.004, False),
            variation("twice the noise", -0.006, False), replace(lost, label="half the speed", is_realistic=False),
            replace(variation(PATCH_AVERAGE, 0.002, found=0.5), vibration_n=0.0005), lost, variation(BOTH, 0.001),
            variation(ELASTO_PLASTIC, -0.001), variation("mains hum of 1 mV", 0.003),
            replace(variation("load law hertz", 0.004, False), is_law=True, light_v=0.25, firm_v=0.0512),
        ],
        steps=StepSensitivity(20, 16, shifts, (SignalError("force_n", 1e-5, 2e-5, 4e-5),)),
        patch_radius_m=2.05e-3,
        windows=[WindowResult(0.01, 0.02, 0.012, 0.02, 3.0), WindowResult(0.03, 0.015, 0.03, math.inf, 1.5)],
        spectra=[Spectrum(name, hz, 1e-6 / (1 + (hz / hz_3db) ** 2)) for name, hz_3db in (("soft", 90), ("bare", 230))],
        accelerations=[
            AccelerationResult(a, name, 1.0, 0.02 / a + late, 0.03 / a + late)
            for a in (0.5, 1.0) for name, late in (("bound", 0.0), ("fast", 0.005), ("fft", math.inf))
        ],
        rates=[SamplingRateResult(rate, 10 / rate, 20 / rate, 1.0, 0.012, 0.02, 0.1) for rate in (1000.0, 2000.0)],
        boards=[BoardResult("article", 0.023, False, 0.5, 0.04, math.inf, 0.25, 0.06, 0.1),
                BoardResult("precision", 0.0049, True, 1.0, 0.02, 0.03, 0.75, 0.04, 0.2)],
        article={"digital": DetectorResult(1.0, tuple(slips))},
        protocol=protocol(summarise(closed_loop())[1]),
        previous=PreviousWorks(
            [PlateResult("ridged_fine", 1.0, 15, 15, 0.012), PlateResult("ridged_fine", 5.0, 15, 0, math.nan)],
            [PlainFftResult(0.0002, 4, 4, 4, 3), PlainFftResult(0.013, 4, 3, 2, 1)],
        ),
    )  # fmt: skip


@pytest.fixture(scope="module")
def files() -> dict[str, bytes]:
    require_module("matplotlib")
    with keep_figures() as figures:
        files = Studies(Design.load("article"), "fast", results()).files()
    return files | {"figures": "\n".join(line for one in figures for line in describe_figure(one)).encode()}


@pytest.mark.parametrize("name", ["studies.txt", "studies.md"])
def test_report_is_the_approved_one(files: dict[str, bytes], name: str) -> None:
    check_text(APPROVED / name, files[name])


def test_figures_are_the_approved_ones(files: dict[str, bytes]) -> None:
    check_figures(APPROVED / "study_figures.txt", files["figures"].decode().splitlines(), 1e-3, 1e-9)
