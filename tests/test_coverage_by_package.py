"""Table of branch coverage by package."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

from tests.conftest import ROOT


def summary(statements: int, covered: int, branches: int, taken: int) -> dict[str, dict[str, int]]:
    return {
        "summary": {
            "num_statements": statements, "covered_lines": covered, "num_branches": branches, "covered_branches": taken
        }
    }  # fmt: skip


def run(folder: Path, files: dict[str, object]) -> subprocess.CompletedProcess[str]:
    (folder / "coverage.json").write_text(json.dumps({"files": files}), encoding="utf-8")
    command = [sys.executable, "-m", "tools.coverage_by_package", str(folder / "coverage.json")]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


def test_modules_of_a_package_count_together_and_a_poor_package_fails(tmp_path: Path) -> None:
    files: dict[str, object] = {
        "src/fingertip/cad/a.py": summary(50, 50, 10, 10),
        "src/fingertip/cad/deep/b.py": summary(30, 22, 10, 8),
        "src/fingertip/foundation/jit.py": summary(0, 0, 0, 0),
    }
    done = run(tmp_path, files)
    assert done.returncode == 0
    assert [line.split() for line in done.stdout.splitlines()[1:]] == [
        ["cad", "80", "20", "90.0", "%"],
        ["foundation", "0", "0", "100.0", "%"],
    ]
    files["src/fingertip/cad/deep/b.py"] = summary(30, 22, 10, 7)
    done = run(tmp_path, files)
    assert (done.returncode, done.stderr) == (1, "coverage: below 90 % are cad; add tests\n")
