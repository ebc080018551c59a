"""Errors in Python speak of arguments, and those of the command line of options."""

from __future__ import annotations

import inspect
import pickle
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fingertip
from fingertip import Design, FingertipError, Trace
from fingertip.foundation.errors import Issue, as_arguments


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        ("use --rate-hz 1000 to adapt its filters.", "use rate_hz=1000 to adapt its filters."),
        (
            "with --rate-hz 2e3 --column time_s=none;",
            'with rate_hz=2e3, columns={"time_s": "none"};',
        ),
        ("use --set a.b=precision --set c.d=3.3", 'use changes={"a.b": "precision", "c.d": 3.3}'),
        (
            "--set a.b=true or --set c.d='x y', both",
            'changes={"a.b": True} or changes={"c.d": \'x y\'}, both',
        ),
        ("add --time-scale ms.", "add time_scale=1e-3."),
        ("choose --calibrate 0:0.5; leave --fab out", "choose calibrate_s=(0, 0.5); leave fab out"),
        ("another folder with --out, or add --force", "another folder with out, or add force=True"),
        ("use --formats stl,3mf.", 'use formats=["stl", "3mf"].'),
        (
            "`fingertip board DESIGN --bringup` writes --out",
            "`fingertip board DESIGN --bringup` writes out",
        ),
        ("uv pip install --python /bin/python; a--b", "uv pip install --python /bin/python; a--b"),
    ],
)
def test_options_become_arguments(typed: str, said: str) -> None:
    assert as_arguments(typed) == said
    issue = Issue("--speed-m-s", typed)
    assert (issue.typed, str(issue)) == (f"--speed-m-s: {typed}", f"speed_m_s: {said}")


def stated() -> Design:
    return Design.load(changes={"detector.sample_rate_hz": 2000})


_HUGE: tuple[Callable[[Path], Any], ...] = (
    lambda folder: Design(skin={"width_mm": 10**400}),
    lambda folder: fingertip.Trial(speed_m_s=10**400),
    lambda folder: fingertip.detect(np.zeros(9), rate_hz=10**400),
    lambda folder: fingertip.calibrate_printer(Design(), 10**400),
    lambda folder: Trace([10**400], [0.0]),
    lambda folder: fingertip.detect([10**400, 1], rate_hz=2000),
)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (
            lambda folder: fingertip.detect(Trace(np.arange(999) / 1e3, np.zeros(999)), stated()),
            "use rate_hz=1000",
        ),
        (
            lambda folder: fingertip.detect(np.zeros(999), detector="slow", rate_hz=2e3),
            "detector: 'slow'",
        ),
        (
            lambda folder: fingertip.read_trace(folder / "t.csv", columns={"volts": "a"}),
            "columns: 'volts'",
        ),
        (lambda folder: fingertip.read_trace(folder / "t.csv", rate_hz=-1.0), "rate_hz: -1 Hz"),
        (lambda folder: fingertip.detect_file(folder / "t.csv"), "rate_hz"),
        (
            lambda folder: fingertip.detect_file("t.csv", columns={"voltage_v": "force_n"}),
            "calibrate_s: is missing",
        ),
        (lambda folder: fingertip.Trial(speed_m_s=-1.0, seed=-1), "speed_m_s: -1 m/s is refused"),
        (lambda folder: fingertip.Trial(speed_m_s=10**307), "speed_m_s: 1e+307 m/s is refused"),
        (lambda folder: fingertip.build(Design(), formats=["obj"]), "formats: 'obj'"),
        (
            lambda folder: fingertip.build(Design(), folder, parts=["hand_stub"]),
            "has no 'hand_stub'",
        ),
        (
            lambda folder: fingertip.write_board(Design(), folder / "t.csv"),
            "choose another folder with out",
        ),
        (lambda folder: fingertip.check(Design(), tolerance_mm=9.0), "tolerance_mm: 9 mm"),
        (lambda folder: Design.load(changes=["bone"]), "changes bone: is not of the form"),
        (lambda folder: fingertip.CampaignPlan(0, 0.0), "negative_minutes: 0 min"),
        (lambda folder: fingertip.validate(Design(), first_seed=7), "seed: 7 is refused"),
        (
            lambda folder: fingertip.calibrate_sensor(
                Design(), fingertip.read_weighings(folder / "t.csv")
            ),
            "t.csv",
        ),
        (
            lambda folder: fingertip.part_mesh(Design(), "bone", tolerance_mm=-1),
            "tolerance_mm: -1 mm is out of bounds",
        ),
        (
            lambda folder: fingertip.picture(Design(), 0),
            "width_px: 0 is out of range; choose 400 to 6000",
        ),
        (
            lambda folder: fingertip.calibrate_printer(Design(), 1.14),
            "half_thickness_mm: 1.14 looks like centimetres",
        ),
        (
            lambda folder: Design.load(changes={"skin.width_mm": None}),
            "changes skin.width_mm: None is no value",
        ),
        (
            lambda folder: Design.load(changes="a.b=c"),
            'changes: \'a.b=c\' is a single text; use changes={"a.b": "c"}',
        ),
        (
            lambda folder: Design.load("adult_finger", changes={"skin": {"width_mm": 15}}),
            "skin.width_mm=16 ",
        ),
        (
            lambda folder: Trace(np.zeros(9), np.zeros(8)),
            "voltage_v: has shape (8,), but time_s has shape (9,)",
        ),
        (
            lambda folder: Trace(np.zeros((3, 2)), [0.0]),
            "time_s: has shape (3, 2); give one value per sample",
        ),
        (lambda folder: Trace(["a"], [0.0]), "time_s: is no array of numbers"),
        *(
            (
                lambda folder, noise=noise: fingertip.detect(
                    np.ones(999), noise_v=noise, rate_hz=1e3
                ),
                f"noise_v: {noise} V is refused; give a finite number above 0, such as 0.0005 V",
            )
            for noise in (0, -1, float("nan"))
        ),
        (
            lambda folder: fingertip.read_trace(folder / "t.csv", rate_hz=500),
            "rate_hz: 500 Hz is out of range; record",
        ),
        (
            lambda folder: fingertip.detect_stream(iter([0.5])),
            "line 1: is 0.5, no text; give lines of CSV",
        ),  # type: ignore[list-item]
        (
            lambda folder: fingertip.Picture(b"").save(folder / "a.jpg"),
            "would be a PNG file of another name",
        ),
        (
            lambda folder: Design.load(changes={"skin.width_mm": "18"}),
            "write the number in mm, without quotes",
        ),
        (
            lambda folder: Design.load(changes={"width_mm": 18}),
            "did you mean hand.width_mm or skin.width_mm?",
        ),
        (lambda folder: Design(changes={}), 'Design.load("fsr400", changes={"skin.width_mm": 18})'),
        (
            lambda folder: setattr(Design().skin, "width_mm", 18),
            'load it again with changes={"skin.width_mm": 18}',
        ),
        (
            lambda folder: Design.load(changes={"skin.width_mm": 18, "skin": {"width_mm": 19}}),
            "is given twice, as 18",
        ),
        (
            lambda folder: fingertip.part_mesh(Design(), "bonee"),
            "name: there is no 'bonee'; did you mean bone?",
        ),
        (lambda folder: fingertip.calibrate_printer(Design(), folder), "give a number"),  # type: ignore[arg-type]
        (
            lambda folder: fingertip.Readout(Design(), b"x"),
            "pads: is b'x', of type bytes; give a list",
        ),  # type: ignore[arg-type]
        (
            lambda folder: Design.load(changes=Design()),
            "changes: holds ('name', 'fsr400'); give texts",
        ),  # type: ignore[arg-type]
        (lambda folder: Trace(float("inf"), True), "time_s: has shape (); give one"),  # type: ignore[arg-type]
        *(
            (
                call,
                "int too large" if place > 3 else "beyond every float" if place else "is too large",
            )
            for place, call in enumerate(_HUGE)
        ),
        (
            lambda folder: fingertip.run_sweep({"outputs": []}, {"fit": True}),
            "changes: change a file",
        ),
        (
            lambda folder: fingertip.run_sweep("board", out=folder, jobs=0),
            "jobs: 0 is out of range; choose 1 to",
        ),
    ],
)
def test_functions_name_their_arguments(
    call: Callable[[Path], Any], said: str, tmp_path: Path
) -> None:
    (tmp_path / "t.csv").write_text("voltage_v,force_n\n1,2\n1,2\n", encoding="utf-8")
    with pytest.raises(FingertipError, match=re.escape(said)) as refused:
        call(tmp_path)
    assert not re.search(r"(?m)(?:^|\s)--[a-z]", str(refused.value))


@pytest.mark.parametrize(
    "name", [name for name in fingertip.__all__ if name.islower() and name != "__version__"]
)
def test_public_functions_refuse_other_types_of_each_argument(name: str) -> None:
    function = getattr(fingertip, name)
    # Anything that numpy reads, a protocol, and what is known.
    unchecked = {
        "recording",
        "controller",
        "origin",
    }
    for argument, parameter in inspect.signature(function).parameters.items():
        if argument not in unchecked:
            others = {
                each: None
                for each, needed in inspect.signature(function).parameters.items()
                if needed.default is needed.empty and each != argument
            }
            wrong: dict[str, Any] = {argument: object(), **others}
            ordered = {
                each: wrong[each]
                for each in inspect.signature(function).parameters
                if each in wrong
            }
            with pytest.raises((TypeError, FingertipError), match=r"of type \w+; give ") as refused:
                function(**ordered)
            assert isinstance(refused.value, FingertipError), parameter


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: Design.load(None), "files[0]: is None, of type NoneType; give a path or a text"),  # type: ignore[arg-type]
        (lambda: Design.load(changes=[5]), "changes[0]: is 5, of type int; give a text"),  # type: ignore[list-item]
        (lambda: fingertip.Trial(seed=1.5), "seed: is 1.5, of type float; give a whole number"),  # type: ignore[arg-type]
        (lambda: fingertip.CampaignPlan("12", 4.0), "trials: is '12', of type str"),  # type: ignore[arg-type]
        (lambda: fingertip.Readout(Design(), -1), "pads: is -1, of type int; give a list"),  # type: ignore[arg-type]
        (lambda: fingertip.SlipChain(Design()), "settings: is Design("),  # type: ignore[arg-type]
        (
            lambda: fingertip.build(Design(), 5),
            "out: is 5, of type int; give None, a path or a text",
        ),
        (
            lambda: fingertip.frames("fsr400"),
            'of type str; give a Design, such as Design.load("fsr400")',
        ),
    ],
)
def test_other_types_are_refused_by_name(call: Callable[[], Any], said: str) -> None:
    with pytest.raises(FingertipError, match=re.escape(said)) as refused:
        call()
    assert isinstance(refused.value, TypeError)


def test_lists_nested_tables_and_numbers_of_numpy_work() -> None:
    for number in (np.float32(19.0), np.int64(19), np.array(19.0)):
        assert Design.load(changes={"skin.width_mm": number}).skin.width_mm == 19.0
    assert Design.load(changes={"skin": {"width_mm": 19}}).skin.width_mm == 19.0
    assert type(fingertip.Trial(seed=np.int64(3)).seed) is int  # type: ignore[arg-type]
    trace = fingertip.simulate(Design(), fingertip.Trial(seed=3))
    found = fingertip.detect(
        Trace(trace.time_s.tolist(), trace.voltage_v.tolist()), Design(), "fast"
    )
    assert found.intervals == fingertip.detect(trace, Design(), "fast").intervals
    assert pickle.loads(pickle.dumps(fingertip.simulate)) is fingertip.simulate
