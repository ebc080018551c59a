"""Command `python -m tools.coverage_by_package FILE`: branch coverage of src by package, from coverage's JSON.

Lines and branches count together, as coverage does. Exit code 1: a package is below `MIN_PERCENT`.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

MIN_PERCENT = 90.0
_COUNTS = ("num_statements", "covered_lines", "num_branches", "covered_branches")


def main() -> None:
    """Print the table and judge it."""
    data = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    table = sum_by_package(data["files"])
    print(f"{'package':24}{'lines':>8}{'branches':>10}{'covered':>10}")
    for package, counts in sorted(table.items()):
        print(f"{package:24}{counts['num_statements']:8}{counts['num_branches']:10}{percent(counts):8.1f} %")
    poor = [package for package, counts in table.items() if percent(counts) < MIN_PERCENT]
    if poor:
        sys.exit(f"coverage: below {MIN_PERCENT:g} % are {', '.join(sorted(poor))}; add tests")


def sum_by_package(files: Mapping[str, Any]) -> dict[str, Counter[str]]:
    """Add up lines and branches by package; modules beside the packages are one group of their own."""
    table: dict[str, Counter[str]] = {}
    for path, file in files.items():
        parts = Path(path).parts
        inner = parts[parts.index("fingertip") + 1 :]
        package = inner[0] if len(inner) > 1 else "(top level)"
        counts = table.setdefault(package, Counter())
        counts.update({name: file["summary"][name] for name in _COUNTS})
    return table


def percent(counts: Mapping[str, int]) -> float:
    """Return the share of lines and branches that ran [%]."""
    total = counts["num_statements"] + counts["num_branches"]
    return 100.0 * (counts["covered_lines"] + counts["covered_branches"]) / total if total else 100.0


if __name__ == "__main__":
    main()
