"""Examples: every script in examples/ runs as its docstring says, and prints a result."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.conftest import ROOT, run_python

EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


def test_there_are_examples() -> None:
    assert len(EXAMPLES) >= 3


@pytest.mark.full
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_example_runs(example: Path, tmp_path: Path) -> None:
    (tmp_path / "params").symlink_to(ROOT / "params")
    done = run_python(str(example), PWD=str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert done.stdout
    assert f"examples/{example.name}" in example.read_text(encoding="utf-8")
