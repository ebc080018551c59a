"""Environment of the fuzzer, which its tests leave as it was."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator

import pytest


@pytest.fixture(autouse=True)
def environment() -> Iterator[None]:
    """Restore the folder of temporary files, which a run of the fuzzer moves for its process."""
    variables, folder = dict(os.environ), tempfile.tempdir
    yield
    os.environ.clear()
    os.environ.update(variables)
    tempfile.tempdir = folder
