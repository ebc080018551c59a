"""Command `python -m tools.dependencies.hashes`: write constraints-hashes.txt from constraints.txt.

    pip install --require-hashes -r constraints-hashes.txt
    pip install --no-deps fingertip-0.1.0-py3-none-any.whl

installs the pinned versions and nothing whose bytes changed since. The list has the SHA-256 of each wheel that the
package index offers for the supported Python versions, on every platform, and of the source archive where a package has
no wheel. It names no index: pip takes the user's own. This command asks the index that pip is set to.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import urllib.request
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from html import unescape
from html.parser import HTMLParser
from urllib.parse import unquote

from tools.dependencies.pins import CONSTRAINTS, ROOT, canonical, read_pins, read_project, supported_pythons

HASHES = ROOT / "constraints-hashes.txt"
_HEADING = """\
# SHA-256 of the wheels of constraints.txt, for pip install --require-hashes -r constraints-hashes.txt.
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
    pins, index = read_pins(CONSTRAINTS.read_text(encoding="utf-8")), find_index()
    pythons = supported_pythons(read_project())
    with ThreadPoolExecutor(_CONNECTIONS) as pool:
        offered = list(pool.map(lambda name: list(list_files(index, name)), pins))
    blocks = []
    for (name, version), files in zip(pins.items(), offered, strict=True):
        chosen = choose_files(files, name, version, pythons)
        if not chosen:
            sys.exit(f"hashes: the index has no file of {name} {version}; set pip to one that has, or pin another")
        blocks.append(format_pin(name, version, chosen))
    HASHES.write_text(_HEADING + "".join(blocks), encoding="utf-8")
    print(f"{HASHES.name}: {len(blocks)} packages")


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


def choose_files(
    files: Iterable[IndexFile], name: str, version: str, pythons: Iterable[tuple[int, int]]
) -> list[IndexFile]:
    """Select the wheels of a version that one of the Python versions can install; without any, the source archive."""
    files, pythons = list(files), list(pythons)
    wheels = [file for file in files if _fits(file.name, name, version, pythons)]
    stem = f"{canonical(name)}-{version}"
    archives = [file for file in files if canonical_archive(file.name) == stem]
    return sorted(wheels or archives, key=lambda file: file.sha256)


def canonical_archive(filename: str) -> str:
    """Name and version of a source archive, such as `numpy-2.4.6`; empty if it is none."""
    found = re.fullmatch(r"(.+)-([^-]+)\.(?:tar\.gz|zip)", filename)
    return f"{canonical(found[1])}-{found[2]}" if found else ""


def _fits(filename: str, name: str, version: str, pythons: list[tuple[int, int]]) -> bool:
    """Tell whether a file is a wheel of this version for one of the Python versions (PEP 427)."""
    if not filename.endswith(".whl"):
        return False
    parts = filename.removesuffix(".whl").split("-")
    tags, abis = parts[-3].split("."), parts[-2].split(".")
    if canonical(parts[0]) != canonical(name) or parts[1] != version:
        return False
    return any(_tag_fits(tag, abi, pythons) for tag in tags for abi in abis)


def _tag_fits(tag: str, abi: str, pythons: list[tuple[int, int]]) -> bool:
    """Tell whether a Python tag with its ABI, such as cp311-cp311, cp39-abi3 or py3-none, suits a Python version."""
    found = re.fullmatch(r"(py|cp)(\d)(\d*)", tag)
    if not found:
        return False
    needed = (int(found[2]), int(found[3] or 0))
    if abi in ("none", "abi3"):
        return any(needed[0] == python[0] and needed <= python for python in pythons)
    return abi == tag and needed in pythons


def format_pin(name: str, version: str, files: Iterable[IndexFile]) -> str:
    """Format a pin with its hashes, as pip reads it."""
    return " \\\n".join([f"{name}=={version}", *(f"    --hash=sha256:{file.sha256}" for file in files)]) + "\n"


if __name__ == "__main__":
    main()
