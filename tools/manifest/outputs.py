"""Outputs that the manifest covers, and the packages on whose versions their bytes depend."""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

from fingertip.foundation.output_set import MANIFEST

ROOT = Path(__file__).resolve().parents[2]
FILE = Path(__file__).with_name("bytes.json")

COMMANDS: dict[str, tuple[str, ...]] = {
    "first_finger": ("make", "params/first_finger.toml"),
    "adult_finger": ("make", "params/adult_finger.toml"),
    "fsr400": ("make", "params/fsr400.toml"),
    "pcb": ("board", "params/fsr400.toml", "--bringup"),
    "pcb/article": ("board", "params/article.toml", "--bringup"),
}
"""Command that makes each folder."""
PACKAGES = ("cadquery-ocp", "manifold3d", "matplotlib", "numpy", "pillow", "pydantic", "tomlkit")
"""Packages that compute or write what the files hold."""


@dataclass(frozen=True)
class Manifest:
    """SHA-256 of each file, by folder and path, and the versions for which they hold."""

    versions: dict[str, str]
    files: dict[str, dict[str, str]]

    @classmethod
    def read(cls) -> Manifest:
        """Read the committed manifest."""
        data = json.loads(FILE.read_text(encoding="utf-8"))
        return cls(data["versions"], data["files"])

    def write(self) -> None:
        """Write the manifest."""
        data = {"versions": self.versions, "files": self.files}
        FILE.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")


def installed_versions() -> dict[str, str]:
    """Return the installed version of each package that matters."""
    return {name: metadata.version(name) for name in PACKAGES}


def make_outputs(names: Iterable[str], top: Path) -> dict[str, Path]:
    """Make some of the outputs below a folder and return where each is."""
    made = {}
    for name in names:
        folder = top / name.replace("/", "_")
        command = [
            sys.executable,
            "-m",
            "fingertip",
            *COMMANDS[name],
            "--out",
            str(folder),
            "--quiet",
        ]
        done = subprocess.run(
            command,
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=False,
        )

        if done.returncode:
            sys.exit(
                f"manifest: exit status {done.returncode} of "
                f"{' '.join(command)}\n{done.stdout}{done.stderr}"
            )

        made[name] = folder

    return made


def hash_folder(folder: Path, other: Iterable[Path] = ()) -> dict[str, str]:
    """Hash every file of a folder, by its path, without the folders of other outputs within it.

    The manifests of its sets are left out: they list the sums of the same files, and one of the
    program's sources, which each edit of a comment changes.
    """
    skipped = tuple(path.resolve() for path in other)
    found = {}

    for path in sorted(folder.rglob("*")):
        is_output = path.is_file() and path.name != MANIFEST
        if is_output and not any(path.resolve().is_relative_to(one) for one in skipped):
            found[path.relative_to(folder).as_posix()] = hashlib.sha256(
                path.read_bytes()
            ).hexdigest()

    return found


def hash_outputs(made: dict[str, Path]) -> dict[str, dict[str, str]]:
    """Hash the files of every output."""
    return {
        name: hash_folder(
            folder,
            [other for other in made.values() if other != folder and other.is_relative_to(folder)],
        )
        for name, folder in made.items()
    }
