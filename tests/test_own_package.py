"""A package of somebody else brings a detector and a check by the entry points in its metadata."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from fingertip.foundation.errors import FingertipError
from fingertip.foundation.extras import find_plugins
from fingertip.slip.detectors.registry import DETECTORS, find_detector_type, list_detectors
from tests.conftest import ROOT
from tests.test_one_file import run_lines
from tests.tools import find_installer

EXAMPLE = ROOT / "examples/own_detector_and_check"


def install(package: str, entry_points: str, site: Path) -> None:
    """What pip leaves of a package: its module, and the metadata beside it."""
    shutil.copy(EXAMPLE / "own_detector_and_check.py", site)
    metadata = site / f"{package}-1.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1\n")
    (metadata / "entry_points.txt").write_text(entry_points)


def read_entry_points() -> str:
    project = tomllib.loads((EXAMPLE / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    groups = project["entry-points"].items()
    return "".join(
        f"[{group}]\n" + "".join(f"{k} = {v}\n" for k, v in names.items())
        for group, names in groups
    )


def run_beside(site: Path, *lines: str) -> subprocess.CompletedProcess[str]:
    folder = site.parent / "work"
    folder.mkdir(exist_ok=True)
    return run_lines(folder, f"{ROOT / 'src'}{os.pathsep}{site}", *lines)


@pytest.mark.second
def test_an_installed_package_brings_a_detector_and_a_check(tmp_path: Path) -> None:
    site = tmp_path / "site"
    site.mkdir()
    install("own_detector_and_check", read_entry_points(), site)
    lines = [
        "complete fingertip detect --detector o",
        "detect --help",
        "simulate --out a.csv",
        "check article --tolerance-mm 0.1 -v",
    ]
    done = run_beside(site, *lines, "detect a.csv --detector own")
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[0] == "own"
    for text in ("own (of another package)", "detector own, on voltage_v", "own.bone_mass 9.0"):
        assert text in " ".join(done.stdout.split())


@pytest.mark.parametrize(
    ("entry", "problem"),
    [
        ("fast = own_detector_and_check:OWN", "bring a name that exists already"),
        ("own = own_detector_and_check:NOTHING", "failed .AttributeError"),
        ("own = own_detector_and_check:ChangeDetector", "is no DetectorType"),
    ],
)
@pytest.mark.every_case
def test_a_broken_package_is_one_sentence(
    entry: str, problem: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install("broken", f"[fingertip.detectors]\n{entry}\n", tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    find_plugins.cache_clear()
    try:
        with pytest.raises(FingertipError, match=problem) as raised:
            find_detector_type(entry.split()[0])
        assert len(raised.value.issues) == 1
        assert list_detectors()[: len(DETECTORS)] == (*DETECTORS,)
    finally:
        find_plugins.cache_clear()
        sys.modules.pop("own_detector_and_check", None)


@pytest.mark.full
def test_pip_installs_the_example(tmp_path: Path) -> None:
    options = (
        "--quiet",
        "--no-deps",
        "--no-build-isolation",
        "--no-index",
        "--target",
        str(tmp_path / "site"),
    )
    command = [*find_installer(), "install", *options, str(EXAMPLE)]
    environment = os.environ | {"VIRTUAL_ENV": sys.prefix}  # where uv looks for a Python
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    done = run_beside(tmp_path / "site", "complete fingertip detect --detector o")
    assert done.stdout == "own\n"
