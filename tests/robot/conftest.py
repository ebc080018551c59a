"""Models of fingers, written once a session."""

from __future__ import annotations

import functools
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from fingertip import Design, write_robot
from fingertip.tasks import robot_files

INSTALL = "run `sh .ci/install-robot-readers` as root on Debian"
READERS = (
    f"/opt/robot-readers/lib/python{sys.version_info.major}.{sys.version_info.minor}/site-packages"
)
DESIGNS = ("adult_finger", "fsr400")
"""One that turns on its pin, and a rigid one with a cross bolt."""


@dataclass(frozen=True)
class Model:
    design: Design
    folder: Path
    figures: dict[str, Any]


@pytest.fixture
def readers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let MuJoCo and the readers of URDF be imported, after the packages of the tests."""
    monkeypatch.setattr(sys, "path", [*sys.path, READERS])


@pytest.fixture(scope="session", params=DESIGNS)
def model(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Model:
    design = Design.load(request.param)
    folder = tmp_path_factory.mktemp("robot") / request.param
    with pytest.MonkeyPatch.context() as patch:  # both formats are of one model
        patch.setattr(robot_files, "build_finger", functools.cache(robot_files.build_finger))
        write_robot(design, folder, file_format="urdf")
        (folder / "finger.urdf").rename(folder.with_suffix(".urdf"))
        figures = write_robot(design, folder, file_format="mjcf", force=True)
    folder.with_suffix(".urdf").rename(folder / "finger.urdf")
    return Model(design, folder, figures)
