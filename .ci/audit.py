"""Judge a report of `pip-audit -f json`.

Exit status 0: the service knows every package, and no advisory. 1: there are advisories. 3: there
is no report, or packages that the service does not know: an index that answers "not found" to
everything would look like a pass.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path


def main() -> int:
    """Print advisories or what was left out, and return the exit status."""
    try:
        packages = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))["dependencies"]
    except (OSError, ValueError, KeyError):
        print("the service gave no answer")
        return 3
    found = [
        (one["name"], one["version"], bug["id"]) for one in packages for bug in one.get("vulns", ())
    ]
    for name, version, advisory in found:
        print(f"{name} {version}: {advisory}")
    skipped = [one["name"] for one in packages if "skip_reason" in one]
    if found:
        return 1
    if skipped or not packages:
        print(f"the service knows nothing of {len(skipped)} of {len(packages)} packages")
        return 3
    print(f"no advisory about {len(packages)} packages")
    return 0


if __name__ == "__main__":
    sys.exit(main())
