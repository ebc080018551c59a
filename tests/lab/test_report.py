"""Report of a validation with known results: text, JSON, page of omissions and figures are the
approved ones.

After a change that is meant, `FINGERTIP_APPROVE=1 pytest tests/lab/test_report.py` writes them;
then read what changed.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from fingertip.cli import app
from fingertip.design import Design
from fingertip.lab import validation as lab
from fingertip.lab.campaign.campaign import CampaignPlan, Case
from fingertip.lab.campaign.closed_loop import NO_CONTROL, evaluate_manipulation, summarise
from fingertip.lab.campaign.run import SCALES, CampaignResult, DetectorResult, TrialResult
from fingertip.lab.validation import Validation, check_closed_loop, check_detection
from fingertip.sim.runs.grip import GripDecision
from fingertip.sim.simulation import article_trials
from fingertip.slip.detectors.registry import DETECTORS
from tests.approved import check_figures, check_text, list_data
from tests.conftest import run_fingertip
from tests.figures import describe_figure, keep_figures

APPROVED = Path(__file__).with_name("approved")
SCENES = [scene for scene, _ in article_trials()]
T = np.arange(400) / 100
LOST = np.where(T > 2.0, (T - 2.0) / 10, 0.0)
HELD = np.where(T > 2.0, 0.003, 0.0)


def campaign() -> CampaignResult:
    """Two detectors at three thresholds: a higher one is later, and has fewer alarms."""
    slides = [
        next(s for s in SCENES if s.contact.surface == name) for name in ("smooth", "wood")
    ] + [SCENES[-1]]
    detectors = {}
    for name, factor in (("digital", 2.0), ("fast", 1.0)):
        results = []
        for scale in (0.7, 1.0, 2.0):
            trials = [
                TrialResult(
                    Case("slip", scene, i),
                    5.0,
                    1,
                    (0.01 * factor * scale + late_s,),
                    0.9,
                    (),
                    0.013,
                    1.8,
                )
                for i, scene in enumerate(slides)
                for late_s in (0.0, 0.004 + 0.002 * i)
            ]
            if name == "digital":
                trials.append(
                    TrialResult(
                        Case("slip", slides[0], 8), 5.0, 1, (), 0.0, ("before slip",), 0.013, 1.8
                    )
                )
            alarms = ("contact",) * round(factor / scale - 0.6)
            trials.append(TrialResult(Case("contact", SCENES[0], 9), 90.0, 0, (), 0.0, alarms))
            trials.append(
                TrialResult(Case("motor", SCENES[0], 10), 120.0, 0, (), 0.0, ("motor",) * 3)
            )
            results.append(DetectorResult(scale, tuple(trials)))
        detectors[name] = tuple(results)
    return CampaignResult(CampaignPlan(4, 0.5), 5_000_000, detectors)


def manipulation(
    name: str, kind: str, seed: int, lost_s: float | None, moved_m: float = 0.0
) -> Any:
    """Manipulation of two fingers, of which the index slips from
    2 s on, and which close from 2.1 s on.
    """
    slip = np.stack((T < 0.0, (T >= 2.0) & (T < 2.3)))
    closing = np.stack((0.02 + 0 * T, np.where(T < 2.1, 0.03, 0.03 + moved_m)))
    columns = {"slip": slip, "force_n": np.stack((1.0 + 0 * T, 1.5 + 0 * T))}
    scene = SimpleNamespace(
        name=name, grasp=SimpleNamespace(kind=kind), object=SimpleNamespace(mass_kg=0.06)
    )
    return SimpleNamespace(
        scene=scene,
        seed=seed,
        time_s=T,
        lost_s=lost_s,
        fingers=("thumb", "index"),
        output=columns.__getitem__,
        signals=SimpleNamespace(closing_m=closing, object_m=HELD if lost_s is None else LOST),
        plan=SimpleNamespace(knock_s=1.9, closed_s=1.0, force_n=np.array((1.0, 1.2))),
    )


def decide(time_s: float, *, suppressed: bool = False) -> GripDecision:
    return GripDecision(time_s, True, suppressed, not suppressed)


def closed_loop() -> list[Any]:
    """An object is lost without control; with it another one is
    held, by a grip in slip and by two without.
    """
    decisions = [
        decide(0.5, suppressed=True),
        decide(0.51, suppressed=True),
        decide(1.5),
        decide(1.994),
        decide(2.05),
        decide(2.5),
        decide(2.52, suppressed=True),
    ]
    late = [
        decide(2.02, suppressed=True),
        GripDecision(2.03, False, False, False),
        decide(2.04, suppressed=True),
    ]
    runs = [
        (NO_CONTROL, manipulation("cylinder", "pinch", 1, 2.8), ()),
        (NO_CONTROL, manipulation("parallelepiped", "power", 2, None), ()),
        ("fast", manipulation("cylinder", "pinch", 1, None, 0.002), decisions),
        ("fast", manipulation("parallelepiped", "power", 2, 3.0), late),
    ]
    return [evaluate_manipulation(detector, run, made) for detector, run, made in runs]


@pytest.fixture(scope="module")
def validation() -> Validation:
    result = campaign()
    manipulations = tuple(closed_loop())
    requirements = (
        *check_detection(result, "fast"),
        *check_closed_loop(summarise(manipulations)[1]),
    )
    return Validation(Design.load("article"), "fast", result, manipulations, requirements)


def test_report_is_the_approved_one(validation: Validation) -> None:
    files = validation.files(with_plots=False)
    for name in ("validation.txt", "omissions.md"):
        check_text(APPROVED / name, files[name])
    data = json.loads(files["validation.json"])
    assert data == validation.as_data()
    check_text(APPROVED / "validation_data.txt", "\n".join(list_data(data)) + "\n")


def test_figures_are_the_approved_ones(validation: Validation) -> None:
    """Positions of all bars, lines and areas, their colours, and
    all words; drawn from the results above.
    """
    with keep_figures() as figures:
        names = [name for name in validation.files() if name.endswith(".png")]
    assert [*names] == [name for name in lab.FILES if name.endswith(".png")]
    lines = (
        line for name, f in zip(names, figures, strict=True) for line in (name, *describe_figure(f))
    )
    check_figures(APPROVED / "figures.txt", lines, 1e-3, 1e-9)


def test_a_board_is_judged_with_all_detectors_and_a_divider_with_its_own(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []

    def note_campaign(_: Design, detectors: Any, scales: Any, **__: Any) -> CampaignResult:
        asked.append((detectors, scales))
        return campaign()

    monkeypatch.setattr(lab, "run_campaign", note_campaign)
    monkeypatch.setattr(
        lab, "run_closed_loop", lambda _, *rest: asked.append(rest) or closed_loop()
    )
    monkeypatch.setattr(lab, "compare_with_board", lambda *_: asked.append("board"))
    for variant, trials in (("precision", 12), ("divider", 11)):
        lab.validate(
            Design.load("fsr400", changes=[f"board.variant={variant}"]),
            CampaignPlan(trials, 1.0),
            "fast",
        )
    of_board = [(tuple(DETECTORS), SCALES), (("analog", "incipient", "fast"), 3)]
    of_divider = [(("fast",), (1.0,))]
    assert asked == [*of_board, *of_divider, (("fast",), 1), "board"]


def test_command_writes_the_report_and_ends_with_1_if_a_requirement_is_missed(
    validation: Validation, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    met = replace(validation, requirements=validation.requirements[:1])
    monkeypatch.setattr("fingertip.foundation.extras.is_installed", lambda *_: False)
    for found, code in ((validation, 1), (met, 0)):
        monkeypatch.setattr(lab, "validate", lambda *_, found=found, **__: found)
        done = CliRunner().invoke(
            app, ["validate", "article", "--json", "--force", "--out", str(tmp_path / "v")]
        )
        assert done.exit_code == code, done.output
        assert json.loads(done.stdout) == found.as_data()
        assert json.loads((tmp_path / "v/validation.json").read_text()) == found.as_data()
        first = (tmp_path / "v/validation.txt").read_text().splitlines()[0]
        assert first == found.as_verdict().splitlines()[0]


@pytest.mark.parametrize("verbose", [False, True])
def test_command_writes_no_file_unasked_and_says_how_to_get_the_report(
    verbose: bool, validation: Validation, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """It once wrote its report into the folder that `fingertip make` had finished."""
    monkeypatch.setattr(lab, "validate", lambda *_, **__: validation)
    made = tmp_path / "out/article/report.json"
    made.parent.mkdir(parents=True)
    made.write_text("{}")
    done = run_fingertip("validate", "article", *["--verbose"] * verbose, PWD=str(tmp_path))
    assert done.stdout.startswith(validation.as_verdict())
    assert (validation.as_text() in done.stdout) == verbose
    assert done.stdout.splitlines()[-1] == (
        "details: --out FOLDER writes them to files"
        if verbose
        else "details: --verbose prints them, and --out FOLDER writes them to files"
    )
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == [made]

    asked = run_fingertip("validate", "article", "--out", "found", PWD=str(tmp_path))
    assert asked.stdout.splitlines()[-1] == "details: found/validation.txt, or --verbose"
    assert {path.name for path in (tmp_path / "found").iterdir()} == {*lab.FILES, "manifest.json"}

    idle = run_fingertip("validate", "article", "--force", PWD=str(tmp_path))
    assert idle.returncode == 2
    assert idle.stderr.startswith(
        "error: --force: has no effect without --out, as no file is written; add --out FOLDER"
    )


def test_comparison_of_recordings_writes_no_file_unasked(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    found = SimpleNamespace(
        files=lambda: {"fitted.toml": b"x"}, as_data=dict, as_text=lambda: "measured beside it"
    )
    monkeypatch.setattr("fingertip.recorded_trials.simulation_comparison.compare", lambda *_: found)
    monkeypatch.setattr("fingertip.recorded_trials.trials.read_recordings", lambda _: [])
    words = ("validate", "first_finger", "--recordings", "recordings")
    done = run_fingertip(*words, PWD=str(tmp_path))
    assert (
        done.stdout
        == "measured beside it\nfitted design: --out FOLDER writes it, with this report\n"
    )
    assert not any(tmp_path.iterdir())
    assert run_fingertip(*words, "--out", "m", PWD=str(tmp_path)).stdout.endswith(
        "fitted design: m/fitted.toml\n"
    )
    assert (tmp_path / "m/fitted.toml").read_bytes() == b"x"
