"""Print a constraints file with the lowest version of each direct dependency that pyproject.toml allows."""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path


def lowest_versions(pyproject: Path) -> list[str]:
    """Lines such as `numpy==1.26.*`, sorted by name."""
    project = tomllib.loads(pyproject.read_text(encoding="utf-8"))["project"]
    extras = project.get("optional-dependencies", {}).values()
    lines = set()
    for requirement in [*project["dependencies"], *(item for extra in extras for item in extra)]:
        if requirement.startswith(f"{project['name']}["):  # an extra that consists of others
            continue
        name, version = re.fullmatch(r"([\w.-]+)>=([\w.]+)(?:,<\d+)?", requirement).groups()
        lines.add(f"{name}=={version}" if version.count(".") > 1 else f"{name}=={version}.*")
    return sorted(lines)


if __name__ == "__main__":
    print("\n".join(lowest_versions(Path(sys.argv[1]))))
