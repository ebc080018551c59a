"""Programs that some tests need beside Python: found, or the test is
skipped loudly, or it fails where it must run.
"""

from __future__ import annotations

import importlib
import os
import shutil
import sys
from pathlib import Path
from typing import Any, NoReturn

import pytest

from fingertip.foundation.extras import EXTRAS, install_command, is_installed


def require_tool(name: str, how_to_install: str) -> Path:
    """Path of a program or of a file or folder given by an absolute path.

    Skips the test if it is missing; fails it instead where FINGERTIP_REQUIRE_TOOLS=1 is set (as in
    CI).
    """
    if not os.path.isabs(name):
        found = shutil.which(name)
    elif os.path.exists(name):
        found = name
    else:
        found = None
    if found:
        return Path(found)
    leave_out(f"{name} IS MISSING, THIS IS NOT TESTED: {how_to_install}")


def find_installer() -> tuple[str, ...]:
    """Command that takes the words of pip: pip of this Python, or uv, which needs none there."""
    if is_installed("pip"):
        return (sys.executable, "-m", "pip")
    return (str(require_tool("uv", "pip install uv")), "pip")


def leave_out(message: str) -> NoReturn:
    """Skip a test loudly, or fail it where everything must be tested."""
    if os.environ.get("FINGERTIP_REQUIRE_TOOLS") == "1":
        pytest.fail(message, pytrace=False)
    pytest.skip(message)


def require_module(name: str, how_to_install: str = "") -> Any:
    """Import an optional package; like `require_tool`, skips the test
    loudly or fails it if the package is missing.
    """
    try:
        return importlib.import_module(name)
    except ImportError:
        package = name.partition(".")[0]
        how_to_install = how_to_install or (
            install_command(package) if package in EXTRAS else "sh install.sh test"
        )
    leave_out(f"{name} IS MISSING, THIS IS NOT TESTED: {how_to_install}")
