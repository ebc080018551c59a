"""Command `python -m tools.dependencies.hashes`: write constraints-hashes.txt from constraints.txt.

Run it in the .venv of `sh install.sh test`, again whenever constraints.txt changes. The list has the SHA-256 of each
wheel of the pinned versions for the supported Python versions on the platforms of `needs.PLATFORMS`, in the order of
the levels of install.sh, which installs its part of the list with `pip install --require-hashes`. The list names no
index: pip takes the user's own. This command asks the index that pip is set to.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import urllib.request
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from html import unescape
from html.parser import HTMLParser
from urllib.parse import unquote

from packaging.tags import Tag
from packaging.utils import InvalidWheelFilename, parse_wheel_filename
from packaging.version import Version

from tools.dependencies.needs import Need, Target, format_marker, list_levels, list_needs, list_targets, wheel_tags
from tools.dependencies.pins import CONSTRAINTS, ROOT, canonical, read_back_end, read_pins, read_project

HASHES = ROOT / "constraints-hashes.txt"
_HEADING = """\
# SHA-256 of the wheels of constraints.txt. install.sh reads this file up to the end of its level.
# Made by python -m tools.dependencies.hashes; do not edit. Renew it whenever constraints.txt changes.
"""
_ACCEPT = "application/vnd.pypi.simple.v1+json, text/html;q=0.5"
_TIMEOUT_S = 120.0
_CONNECTIONS = 4


@dataclass(frozen=True)
class IndexFile:
    """File that the index offers."""

    name: str
    sha256: str


def main() -> None:
    """Write the list."""
    pins, index, project = read_pins(CONSTRAINTS.read_text(encoding="utf-8")), find_index(), read_project()
    targets = list_targets(project)
    levels = list_levels(project, read_back_end())
    needs = list_needs(levels, targets)
    names = {canonical(name) for name in pins}
    if needs.keys() != names:
        lacking, idle = sorted(needs.keys() - names), sorted(names - needs.keys())
        sys.exit(
            f"hashes: constraints.txt lacks {lacking or 'nothing'}, and nothing needs {idle or 'what it has more'}"
        )
    with ThreadPoolExecutor(_CONNECTIONS) as pool:
        offered = list(pool.map(lambda name: list(list_files(index, name)), pins))
    chosen = {
        name: choose_wheels(files, name, version, needs[canonical(name)].targets)
        for (name, version), files in zip(pins.items(), offered, strict=True)
    }
    HASHES.write_text(format_list(pins, needs, levels, targets, chosen), encoding="utf-8")
    print(f"{HASHES.name}: {len(pins)} packages, {sum(map(len, chosen.values()))} wheels")


def find_index() -> str:
    """Find the address of the index that pip is set to, or pip's own default."""
    command = [sys.executable, "-m", "pip", "config", "list"]
    settings = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    found = re.search(r"^[^=\n]*\bindex-url='([^']*)'$", settings, re.MULTILINE)
    if found and "extra" not in found[0]:
        return found[1].rstrip("/")
    from pip._internal.models.index import PyPI  # the address stands in pip only

    return str(PyPI.simple_url).rstrip("/")


def list_files(index: str, name: str) -> Iterator[IndexFile]:
    """List the files of a package, from the JSON or the HTML form of the simple index (PEP 691, PEP 503)."""
    request = urllib.request.Request(f"{index}/{canonical(name)}/", headers={"Accept": _ACCEPT})
    with urllib.request.urlopen(request, timeout=_TIMEOUT_S) as answer:
        kind, text = answer.headers.get_content_type(), answer.read().decode("utf-8")
    return read_json_page(text) if kind.endswith("json") else read_html_page(text)


def read_json_page(text: str) -> Iterator[IndexFile]:
    """Read a page of PEP 691."""
    for file in json.loads(text)["files"]:
        if "sha256" in file["hashes"]:
            yield IndexFile(file["filename"], file["hashes"]["sha256"])


def read_html_page(text: str) -> Iterator[IndexFile]:
    """Read a page of PEP 503, whose links end in `FILE#sha256=HASH`."""
    links: list[str] = []

    class Links(HTMLParser):
        def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
            links.extend(value for key, value in attrs if tag == "a" and key == "href" and value)

    Links().feed(text)
    for link in links:
        address, _, fragment = unescape(link).partition("#sha256=")
        if re.fullmatch("[0-9a-f]{64}", fragment):
            yield IndexFile(unquote(address.rsplit("/", 1)[-1]), fragment)


def choose_wheels(files: Iterable[IndexFile], name: str, version: str, targets: Iterable[Target]) -> list[IndexFile]:
    """Select the wheels of a version that a target can install; a target without any is an error."""
    wheels = {file: tags for file in files if (tags := _tags_of(file.name, name, version))}
    chosen = set()
    for target in targets:
        fitting = {file for file, tags in wheels.items() if not tags.isdisjoint(wheel_tags(target))}
        if not fitting:
            sys.exit(f"hashes: the index has no wheel of {name} {version} for {target.name}; pin another version")
        chosen |= fitting
    return sorted(chosen, key=lambda file: file.sha256)


def _tags_of(filename: str, name: str, version: str) -> frozenset[Tag]:
    """Tags of a wheel of this version; none if the file is something else."""
    try:
        found, release, _, tags = parse_wheel_filename(filename)
    except InvalidWheelFilename:
        return frozenset()
    return tags if found == canonical(name) and release == Version(version) else frozenset()


def format_list(
    pins: Mapping[str, str],
    needs: Mapping[str, Need],
    levels: Iterable[str],
    targets: Iterable[Target],
    wheels: Mapping[str, Iterable[IndexFile]],
) -> str:
    """Format the targets, and each level's pins with their hashes, as pip reads them."""
    targets = list(targets)
    lines = [_HEADING, *(f"# covers {target.name}\n" for target in targets)]
    for level in levels:
        for name, version in pins.items():
            need = needs[canonical(name)]
            if need.level == level:
                lines.append(format_pin(name, version, format_marker(need, targets), wheels[name]))
        lines.append(f"# end of {level}\n")
    return "".join(lines)


def format_pin(name: str, version: str, marker: str, files: Iterable[IndexFile]) -> str:
    """Format a pin with its hashes, as pip reads it."""
    pin = f"{name}=={version}" + (f" ; {marker}" if marker else "")
    return " \\\n".join([pin, *(f"    --hash=sha256:{file.sha256}" for file in files)]) + "\n"


if __name__ == "__main__":
    main()
