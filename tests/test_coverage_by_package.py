"""Table of branch coverage by package."""

from __future__ import annotations

import json
from pathlib import Path

from tests.conftest import run_python


def test_modules_of_a_package_count_together_and_a_poor_package_fails(tmp_path: Path) -> None:
    names = ("num_statements", "covered_lines", "num_branches", "covered_branches")
    for taken, code, percent in ((8, 0, "90.0"), (7, 1, "89.0")):
        numbers = {"cad/a": (50, 50, 10, 10), "cad/deep/b": (30, 22, 10, taken), "foundation/jit": (0, 0, 0, 0)}
        files = {
            f"src/fingertip/{path}.py": {"summary": dict(zip(names, n, strict=True))} for path, n in numbers.items()
        }
        (tmp_path / "coverage.json").write_text(json.dumps({"files": files}), encoding="utf-8")
        done = run_python("-m", "tools.coverage_by_package", str(tmp_path / "coverage.json"))
        assert (done.returncode, done.stderr) == (code, "coverage: below 90 % are cad; add tests\n" * code)
        rows = [["cad", "80", "20", percent, "%"], ["foundation", "0", "0", "100.0", "%"]]
        assert [line.split() for line in done.stdout.splitlines()[1:]] == rows
