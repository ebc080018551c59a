"""Command `python -m tools.manifest.write`: make all outputs and write their SHA-256 to
tools/manifest/bytes.json.

Run it in the .venv of `sh install.sh test` after each deliberate change of an output. It takes
about a minute.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from tools.manifest.outputs import (
    COMMANDS,
    FILE,
    Manifest,
    hash_outputs,
    installed_versions,
    make_outputs,
)


def main() -> None:
    """Write the manifest."""
    with tempfile.TemporaryDirectory(prefix="fingertip-manifest-") as top:
        files = hash_outputs(make_outputs(COMMANDS, Path(top)))

    Manifest(installed_versions(), files).write()
    print(f"{FILE.name}: {sum(map(len, files.values()))} files")


if __name__ == "__main__":
    main()
