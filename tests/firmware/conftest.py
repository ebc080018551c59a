"""Libraries of two designs, compiled for this machine once a session."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest

from fingertip.design import Design
from tests.conftest import design_file
from tests.tools import require_tool
from tools.firmware.toolchain import HOST_LIBRARY, HostDetector, compile_host, write_sources

INSTALL = "as root, sh .ci/install-firmware"


def require_gcc() -> None:
    require_tool("gcc", INSTALL)


def require_arm() -> None:
    for tool in ("gcc", "arm-none-eabi-gcc", "qemu-system-arm"):
        require_tool(tool, INSTALL)


@dataclass(frozen=True)
class Library:
    """Library of a design, compiled for this machine."""

    design: Design
    folder: Path

    def detector(self) -> HostDetector:
        return HostDetector(self.folder / HOST_LIBRARY)


def make_library(design: Design, folder: Path) -> Library:
    """Write and compile the library of a design."""
    require_gcc()
    folder.mkdir(exist_ok=True)
    write_sources(design, folder)
    compile_host(folder)
    return Library(design, folder)


@pytest.fixture(scope="session")
def library(tmp_path_factory: pytest.TempPathFactory) -> Library:
    """Library of the default design, whose board is made for a controller."""
    return make_library(Design(), tmp_path_factory.mktemp("library"))


@pytest.fixture(scope="session")
def article_library(tmp_path_factory: pytest.TempPathFactory) -> Library:
    """Library of the article's design, whose board gives no filtered signal."""
    return make_library(Design.load(design_file("article")), tmp_path_factory.mktemp("article"))
