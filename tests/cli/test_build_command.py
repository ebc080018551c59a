"""`fingertip build`: exit codes, output streams, and the files that remain after an error."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from fingertip.design import Design
from tests.conftest import design_file, run_fingertip

FSR400 = design_file("fsr400")


def test_failed_check_exits_1(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fingertip.cad.verification.printing.part_genus", lambda *_: 3)
    done = run_fingertip("build", FSR400, "--out", tmp_path, "--parts", "skin", "--formats", "stl")
    assert done.returncode == 1, done.stderr
    assert "FAILED skin.stl.genus" in done.stdout
    assert json.loads((tmp_path / "report.json").read_text())["passed"] is False
    assert (tmp_path / "skin.stl").exists()


def fake_module(tmp_path: Path, name: str, text: str) -> str:
    fake = tmp_path / "fake"
    fake.mkdir()
    (fake / f"{name}.py").write_text(text)
    return str(fake) + os.pathsep + os.environ.get("PYTHONPATH", "")


@pytest.mark.full
def test_without_libgl_the_step_error_names_the_packages_to_install(tmp_path: Path) -> None:
    out = tmp_path / "out"
    fake = fake_module(
        tmp_path, "OCP", "raise ImportError('libGL.so.1: cannot open shared object file')\n"
    )
    done = run_fingertip("build", FSR400, "--out", out, PYTHONPATH=fake)
    assert done.returncode == 2
    errors = [line for line in done.stderr.splitlines() if line.startswith("error")]
    assert len(errors) == 1
    assert "libGL.so.1" in errors[0]
    assert "apt-get install libgl1" in errors[0]
    assert "--formats stl,3mf" in errors[0]
    assert not out.exists()


@pytest.mark.full
def test_hanging_step_process_is_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from fingertip.cad.files.step_process import StepProcess
    from fingertip.foundation.errors import GeometryError
    from fingertip.tasks import build as module

    fake = fake_module(tmp_path, "OCP", "import time\ntime.sleep(600)\n")
    monkeypatch.setenv("PYTHONPATH", fake)  # of a new process
    monkeypatch.syspath_prepend(str(tmp_path / "fake"))  # of a copy of this one
    monkeypatch.setattr(StepProcess.result, "__defaults__", (3.0,))
    with pytest.raises(GeometryError, match="still loading Open CASCADE after 3 s"):
        module.build(Design(), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_string_instead_of_a_list_is_rejected() -> None:
    from fingertip import Design, build
    from fingertip.foundation.errors import DesignError

    with pytest.raises(
        DesignError,
        match=r"formats: 'stl,3mf' is a single text; give a list, such as \['stl', '3mf'\]",
    ):
        build(Design(), formats="stl,3mf")
    with pytest.raises(
        DesignError, match=r"changes: 'skin.width_mm=18' is a single text; use changes="
    ):
        Design.load(changes="skin.width_mm=18")
