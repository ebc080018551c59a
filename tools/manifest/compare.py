"""Command `python -m tools.manifest.compare`: compare the outputs that this machine makes with the
manifest.

    python -m tools.manifest.compare    makes everything anew, about a minute
    python -m tools.manifest.compare --made first_finger=out/first_finger --made pcb=pcb
        compares folders that exist

Exit code 1: a file differs, is missing or new, or other versions are installed than the manifest is
for.
"""

from __future__ import annotations

import argparse
import platform
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from tools.manifest.outputs import (
    COMMANDS,
    Manifest,
    hash_outputs,
    installed_versions,
    make_outputs,
)

Files = Mapping[str, Mapping[str, str]]


def main() -> None:
    """Compare and print what differs."""
    parser = argparse.ArgumentParser(description="Compare outputs with the byte manifest.")
    parser.add_argument(
        "--made",
        action="append",
        default=[],
        metavar="NAME=FOLDER",
        help=", ".join(COMMANDS),
    )
    given = dict(word.split("=", 1) for word in parser.parse_args().made)
    unknown = sorted(set(given) - set(COMMANDS))
    if unknown:
        parser.error(f"--made takes {', '.join(COMMANDS)}; not {', '.join(unknown)}")

    manifest = Manifest.read()
    wrong = describe_versions(manifest.versions, installed_versions())
    if wrong:
        sys.exit(
            f"manifest: {wrong}; install with -c constraints.txt, or run python -m "
            "tools.manifest.write"
        )

    if given:
        found = hash_outputs({name: Path(folder) for name, folder in with_nested(given).items()})
        found = {name: files for name, files in found.items() if name in given}
    else:
        with tempfile.TemporaryDirectory(prefix="fingertip-manifest-") as top:
            found = hash_outputs(make_outputs(COMMANDS, Path(top)))

    lines = list_differences({name: manifest.files[name] for name in found}, found)
    for line in lines:
        print(f"manifest: {line}", file=sys.stderr)

    where = f"Python {platform.python_version()}, {platform.system()} {platform.machine()}"
    if lines:
        remedy = "if the change is meant, run python -m tools.manifest.write"
        sys.exit(f"manifest: {len(lines)} files differ on {where}; {remedy}")

    print(f"manifest: {sum(map(len, found.values()))} files are the same on {where}")


def with_nested(given: Mapping[str, str]) -> dict[str, str]:
    """Add outputs that lie in the folder of a given one, as
    pcb/article lies in pcb, so that they are told apart.
    """
    nested = {
        other: str(Path(folder) / other.removeprefix(f"{name}/"))
        for name, folder in given.items()
        for other in COMMANDS
        if other.startswith(f"{name}/")
    }
    return {**nested, **given}


def describe_versions(stated: Mapping[str, str], installed: Mapping[str, str]) -> str:
    """Name the packages whose installed versions are not those of
    the manifest; empty if there are none.
    """
    other = [
        f"{name} {stated.get(name)}, not {version}"
        for name, version in installed.items()
        if version != stated.get(name)
    ]
    return f"the manifest is for {'; '.join(other)}" if other else ""


def list_differences(expected: Files, found: Files) -> list[str]:
    """List files that differ, are missing or are new."""
    lines = []
    for name in expected:
        before = expected[name]
        now = found[name]
        for path in sorted({*before, *now}):
            if before.get(path) != now.get(path):
                if path not in now:
                    kind = "missing"
                elif path not in before:
                    kind = "new"
                else:
                    kind = "different"

                lines.append(f"{name}: {path} is {kind}")

    return lines


if __name__ == "__main__":
    main()
